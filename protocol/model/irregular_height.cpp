#include "protocol/model/irregular_height.hpp"

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/sincos.hpp"

namespace trochoid {

namespace {

constexpr float two_pi = 0x1.921fb6p+2F;

uint32_t phase_from_place(int32_t kx, int32_t kz, LatticePoint p) {
    return static_cast<uint32_t>(kx) * static_cast<uint32_t>(static_cast<uint64_t>(p.x)) +
           static_cast<uint32_t>(kz) * static_cast<uint32_t>(static_cast<uint64_t>(p.z));
}

/// Turns per lattice unit, Q0.32, to rad/m.
float radians_per_metre(int32_t k) { return two_pi * (static_cast<float>(k) * 0x1p-22F); }

}  // namespace

IrregularPhases phases_at_origin(const IrregularHeight& irregular, SeaTime t) {
    const auto turned = static_cast<uint32_t>((irregular.omega * static_cast<uint64_t>(t.us)) >> 32);
    return {irregular.phase_u - turned, irregular.phase_v};
}

HeightModulation modulation_at(const IrregularHeight& irregular, const IrregularPhases& at_origin,
                               LatticePoint p) {
    if (irregular.share == 0) return {};
    const SinCos u = sincos_turns(phase_from_place(irregular.ukx, irregular.ukz, p) + at_origin.u);
    const SinCos v = sincos_turns(phase_from_place(irregular.vkx, irregular.vkz, p) + at_origin.v);
    const float share = static_cast<float>(irregular.share) * 0x1p-15F;
    const float along = u.cos * v.sin;
    const float across = u.sin * v.cos;
    HeightModulation m;
    m.factor = 1.0F - share * (u.sin * v.sin);
    m.dx = -(share * (along * radians_per_metre(irregular.ukx) + across * radians_per_metre(irregular.vkx)));
    m.dz = -(share * (along * radians_per_metre(irregular.ukz) + across * radians_per_metre(irregular.vkz)));
    return m;
}

Result<Done> validate(const IrregularHeight& irregular) {
    if (irregular.share > full_irregularity)
        return Error{ErrorCode::value_out_of_range, "irregular heights: the share is above 2^15 (1)"};
    for (const int32_t k : {irregular.ukx, irregular.ukz, irregular.vkx, irregular.vkz})
        if (k == INT32_MIN)
            return Error{ErrorCode::value_out_of_range,
                         "irregular heights: a wave vector component is -2^31"};
    if (irregular.share != 0 &&
        ((irregular.ukx == 0 && irregular.ukz == 0) || (irregular.vkx == 0 && irregular.vkz == 0)))
        return Error{ErrorCode::value_out_of_range, "irregular heights: a wave vector is 0"};
    return Done{};
}

}  // namespace trochoid
