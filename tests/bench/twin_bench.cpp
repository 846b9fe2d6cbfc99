// R2: every mesher's vertices, read back by transform feedback, against the CPU at the same places: seas of 10 m, now and in ten
// years, here and 9000 km away, over a coast with fields.
#include <algorithm>
#include <string>

#include "client/gpu/offscreen_context.hpp"
#include "tests/bench/report.hpp"
#include "tests/gpu/fixture_sea.hpp"
#include "tests/gpu/sea_comparison.hpp"

namespace trochoid::bench {
namespace {

constexpr double bar_mm = 0.1;

struct Case {
    const char* name;
    double east_m, south_m;
    int64_t years;
};
constexpr Case cases[] = {{"coast, now", -900, -2'600, 0},
                          {"9000 km away, now", 9'000'123.25, -7'654'321.75, 0},
                          {"coast, in ten years", -900, -2'600, 10},
                          {"9000 km away, in ten years", 9'000'123.25, -7'654'321.75, 10}};
constexpr int64_t us_a_year = 31'557'600'098'765;

/// Waves of 10 m significant height over the fixture's sea.
WaveTrainBox storm() {
    WaveTrainBox box;
    box.id = {3};
    box.first_train = {200};
    box.begin = {-sea_time_bound};
    box.trains = wind_sea(180.0, 0.6, 10.0, 32, 11);
    return box;
}

Comparison compare(MesherKind kind, const Case& one) {
    FixtureSource source(shipped_terrain());
    source.add_box(storm());
    Camera camera;
    camera.position = {to_lattice(one.east_m), to_lattice(one.south_m)};
    camera.fraction_x = 0.25;
    camera.altitude_m = 30;
    camera.pitch = -0.2;
    camera.width = 512;
    camera.height = 288;
    DrawOptions options;
    options.mesher = kind;
    options.error_px = 12.0F;
    options.projected_rows = 150;
    options.projected_columns = 100;
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source.set_view(view);
    return compare_sea(source.state(), SeaTime{one.years * us_a_year + 73'500'123}, camera, options);
}

void bench(Report& report) {
    const OffscreenContext context;
    const std::string device = describe_gl();
    report.text("device", device);
    double worst = 0;
    size_t vertices = 0;
    size_t bits = 0;
    for (const MesherKind kind :
         {MesherKind::patches, MesherKind::uniform, MesherKind::projected, MesherKind::coherent}) {
        Comparison all;
        for (const Case& one : cases) {
            if (report.quick() && (one.years == 0) != (one.east_m > 0)) continue;
            fmt::print("{}, {}\n  ", name_of(kind), one.name);
            const Comparison c = compare(kind, one);
            all.vertices += c.vertices;
            all.moved += c.moved;
            all.phase_differs += c.phase_differs;
            all.bits_differ += c.bits_differ;
            all.worst_mm = std::max(all.worst_mm, c.worst_mm);
        }
        const std::string name{name_of(kind)};
        report.at_least(name + ": vertices that move", static_cast<double>(all.moved), 1'000);
        report.at_most(name + ": vertices whose phases differ", static_cast<double>(all.phase_differs), 0);
        report.at_most(name + ": largest difference of displacement", all.worst_mm, bar_mm, " mm");
        report.figure(name + ", vertices", static_cast<double>(all.vertices));
        report.figure(name + ", vertices whose bits differ", static_cast<double>(all.bits_differ));
        report.figure(name + ", largest difference, mm", all.worst_mm);
        vertices += all.vertices;
        bits += all.bits_differ;
        worst = std::max(worst, all.worst_mm);
    }
    report.write(fmt::format("{:.6f} mm at most, bits differ at {} of {} vertices, {};", worst, bits,
                             vertices, device));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
