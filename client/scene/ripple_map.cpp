#include "client/scene/ripple_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

struct Ripple {
    int kx, kz;  // periods on the tile
    double amplitude;
    double phase;
};

/// A small generator of our own, so that pictures are the same everywhere.
class Dice {
public:
    explicit Dice(uint32_t seed) : state_(seed * 2654435769U + 1U) {}
    double next() {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 17;
        state_ ^= state_ << 5;
        return state_ / 4294967296.0;
    }

private:
    uint32_t state_;
};

constexpr double two_pi = 6.283185307179586;

std::vector<Ripple> choose_ripples(uint32_t seed) {
    Dice dice(seed);
    std::vector<Ripple> ripples;
    while (ripples.size() < 90) {
        const double k = 3.0 * std::pow(14.0, dice.next());
        const double across = dice.next() + dice.next() + dice.next() - 1.5;  // about a bell, ±1.5
        const double angle = across * 1.1;
        const auto kx = static_cast<int>(std::lround(k * std::cos(angle)));
        const auto kz = static_cast<int>(std::lround(k * std::sin(angle)));
        const double length = std::hypot(kx, kz);
        if (length < 2.5) continue;
        ripples.push_back({kx, kz, std::pow(length, -1.2), two_pi * dice.next()});
    }
    return ripples;
}

/// A ripple has whole numbers of periods, so its phase takes only `side` values: sines come from a table.
void add_ripple(MipLevel& level, std::vector<double>& height, uint32_t side, const Ripple& r) {
    std::vector<double> sine(side);
    std::vector<double> cosine(side);
    for (uint32_t i = 0; i < side; ++i) {
        sine[i] = r.amplitude * std::sin(two_pi * i / side + r.phase);
        cosine[i] = r.amplitude * std::cos(two_pi * i / side + r.phase);
    }
    const auto slope_x = static_cast<float>(r.kx);
    const auto slope_z = static_cast<float>(r.kz);
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t turn =
                (static_cast<uint32_t>(r.kx) * x + static_cast<uint32_t>(r.kz) * z) & (side - 1);
            const auto slope = static_cast<float>(cosine[turn]);
            level[z * side + x][0] += slope * slope_x;
            level[z * side + x][1] += slope * slope_z;
            height[z * side + x] += sine[turn];
        }
}

}  // namespace

RippleMap make_ripple_map(uint32_t side, uint32_t seed) {
    TROCHOID_ASSERT(std::has_single_bit(side), "side {}", side);
    RippleMap map;
    map.side = side;
    MipLevel level(size_t{side} * side);
    const std::vector<Ripple> ripples = choose_ripples(seed);
    double height_power = 0;
    for (const Ripple& r : ripples) height_power += 0.5 * r.amplitude * r.amplitude;
    const double height_scale = 0.2 / std::sqrt(height_power);
    std::vector<double> height(level.size());
    for (const Ripple& r : ripples) add_ripple(level, height, side, r);
    // Measured, for ripples of one wave vector interfere.
    double squares = 0;
    for (const auto& texel : level) squares += static_cast<double>(texel[0] * texel[0] + texel[1] * texel[1]);
    const auto scale = static_cast<float>(1.0 / std::sqrt(squares / static_cast<double>(level.size())));
    for (size_t i = 0; i < level.size(); ++i) {
        level[i][0] *= scale;
        level[i][1] *= scale;
        level[i][2] = level[i][0] * level[i][0] + level[i][1] * level[i][1];
        level[i][3] = static_cast<float>(std::clamp(0.5 + height[i] * height_scale, 0.0, 1.0));
    }
    map.levels = with_coarser_levels(std::move(level), side);
    return map;
}

}  // namespace trochoid
