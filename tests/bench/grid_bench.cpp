// P1: the grid kernel against std::sin and std::cos in double, each vector target against its own bound, and dispatch
// against -march=native.
#include <cmath>
#include <string>
#include <vector>

#include "protocol/model/simd/vector_target.hpp"
#include "tests/bench/grid_case.hpp"
#include "tests/bench/native_grid.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"
#include "tests/bench/vector_rate.hpp"

namespace trochoid::bench {
namespace {

/// The opponent: the same sum as anybody would write it, in double with the C library's sine and cosine.
class PlainGrid {
public:
    explicit PlainGrid(const GridCase& grid) : grid_(grid.grid()) {
        const LiveBox& live = grid.instant().live()[0];
        constexpr double turn = 6.283185307179586;
        for (size_t i = 0; i < live.phase.size(); ++i) {
            const WaveTrain& t = live.box->record.trains[i];
            const TrainConstants& c = live.box->constants[i];
            trains_.push_back({t.kx * turn / 4194304.0, t.kz * turn / 4194304.0,
                               live.phase[i] * turn / 4294967296.0, static_cast<double>(c.a),
                               static_cast<double>(c.hx), static_cast<double>(c.hz)});
        }
        for (auto& plane : planes_) plane.resize(grid_.size());
    }
    void evaluate() {
        size_t at = 0;
        for (int32_t j = 0; j < grid_.nz; ++j)
            for (int32_t i = 0; i < grid_.nx; ++i) point(grid_.at(i, j), at++);
    }
    double plane(size_t which, size_t at) const { return planes_[which][at]; }

private:
    struct Train {
        double kx, kz, phase, a, hx, hz;
    };
    void point(LatticePoint p, size_t at) {
        const double x = to_metres(p.x);
        const double z = to_metres(p.z);
        double ax = 0, ay = 0, az = 0, bx = 0, bz = 0, mxx = 0, mxz = 0, mzx = 0, mzz = 0;
        for (const Train& t : trains_) {
            const double phase = t.kx * x + t.kz * z + t.phase;
            const double s = std::sin(phase);
            const double c = std::cos(phase);
            ax += t.hx * s;
            ay += t.a * c;
            az += t.hz * s;
            bx += t.a * t.kx * s;
            bz += t.a * t.kz * s;
            mxx += t.hx * t.kx * c;
            mxz += t.hx * t.kz * c;
            mzx += t.hz * t.kx * c;
            mzz += t.hz * t.kz * c;
        }
        const double pxx = 1 - mxx, pzz = 1 - mzz, pxz = -mxz, pzx = -mzx, yx = -bx, yz = -bz;
        const double values[6] = {
            ax, ay, az, yz * pzx - pzz * yx, pzz * pxx - pxz * pzx, pxz * yx - yz * pxx};
        for (size_t i = 0; i < 6; ++i) planes_[i][at] = values[i];
    }
    LatticeGrid grid_;
    std::vector<Train> trains_;
    std::vector<double> planes_[6];
};

double largest_difference(const GridCase& grid, const PlainGrid& plain) {
    double most = 0.0;
    for (size_t p = 0; p < 6; ++p)
        for (size_t i = 0; i < grid.grid().size(); ++i)
            most = std::max(most, std::abs(static_cast<double>(grid.plane(p)[i]) - plain.plane(p, i)));
    return most;
}

struct Bar {
    const char* target;
    double ratio;
};
constexpr Bar bars[] = {{"AVX3", 40.0}, {"AVX2", 24.0}};

void bench(Report& report) {
    constexpr int trains = 16;
    constexpr int32_t side = 256;
    constexpr double point_trains = 1.0 * side * side * trains;
    constexpr int64_t work = 24'000'000;
    GridCase grid(trains, side);
    PlainGrid plain(grid);
    Workers one_core(1);
    const std::vector<std::string> targets = vector_targets();
    const std::string best = vector_target();

    std::vector<std::function<void()>> contenders{[&] { plain.evaluate(); },
                                                  [&] { keep(trochoid_native_grid(trains, side)); }};
    for (const std::string& target : targets) {
        contenders.emplace_back([&, target] {
            force_vector_target(target);
            grid.evaluate(one_core);
        });
        contenders.emplace_back([&, target] {
            force_vector_target(target);
            keep(vector_work(work));
        });
    }
    const Interleaved times(contenders, report.quick() ? 5 : 31, report.quick() ? 0.004 : 0.02);

    fmt::print("{:<22} {:>9} {:>16} {:>9} {:>18}\n", "256^2 x 16, one core", "ms", "point-trains/us", "ratio",
               "vector ops/ns");
    const auto line = [&](const std::string& name, size_t contender, double rate) {
        fmt::print("{:<22} {:>9.3f} {:>16.0f} {:>9.1f} {:>18}\n", name, times.time(contender) * 1e3,
                   point_trains / times.time(contender) * 1e-6, times.ratio(0, contender),
                   rate > 0 ? fmt::format("{:.2f}", rate) : "");
    };
    std::vector<std::string> names{"std::sin/cos", "native"};
    std::vector<double> rates{point_trains / times.time(0) * 1e-6, point_trains / times.time(1) * 1e-6};
    line("double std::sin/cos", 0, 0);
    line("-march=native", 1, 0);
    for (size_t i = 0; i < targets.size(); ++i) {
        const size_t kernel = 2 + 2 * i;
        force_vector_target(targets[i]);
        const auto operations = static_cast<double>(vector_work(work));
        line(targets[i], kernel, operations / times.time(kernel + 1) * 1e-9);
        names.insert(names.begin() + 1, targets[i]);
        rates.insert(rates.begin() + 1, point_trains / times.time(kernel) * 1e-6);
        // Time of the kernel per vector operation of the rate loop: what the bound is made of.
        report.figure(targets[i] + " operations per point-train vector",
                      times.ratio(kernel, kernel + 1) * operations / (point_trains / vector_width()));
        report.figure(targets[i] + " ratio", times.ratio(0, kernel));
        report.figure(targets[i] + " ms", times.time(kernel) * 1e3);
        for (const Bar& bar : bars)
            if (targets[i] == bar.target)
                report.at_least("std::sin/cos against " + targets[i], times.ratio(0, kernel), bar.ratio, "x");
    }
    force_vector_target("");
    grid.evaluate(one_core);
    report.at_most("dispatched " + best + " against -march=native", times.ratio(2, 1), 1.10, "x");
    report.at_most("largest difference from double, m and 1", largest_difference(grid, plain), 2e-5);
    report.plot({{"title", "256^2 points x 16 trains with normals, one core"},
                 {"x", "opponent, instruction sets, -march=native"},
                 {"y", "million point-trains a second"},
                 {"log", true},
                 {"categories", names},
                 {"bars", {{{"name", "displacement + normal"}, {"values", rates}}}}});
    report.write(fmt::format("{:.1f}x ({})", times.ratio(0, 2), best));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
