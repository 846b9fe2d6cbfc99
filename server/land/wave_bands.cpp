#include "server/land/wave_bands.hpp"

#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/world/significant_height.hpp"

namespace trochoid {

namespace {

constexpr double cos_15_degrees = 0x1.ee8dd4748bf15p-1;
constexpr double sin_15_degrees = 0x1.0907dc1930690p-2;
constexpr int direction_bins = 24;

/// |k| in turns per lattice unit Q0.32, squared: below 2^63, and any rounding is far below an octave.
double squared_wave_number(const WaveTrain& t) {
    const auto x = static_cast<double>(t.kx);
    const auto z = static_cast<double>(t.kz);
    return x * x + z * z;
}

int octave_of(const WaveTrain& t) {
    const double square = squared_wave_number(t);
    int octave = 0;
    for (double edge = 4.0; edge <= square; edge *= 4.0) ++octave;
    return octave;
}

/// The bin whose centre is nearest: 0 along u, then every 15 degrees towards v.
int direction_bin(const WaveTrain& t, const WaveTrainBox& box) {
    const auto ux = static_cast<double>(box.ux);
    const auto uz = static_cast<double>(box.uz);
    double along = static_cast<double>(t.kx) * ux + static_cast<double>(t.kz) * uz;
    double across = static_cast<double>(t.kz) * ux - static_cast<double>(t.kx) * uz;
    int best = 0;
    double best_along = along;
    for (int bin = 1; bin < direction_bins; ++bin) {
        const double turned = along * cos_15_degrees + across * sin_15_degrees;
        across = across * cos_15_degrees - along * sin_15_degrees;
        along = turned;
        if (along > best_along) {
            best_along = along;
            best = bin;
        }
    }
    return best;
}

struct BinKey {
    int octave;
    int direction;
    bool operator==(const BinKey&) const = default;
};

/// Mean direction and wave number of the band's trains.
void take_means(WaveBand& band, const WaveTrainBox& box) {
    double sum_x = 0.0;
    double sum_z = 0.0;
    double sum_k = 0.0;
    double sum_weight = 0.0;
    double sum_amplitude = 0.0;
    for (const size_t i : band.trains) {
        const WaveTrain& t = box.trains[i];
        const auto a = static_cast<double>(t.amplitude);
        // The addend lets trains of amplitude 0 (not yet grown) have a band too.
        const double weight = a * a + 0x1p-60;
        const double k = std::sqrt(squared_wave_number(t));
        sum_x = sum_x + weight * (static_cast<double>(t.kx) / k);
        sum_z = sum_z + weight * (static_cast<double>(t.kz) / k);
        sum_k = sum_k + weight * k;
        sum_weight = sum_weight + weight;
        band.variance = band.variance + a * a * 0.5;
        sum_amplitude = sum_amplitude + a;
        band.steepness = band.steepness + a * (k * 0x1p-22);
    }
    const double norm = std::sqrt(sum_x * sum_x + sum_z * sum_z);
    band.dx = sum_x / norm;
    band.dz = sum_z / norm;
    // Turns per lattice unit Q0.32 to turns per metre.
    band.turns_per_metre = (sum_k / sum_weight) * 0x1p-22;
    band.steep_turns_per_metre = sum_amplitude > 0.0 ? band.steepness / sum_amplitude : band.turns_per_metre;
}

}  // namespace

std::vector<WaveBand> wave_bands(const WaveTrainBox& box) {
    std::vector<WaveBand> bands;
    std::vector<BinKey> keys;
    for (size_t i = 0; i < box.trains.size(); ++i) {
        const BinKey key{octave_of(box.trains[i]), direction_bin(box.trains[i], box)};
        size_t at = 0;
        while (at < keys.size() && !(keys[at] == key)) ++at;
        if (at == keys.size()) {
            keys.push_back(key);
            bands.emplace_back();
        }
        bands[at].trains.push_back(i);
    }
    for (WaveBand& band : bands) take_means(band, box);
    return bands;
}

double significant_height(const WaveTrainBox& box) { return significant_height(box.trains); }

}  // namespace trochoid
