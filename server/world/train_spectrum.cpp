#include "server/world/train_spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

namespace {

/// What a train draws from its seed; every (stream, index) is its own number.
enum class Stream : uint64_t { frequency = 1, direction = 2, shuffle = 3, phase = 4 };

uint64_t draw(uint64_t seed, Stream stream, size_t index) {
    return splitmix64(splitmix64(seed ^ (static_cast<uint64_t>(stream) << 56)) + index);
}

/// In [-0.5, 0.5), a multiple of 2^-53.
double centred(uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53 - 0.5; }

/// Middle of stratum `index` of `count`, moved by up to a quarter of its width.
double stratified(uint64_t seed, Stream stream, size_t index, size_t count) {
    const double offset = 0.5 + 0.5 * centred(draw(seed, stream, index));
    return (static_cast<double>(index) + offset) / static_cast<double>(count);
}

std::vector<size_t> shuffled(uint64_t seed, size_t count) {
    std::vector<size_t> order(count);
    std::iota(order.begin(), order.end(), size_t{0});
    for (size_t left = count; left > 1; --left)
        std::swap(order[left - 1], order[draw(seed, Stream::shuffle, left) % left]);
    return order;
}

constexpr size_t spread_cells = 256;

/// F at t = -1, …, 1 (spread_quantile).
const std::array<double, spread_cells + 1>& spread_table() {
    static const auto table = [] {
        std::array<double, spread_cells + 1> values{};
        for (size_t i = 0; i <= spread_cells; ++i) {
            const double t = static_cast<double>(i) * (2.0 / spread_cells) - 1.0;
            values[i] = 0.5 * (1.0 + t) + sine_of_half_turns(t) / (2.0 * pi);
        }
        return values;
    }();
    return table;
}

int64_t square_of(const WaveTrain& train) {
    return int64_t{train.kx} * train.kx + int64_t{train.kz} * train.kz;
}

}  // namespace

double energy_quantile(double peak_omega, double quantile) {
    TROCHOID_ASSERT(quantile > 0.0 && quantile < 1.0, "quantile {}", quantile);
    return peak_omega * std::sqrt(std::sqrt(1.25 / -natural_log(quantile)));
}

double spread_half_width(double omega, double peak_omega) {
    const double above = std::clamp(omega / peak_omega - 1.0, 0.0, 1.0);
    return 40.0 + 20.0 * above;
}

double spread_quantile(double quantile) {
    TROCHOID_ASSERT(quantile >= 0.0 && quantile <= 1.0, "quantile {}", quantile);
    const auto& table = spread_table();
    const auto above = std::upper_bound(table.begin() + 1, table.end() - 1, quantile);
    const auto cell = static_cast<size_t>(above - table.begin()) - 1;
    // The density vanishes at both ends, where rounding may leave a cell without width.
    const double height = table[cell + 1] - table[cell];
    const double part = height > 0.0 ? std::clamp((quantile - table[cell]) / height, 0.0, 1.0) : 0.5;
    return (static_cast<double>(cell) + part) * (2.0 / spread_cells) - 1.0;
}

std::vector<WaveTrain> wind_trains(const WindSea& sea, double towards_degrees, uint16_t count,
                                   uint64_t seed) {
    TROCHOID_ASSERT(count >= 1, "a wind without trains");
    const double n = count;
    const double amplitude =
        count == 1 ? sea.significant_height / 2.0 : sea.significant_height / std::sqrt(8.0 * n);
    const std::vector<size_t> order = shuffled(seed, count);
    std::vector<WaveTrain> trains(count);
    for (size_t i = 0; i < count; ++i) {
        const double omega =
            count == 1 ? sea.peak_omega
                       : energy_quantile(sea.peak_omega, stratified(seed, Stream::frequency, i, count));
        const double deviation =
            count == 1 ? 0.0 : spread_quantile(stratified(seed, Stream::direction, order[i], count));
        const double heading = towards_degrees + deviation * spread_half_width(omega, sea.peak_omega);
        const QuantisedVector k = quantise(deep_wave_number(omega), heading_vector(heading));
        trains[i] = {k.kx,
                     k.kz,
                     quantised_omega(k),
                     static_cast<uint32_t>(draw(seed, Stream::phase, i) >> 32),
                     static_cast<float>(amplitude),
                     1.0F,
                     {}};
    }
    // The strata rise in frequency already; quantisation may swap neighbours.
    std::stable_sort(trains.begin(), trains.end(),
                     [](const WaveTrain& a, const WaveTrain& b) { return square_of(a) < square_of(b); });
    return trains;
}

double significant_height(const std::vector<WaveTrain>& trains) {
    double sum = 0.0;
    for (const WaveTrain& train : trains) {
        const double a = static_cast<double>(train.amplitude);
        sum += a * a / 2.0;
    }
    return trains.size() == 1 ? 2.0 * static_cast<double>(trains[0].amplitude) : 4.0 * std::sqrt(sum);
}

}  // namespace trochoid
