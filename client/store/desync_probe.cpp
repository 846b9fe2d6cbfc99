#include "client/store/desync_probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/model/probe_sum.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

/// 0 to below - 1.
int64_t drawn(uint64_t& dice, int64_t below) {
    dice = splitmix64(dice);
    return static_cast<int64_t>((dice >> 1) % static_cast<uint64_t>(below));
}

LatticePoint point_in(const LatticeRect& rect, uint64_t& dice) {
    const int64_t x = drawn(dice, rect.max.x - rect.min.x);
    const int64_t z = drawn(dice, rect.max.z - rect.min.z);
    return {rect.min.x + x, rect.min.z + z};
}

LatticePoint point_in(const SyncRegion& region, uint64_t& dice) {
    const int64_t side = 2 * int64_t{region.radius} + 1;
    const int64_t x = region.centre.x - region.radius + drawn(dice, side);
    const int64_t z = region.centre.z - region.radius + drawn(dice, side);
    return {std::clamp(x, -world_bound, world_bound), std::clamp(z, -world_bound, world_bound)};
}

PointSum sum_of(const ProbedPoint& point) {
    PointSum sum;
    sum.sample = point.sample;
    sum.parts.reserve(point.parts.size());
    for (const ProbePart& part : point.parts) sum.parts.push_back({part.box, part.part, part.sum});
    return sum;
}

PatchKey patch_of(const InterestState& state, LatticePoint p) {
    const PatchDescriptor* patch = patch_holding(state, p);
    if (patch != nullptr) return patch->key;
    // The eastern and southern borders of the world belong to no patch.
    return patch_at({std::min(p.x, world_bound - 1), std::min(p.z, world_bound - 1)}, finest_patch_level);
}

}  // namespace

std::vector<LatticePoint> probe_points(const InterestState& state, const std::vector<SyncRegion>& regions,
                                       uint64_t seed, size_t count) {
    std::vector<PatchKey> patches;
    for (const auto& [key, patch] : state.patches)
        if (!patch.boxes.empty()) patches.push_back(key);
    std::vector<LatticePoint> points;
    uint64_t dice = seed;
    while (points.size() < count && !(patches.empty() && regions.empty())) {
        if (!patches.empty())
            points.push_back(point_in(
                rect_of(patches[static_cast<size_t>(drawn(dice, static_cast<int64_t>(patches.size())))]),
                dice));
        else
            points.push_back(point_in(
                regions[static_cast<size_t>(drawn(dice, static_cast<int64_t>(regions.size())))], dice));
    }
    return points;
}

Result<ProbeFinding> compare(const ProbeReply& theirs, const Probe& asked, const InterestState& ours) {
    if (theirs.result != asked.result || theirs.time != asked.time ||
        theirs.points.size() > asked.points.size())
        return Error{
            ErrorCode::value_out_of_range,
            fmt::format("probe {} was answered for result {} with {} points, asked for result {} with {}",
                        asked.sequence, theirs.result, theirs.points.size(), asked.result,
                        asked.points.size())};
    ProbeFinding finding;
    finding.compared = theirs.points.size();
    for (size_t i = 0; i < theirs.points.size(); ++i) {
        const LatticePoint p = asked.points[i];
        const auto first =
            first_difference(sum_of(theirs.points[i]), probe_sum(ours, asked.time, p, most_probe_parts));
        if (!first) continue;
        Desync desync;
        desync.result = asked.result;
        desync.time = asked.time;
        desync.at = p;
        desync.patch = patch_of(ours, p);
        desync.box = first->box;
        desync.part = first->part;
        desync.expected = first->theirs;
        desync.actual = first->ours;
        finding.difference = desync;
        break;
    }
    return finding;
}

}  // namespace trochoid
