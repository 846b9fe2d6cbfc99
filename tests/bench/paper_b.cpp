// Paper B, section 5: trains that its filter leaves to evaluate a vertex, frame rates by screen grid, and its complexity argument
// against a Fourier transform at equal density, worked out and measured.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "client/scene/fft_sea.hpp"
#include "client/scene/projected_grid.hpp"
#include "tests/bench/frame_stage.hpp"
#include "tests/bench/grid_case.hpp"
#include "tests/bench/papers.hpp"
#include "tests/bench/stopwatch.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid::bench {
namespace {

/// A coarse level shows a wave whole with so many vertices a wave (spacings_of_full_show).
constexpr double vertices_a_wave = 4.0;

DrawOptions grid_of(uint32_t n) {
    DrawOptions options = bare_options(MesherKind::projected);
    options.projected_rows = options.projected_columns = n;
    options.triangles_per_draw = 20'000;
    return options;
}

/// Mean number of trains that a vertex evaluates, as the shaders count it; places that triangles share count once.
double evaluated_of(const InterestState& state, const Camera& camera, const DrawOptions& options) {
    const Probe probe = probe_view(state, SeaTime{60'000'000}, camera, options);
    std::vector<std::tuple<int32_t, int32_t, uint32_t>> seen;
    seen.reserve(probe.vertices.size());
    for (const ProbedVertex& v : probe.vertices) seen.emplace_back(v.x, v.z, v.trains_evaluated);
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    double sum = 0;
    for (const auto& [x, z, trains] : seen) sum += trains;
    return seen.empty() ? 0.0 : sum / static_cast<double>(seen.size());
}

/// Shares of the trains that a vertex evaluates, means over a screen grid; worked out as the shaders filter.
struct Shares {
    double by_direction = 0;  ///< each train by the spacing along its own direction, as projected.vert does
    double by_longest = 0;    ///< all by the longest spacing, as paper B does
    double with_levels = 0;   ///< each evaluated only on a level coarse enough for it: an estimate, as theirs
};

Shares shares_of(const std::vector<WaveTrain>& trains, const Camera& camera, const DrawOptions& options) {
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    const ProjectedView view = projected_view(frame);
    const DisplayFilter filter = display_filter(view_of(camera, glm::dvec3(0)), options.error_px);
    const ProjectedGrid grid =
        make_projected_grid(view, {1.5F, 1.5F}, {options.projected_rows, options.projected_columns}, 1.0);
    Shares sum;
    double vertices = 0;
    for (size_t row = 0; row < grid.rows.size(); ++row)
        for (uint32_t column = 0; column <= grid.columns; column += std::max(1U, grid.columns / 8)) {
            const VertexSteps steps = steps_at(view, grid, row, column);
            const float side = 2.0F * static_cast<float>(column) / static_cast<float>(grid.columns) - 1.0F;
            const float wanted = vertex_spacing(
                filter, std::hypot(grid.rows[row].forward, side * grid.rows[row].half_width, frame.altitude));
            const float cell = std::max(grid.rows[row].along, glm::length(steps.across));
            const float longest = std::max(cell, wanted);
            const float least = std::max(cell * least_spacing_share, wanted);
            ++vertices;
            for (const WaveTrain& train : trains) {
                const TrainConstants c = derive_constants(train);
                const glm::vec2 k{c.kx, c.kz};
                if (displayed_weight(c.wavelength, longest) > 0.0F) ++sum.by_longest;
                if (displayed_weight(c.wavelength, wave_spacing(steps, k, c.wavelength, least)) <= 0.0F)
                    continue;
                ++sum.by_direction;
                const auto level = [&](glm::vec2 step) {
                    return std::min(1.0, vertices_a_wave * std::abs(static_cast<double>(glm::dot(k, step))) /
                                             6.283185307);
                };
                sum.with_levels += level(steps.along) * level(steps.across);
            }
        }
    const double all = std::max(1.0, vertices * static_cast<double>(trains.size()));
    return {sum.by_direction / all, sum.by_longest / all, sum.with_levels / all};
}

/// Trains as paper B's argument has them: evenly over the frequencies up to that which the nearest row just shows.
std::vector<WaveTrain> even_in_frequency(int count, const Camera& camera, const DrawOptions& options) {
    const ProjectedView view = projected_view(frame_of(camera, DepthRange::classic));
    const ProjectedGrid grid =
        make_projected_grid(view, {1.5F, 1.5F}, {options.projected_rows, options.projected_columns}, 1.0);
    const ProjectedRow& nearest = grid.rows.front();
    const double shortest = static_cast<double>(spacings_of_first_show) *
                            std::max(static_cast<double>(nearest.along),
                                     2.0 * static_cast<double>(nearest.half_width) / grid.columns);
    std::vector<WaveTrain> trains;
    for (int i = 0; i < count; ++i) {
        const double slower = count / (i + 0.5);
        trains.push_back(deep_train(shortest * slower * slower, 0.4 + std::fmod(i * 0.618, 1.0) * 2.0 - 1.0,
                                    0.01F, 0.8F, 0));
    }
    return trains;
}

/// Why the share differs from theirs: how high the camera stands, and which trains there are.
void shares_by_camera(Report& report) {
    fmt::print(
        "\nB, section 5.3: share of 60 trains evaluated a vertex, 100^2, by camera. Theirs, 1/2 and 1/12, assume a spectrum even in "
        "frequency without an end, one spacing for all directions\n"
        "{:>7} {:>6} {:>22} {:>26} {:>24}\n{:>7} {:>6} {:>11} {:>10} {:>13} {:>12} {:>12} {:>11}\n",
        "", "", "trains of 3 to 90 m", "even in frequency", "with levels", "height", "pitch", "one spacing",
        "direction", "one spacing", "direction", "3 to 90 m", "even");
    DrawOptions options = grid_of(100);
    options.error_px = 0.5F;  // the grid alone filters
    const std::vector<WaveTrain> ours = wind_box(60).trains;
    for (const double pitch : {-0.1, -0.4})
        for (const double height : {3.0, 10.0, 40.0, 200.0}) {
            const Camera camera = looking(height, pitch, 640, 480);
            const Shares a = shares_of(ours, camera, options);
            const Shares b = shares_of(even_in_frequency(60, camera, options), camera, options);
            fmt::print(
                "{:>5.0f} m {:>6.1f} {:>10.0f}% {:>9.0f}% {:>12.0f}% {:>11.0f}% {:>11.1f}% {:>10.1f}%\n",
                height, pitch, 100 * a.by_longest, 100 * a.by_direction, 100 * b.by_longest,
                100 * b.by_direction, 100 * a.with_levels, 100 * b.with_levels);
            const std::string name = fmt::format("B: from {:.0f} m, pitch {:.1f}: ", height, pitch);
            report.figure(name + "share of 3 to 90 m, %", 100 * a.by_direction);
            report.figure(name + "share of trains even in frequency, %", 100 * b.by_direction);
            report.figure(name + "the same by one spacing, %", 100 * b.by_longest);
            report.figure(name + "the same with coarse levels, %", 100 * b.with_levels);
        }
}

struct Row {
    uint32_t n;
    int trains;
    double evaluated;
    double with_levels;
};

const char* theirs(uint32_t n, int trains) {
    if (n == 50 && trains == 30) return "15-30";
    if (n == 100 && trains == 30) return "3-5";
    if (n == 500 && trains == 60) return "0.1";
    return "-";
}

std::vector<Row> screen_grids(Report& report, Stage& stage) {
    fmt::print(
        "\nB, section 5: screen grids at 640 x 480 (paper B: Pentium III, 800 MHz); trains evaluated a vertex (paper B: 1/2; with "
        "coarse levels 1/12, an estimate of theirs, of ours too)\n"
        "{:>8} {:>7} {:>10} {:>8} {:>12} {:>8} {:>10} {:>9} {:>10} {:>12}\n",
        "grid", "trains", "evaluated", "share", "with levels", "share", "fps paper", "ours", "frame, ms",
        "with FFT, ms");
    std::vector<Row> rows;
    std::vector<std::string> names;
    std::vector<double> shares[2];
    std::vector<double> frames[2];
    const Camera camera = looking(10, -0.1, 640, 480);
    for (const uint32_t n : {50U, 100U, 500U})
        for (const int trains : {30, 60}) {
            if (report.quick() && n == 500 && trains == 30) continue;
            const KnownSea sea{{wind_box(trains)}, {}};
            DrawOptions options = grid_of(n);
            const SceneInput scene = scene_of(sea, camera, options);
            const int pictures = report.quick() ? 1 : n == 500 ? 4 : 9;
            const int warm = !report.quick() ? 2 : n == 500 ? 0 : 1;
            const FrameCost cost = stage.measure(scene, camera, options, pictures, warm);
            const double ms = cost.work_ms();
            options.displacement = Displacement::fft;
            const double fft = stage.measure(scene, camera, options, pictures, warm).work_ms();
            options.displacement = Displacement::trains;
            const Row row{n, trains, evaluated_of(*scene.state, camera, options),
                          trains * shares_of(sea.boxes[0].trains, camera, options).with_levels};
            rows.push_back(row);
            fmt::print(
                "{:>6}^2 {:>7} {:>10.1f} {:>7.0f}% {:>12.2f} {:>7.0f}% {:>10} {:>9.1f} {:>10.2f} {:>12.2f}\n",
                n, trains, row.evaluated, 100 * row.evaluated / trains, row.with_levels,
                100 * row.with_levels / trains, theirs(n, trains), cost.fps(), ms, fft);
            const std::string name = fmt::format("B: {}^2, {} trains: ", n, trains);
            report.figure(name + "share evaluated, %", 100 * row.evaluated / trains);
            report.figure(name + "share with coarse levels, %", 100 * row.with_levels / trains);
            report.figure(name + "fps", cost.fps());
            report.figure(name + "frame, ms", ms);
            report.figure(name + "frame with a Fourier tile, ms", fft);
            names.push_back(fmt::format("{}²\n{} trains", n, trains));
            shares[0].push_back(row.evaluated / trains);
            shares[1].push_back(row.with_levels / trains);
            frames[0].push_back(ms);
            frames[1].push_back(fft);
        }
    const std::vector<double> half(names.size(), 0.5);
    const std::vector<double> twelfth(names.size(), 1.0 / 12);
    report.plot({{"title", "B: share of trains evaluated a vertex"},
                 {"x", "screen grid"},
                 {"y", "share"},
                 {"categories", names},
                 {"bars",
                  {{{"name", "paper B"}, {"values", half}, {"dashed", true}},
                   {{"name", "ours, counted"}, {"values", shares[0]}},
                   {{"name", "paper B, coarse levels"}, {"values", twelfth}, {"dashed", true}},
                   {{"name", "ours, coarse levels (estimate)"}, {"values", shares[1]}}}}});
    report.plot({{"title", "B: a picture of 640 x 480"},
                 {"x", "screen grid"},
                 {"y", "ms"},
                 {"log", true},
                 {"categories", names},
                 {"bars",
                  {{{"name", "wave trains"}, {"values", frames[0]}},
                   {{"name", "Fourier tile of 256², same grid"}, {"values", frames[1]}}}}});
    return rows;
}

double transform_ms(uint32_t side, int rounds) {
    FftSeaSettings settings;
    settings.side = side;
    FftSea sea(settings);
    sea.transform(1.0);
    std::vector<double> times;
    for (int i = 0; i < rounds; ++i)
        times.push_back(1e3 * seconds([&] { sea.transform(2.0 + i); }, Clock::thread));
    return median(times);
}

double sum_ms(int trains, double points, int rounds) {
    GridCase grid(std::max(1, trains), static_cast<int32_t>(std::lround(std::sqrt(points))));
    Workers one_core(1);
    grid.evaluate(one_core);
    std::vector<double> times;
    for (int i = 0; i < rounds; ++i)
        times.push_back(1e3 * seconds([&] { grid.evaluate(one_core); }, Clock::thread));
    return median(times);
}

/// Section 5.3: n samples in the nearest row need 3n x 2n of a Fourier tile and n x 4n/3 of a screen grid.
void against_fourier(Report& report, const std::vector<Row>& rows) {
    const int rounds = report.quick() ? 1 : 7;
    fmt::print(
        "\nB, section 5.3: equal density near the camera, one CPU core. Operations: 6n² log2 6n² against 4/3 n² m, m of the table "
        "above; measured: a transform of the next smaller 2^k samples a side, scaled to 6n², against our sum with normals over 4/3 n² "
        "points\n{:>6} {:>7} {:>6} {:>14} {:>14} {:>8} {:>10} {:>10} {:>8}\n",
        "n", "trains", "m", "theirs, FFT", "trochoids", "ratio", "FFT, ms", "sum, ms", "ratio");
    for (const Row& row : rows) {
        if (row.trains != 60) continue;
        const double n = row.n;
        const double samples = 6 * n * n;
        const double points = 4.0 / 3 * n * n;
        const double operations = samples * std::log2(samples);
        uint32_t side = 16;
        while (side < 1'024 && 4.0 * side * side <= samples) side *= 2;
        const double own = static_cast<double>(side) * side;
        const double fft = transform_ms(side, rounds) * operations / (own * std::log2(own));
        const double sum = sum_ms(static_cast<int>(std::lround(row.evaluated)), points, rounds);
        fmt::print("{:>6} {:>7} {:>6.1f} {:>14.0f} {:>14.0f} {:>8.1f} {:>10.2f} {:>10.3f} {:>8.1f}\n", row.n,
                   row.trains, row.evaluated, operations, points * row.evaluated,
                   operations / (points * row.evaluated), fft, sum, fft / sum);
        report.figure(fmt::format("B: n = {}: FFT operations over trochoids", row.n),
                      operations / (points * row.evaluated));
        report.figure(fmt::format("B: n = {}: FFT time over the sum's", row.n), fft / sum);
    }
}

}  // namespace

void paper_b(Report& report) {
    Stage stage(640, 480);
    const std::vector<Row> rows = screen_grids(report, stage);
    shares_by_camera(report);
    against_fourier(report, rows);
}

}  // namespace trochoid::bench
