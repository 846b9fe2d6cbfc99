#pragma once
#include <cstdint>

#include "protocol/model/sea.hpp"

namespace trochoid {

/// What a random sea is made of.
struct RandomSeaOptions {
    int boxes = 4;
    int trains = 6;              ///< most of a box
    LatticePoint centre = {};    ///< boxes and land lie around it
    int64_t extent = 2'000'000;  ///< lattice units: how far around
    bool land = true;            ///< fields, some over a base, some with holes
    bool orbits = true;
    bool irregular = true;
    bool round = true;
    bool noise = true;
    bool wakes = true;
    bool moving = true;
    bool unlimited = true;  ///< some boxes have no length, width or both
};

/// A sea of every feature, the same for the same seed; every record is valid.
Sea random_sea(uint64_t seed, const RandomSeaOptions& options = {});

}  // namespace trochoid
