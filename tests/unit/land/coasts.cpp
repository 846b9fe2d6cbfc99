#include "tests/unit/land/coasts.hpp"

#include <cmath>
#include <numbers>

namespace trochoid {

TerrainGrid coast(uint32_t samples, uint32_t spacing_log2, int32_t open_depth_m,
                  const std::function<double(double, double)>& height) {
    TerrainGrid grid;
    grid.spacing_log2 = spacing_log2;
    grid.columns = samples;
    grid.rows = samples;
    const int64_t spacing = int64_t{1} << spacing_log2;
    grid.origin_x = -spacing * (samples / 2);
    grid.origin_z = grid.origin_x;
    grid.open_sea_depth = -(open_depth_m << 10);
    for (uint32_t row = 0; row < samples; ++row)
        for (uint32_t column = 0; column < samples; ++column) {
            const double x = to_metres(grid.origin_x + int64_t{column} * spacing);
            const double z = to_metres(grid.origin_z + int64_t{row} * spacing);
            grid.heights.push_back(static_cast<int16_t>(std::lround(height(x, z) * 32.0)));
        }
    return grid;
}

WaveTrain train(double degrees, double wavelength, double amplitude) {
    WaveTrain t;
    const double angle = degrees * std::numbers::pi / 180.0;
    const double turns = 0x1p22 / wavelength;
    t.kx = static_cast<int32_t>(std::lround(turns * std::cos(angle)));
    t.kz = static_cast<int32_t>(std::lround(turns * std::sin(angle)));
    t.amplitude = static_cast<float>(amplitude);
    return t;
}

WaveTrainBox open_box(double degrees) {
    WaveTrainBox b;
    b.id = {1};
    b.first_train = {1};
    const double angle = degrees * std::numbers::pi / 180.0;
    b.ux = static_cast<int32_t>(std::lround(std::cos(angle) * 0x1p30));
    b.uz = static_cast<int32_t>(std::lround(std::sin(angle) * 0x1p30));
    return b;
}

WaveTrainBox box(double degrees, double length, double width) {
    WaveTrainBox b = open_box(degrees);
    b.length = to_lattice(length);
    b.width = to_lattice(width);
    const double ux = static_cast<double>(b.ux) * 0x1p-30;
    const double uz = static_cast<double>(b.uz) * 0x1p-30;
    b.origin = {to_lattice(-0.5 * (length * ux - width * uz)), to_lattice(-0.5 * (length * uz + width * ux))};
    return b;
}

NodeValue node_value(const LandField& field, double x_metres, double z_metres) {
    const double step = static_cast<double>(int64_t{1} << field.step_log2()) / 1024.0;
    const auto x = static_cast<int32_t>(std::lround(x_metres / step));
    const auto z = static_cast<int32_t>(std::lround(z_metres / step));
    const LandBlock* block = field.find({x >> 4, z >> 4});
    if (block == nullptr) return {};
    const auto n = static_cast<size_t>((z & 15) * block_nodes + (x & 15));
    return {block->shift[n] / 65536.0, block->gain[n] / 32768.0};
}

}  // namespace trochoid
