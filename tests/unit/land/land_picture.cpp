// Writes two PPM pictures over a .terrain file, or one of the coasts `beach`, `breakwater`, `island`: the crests of one train (cos of
// its phase times the gain) and the gain.
// Usage: land_picture TERRAIN OUT_PREFIX [degrees] [wavelength m] [Hs m] [refraction 0..3] [metres per pixel] [x z: centre, m]
// [diffraction 0..2]
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "protocol/model/terrain_file.hpp"
#include "protocol/units/operator_error.hpp"
#include "server/land/land_trace.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

struct Picture {
    int size;
    std::vector<uint8_t> rgb;
    explicit Picture(int n) : size(n), rgb(static_cast<size_t>(n) * static_cast<size_t>(n) * 3) {}
    void put(int x, int y, double r, double g, double b) {
        const size_t at = (static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x)) * 3;
        const double values[3] = {r, g, b};
        for (size_t i = 0; i < 3; ++i)
            rgb[at + i] = static_cast<uint8_t>(std::clamp(values[i], 0.0, 1.0) * 255.0);
    }
    void write(const std::string& path) const {
        std::ofstream out(path, std::ios::binary);
        out << fmt::format("P6\n{} {}\n255\n", size, size);
        out.write(reinterpret_cast<const char*>(rgb.data()), static_cast<std::streamsize>(rgb.size()));
    }
};

TerrainGrid terrain_named(const std::string& name) {
    if (name == "beach")
        return coast(385, 15, 60,
                     [](double x, double) { return std::clamp((x - 3000.0) / 60.0, -60.0, 20.0); });
    if (name == "breakwater")
        return coast(513, 14, 30,
                     [](double x, double z) { return std::abs(x) < 20.0 && z < 0.0 ? 4.0 : -30.0; });
    if (name == "island")
        return coast(385, 15, 60, [](double x, double z) {
            return std::clamp((600.0 - std::hypot(x + 2000.0, z)) / 25.0, -60.0, 20.0);
        });
    std::ifstream in(name, std::ios::binary);
    const std::vector<uint8_t> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    auto read = decode_terrain(bytes);
    if (!read) throw OperatorError(fmt::format("{}: {}", name, read.error().message));
    return std::move(read).value();
}

int draw(int argc, char** argv) {
    const auto argument = [&](int i, double otherwise) { return argc > i ? std::atof(argv[i]) : otherwise; };
    const TerrainGrid terrain = terrain_named(argv[1]);
    const double degrees = argument(3, 45.0);
    const double wavelength = argument(4, 100.0);
    const double hs = argument(5, 2.0);
    const double scale = argument(7, 24.0);
    const LatticePoint centre{terrain.origin_x + ((int64_t{terrain.columns} - 1) << terrain.spacing_log2) / 2,
                              terrain.origin_z + ((int64_t{terrain.rows} - 1) << terrain.spacing_log2) / 2};
    WaveTrainBox b = box(degrees, 30000.0, 30000.0);
    b.origin = {b.origin.x + centre.x, b.origin.z + centre.z};
    b.trains.push_back(train(degrees, wavelength, hs / std::sqrt(8.0)));
    b.trains[0].choppiness = 1.0F;
    LandSettings settings;
    settings.refraction = static_cast<Refraction>(static_cast<int>(argument(6, 3.0)));
    settings.diffraction = static_cast<Diffraction>(static_cast<int>(argument(10, 1.0)));
    const auto begin = std::chrono::steady_clock::now();
    LandTraceStats stats;
    const TracedLand land = trace_land(b, terrain, {1}, settings, &stats);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    fmt::print(
        "{:.3f} s, {} nodes, {} blocks, gain_max {:.3f}, steepness growth {:.3f}, largest step {:.3f}, largest bend {:.3f} turns, bent {} of {}, too steep {}\n",
        took.count(), stats.nodes_per_band, stats.blocks, land.gain_max / 32768.0, land.steepness_growth,
        stats.largest_step, stats.largest_bend, stats.bent_cells, stats.live_cells, stats.limited_cells);
    if (land.fields.empty()) return fmt::print("the land does not touch this train\n"), 0;

    constexpr int size = 1000;
    Picture crests(size);
    Picture gains(size);
    const WaveTrain& t = b.trains[0];
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const LatticePoint p{centre.x + to_lattice(argument(8, 0.0) + (x - size / 2) * scale),
                                 centre.z + to_lattice(argument(9, 0.0) + (y - size / 2) * scale)};
            if (height_at(terrain, p.x, p.z) > 0) {
                crests.put(x, y, 0.45, 0.38, 0.2);
                gains.put(x, y, 0.45, 0.38, 0.2);
                continue;
            }
            const LandSample s = land.fields[0]->sample(p);
            const double turns = (phase_from_place(t, p.x, p.z) + s.shift) * 0x1p-32;
            const double gain = s.gain * 0x1p-24;
            const double h = 0.5 + 0.35 * gain * std::cos(2.0 * 3.14159265358979 * turns);
            crests.put(x, y, h * 0.6, h * 0.9, h);
            gains.put(x, y, gain > 1.0 ? 0.6 + (gain - 1.0) * 1.5 : gain * 0.6, gain * 0.6, 1.0 - gain * 0.4);
        }
    for (const WaveRay& ray : land.rays)
        for (const ActionPoint& point : ray.points) {
            const int x =
                static_cast<int>((to_metres(point.at.x - centre.x) - argument(8, 0.0)) / scale) + size / 2;
            const int y =
                static_cast<int>((to_metres(point.at.z - centre.z) - argument(9, 0.0)) / scale) + size / 2;
            if (x < 1 || y < 1 || x >= size - 1 || y >= size - 1) continue;
            const auto kind = static_cast<int>(point.kind);
            for (int k = 0; k < 9; ++k)
                gains.put(x + k % 3 - 1, y + k / 3 - 1, kind == 1 || kind == 2, kind == 1 || kind >= 3,
                          kind == 4);
        }
    crests.write(fmt::format("{}-crests.ppm", argv[2]));
    gains.write(fmt::format("{}-gain.ppm", argv[2]));
    return 0;
}

}  // namespace
}  // namespace trochoid

int main(int argc, char** argv) {
    if (argc < 3)
        return fmt::print(
                   stderr,
                   "usage: land_picture TERRAIN OUT_PREFIX [degrees] [wavelength] [Hs] [refraction] [scale] [x z] [diffraction]\n"),
               2;
    try {
        return trochoid::draw(argc, argv);
    } catch (const std::exception& error) {
        return fmt::print(stderr, "land_picture: {}\n", error.what()), 2;
    }
}
