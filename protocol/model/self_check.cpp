#include "protocol/model/self_check.hpp"

#include <fmt/format.h>

#include "protocol/units/hash.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr uint64_t self_check_seed = 2004;
constexpr uint32_t self_check_points = 512;
constexpr uint64_t self_check_hash = 0x7f391bda8b297398;

}  // namespace

uint64_t reference_hash(uint64_t seed, uint32_t count) { return hash_over(reference_sea(), seed, count); }

uint64_t hash_over(const Sea& sea, uint64_t seed, uint32_t count) {
    std::vector<SurfaceSample> samples;
    samples.reserve(count);
    constexpr uint32_t points_per_time = 64;
    for (uint32_t i = 0; i < count;) {
        // Times over twelve years, so begin, plateau, decay and the calm after are all met.
        const uint64_t h = splitmix64(seed ^ (uint64_t{i} << 32));
        const int64_t spread = (i / points_per_time) % 2 == 0 ? 900'000'000 : 378'432'000'000'000;
        const SeaInstant instant(sea, SeaTime{static_cast<int64_t>(h % static_cast<uint64_t>(spread))});
        for (uint32_t j = 0; j < points_per_time && i < count; ++j, ++i) {
            const uint64_t a = splitmix64(h + j);
            const uint64_t b = splitmix64(a);
            // Near the fields mostly, every eighth anywhere within 10,000 km.
            const uint64_t span = j % 8 == 7 ? 20'480'000'000ULL : 4'194'304ULL;
            samples.push_back(
                instant.evaluate({static_cast<int64_t>(a % span) - static_cast<int64_t>(span / 2),
                                  static_cast<int64_t>(b % span) - static_cast<int64_t>(span / 2)}));
        }
    }
    return hash_of(samples);
}

void self_check() {
    const uint64_t hash = reference_hash(self_check_seed, self_check_points);
    if (hash != self_check_hash)
        throw OperatorError(fmt::format(
            "this build computes another sea (self-check {:016x}, expected {:016x}): rebuild with -ffp-contract=off and "
            "without -ffast-math",
            hash, self_check_hash));
}

}  // namespace trochoid
