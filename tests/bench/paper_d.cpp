// Paper D: table 2, gradient noise against a Fourier transform by triangles, and table 3, frame rates. Its figure 8 is drawn by
// coherent_bench.cpp.
#include <string>
#include <vector>

#include "client/gpu/gl_health.hpp"
#include "tests/bench/frame_stage.hpp"
#include "tests/bench/papers.hpp"

namespace trochoid::bench {
namespace {

struct Size {
    uint32_t rows, columns;
    double paper_triangles, noise_ms, fft_ms;  // theirs
};
/// Our largest screen grid has 524,288 triangles.
constexpr Size sizes[] = {{32, 64, 4'096, 2.45, 4.89},
                          {64, 128, 16'384, 3.14, 6.45},
                          {128, 256, 65'536, 4.18, 7.22},
                          {256, 512, 262'144, 5.69, 10.23},
                          {512, 512, 562'500, 13.25, 18.65}};

void table_2(Report& report) {
    fmt::print(
        "\nD, table 2: animating a mesh, 64 x 36 pixels, so that vertices cost and not pixels; the transform of 256² samples and its "
        "upload included (paper D: GeForce 8800 GT)\n{:>10} {:>12} {:>9} {:>12} {:>9} {:>12} {:>10} {:>10}\n",
        "triangles", "noise, paper", "ours ms", "FFT, paper", "ours ms", "60 trains ms", "FFT/noise",
        "theirs");
    const Camera camera = looking(10, -0.3, 1280, 720);
    const KnownSea sea{{wind_box(60)}, {}};
    Stage stage(64, 36);
    nlohmann::json triangles, theirs[2], ours[3];
    for (const Size& size : sizes) {
        if (report.quick() && size.rows > 128) continue;
        DrawOptions options = bare_options(MesherKind::projected);
        options.projected_rows = size.rows;
        options.projected_columns = size.columns;
        options.triangles_per_draw = 20'000;
        double ms[3];
        uint32_t count = 0;
        for (const Displacement displacement :
             {Displacement::noise, Displacement::fft, Displacement::trains}) {
            options.displacement = displacement;
            const FrameCost cost =
                stage.measure(scene_of(sea, camera, options), camera, options, report.quick() ? 1 : 4, 1);
            const size_t at = displacement == Displacement::noise ? 0
                              : displacement == Displacement::fft ? 1
                                                                  : 2;
            ms[at] = cost.work_ms();
            count = cost.report.sea_triangles;
            ours[at].push_back(ms[at]);
            report.figure(fmt::format("D: {} triangles, {}, ms", count, name_of(displacement)), ms[at]);
        }
        fmt::print("{:>10} {:>12.2f} {:>9.2f} {:>12.2f} {:>9.2f} {:>12.2f} {:>10.2f} {:>10.2f}\n", count,
                   size.noise_ms, ms[0], size.fft_ms, ms[1], ms[2], ms[1] / ms[0],
                   size.fft_ms / size.noise_ms);
        triangles.push_back(count);
        theirs[0].push_back(size.noise_ms);
        theirs[1].push_back(size.fft_ms);
    }
    report.plot({{"title", "D, table 2: time to animate by triangles"},
                 {"x", "triangles"},
                 {"y", "ms"},
                 {"log", true},
                 {"curves",
                  {{{"name", "paper D, noise"}, {"x", triangles}, {"y", theirs[0]}, {"dashed", true}},
                   {{"name", "paper D, FFT"}, {"x", triangles}, {"y", theirs[1]}, {"dashed", true}},
                   {{"name", "ours, noise"}, {"x", triangles}, {"y", ours[0]}},
                   {{"name", "ours, FFT"}, {"x", triangles}, {"y", ours[1]}},
                   {{"name", "ours, 60 trains"}, {"x", triangles}, {"y", ours[2]}}}}});
}

void table_3(Report& report) {
    fmt::print(
        "\nD, table 3: pictures a second (paper D: Kryachko 293,470 triangles 139; Bruneton et al. 226,200 137; paper D 250,000 225)\n"
        "{:<12} {:<14} {:>10} {:>10} {:>8}\n",
        "mesher", "displacement", "triangles", "frame, ms", "fps");
    const Camera camera = looking(20, -0.12, 1280, 720);
    Stage stage(1280, 720);
    std::vector<std::string> names{"Kryachko\n293 k", "Bruneton et al.\n226 k", "paper D\n250 k"};
    std::vector<double> rates{139, 137, 225};
    // In haste as many as the default error gives.
    const DrawOptions fine =
        report.quick() ? DrawOptions{} : options_for_triangles(MesherKind::coherent, 250'000, camera);
    for (const Displacement displacement : {Displacement::noise, Displacement::fft, Displacement::trains}) {
        DrawOptions options = bare_options(MesherKind::coherent);
        options.error_px = fine.error_px;
        options.sky = true;
        options.displacement = displacement;
        const auto source = sea_of_60_trains(TerrainGrid{});
        const FrameCost cost = stage.measure(scene_of(*source, camera, options), camera, options,
                                             report.quick() ? 1 : 4, report.quick() ? 1 : 2, 0.17);
        fmt::print("{:<12} {:<14} {:>10} {:>10.2f} {:>8.1f}\n", "coherent", name_of(displacement),
                   cost.report.sea_triangles, cost.ms, cost.fps());
        report.figure(fmt::format("D: coherent, {}, fps", name_of(displacement)), cost.fps());
        names.push_back(
            fmt::format("ours, {}\n{} k", name_of(displacement), cost.report.sea_triangles / 1'000));
        rates.push_back(cost.fps());
    }
    report.plot({{"title", is_software_gl() ? "D, table 3: theirs on a GPU of 2007, ours on a processor alone"
                                            : "D, table 3"},
                 {"x", ""},
                 {"y", "pictures a second"},
                 {"log", true},
                 {"categories", names},
                 {"bars", {{{"name", "coherent mesh, 1280 x 720"}, {"values", rates}}}}});
}

}  // namespace

void paper_d(Report& report) {
    table_2(report);
    table_3(report);
}

}  // namespace trochoid::bench
