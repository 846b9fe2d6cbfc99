#include "server/interest/patch_lod.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

/// Distance between an anchor's coordinate and the interval, lattice units.
int64_t gap(int64_t p, int64_t min, int64_t max) { return std::max({min - p, p - max, int64_t{0}}); }
int64_t reach(int64_t p, int64_t min, int64_t max) { return std::max(max - p, p - min); }

double length(double a, double b) { return std::sqrt(a * a + b * b); }

}  // namespace

PatchLod::PatchLod(const CullKey& key)
    : anchor_(key.anchor.position),
      altitude_(to_metres(key.anchor.altitude)),
      slack_(to_metres(key.slack)),
      angle_per_vertex_(display_filter(key.anchor, key.error_in_force_px).angle_per_vertex),
      slope_(std::min(angle_per_vertex_ * patch_segments, largest_patch_slope)) {}

double PatchLod::nearest_along_sea(const LatticeRect& r) const {
    return length(to_metres(gap(anchor_.x, r.min.x, r.max.x)), to_metres(gap(anchor_.z, r.min.z, r.max.z)));
}

double PatchLod::farthest_along_sea(const LatticeRect& r) const {
    return length(to_metres(reach(anchor_.x, r.min.x, r.max.x)),
                  to_metres(reach(anchor_.z, r.min.z, r.max.z)));
}

double PatchLod::distance(const LatticeRect& rect) const {
    return std::max(length(nearest_along_sea(rect), altitude_) - slack_, 0.0);
}

double PatchLod::spacing(double distance) const {
    return std::max(distance * angle_per_vertex_, static_cast<double>(finest_vertex_spacing));
}

bool PatchLod::splits(PatchKey key) const {
    if (key.level <= finest_patch_level) return false;
    const double side = to_metres(int64_t{1} << key.level);
    const double floor = static_cast<double>(finest_vertex_spacing) * patch_segments;
    return side > std::max(floor, slope_ * distance(rect_of(key)));
}

PatchKey PatchLod::leaf_at(LatticePoint p) const {
    PatchKey key = patch_at(p, coarsest_patch_level);
    while (splits(key)) key = patch_at(p, static_cast<uint8_t>(key.level - 1));
    return key;
}

}  // namespace trochoid
