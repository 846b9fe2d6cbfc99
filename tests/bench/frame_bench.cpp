// P8: a picture of 1280 x 720 with 250,000 triangles of sea and 60 trains by every mesher, what its passes take, and the viewer's
// qualities. Which bar applies follows from the device.
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/gpu/offscreen_context.hpp"
#include "tests/bench/frame_stage.hpp"
#include "tests/bench/report.hpp"

namespace trochoid::bench {
namespace {

constexpr double wanted_triangles = 250'000;
constexpr MesherKind all[] = {MesherKind::patches, MesherKind::uniform, MesherKind::projected,
                              MesherKind::coherent};
/// 10 m/s at 60 pictures a second.
constexpr double slow_flight_m = 0.17;

/// Most that a picture of 250,000 triangles may take, ms; none where the processor draws.
std::optional<double> frame_bar() {
    if (is_software_gl()) return std::nullopt;
    const std::string device = describe_gl();
    const bool few_raster_units =
        device.find("H100") != std::string::npos || device.find("H200") != std::string::npos;
    return few_raster_units ? 4.0 : 1.0;
}

Camera islands_view() {
    Camera camera = looking(12, -0.07, 1280, 720);
    camera.position = {to_lattice(-9'000), to_lattice(5'000)};
    camera.yaw = 4.36;
    return camera;
}

struct Measured {
    MesherKind kind;
    FrameCost cost;
};

void print_passes(const std::vector<Measured>& rows) {
    fmt::print("\nGPU time by pass, ms{}\n{:<12}",
               is_software_gl() ? " (a processor's timers give a pass what was waiting from others)" : "",
               "mesher");
    for (const PassTime& pass : rows.front().cost.report.passes) fmt::print("{:>9}", pass.name);
    fmt::print("{:>9}\n", "all");
    for (const Measured& row : rows) {
        fmt::print("{:<12}", name_of(row.kind));
        for (const PassTime& pass : row.cost.report.passes) fmt::print("{:>9.2f}", pass.ms);
        fmt::print("{:>9.2f}\n", row.cost.report.gpu_ms);
    }
}

/// Bars of the passes that take a hundredth of the picture somewhere.
void plot_passes(Report& report, const std::vector<Measured>& rows) {
    std::vector<std::string> names;
    for (size_t i = 0; i < rows.front().cost.report.passes.size(); ++i)
        for (const Measured& row : rows)
            if (row.cost.report.passes.size() > i &&
                row.cost.report.passes[i].ms > 0.01 * row.cost.report.gpu_ms) {
                names.emplace_back(row.cost.report.passes[i].name);
                break;
            }
    nlohmann::json bars = nlohmann::json::array();
    for (const Measured& row : rows) {
        std::vector<double> values;
        for (const std::string& name : names)
            for (const PassTime& pass : row.cost.report.passes)
                if (name == pass.name) values.push_back(pass.ms);
        bars.push_back({{"name", name_of(row.kind)}, {"values", values}});
    }
    report.plot({{"title", "A picture of 1280 x 720, 250,000 triangles, 60 trains: passes"},
                 {"x", "pass"},
                 {"y", "ms on the GPU"},
                 {"categories", names},
                 {"bars", bars}});
}

void meshers(Report& report) {
    const Camera camera = looking(20, -0.12, 1280, 720);
    Stage stage(camera.width, camera.height);
    std::vector<Measured> rows;
    fmt::print("{:<12} {:>10} {:>8} {:>9} {:>8} {:>9}\n", "mesher", "triangles", "draws", "frame, ms", "fps",
               "CPU, ms");
    for (const MesherKind kind : all) {
        const DrawOptions options = options_for_triangles(kind, wanted_triangles, camera);
        const auto source = sea_of_60_trains(TerrainGrid{});
        const FrameCost cost = stage.measure(scene_of(*source, camera, options), camera, options,
                                             report.quick() ? 3 : 15, report.quick() ? 2 : 4, slow_flight_m);
        fmt::print("{:<12} {:>10} {:>8} {:>9.2f} {:>8.1f} {:>9.2f}\n", name_of(kind),
                   cost.report.sea_triangles, cost.report.draws, cost.ms, cost.fps(), cost.report.cpu_ms);
        const std::string name{name_of(kind)};
        report.figure(name + ", triangles", cost.report.sea_triangles);
        report.figure(name + ", ms", cost.ms);
        for (const PassTime& pass : cost.report.passes)
            report.figure(fmt::format("{}, pass {}, ms", name, pass.name), pass.ms);
        report.at_most(name + ": triangles off 250,000",
                       100 * std::abs(cost.report.sea_triangles - wanted_triangles) / wanted_triangles, 10,
                       "%");
        if (const auto bar = frame_bar(); bar && kind == DrawOptions{}.mesher)
            report.at_most(name + ", the default mesher: a picture", cost.ms, *bar, " ms");
        rows.push_back({kind, cost});
    }
    std::vector<std::string> names;
    std::vector<double> times;
    for (const Measured& row : rows) {
        names.emplace_back(name_of(row.kind));
        times.push_back(row.cost.ms);
    }
    report.plot(
        {{"title", "A picture of 1280 x 720, 250,000 triangles, 60 trains"},
         {"x", "mesher"},
         {"y", "ms"},
         {"categories", names},
         {"bars", {{{"name", is_software_gl() ? "on the processor" : "on the GPU"}, {"values", times}}}}});
    print_passes(rows);
    if (!is_software_gl()) plot_passes(report, rows);
}

/// What a picture of the default quality costs less when something is left out: on software renderers, whose timers tell little, too.
void left_out(Report& report) {
    struct Part {
        const char* name;
        void (*leave_out)(DrawOptions& options);
    };
    const Part parts[] = {{"nothing", [](DrawOptions&) {}},
                          {"land", [](DrawOptions& o) { o.land = false; }},
                          {"far sea", [](DrawOptions& o) { o.far_sea = false; }},
                          {"sky", [](DrawOptions& o) { o.sky = false; }},
                          {"foam, spray", [](DrawOptions& o) { o.foam_history = o.spray = false; }},
                          {"waves", [](DrawOptions& o) { o.layers = Layers{}; }},
                          {"half its pixels", [](DrawOptions& o) { o.render_scale = 0.7F; }}};
    const Camera camera = islands_view();
    const auto source = sea_of_60_trains(shipped_terrain());
    double whole = 0;
    fmt::print(
        "\ndefault quality, islands: what leaving something out saves{}\n",
        is_software_gl() ? ", ms of a core (the processor's timers do not tell passes apart)" : ", ms");
    for (const Part& part : parts) {
        DrawOptions options;
        part.leave_out(options);
        Stage stage(camera.width, camera.height, options.samples, options.render_scale);
        const double ms =
            stage.measure(scene_of(*source, camera, options), camera, options, 3, 1, slow_flight_m).work_ms();
        if (whole == 0) whole = ms;
        fmt::print("{:<18} {:>9.2f} {:>9.2f}\n", part.name, ms, whole - ms);
        report.figure(fmt::format("default quality without {}, ms", part.name), ms);
    }
}

/// The viewer's own qualities over the shipped islands.
void qualities(Report& report) {
    const TerrainGrid islands = shipped_terrain();
    const Camera camera = islands_view();
    fmt::print("\nqualities at 1280 x 720, islands, 60 trains\n{:<12} {:>10} {:>9} {:>8}\n", "quality",
               "triangles", "frame, ms", "fps");
    std::vector<std::string> names;
    std::vector<double> rates;
    for (const Quality quality : {Quality::low, Quality::medium, Quality::high}) {
        if (report.quick() && quality == Quality::high) continue;
        const DrawOptions options = options_for(quality);
        const auto source = sea_of_60_trains(islands);
        Stage stage(camera.width, camera.height, options.samples);
        const bool slow = quality == Quality::high && is_software_gl();
        const FrameCost cost = stage.measure(scene_of(*source, camera, options), camera, options,
                                             slow             ? 2
                                             : report.quick() ? 5
                                                              : 15,
                                             slow ? 1 : 4, slow_flight_m);
        fmt::print("{:<12} {:>10} {:>9.2f} {:>8.1f}\n", name_of(quality),
                   cost.report.sea_triangles + cost.report.land_triangles, cost.ms, cost.fps());
        report.figure(fmt::format("quality {}, fps", name_of(quality)), cost.fps());
        names.emplace_back(name_of(quality));
        rates.push_back(cost.fps());
        if (options == DrawOptions{}) report.at_least("default quality, pictures a second", cost.fps(), 5.0);
    }
    report.plot({{"title", "Pictures a second at 1280 x 720 by quality, islands, 60 trains"},
                 {"x", "quality"},
                 {"y", "1/s"},
                 {"categories", names},
                 {"bars", {{{"name", "patches, the default mesher"}, {"values", rates}}}}});
}

void bench(Report& report) {
    const OffscreenContext context;
    const std::string device = describe_gl();
    fmt::print("{}\n", device);
    report.text("device", device);
    meshers(report);
    qualities(report);
    if (!report.quick()) left_out(report);
    report.write(fmt::format("{:.1f} fps at the default quality, {:.1f} ms for 250,000 triangles, {};",
                             report.kept("quality medium, fps"),
                             report.kept(std::string(name_of(DrawOptions{}.mesher)) + ", ms"), device));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
