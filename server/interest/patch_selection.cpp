#include "server/interest/patch_selection.hpp"

#include <algorithm>
#include <cstdint>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

/// Ground must stand this much above the highest wave before water below it is given up, metres (covers run-up).
constexpr double land_margin = 2.0;

LatticeRect widened(const LatticeRect& r, int64_t by) {
    return {{r.min.x - by, r.min.z - by}, {r.max.x + by, r.max.z + by}};
}

class Descent {
public:
    /// Stops once more than `most` patches are found.
    Descent(const InterestIndex& index, const CullKey& key, size_t most);
    Selection run();

private:
    /// `reach` bounds the displacement of every box that any point of the square can feel.
    void visit(PatchKey key, size_t first, size_t last, double reach);
    bool hidden_by_frustum(const LatticeRect& rect, double height, double reach) const;
    bool under_land(const LatticeRect& rect, double height, double reach) const;
    void add_leaf(PatchKey key, const LatticeRect& rect, size_t first, size_t last, double reach);

    const InterestIndex& index_;
    const CullKey& key_;
    size_t most_;
    PatchLod lod_;
    double slack_;
    double altitude_;
    SixPlanes planes_{};
    Selection out_;
    std::vector<uint32_t> stack_;  // candidate boxes of the squares on the way down
};

Descent::Descent(const InterestIndex& index, const CullKey& key, size_t most)
    : index_(index),
      key_(key),
      most_(most),
      lod_(key),
      slack_(to_metres(key.slack)),
      altitude_(to_metres(key.anchor.altitude)) {}

Selection Descent::run() {
    const LatticePoint anchor = key_.anchor.position;
    double height = 0.0;
    double reach = 0.0;
    for (const auto& box : index_.boxes()) {
        const BoxFootprint f = footprint_over(*box, anchor, key_.from, key_.until);
        if (f.share > 0.0) stack_.push_back(static_cast<uint32_t>(out_.footprints.size()));
        height += f.height;
        reach += f.displacement;
        out_.footprints.push_back(f);
    }
    out_.visibility = visibility_distance(altitude_ + slack_, height);
    planes_ = padded_planes(key_.anchor, slack_, static_cast<double>(key_.slack_tangent), out_.visibility);

    const int64_t around = to_lattice(out_.visibility + slack_ + reach);
    const auto clamped = [](int64_t v) { return std::clamp(v, -world_bound, world_bound - 1); };
    const PatchKey first =
        patch_at({clamped(anchor.x - around), clamped(anchor.z - around)}, coarsest_patch_level);
    const PatchKey last =
        patch_at({clamped(anchor.x + around), clamped(anchor.z + around)}, coarsest_patch_level);
    const size_t alive_boxes = stack_.size();
    for (int32_t z = first.z; z <= last.z; ++z)
        for (int32_t x = first.x; x <= last.x; ++x)
            visit({coarsest_patch_level, x, z}, 0, alive_boxes, reach);
    return std::move(out_);
}

void Descent::visit(PatchKey key, size_t first, size_t last, double reach) {
    if (out_.patches.size() > most_) return;
    ++out_.counts.considered;
    const LatticeRect rect = rect_of(key);
    if (lod_.nearest_along_sea(rect) - reach > out_.visibility + slack_) {
        ++out_.counts.beyond_horizon;
        return;
    }
    const SquareOnSea square = square_on_sea(rect, key_.anchor.position, reach);
    double height = 0.0;
    double own_reach = 0.0;
    for (size_t i = first; i < last; ++i) {
        const BoxFootprint& f = out_.footprints[stack_[i]];
        if (!touches(f, square)) continue;
        height += f.height;
        own_reach += f.displacement;
        stack_.push_back(stack_[i]);
    }
    if (hidden_by_frustum(rect, height, own_reach)) {
        ++out_.counts.outside_frustum;
    } else if (under_land(rect, height, own_reach)) {
        ++out_.counts.under_land;
    } else if (lod_.splits(key)) {
        const auto level = static_cast<uint8_t>(key.level - 1);
        const size_t end = stack_.size();
        for (int32_t child = 0; child < 4; ++child)
            visit({level, 2 * key.x + (child & 1), 2 * key.z + (child >> 1)}, last, end, own_reach);
    } else {
        add_leaf(key, rect, last, stack_.size(), own_reach);
    }
    stack_.resize(last);
}

bool Descent::hidden_by_frustum(const LatticeRect& rect, double height, double reach) const {
    const SquareOnSea square = square_on_sea(rect, key_.anchor.position, reach);
    const double low = -height - curvature_drop(lod_.farthest_along_sea(rect) + slack_ + reach);
    const SurfaceBounds bounds{{square.x, (height + low) * 0.5 - altitude_, square.z},
                               {square.half, (height - low) * 0.5, square.half}};
    return outside(planes_, bounds);
}

bool Descent::under_land(const LatticeRect& rect, double height, double reach) const {
    const TerrainMinima* terrain = index_.terrain();
    return terrain != nullptr &&
           terrain->all_above(widened(rect, to_lattice(reach) + 1), to_lattice(height + land_margin));
}

void Descent::add_leaf(PatchKey key, const LatticeRect& rect, size_t first, size_t last, double reach) {
    const auto at = static_cast<uint32_t>(out_.box_lists.size());
    for (size_t i = first; i < last; ++i) out_.box_lists.push_back(stack_[i]);
    out_.patches.push_back({key, lod_.distance(rect), reach, at, static_cast<uint32_t>(last - first)});
}

}  // namespace

Selection select_patches(const InterestIndex& index, const CullKey& key) {
    return Descent(index, key, SIZE_MAX).run();
}

bool fits_limit(const InterestIndex& index, const CullKey& key) {
    return Descent(index, key, key.patch_limit).run().patches.size() <= key.patch_limit;
}

}  // namespace trochoid
