#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/model/terrain.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// Metres along the sea in which the sides of a change rise or fall by one metre: rubble lies at 1 in 2.
inline constexpr double side_slope = 2.0;
/// Samples that a crest is wide at least: with them a line in any direction closes the water, which is bilinear between samples.
inline constexpr double least_crest_samples = 1.5;

/// Whether a change's figures lie in their ranges (server/event/wind_limits.hpp).
Result<Done> validate(const ChangeLand& change);

/// A terrain after a change.
struct TerrainEdit {
    std::shared_ptr<const TerrainGrid> terrain;
    /// Outside it every height is the old terrain's (height_at, the belt beyond the grid included). Lattice units.
    LatticeRect touched;
    size_t samples = 0;  ///< how many changed, at least 1
};

/// The terrain with the bed raised (or dug) to `crest` within width/2 of the line (at least least_crest_samples/2 samples), with sides that
/// fall (or rise) by 1 in side_slope from there on. What is higher (deeper) already stays. A pure function: + - * / sqrt on doubles,
/// then whole counts. The change must be valid. value_out_of_range where no sample changes.
Result<TerrainEdit> edited(const TerrainGrid& terrain, const ChangeLand& change);

/// Both, one after the other: `next` is an edit of first's terrain.
TerrainEdit followed_by(const TerrainEdit& first, TerrainEdit next);

/// All of them in order; `touched` is around all, `samples` the sum. The first error; none of the changes may come to nothing.
Result<TerrainEdit> edited(const TerrainGrid& terrain, std::span<const ChangeLand> changes);

/// An event's changes in order, at least one.
std::vector<ChangeLand> changes_of(const LandChanged& event);

}  // namespace trochoid
