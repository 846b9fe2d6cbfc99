#pragma once
#include <cstdint>

#include "protocol/model/sea.hpp"

namespace trochoid {

/// A small fixed sea with every feature of the model: what the self-check and the hello's known-answer challenge evaluate. Boxes: 1 swell,
/// 2 a wind over a land field, 3 a moving storm (legs, round waves, irregular heights, orbits, overlays, noise), 4 a ship, 5 a
/// successor, 6 displayed noise everywhere. Values come from integers and binary fractions only.
Sea reference_sea();

/// Hash of `count` points of the reference sea over 10 years and 10,000 km, chosen by the seed.
uint64_t reference_hash(uint64_t seed, uint32_t count);
/// The same over another sea.
uint64_t hash_over(const Sea& sea, uint64_t seed, uint32_t count);

/// Evaluates the reference sea and compares with the normative hash. A program whose build computes another sea (fused
/// products, fast-math, x87) throws OperatorError here and must not join.
void self_check();

}  // namespace trochoid
