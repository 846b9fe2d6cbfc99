#include "server/world/wind_sea.hpp"

#include "protocol/model/arithmetic_rules.hpp"
#include "server/world/spectrum.hpp"

namespace trochoid {

WindSea wind_sea(double speed, int64_t fetch, Spectrum spectrum) {
    const FrequencySpectrum s = wind_spectrum(speed, fetch, spectrum);
    return {s.significant_height(), s.peak_omega()};
}

}  // namespace trochoid
