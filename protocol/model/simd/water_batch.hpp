#pragma once
#include <span>

#include "protocol/model/point_query.hpp"
#include "protocol/model/simd/workers.hpp"

namespace trochoid {

/// water_at for many places at one sea time, to the bit, whatever machine or number of threads; out.size() == places.size().
/// Places near each other are best given next to each other.
void water_at_batch(const SeaInstant& sea, std::span<const LatticePoint> places, std::span<WaterPoint> out,
                    Workers& workers);

/// SeaInstant::evaluate for many rest points inside the world, to the bit; out.size() == rests.size(). For a regular grid of them
/// evaluate_grid is faster.
void evaluate_batch(const SeaInstant& sea, std::span<const LatticePoint> rests, std::span<SurfaceSample> out,
                    Workers& workers);

}  // namespace trochoid
