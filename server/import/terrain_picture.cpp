#include "server/import/terrain_picture.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "protocol/units/lattice.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

struct Colour {
    double red, green, blue;  // 0..255
};

struct Stop {
    double share;  // of the deepest or the highest sample, 0..1
    Colour colour;
};

constexpr std::array<Stop, 5> sea_stops{{{0.0, {190, 226, 222}},
                                         {0.12, {122, 190, 209}},
                                         {0.35, {66, 141, 184}},
                                         {0.7, {33, 92, 148}},
                                         {1.0, {18, 58, 110}}}};
constexpr std::array<Stop, 5> land_stops{{{0.0, {222, 208, 164}},
                                          {0.12, {158, 178, 112}},
                                          {0.4, {116, 150, 84}},
                                          {0.7, {146, 134, 90}},
                                          {1.0, {186, 166, 138}}}};

Colour colour_at(std::span<const Stop> stops, double share) {
    std::size_t i = 1;
    while (i + 1 < stops.size() && share > stops[i].share) ++i;
    const Stop& low = stops[i - 1];
    const Stop& high = stops[i];
    const double t = std::clamp((share - low.share) / (high.share - low.share), 0.0, 1.0);
    return {std::lerp(low.colour.red, high.colour.red, t), std::lerp(low.colour.green, high.colour.green, t),
            std::lerp(low.colour.blue, high.colour.blue, t)};
}

/// Light on a slope, 1 on level ground. Slopes are metres per metre towards east and south.
double light_on(double slope_east, double slope_south, double exaggeration) {
    // From the north-west, 45 degrees high.
    const double x = -slope_east * exaggeration;
    const double z = -slope_south * exaggeration;
    const double lit = (-0.5 * x - 0.5 * z + std::sqrt(0.5)) / std::sqrt(x * x + z * z + 1.0);
    return std::clamp(lit / std::sqrt(0.5), 0.25, 1.5);
}

class Painter {
public:
    explicit Painter(const TerrainGrid& grid)
        : grid_(grid), spacing_(to_metres(int64_t{1} << grid.spacing_log2)) {
        const auto [low, high] = std::minmax_element(grid.heights.begin(), grid.heights.end());
        deepest_ = std::max(1.0, -metres(*low));
        highest_ = std::max(1.0, metres(*high));
    }

    std::array<png_byte, 3> pixel(int64_t column, int64_t row) const {
        const double height = at(column, row);
        const bool land = height > 0.0;
        const Colour base =
            land ? colour_at(land_stops, height / highest_) : colour_at(sea_stops, -height / deepest_);
        const double slope_east = (at(column + 1, row) - at(column - 1, row)) / (2.0 * spacing_);
        const double slope_south = (at(column, row + 1) - at(column, row - 1)) / (2.0 * spacing_);
        const double light = light_on(slope_east, slope_south, land ? 4.0 : 8.0);
        const auto channel = [light](double value) {
            return static_cast<png_byte>(std::clamp(value * light, 0.0, 255.0));
        };
        return {channel(base.red), channel(base.green), channel(base.blue)};
    }

private:
    double metres(int64_t count) const {
        return std::ldexp(static_cast<double>(count), grid_.height_step_log2 - 10);
    }
    double at(int64_t column, int64_t row) const {
        const int64_t c = std::clamp<int64_t>(column, 0, int64_t{grid_.columns} - 1);
        const int64_t r = std::clamp<int64_t>(row, 0, int64_t{grid_.rows} - 1);
        return metres(height_count_at(grid_, c, r));
    }

    const TerrainGrid& grid_;
    double spacing_;
    double deepest_;
    double highest_;
};

}  // namespace

void write_picture(const std::filesystem::path& path, const TerrainGrid& grid) {
    const Painter painter(grid);
    std::vector<png_byte> pixels;
    pixels.reserve(grid.heights.size() * 3);
    for (int64_t row = 0; row < grid.rows; ++row)
        for (int64_t column = 0; column < grid.columns; ++column)
            for (const png_byte channel : painter.pixel(column, row)) pixels.push_back(channel);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = grid.columns;
    image.height = grid.rows;
    image.format = PNG_FORMAT_RGB;
    if (png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, nullptr) == 0)
        throw OperatorError(fmt::format(
            "cannot write the picture {} ({}): check that its folder exists and may be written to",
            path.string(), image.message));
}

}  // namespace trochoid
