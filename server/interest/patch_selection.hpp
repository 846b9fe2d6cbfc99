#pragma once
#include <span>
#include <vector>

#include "server/interest/box_footprint.hpp"
#include "server/interest/frustum.hpp"
#include "server/interest/patch_lod.hpp"

namespace trochoid {

/// How often the quadtree's descent ended, and why. A square culled with all below it counts once, at its own level.
struct SelectionCounts {
    uint32_t considered = 0;       ///< squares looked at, at any level
    uint32_t outside_frustum = 0;  ///< behind one of the padded planes
    uint32_t beyond_horizon = 0;   ///< farther along the sea than water is shown
    uint32_t under_land = 0;       ///< ground above every wave on the whole square
    bool operator==(const SelectionCounts&) const = default;
};

struct SelectedPatch {
    PatchKey key;
    double distance = 0.0;   ///< m, of the nearest camera within the slack
    double reach = 0.0;      ///< m, bound of the horizontal displacement on and around the patch
    uint32_t first_box = 0;  ///< its boxes: box_count entries of Selection::box_lists from here
    uint32_t box_count = 0;
};

/// The patches in the padded view, before filter and limit.
struct Selection {
    std::vector<BoxFootprint> footprints;  ///< parallel to the index's boxes
    std::vector<SelectedPatch> patches;    ///< in the quadtree's order
    std::vector<uint32_t> box_lists;       ///< indices of footprints, ascending for each patch
    double visibility = 0.0;               ///< m along the sea
    SelectionCounts counts;

    std::span<const uint32_t> boxes_of(const SelectedPatch& p) const {
        return std::span(box_lists).subspan(p.first_box, p.box_count);
    }
};

/// Descends the quadtree from the 65 km squares around the anchor (row A10). Conservative: a point of the displaced
/// surface that some camera within slack and tangent can see, at any time of the span, with or without curvature, has its
/// rest point on a selected patch. Each patch's bounding box is its square and the sum of the heights of all boxes that
/// overlap it, widened by their displacement.
Selection select_patches(const InterestIndex& index, const CullKey& key);

/// Whether no more than key.patch_limit patches would be selected; stops looking at the first one too many.
bool fits_limit(const InterestIndex& index, const CullKey& key);

}  // namespace trochoid
