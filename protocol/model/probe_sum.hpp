#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "protocol/model/interest_state.hpp"
#include "protocol/units/sea_time.hpp"

// What two parties that should hold the same interest state compare to find where they differ (protocol/README.md, "Probes").
namespace trochoid {

/// Parts of a box behind its trains, which are parts 0 to 255 by their place in the record.
inline constexpr uint16_t wake_part = 256;
inline constexpr uint16_t noise_part = 257;

enum class PartKind : uint8_t { train, wake, noise, none };
/// `none`: of no box, or no part that the standard knows.
constexpr PartKind kind_of(BoxId box, uint16_t part) {
    if (box.value == 0 || part > noise_part) return PartKind::none;
    return part == wake_part ? PartKind::wake : part == noise_part ? PartKind::noise : PartKind::train;
}
constexpr std::string_view name_of(PartKind kind) {
    switch (kind) {
        case PartKind::train: return "train";
        case PartKind::wake: return "wake";
        case PartKind::noise: return "noise";
        case PartKind::none: break;
    }
    return "unknown part";
}

/// One step of the sum at a point.
struct PartSum {
    BoxId box;
    uint16_t part = 0;
    uint64_t sum = 0;  ///< hash of the twelve accumulators after it
    bool operator==(const PartSum&) const = default;
};

/// The sum at a point, step by step.
struct PointSum {
    uint64_t sample = 0;         ///< hash of the 15 floats that it comes to
    std::vector<PartSum> parts;  ///< in the order of the sum
    bool operator==(const PointSum&) const = default;
};

/// The patch of the state that holds the point; where several do, which no server sends, the finest.
const PatchDescriptor* patch_holding(const InterestState& state, LatticePoint p);

/// The sum at a rest point as the state has it: the boxes of the patch that holds it, of each as many trains as the patch says, its
/// wake and its noise, displayed noise too. Where no patch holds the point: all boxes of the state, whole. The same bits on every
/// machine. Lists `most_parts` parts at most; the sample is that of all.
PointSum probe_sum(const InterestState& state, SeaTime time, LatticePoint p,
                   size_t most_parts = std::numeric_limits<size_t>::max());

/// The first step in which two sums differ.
struct PartDifference {
    BoxId box;
    uint16_t part = 0;
    uint64_t theirs = 0;  ///< 0: they have no such part
    uint64_t ours = 0;
    bool operator==(const PartDifference&) const = default;
};
/// nullopt: none. Where only the samples differ (not all parts were listed), box 0 with the samples.
std::optional<PartDifference> first_difference(const PointSum& theirs, const PointSum& ours);

}  // namespace trochoid
