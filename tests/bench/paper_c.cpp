// Paper C: frame rate by number of waves on a mesh of 40 x 20 (its figure 3), and its three methods on 60 x 30 (figures 8 and 9,
// section 6.2).
#include <string>
#include <vector>

#include "tests/bench/frame_stage.hpp"
#include "tests/bench/papers.hpp"

namespace trochoid::bench {
namespace {

DrawOptions mesh_of(uint32_t columns, uint32_t rows) {
    DrawOptions options = bare_options(MesherKind::projected);
    options.projected_columns = columns;
    options.projected_rows = rows;
    return options;
}

void by_waves(Report& report, Stage& stage) {
    fmt::print(
        "\nC, figure 3: 40 x 20 mesh, every wave at every vertex; at 64 x 36 vertices cost and not pixels\n{:>8} {:>16} {:>14}\n",
        "waves", "640 x 480, fps", "64 x 36, ms");
    const Camera camera = looking(10, -0.1, 640, 480);
    nlohmann::json waves, rates, small_rates;
    Stage small(64, 36);
    const int pictures = report.quick() ? 1 : 15;
    const int warm = report.quick() ? 1 : 2;
    for (const int n : {1, 10, 20, 40, 80, 160, 250}) {
        if (report.quick() && n != 1 && n != 40 && n != 250) continue;
        DrawOptions options = mesh_of(40, 20);
        options.authoritative = true;
        const KnownSea sea{{wind_box(n)}, {}};
        const SceneInput scene = scene_of(sea, camera, options);
        const double rate = stage.measure(scene, camera, options, pictures, warm).fps();
        const double vertices = small.measure(scene, camera, options, pictures, warm).work_ms();
        fmt::print("{:>8} {:>16.1f} {:>14.2f}\n", n, rate, vertices);
        report.figure(fmt::format("C: {} waves, fps", n), rate);
        report.figure(fmt::format("C: {} waves, 64 x 36, ms", n), vertices);
        waves.push_back(n);
        rates.push_back(rate);
        small_rates.push_back(1e3 / vertices);
    }
    report.plot({{"title", "C, figure 3: rate by number of waves, 40 x 20 mesh"},
                 {"x", "waves"},
                 {"y", "pictures a second"},
                 {"log_y", true},
                 {"curves",
                  {{{"name", "ours, 640 x 480"}, {"x", waves}, {"y", rates}},
                   {{"name", "ours, 64 x 36 (vertices cost)"}, {"x", waves}, {"y", small_rates}}}}});
}

void methods(Report& report, Stage& stage) {
    struct Method {
        FarMethod method;
        double theirs;  // frames a second
    };
    // "its rendering speed improves 2 frames or so compared to spectrum analysis", "maximum … only 20 fps", "22 frames/second or so"
    const Method all[] = {{FarMethod::spectrum, 18}, {FarMethod::texture, 22}, {FarMethod::combined, 20}};
    fmt::print(
        "\nC, section 6.2: the three methods, 60 trains at 640 x 480 (paper C: Pentium III, 800 MHz; spectrum there: every wave "
        "everywhere, and so here)\n{:<12} {:>10} {:>14} {:>14} {:>16} {:>14}\n",
        "method", "paper fps", "60 x 30, ms", "60 x 30, fps", "250 x 250, ms", "250 x 250, fps");
    const Camera camera = looking(10, -0.1, 640, 480);
    std::vector<std::string> names;
    std::vector<double> rates[3];
    const KnownSea sea{{wind_box(60)}, {}};
    for (const Method& one : all) {
        double ms[2];
        double rate[2];
        for (size_t k = 0; k < 2; ++k) {
            DrawOptions options = k == 0 ? mesh_of(60, 30) : mesh_of(250, 250);
            options.far_method = one.method;
            options.authoritative = one.method == FarMethod::spectrum;
            const FrameCost cost = stage.measure(scene_of(sea, camera, options), camera, options,
                                                 report.quick() ? 1 : 15, report.quick() ? 1 : 2);
            ms[k] = cost.work_ms();
            rate[k] = cost.fps();
        }
        fmt::print("{:<12} {:>10.0f} {:>14.2f} {:>14.1f} {:>16.2f} {:>14.1f}\n", name_of(one.method),
                   one.theirs, ms[0], rate[0], ms[1], rate[1]);
        report.figure(fmt::format("C: {}, 60 x 30, fps", name_of(one.method)), rate[0]);
        report.figure(fmt::format("C: {}, 250 x 250, fps", name_of(one.method)), rate[1]);
        names.emplace_back(name_of(one.method));
        rates[0].push_back(one.theirs);
        rates[1].push_back(rate[0]);
        rates[2].push_back(rate[1]);
    }
    report.plot({{"title", "C: three methods, 60 trains"},
                 {"x", "method"},
                 {"y", "pictures a second"},
                 {"categories", names},
                 {"bars",
                  {{{"name", "paper C, 60 x 30"}, {"values", rates[0]}, {"dashed", true}},
                   {{"name", "ours, 60 x 30"}, {"values", rates[1]}},
                   {{"name", "ours, 250 x 250"}, {"values", rates[2]}}}}});
}

}  // namespace

void paper_c(Report& report) {
    Stage stage(640, 480);
    by_waves(report, stage);
    methods(report, stage);
}

}  // namespace trochoid::bench
