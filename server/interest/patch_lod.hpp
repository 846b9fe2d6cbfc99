#pragma once
#include "protocol/model/interest_state.hpp"

namespace trochoid {

/// Coarsest patch for its distance: side <= largest_patch_slope * distance. Below 1/sqrt(2) two leaves that touch differ
/// by at most one level, whatever is culled (see PatchLod).
inline constexpr double largest_patch_slope = 0.7;

/// How fine patches are by distance: a patch splits while its side is longer than
/// T(d) = max(patch_segments * finest vertex spacing, slope * d), d the distance of the nearest camera within the slack to
/// the closed square on still water, slope = min(patch_segments * angle per vertex, 0.7). So each patch's side takes at
/// most patch_segments vertex spacings, until the slope's limit makes patches finer than they need be.
///
/// Balanced by construction: were a leaf of side 4s beside one of side s, then T(d1) >= 4s at the large one and
/// T(d2) < 2s at the small one's parent; but T changes by at most slope per metre and d1 <= d2 + the parent's diagonal
/// 2s * sqrt(2), so T(d1) < 2s + 0.7 * 2.83 s < 4s.
class PatchLod {
public:
    explicit PatchLod(const CullKey& key);

    /// Distance in three dimensions from the nearest camera within the slack to the closed rectangle, metres.
    double distance(const LatticeRect& rect) const;
    /// Horizontal distance from the anchor to the nearest point of the closed rectangle, metres.
    double nearest_along_sea(const LatticeRect& rect) const;
    double farthest_along_sea(const LatticeRect& rect) const;
    /// Finest spacing of displayed vertices at that distance, metres.
    double spacing(double distance) const;
    bool splits(PatchKey key) const;
    /// The leaf over a point, culled or not.
    PatchKey leaf_at(LatticePoint p) const;
    /// Whether more error makes the patches coarser still.
    bool can_coarsen() const { return slope_ < largest_patch_slope; }

private:
    LatticePoint anchor_;
    double altitude_;  // m
    double slack_;     // m
    double angle_per_vertex_;
    double slope_;
};

}  // namespace trochoid
