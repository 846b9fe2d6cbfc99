#include "server/interest/patch_priority.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

constexpr double padding_share = 0.25;  // how much of its nearness a patch out of view keeps
constexpr double typical_wave = 2.0;    // m, half height of the patches' boxes
constexpr double nearest = 1.0;         // m
constexpr double near_plane = 0.1;      // m
constexpr double far_plane = 1.0e7;     // m

}  // namespace

PatchPriority::PatchPriority(const ViewState& view)
    : anchor_(view.position),
      altitude_(to_metres(view.altitude)),
      planes_(planes_of(view, near_plane, far_plane)) {}

double PatchPriority::operator()(PatchKey key) const {
    const LatticeRect rect = rect_of(key);
    const double half = to_metres(int64_t{1} << key.level) * 0.5;
    const double x = to_metres(rect.min.x - anchor_.x) + half;
    const double z = to_metres(rect.min.z - anchor_.z) + half;
    const double gap_x = std::max(std::max(x, -x) - half, 0.0);
    const double gap_z = std::max(std::max(z, -z) - half, 0.0);
    const double distance =
        std::max(std::sqrt(gap_x * gap_x + gap_z * gap_z + altitude_ * altitude_), nearest);
    const bool seen = !outside(planes_, {{x, -altitude_, z}, {half, typical_wave, half}});
    return (seen ? 1.0 : padding_share) / distance;
}

double priority(const PatchDescriptor& patch, const ViewState& view) {
    return PatchPriority(view)(patch.key);
}

void sort_by_priority(std::vector<PatchDescriptor>& patches, const ViewState& view) {
    const PatchPriority priority_of(view);
    std::vector<std::pair<double, size_t>> order;
    for (size_t i = 0; i < patches.size(); ++i) order.emplace_back(priority_of(patches[i].key), i);
    std::sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : patches[a.second].key < patches[b.second].key;
    });
    std::vector<PatchDescriptor> sorted;
    sorted.reserve(patches.size());
    for (const auto& [value, i] : order) sorted.push_back(std::move(patches[i]));
    patches = std::move(sorted);
}

}  // namespace trochoid
