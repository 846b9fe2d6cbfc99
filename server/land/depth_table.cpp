#include "server/land/depth_table.hpp"

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

DepthTable::DepthTable(const DepthResponse& response)
    : deep_(static_cast<float>(response.deep())),
      untouched_(static_cast<float>(response.untouched())),
      shallowest_(static_cast<float>(response.shallowest())) {
    const auto sample = [&](uint32_t node) {
        const double depth = static_cast<double>(std::bit_cast<float>(first_bits + (node << low_bits)));
        return FourFloats{static_cast<float>(response.wave_number(depth)),
                          static_cast<float>(response.growth(depth)),
                          static_cast<float>(response.breaking_gain(depth)),
                          static_cast<float>(response.share_limit(depth))};
    };
    FourFloats here = sample(0);
    land_ = here;
    land_[2] = 0.0F;
    land_[3] = 0.0F;
    const uint32_t last_bits = std::max(std::bit_cast<uint32_t>(untouched_), first_bits);
    const uint32_t cells = ((last_bits - first_bits) >> low_bits) + 1;
    rows_.reserve(cells);
    for (uint32_t cell = 0; cell < cells; ++cell) {
        const FourFloats next = sample(cell + 1);
        rows_.push_back({here, next - here});
        here = next;
    }
}

}  // namespace trochoid
