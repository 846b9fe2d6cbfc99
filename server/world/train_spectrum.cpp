#include "server/world/train_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "server/world/direction_spread.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/integer_math.hpp"
#include "server/world/spectrum.hpp"

namespace trochoid {

namespace {

/// In [-0.5, 0.5), a multiple of 2^-53.
double centred(uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53 - 0.5; }

/// A place in stratum `index` of `count`: its middle, moved by up to `reach` halves of its width.
double stratified(uint64_t bits, size_t index, size_t count, double reach) {
    return (static_cast<double>(index) + 0.5 + reach * centred(bits)) / static_cast<double>(count);
}

std::vector<size_t> shuffled(uint64_t seed, size_t count) {
    std::vector<size_t> order(count);
    std::iota(order.begin(), order.end(), size_t{0});
    for (size_t left = count; left > 1; --left)
        std::swap(order[left - 1], order[draw(seed, Stream::shuffle, left) % left]);
    return order;
}

int64_t square_of(const WaveTrain& train) {
    return int64_t{train.kx} * train.kx + int64_t{train.kz} * train.kz;
}

/// Turns the wind's frequencies and directions into trains.
class TrainDrawing {
public:
    explicit TrainDrawing(const StartWind& wind)
        : wind_(wind),
          spectrum_(wind_spectrum(static_cast<double>(wind.speed), wind.fetch, wind.spectrum)),
          u10_(wind_at_height(static_cast<double>(wind.speed), 10.0)),
          depth_(reference_depth_of(wind)),
          amplitude_(std::sqrt(2.0 * spectrum_.m0() / static_cast<double>(wind.trains))) {}

    std::vector<WaveTrain> draw_all() {
        if (wind_.trains == 1)
            add(spectrum_.peak_omega(), 0.0);
        else if (wind_.directions == 0)
            draw_single_directions();
        else
            draw_partition();
        // The strata rise in frequency already; quantisation may swap neighbours.
        std::stable_sort(trains_.begin(), trains_.end(),
                         [](const WaveTrain& a, const WaveTrain& b) { return square_of(a) < square_of(b); });
        return std::move(trains_);
    }

private:
    double omega(size_t index, size_t count) const {
        return spectrum_.quantile(stratified(draw(wind_.seed, Stream::frequency, index), index, count, 0.5));
    }

    DirectionSpread spread(double at) const { return {wind_.spreading, at, spectrum_.peak_omega(), u10_}; }

    void draw_single_directions() {
        const size_t count = wind_.trains;
        const std::vector<size_t> order = shuffled(wind_.seed, count);
        for (size_t i = 0; i < count; ++i) {
            const double at = omega(i, count);
            const uint64_t bits = draw(wind_.seed, Stream::direction, order[i]);
            add(at, spread(at).quantile(stratified(bits, order[i], count, 0.5)));
        }
    }

    void draw_partition() {
        const size_t n = wind_.directions;
        const size_t m = wind_.trains / n;
        for (size_t i = 0; i < m; ++i) {
            const double at = omega(i, m);
            const DirectionSpread directions = spread(at);
            for (size_t j = 0; j < n; ++j) {
                const uint64_t bits = draw(wind_.seed, Stream::direction, i * n + j);
                add(at, directions.quantile(stratified(bits, j, n, 1.0)));
            }
        }
    }

    void add(double at, double deviation) {
        const double heading = static_cast<double>(wind_.towards_degrees) + deviation;
        const QuantisedVector k = quantise(wave_number_at(at, depth_), heading_vector(heading));
        const uint64_t phase = draw(wind_.seed, Stream::phase, trains_.size());
        trains_.push_back({k.kx,
                           k.kz,
                           quantised_omega(k, depth_),
                           static_cast<uint32_t>(phase >> 32),
                           static_cast<float>(amplitude_),
                           1.0F,
                           {}});
    }

    const StartWind& wind_;
    FrequencySpectrum spectrum_;
    double u10_;
    double depth_;
    double amplitude_;
    std::vector<WaveTrain> trains_;
};

}  // namespace

uint64_t draw(uint64_t seed, Stream stream, uint64_t index) {
    return splitmix64(splitmix64(seed ^ (static_cast<uint64_t>(stream) << 56)) + index);
}

double reference_depth_of(const StartWind& wind) {
    return wind.reference_depth == 0.0F ? deep_water : static_cast<double>(wind.reference_depth);
}

std::vector<WaveTrain> wind_trains(const StartWind& wind) {
    TROCHOID_ASSERT(wind.trains >= 1 && (wind.directions == 0 || wind.trains % wind.directions == 0),
                    "{} trains of {} directions", wind.trains, wind.directions);
    return TrainDrawing(wind).draw_all();
}

}  // namespace trochoid
