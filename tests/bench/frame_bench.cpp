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

/// In haste fewer.
double wanted_triangles(const Report& report) { return report.quick() ? 60'000 : 250'000; }
constexpr MesherKind all[] = {MesherKind::patches, MesherKind::uniform, MesherKind::projected,
                              MesherKind::coherent};
/// 10 m/s at 60 pictures a second.
constexpr double slow_flight_m = 0.17;

std::string with_commas(double thousands) { return fmt::format("{:.0f},000", thousands / 1e3); }

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
    fmt::print(
        "\n{}\n{:<12}",
        rows.front().cost.report.passes_waited
            ? "time by pass, ms, each waited for (where the processor draws its own timers tell nothing)"
            : "GPU time by pass, ms",
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
    report.plot({{"title", "Passes of a picture of 1280 x 720, 60 trains"},
                 {"x", "pass"},
                 {"y", is_software_gl() ? "ms, each pass waited for" : "ms on the GPU"},
                 {"categories", names},
                 {"bars", bars}});
}

void meshers(Report& report) {
    const Camera camera = looking(20, -0.12, 1280, 720);
    Stage stage(camera.width, camera.height);
    std::vector<Measured> rows;
    const double wanted = wanted_triangles(report);
    fmt::print("{:<12} {:>10} {:>8} {:>9} {:>8} {:>9}\n", "mesher", "triangles", "draws", "frame, ms", "fps",
               "CPU, ms");
    for (const MesherKind kind : all) {
        DrawOptions options = options_for_triangles(kind, wanted, camera, report.quick() ? 0.08 : 0.01);
        const auto source = sea_of_60_trains(TerrainGrid{});
        const SceneInput scene = scene_of(*source, camera, options);
        FrameCost cost = stage.measure(scene, camera, options, report.quick() ? 1 : 15,
                                       report.quick() ? 1 : 4, slow_flight_m);
        if (is_software_gl()) {
            options.time_passes = true;
            const FrameReport waited = stage
                                           .measure(scene, camera, options, report.quick() ? 1 : 5,
                                                    report.quick() ? 0 : 1, slow_flight_m)
                                           .report;
            cost.report.passes = waited.passes;
            cost.report.passes_waited = waited.passes_waited;
            cost.report.gpu_ms = 0;
            for (const PassTime& pass : waited.passes) cost.report.gpu_ms += pass.ms;
        }
        fmt::print("{:<12} {:>10} {:>8} {:>9.2f} {:>8.1f} {:>9.2f}\n", name_of(kind),
                   cost.report.sea_triangles, cost.report.draws, cost.ms, cost.fps(), cost.report.cpu_ms);
        const std::string name{name_of(kind)};
        report.figure(name + ", triangles", cost.report.sea_triangles);
        report.figure(name + ", ms", cost.ms);
        for (const PassTime& pass : cost.report.passes)
            report.figure(fmt::format("{}, pass {}, ms", name, pass.name), pass.ms);
        report.at_most(fmt::format("{}: triangles off {}", name, with_commas(wanted)),
                       100 * std::abs(cost.report.sea_triangles - wanted) / wanted, 10, "%");
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
        {{"title", fmt::format("A picture of 1280 x 720, {} triangles, 60 trains", with_commas(wanted))},
         {"x", "mesher"},
         {"y", "ms"},
         {"categories", names},
         {"bars", {{{"name", is_software_gl() ? "on the processor" : "on the GPU"}, {"values", times}}}}});
    print_passes(rows);
    plot_passes(report, rows);
}

/// As the viewer draws a quality: lean where the processor draws.
DrawOptions viewers(Quality quality) {
    DrawOptions options = options_for(quality);
    options.lean = is_software_gl();
    return options;
}

/// What a picture of the default quality costs less when something is left out.
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
                          {"leanness", [](DrawOptions& o) { o.lean = false; }},
                          {"waves", [](DrawOptions& o) { o.layers = Layers{}; }},
                          {"half its pixels", [](DrawOptions& o) { o.render_scale = 0.7F; }}};
    const Camera camera = islands_view();
    const auto source = sea_of_60_trains(shipped_terrain());
    double whole = 0;
    fmt::print("\ndefault quality, islands: what leaving something out saves{}\n",
               is_software_gl() ? ", ms of a core" : ", ms");
    for (const Part& part : parts) {
        DrawOptions options = viewers(Quality::medium);
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
    fmt::print("\nqualities at 1280 x 720, islands, 60 trains\n{:<12} {:>10} {:>9} {:>8} {:>14}\n", "quality",
               "triangles", "frame, ms", "fps", "ms of a core");
    std::vector<std::string> names;
    std::vector<double> rates;
    for (const Quality quality : {Quality::low, Quality::medium, Quality::high}) {
        if (report.quick() && quality != Quality::medium) continue;
        const DrawOptions options = viewers(quality);
        const auto source = sea_of_60_trains(islands);
        Stage stage(camera.width, camera.height, options.samples);
        const bool slow = quality == Quality::high && is_software_gl();
        const FrameCost cost = stage.measure(scene_of(*source, camera, options), camera, options,
                                             slow             ? 2
                                             : report.quick() ? 4
                                                              : 15,
                                             slow             ? 1
                                             : report.quick() ? 2
                                                              : 4,
                                             slow_flight_m);
        fmt::print("{:<12} {:>10} {:>9.2f} {:>8.1f} {:>14.2f}\n", name_of(quality),
                   cost.report.sea_triangles + cost.report.land_triangles, cost.ms, cost.fps(), cost.core_ms);
        report.figure(fmt::format("quality {}, fps", name_of(quality)), cost.fps());
        report.figure(fmt::format("quality {}, ms of a core", name_of(quality)), cost.core_ms);
        names.emplace_back(name_of(quality));
        rates.push_back(cost.fps());
        if (quality == Quality::medium)
            report.at_least("default quality, pictures a second", cost.fps(), 5.0);
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
    report.write(fmt::format("{:.1f} fps at the default quality, {:.1f} ms for {} triangles, {};",
                             report.kept("quality medium, fps"),
                             report.kept(std::string(name_of(DrawOptions{}.mesher)) + ", ms"),
                             with_commas(wanted_triangles(report)), device));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
