// B8: long waves on a coarser grid, interpolated: what it saves, what it errs, and that the error keeps its bound.
#include <cmath>
#include <vector>

#include "protocol/model/simd/coarse_grid.hpp"
#include "tests/bench/grid_case.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"

namespace trochoid::bench {
namespace {

/// Displacement, as a mesh needs it, of a grid with points a quarter of a metre apart.
struct Mesh {
    explicit Mesh(const LatticeGrid& g) : grid(g), ax(g.size()), ay(g.size()), az(g.size()) {}
    SurfacePlanes planes() { return {.ax = ax.data(), .ay = ay.data(), .az = az.data()}; }
    LatticeGrid grid;
    std::vector<float> ax, ay, az;
};

void bench(Report& report) {
    const int32_t side = report.quick() ? 256 : 512;
    const LatticeGrid grid{{-70'000, 30'000}, 256, 256, side, side};
    Workers one_core(1);
    Mesh exact(grid);
    Mesh mesh(grid);
    bool bounds_hold = true;
    double recommended = 0.0;
    fmt::print(
        "{}^2 points, 0.25 m apart, displacement, one core\n{:>7} {:>7} {:>6} {:>13} {:>10} {:>10} {:>8} {:>12} {:>12}\n",
        side, "trains", "factor", "ratio", "interpolated", "exact, ms", "coarse, ms", "faster", "error, mm",
        "bound, mm");
    nlohmann::json curves = nlohmann::json::array();
    for (const int trains : {4, 16, 60}) {
        const SeaInstant sea(open_sea(trains), {123'456'789});
        nlohmann::json factors = nlohmann::json::array();
        nlohmann::json gains = nlohmann::json::array();
        for (const int factor : {4, 8, 16})
            for (const double ratio : {12.0, 24.0}) {
                const CoarseOptions options{factor, ratio};
                CoarseBound bound;
                const Interleaved times(
                    {[&] { evaluate_grid(sea, grid, exact.planes(), one_core); },
                     [&] { bound = evaluate_coarse_grid(sea, grid, mesh.planes(), options, one_core); }},
                    report.quick() ? 5 : 15, report.quick() ? 0.001 : 0.01);
                double error = 0.0;
                for (size_t i = 0; i < grid.size(); ++i)
                    error = std::max(
                        error, std::abs(static_cast<double>(exact.ay[i]) - static_cast<double>(mesh.ay[i])));
                bounds_hold = bounds_hold && error <= bound.height;
                const double faster = times.ratio(0, 1);
                fmt::print("{:>7} {:>7} {:>6.0f} {:>13} {:>10.3f} {:>10.3f} {:>8.2f} {:>12.3f} {:>12.3f}\n",
                           trains, factor, ratio, bound.trains, times.time(0) * 1e3, times.time(1) * 1e3,
                           faster, error * 1e3, bound.height * 1e3);
                if (ratio == 24.0) {
                    factors.push_back(factor);
                    gains.push_back(faster);
                    if (trains == 60 && factor == 8) recommended = faster;
                }
                report.figure(fmt::format("{} trains, factor {}, ratio {}: faster", trains, factor, ratio),
                              faster);
            }
        curves.push_back(
            {{"name", fmt::format("{} trains of 8 to 200 m", trains)}, {"x", factors}, {"y", gains}});
    }
    report.plot({{"title", "Long waves on a coarser grid, the others exact (at least 24 steps a wave)"},
                 {"x", "coarse step / step"},
                 {"y", "times faster than all exact"},
                 {"curves", curves}});
    report.check("the bound holds at every point", bounds_hold ? "yes" : "no", "yes", bounds_hold);
    report.at_least("60 trains, factor 8, ratio 24, against every point exact", recommended, 1.2, "x");
    report.write(fmt::format("{:.2f}x", recommended));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
