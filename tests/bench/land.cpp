// Bar P4: what a trace of the land costs on one core, and what a moved breakwater costs.
#include <cmath>
#include <cstdint>
#include <ctime>
#include <numbers>

#include "server/land/land_retrace.hpp"
#include "server/land/land_trace.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"

namespace trochoid::bench {
namespace {

/// The bar's rays, steps and bands.
constexpr double bar_ray_steps = 1024.0 * 1024.0 * 8.0;
constexpr double degree = std::numbers::pi / 180.0;

/// 32 km of coast at 32 m: a shelf that rises to a shore in the east, with islands on it. Felt by the longest waves everywhere.
TerrainGrid coast() {
    TerrainGrid grid;
    grid.spacing_log2 = 15;
    grid.columns = 1025;
    grid.rows = 1025;
    grid.origin_x = -(int64_t{512} << 15);
    grid.origin_z = grid.origin_x;
    grid.open_sea_depth = -(120 << 10);
    for (uint32_t row = 0; row < grid.rows; ++row)
        for (uint32_t column = 0; column < grid.columns; ++column) {
            const double x = to_metres(grid.origin_x) + 32.0 * column;
            const double z = to_metres(grid.origin_z) + 32.0 * row;
            double height =
                -100.0 + (x + 16384.0) * 0.0032 + 6.0 * std::sin(x / 900.0) * std::cos(z / 1100.0);
            for (const auto [ix, iz, radius] :
                 {std::array{-6000.0, -4000.0, 900.0}, std::array{2000.0, 5000.0, 1500.0},
                  std::array{7000.0, -6000.0, 700.0}})
                height = std::max(height, (radius - std::hypot(x - ix, z - iz)) / 25.0);
            grid.heights.push_back(static_cast<int16_t>(std::lround(std::min(height, 30.0) * 32.0)));
        }
    return grid;
}

/// Processor seconds of one call (the best of some counts: other processes share the caches): with one thread the time of one core, whatever else the machine does.
template <class Work>
double core_seconds(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

WaveTrain train(double degrees, double wavelength, double amplitude) {
    WaveTrain t;
    t.kx = static_cast<int32_t>(std::lround(0x1p22 / wavelength * std::cos(degrees * degree)));
    t.kz = static_cast<int32_t>(std::lround(0x1p22 / wavelength * std::sin(degrees * degree)));
    t.amplitude = static_cast<float>(amplitude);
    t.choppiness = 0.7F;
    return t;
}

/// Four octaves in two directions: eight bands over a square box whose rays and steps come to the bar's.
WaveTrainBox sea() {
    constexpr double heading = 7.5;
    constexpr double side = 868.0 * 32.0;
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    const double ux = std::cos(heading * degree);
    const double uz = std::sin(heading * degree);
    box.ux = static_cast<int32_t>(std::lround(ux * 0x1p30));
    box.uz = static_cast<int32_t>(std::lround(uz * 0x1p30));
    box.length = box.width = to_lattice(side);
    box.origin = {to_lattice(-0.5 * side * (ux - uz)), to_lattice(-0.5 * side * (uz + ux))};
    for (const double wavelength : {200.0, 100.0, 50.0, 25.0})
        for (const double turned : {-7.4, 7.6})
            box.trains.push_back(train(heading + turned, wavelength, wavelength / 250.0));
    return box;
}

/// The coast with a mole of 1.2 km in front of it.
TerrainGrid with_mole(TerrainGrid grid, double x, double z, LatticeRect& changed) {
    changed = {{INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN}};
    for (uint32_t row = 0; row < grid.rows; ++row)
        for (uint32_t column = 0; column < grid.columns; ++column) {
            const LatticePoint at{grid.origin_x + (int64_t{column} << 15),
                                  grid.origin_z + (int64_t{row} << 15)};
            if (std::abs(to_metres(at.x) - x) > 20.0 || std::abs(to_metres(at.z) - z) > 600.0) continue;
            grid.heights[row * grid.columns + column] = 3 * 32;
            changed.min = {std::min(changed.min.x, at.x), std::min(changed.min.z, at.z)};
            changed.max = {std::max(changed.max.x, at.x), std::max(changed.max.z, at.z)};
        }
    return grid;
}

struct Case {
    const char* name;
    LandSettings settings;
};

std::vector<Case> cases() {
    LandSettings straight;
    straight.threads = 1;
    straight.refraction = Refraction::straight;
    straight.diffraction = Diffraction::none;
    LandSettings eikonal = straight;
    eikonal.refraction = Refraction::eikonal;
    LandSettings wedge = eikonal;
    wedge.diffraction = Diffraction::wedge;
    LandSettings parabolic = eikonal;
    parabolic.diffraction = Diffraction::parabolic;
    LandSettings orbits = wedge;
    orbits.shallow_orbits = true;
    return {{"straight rays", straight},
            {"eikonal", eikonal},
            {"eikonal, wedge (default)", wedge},
            {"eikonal, parabolic", parabolic},
            {"eikonal, wedge, orbits", orbits}};
}

double time_case(const Case& one, const WaveTrainBox& box, const TerrainGrid& terrain, int rounds) {
    LandTraceStats stats;
    (void)trace_land(box, terrain, {1}, one.settings, &stats);
    std::vector<double> times;
    for (int i = 0; i < rounds; ++i)
        times.push_back(core_seconds([&] { keep(trace_land(box, terrain, {1}, one.settings).gain_max); }));
    const double taken = *std::min_element(times.begin(), times.end());
    const double scaled = taken * bar_ray_steps / static_cast<double>(stats.ray_steps);
    fmt::print(
        "{:26} {:8.1f} ms   {:5.2f} M ray steps   {:5.2f} ns a step   {:8.1f} ms at the bar's size   {} blocks\n",
        one.name, taken * 1e3, static_cast<double>(stats.ray_steps) * 1e-6,
        taken * 1e9 / static_cast<double>(stats.ray_steps), scaled * 1e3, stats.blocks);
    return scaled;
}

void breakwater(Report& report, const WaveTrainBox& box, const TerrainGrid& before, int rounds) {
    LandSettings settings;
    settings.threads = 1;
    const TracedLand old = trace_land(box, before, {1}, settings);
    std::vector<double> times;
    const double whole = [&] {
        for (int i = 0; i < rounds; ++i)
            times.push_back(core_seconds([&] { keep(trace_land(box, before, {1}, settings).gain_max); }));
        return *std::min_element(times.begin(), times.end());
    }();
    double worst = 0.0;
    struct Mole {
        const char* name;
        double x;
    };
    for (const Mole& mole :
         {Mole{"a mole near the shore", 9000.0}, Mole{"half way", 0.0}, Mole{"far out", -12000.0}}) {
        LatticeRect changed;
        const TerrainGrid after = with_mole(before, mole.x, 0.0, changed);
        RetraceStats stats;
        times.clear();
        for (int i = 0; i < rounds; ++i)
            times.push_back(core_seconds([&] {
                keep(retrace_land(box, old, before, after, changed, {100}, settings, &stats).gain_max);
            }));
        const double taken = *std::min_element(times.begin(), times.end());
        const double share = taken / whole;
        worst = std::max(worst, share);
        fmt::print(
            "{:24} {:6.1f} ms, {:3.0f} % of a whole trace; {} of {} bands, {} of {} rows, {} of {} rays, {} of {} blocks changed\n",
            mole.name, taken * 1e3, share * 100.0, stats.bands_traced, stats.bands, stats.rows_marched,
            stats.rows, stats.rays_walked, stats.rays, stats.blocks_changed, stats.blocks_compared);
        report.figure(fmt::format("retrace share, {}", mole.name), share);
    }
    report.at_most("moved breakwater over whole trace", worst, 1.0);
}

void measure(Report& report) {
    const TerrainGrid terrain = coast();
    const WaveTrainBox box = sea();
    const int rounds = report.quick() ? 3 : 9;
    std::vector<double> times;
    for (const Case& one : cases()) {
        times.push_back(time_case(one, box, terrain, rounds));
        report.figure(fmt::format("{}, ms", one.name), times.back() * 1e3);
    }
    report.at_most("straight rays", times[0] * 1e3, 50.0, " ms");
    report.at_most("eikonal over straight", times[1] / times[0], 3.0);
    breakwater(report, box, terrain, rounds);
    report.write(
        fmt::format("{:.1f} ms straight, eikonal {:.2f} times that", times[0] * 1e3, times[1] / times[0]));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::measure); }
