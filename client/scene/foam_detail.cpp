#include "client/scene/foam_detail.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "client/scene/sea_weather.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

uint32_t mixed(uint32_t x, uint32_t y, uint32_t seed) {
    uint32_t h = x * 0x9e3779b9U ^ y * 0x85ebca6bU ^ seed * 0xc2b2ae35U;
    h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
    h = (h ^ (h >> 12)) * 0x297a2d39U;
    return h ^ (h >> 15);
}
float even(uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1p-24F; }

/// Value noise with whole cells on the tile, x and y in cells.
float cell_noise(float x, float y, uint32_t columns, uint32_t rows, uint32_t seed) {
    const float fx = x - std::floor(x);
    const float fy = y - std::floor(y);
    const auto i = static_cast<uint32_t>(std::floor(x)) % columns;
    const auto j = static_cast<uint32_t>(std::floor(y)) % rows;
    const uint32_t k = (i + 1) % columns;
    const uint32_t l = (j + 1) % rows;
    const float u = fx * fx * fx * (fx * (fx * 6 - 15) + 10);
    const float v = fy * fy * fy * (fy * (fy * 6 - 15) + 10);
    const auto at = [&](uint32_t a, uint32_t b) { return even(mixed(a, b, seed)); };
    const float top = at(i, j) + (at(k, j) - at(i, j)) * u;
    const float bottom = at(i, l) + (at(k, l) - at(i, l)) * u;
    return top + (bottom - top) * v;
}

/// Distances to the nearest and the second nearest of one point a cell (Worley 1996), in cells.
std::array<float, 2> nearest_points(float x, float y, uint32_t cells, uint32_t seed) {
    const auto i = static_cast<int>(std::floor(x));
    const auto j = static_cast<int>(std::floor(y));
    std::array<float, 2> nearest{9.0F, 9.0F};
    for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
            const auto wrapped = [&](int c) {
                return static_cast<uint32_t>(c + static_cast<int>(cells)) % cells;
            };
            const uint32_t h = mixed(wrapped(i + di), wrapped(j + dj), seed);
            const float px = static_cast<float>(i + di) + even(h);
            const float py = static_cast<float>(j + dj) + even(h * 0x9e3779b9U + 1U);
            const float d = std::hypot(px - x, py - y);
            if (d < nearest[0])
                nearest = {d, nearest[0]};
            else
                nearest[1] = std::min(nearest[1], d);
        }
    return nearest;
}

/// Ranks made even over (0, 1).
std::vector<float> evened(const std::vector<float>& values) {
    std::vector<uint32_t> order(values.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return values[a] < values[b] || (values[a] == values[b] && a < b);
    });
    std::vector<float> out(values.size());
    for (size_t i = 0; i < order.size(); ++i)
        out[order[i]] = (static_cast<float>(i) + 0.5F) / static_cast<float>(order.size());
    return out;
}

float as_normal(float share) {
    return share < 0.5F ? -normal_quantile(share) : normal_quantile(1.0F - share);
}

/// Patches longer along y than along x, which is the wind's way.
float whitecap_noise(float u, float v, uint32_t seed) {
    float sum = 0;
    float amplitude = 1.0F;
    uint32_t cells = 20;
    for (uint32_t octave = 0; octave < 4; ++octave, cells *= 2, amplitude *= 0.55F)
        sum += amplitude * cell_noise(u * static_cast<float>(cells), v * static_cast<float>(cells) * 0.6F,
                                      cells, cells * 3 / 5, seed + octave);
    return sum;
}

/// A net of bubbles, large ones with small ones in their walls.
float lace_noise(float u, float v, uint32_t seed) {
    // Bent a little, so that no cell has straight walls.
    const float bu = u + 0.012F * cell_noise(u * 24, v * 24, 24, 24, seed + 40);
    const float bv = v + 0.012F * cell_noise(u * 24, v * 24, 24, 24, seed + 41);
    const auto coarse = nearest_points(bu * 14, bv * 14, 14, seed + 42);
    const auto fine = nearest_points(bu * 37, bv * 37, 37, seed + 43);
    const float walls = 1.0F - std::min(1.0F, 1.5F * (coarse[1] - coarse[0]));
    const float small_walls = 1.0F - std::min(1.0F, 1.3F * (fine[1] - fine[0]));
    return walls * 0.62F + small_walls * 0.30F + 0.35F * cell_noise(u * 9, v * 9, 9, 9, seed + 44);
}

/// Long threads along x.
float streak_noise(float u, float v, uint32_t seed) {
    const float bent = v + 0.02F * cell_noise(u * 5, v * 5, 5, 5, seed + 60);
    return cell_noise(u * 4, bent * 22, 4, 22, seed + 61) +
           0.6F * cell_noise(u * 8, bent * 47, 8, 47, seed + 62) +
           0.35F * cell_noise(u * 24, bent * 96, 24, 96, seed + 63);
}

}  // namespace

FoamDetail make_foam_detail(uint32_t side, uint32_t seed) {
    TROCHOID_ASSERT(std::has_single_bit(side), "side {}", side);
    const size_t count = size_t{side} * side;
    std::vector<float> caps(count);
    std::vector<float> other_caps(count);
    std::vector<float> lace(count);
    std::vector<float> streaks(count);
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t x = 0; x < side; ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(side);
            const float v = static_cast<float>(z) / static_cast<float>(side);
            const size_t i = size_t{z} * side + x;
            caps[i] = whitecap_noise(u, v, seed);
            other_caps[i] = whitecap_noise(u, v, seed + 90);
            lace[i] = lace_noise(u, v, seed);
            streaks[i] = streak_noise(u, v, seed);
        }
    caps = evened(caps);
    other_caps = evened(other_caps);
    lace = evened(lace);
    streaks = evened(streaks);
    FoamDetail detail;
    detail.side = side;
    MipLevel level(count);
    const auto stored = [](float share) { return std::clamp(0.5F + 0.125F * as_normal(share), 0.0F, 1.0F); };
    for (size_t i = 0; i < count; ++i)
        level[i] = {stored(caps[i]), lace[i], streaks[i], stored(other_caps[i])};
    detail.levels = with_coarser_levels(std::move(level), side);
    return detail;
}

}  // namespace trochoid
