#include "tests/support/sea_audit.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "protocol/model/sea.hpp"
#include "protocol/units/hash.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/significant_height.hpp"
#include "server/world/spectrum.hpp"
#include "server/world/wind_box.hpp"

namespace trochoid {

namespace {

double omega_of(const WaveTrain& train) {
    return static_cast<double>(train.omega) * 0x1p-64 * 2.0 * pi * 1e6;
}

double energy_of(const WaveTrain& train) {
    return 0.5 * static_cast<double>(train.amplitude) * static_cast<double>(train.amplitude);
}

/// In [0, 1).
double chance(uint64_t seed, uint64_t index) {
    return static_cast<double>(splitmix64(splitmix64(seed) + index) >> 11) * 0x1p-53;
}

/// The grown sea of one box and places inside it where its envelope is full.
class GrownSea {
public:
    explicit GrownSea(const WaveTrainBox& box) : box_(box), sea_({prepare(box, {})}) {
        const double front = static_cast<double>(box.front_speed) / 17179.869184;
        grown_ = box.begin + box.build_up_us + seconds_to_us(1.1 * to_metres(box.length) / front);
    }

    SeaInstant at(double seconds) const { return SeaInstant(sea_, grown_ + seconds_to_us(seconds)); }

    LatticePoint place(uint64_t index) const {
        const auto part = [&](uint64_t axis, int64_t side) {
            return static_cast<int64_t>((0.3 + 0.4 * chance(7, 2 * index + axis)) *
                                        static_cast<double>(side));
        };
        const int64_t u = part(0, box_.length);
        const int64_t v = part(1, box_.width);
        return {box_.origin.x + ((u * box_.ux - v * box_.uz) >> 30),
                box_.origin.z + ((u * box_.uz + v * box_.ux) >> 30)};
    }

private:
    WaveTrainBox box_;
    Sea sea_;
    SeaTime grown_;
};

double measured_height(const GrownSea& sea, const AuditEffort& effort) {
    double square = 0.0;
    for (size_t i = 0; i < effort.instants; ++i) {
        const SeaInstant now = sea.at(8e6 * chance(11, i));
        for (size_t j = 0; j < effort.points; ++j) {
            const auto y = static_cast<double>(now.evaluate(sea.place(i * effort.points + j)).ay);
            square += y * y;
        }
    }
    return 4.0 * std::sqrt(square / static_cast<double>(effort.instants * effort.points));
}

/// Mean time between zero up-crossings, each placed by linear interpolation.
double measured_mean(const GrownSea& sea, const AuditEffort& effort, double peak_period, double step) {
    struct Gauge {
        double last = 0.0;
        double first_crossing = -1.0;
        double last_crossing = -1.0;
        double waves = -1.0;
    };
    std::vector<Gauge> gauges(effort.gauges);
    const auto steps = static_cast<size_t>(effort.waves * peak_period / step);
    for (size_t i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) * step;
        const SeaInstant now = sea.at(t);
        for (size_t j = 0; j < gauges.size(); ++j) {
            Gauge& g = gauges[j];
            const auto y = static_cast<double>(now.evaluate(sea.place(j)).ay);
            if (i > 0 && g.last < 0.0 && y >= 0.0) {
                g.last_crossing = t - step * y / (y - g.last);
                if (g.waves < 0.0) g.first_crossing = g.last_crossing;
                g.waves += 1.0;
            }
            g.last = y;
        }
    }
    double time = 0.0;
    double waves = 0.0;
    for (const Gauge& g : gauges)
        if (g.waves > 0.0) {
            time += g.last_crossing - g.first_crossing;
            waves += g.waves;
        }
    return time / waves;
}

double binned_peak(const std::vector<WaveTrain>& trains) {
    std::vector<double> omegas;
    for (const WaveTrain& train : trains) omegas.push_back(omega_of(train));
    std::nth_element(omegas.begin(), omegas.begin() + static_cast<std::ptrdiff_t>(omegas.size() / 2),
                     omegas.end());
    const double median = omegas[omegas.size() / 2];
    const double reach = 0.12 * median;
    double best = 0.0;
    double highest = 0.0;
    for (double w = 0.3 * median; w < 3.0 * median; w += 0.002 * median) {
        double density = 0.0;
        for (const WaveTrain& train : trains)
            density += energy_of(train) * std::max(0.0, 1.0 - std::abs(omega_of(train) - w) / reach);
        if (density > highest) {
            highest = density;
            best = w;
        }
    }
    return 2.0 * pi / best;
}

void add_published(AuditResult& result, const FrequencySpectrum& spectrum) {
    const double u = spectrum.wind_speed();
    const double x = result.dimensionless_fetch;
    switch (spectrum.kind()) {
        case Spectrum::jonswap:
            result.published_height = 0.0016 * std::sqrt(x) * u * u / gravity;
            result.published_peak = u / gravity * std::cbrt(x) / 3.5;
            break;
        case Spectrum::neumann:
            result.published_height = 0.00707 * std::pow(u, 2.5);
            result.published_peak = 0.785 * u;
            break;
        default:
            result.published_height = 0.21 * u * u / gravity;
            result.published_peak = 2.0 * pi * u / (0.877 * gravity);
    }
}

}  // namespace

AuditResult audit(const AuditCase& asked, const AuditEffort& effort) {
    StartWind wind;
    wind.speed = static_cast<float>(asked.speed);
    wind.towards_degrees = 70.0F;
    wind.fetch = wind.width = to_lattice(asked.fetch);
    wind.trains = asked.trains;
    wind.directions = asked.directions;
    wind.spectrum = asked.spectrum;
    wind.seed = asked.seed;
    const FrequencySpectrum spectrum =
        wind_spectrum(static_cast<double>(wind.speed), wind.fetch, wind.spectrum);
    const WaveTrainBox box = box_of(wind, {}, {{1}, {1}});

    AuditResult result;
    result.kind = spectrum.kind();
    const double u10 = wind_at_height(static_cast<double>(wind.speed), 10.0);
    result.dimensionless_fetch = std::min(gravity * asked.fetch / (u10 * u10), jonswap_full_development);
    result.spectrum_height = spectrum.significant_height();
    result.spectrum_peak = 2.0 * pi / spectrum.peak_omega();
    result.spectrum_mean = 2.0 * pi * std::sqrt(spectrum.m0() / spectrum.m2());
    add_published(result, spectrum);

    double m0 = 0.0;
    double m2 = 0.0;
    double fastest = 0.0;
    for (const WaveTrain& train : box.trains) {
        const double w = omega_of(train);
        m0 += energy_of(train);
        m2 += energy_of(train) * w * w;
        fastest = std::max(fastest, w);
    }
    result.train_height = significant_height(box.trains);
    result.train_mean = 2.0 * pi * std::sqrt(m0 / m2);
    result.train_peak = binned_peak(box.trains);

    const GrownSea sea(box);
    result.surface_height = measured_height(sea, effort);
    // Eight steps for the shortest wave.
    result.surface_mean = measured_mean(sea, effort, result.spectrum_peak, 2.0 * pi / fastest / 8.0);
    return result;
}

}  // namespace trochoid
