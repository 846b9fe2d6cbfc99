#pragma once
#include "server/interest/patch_selection.hpp"

namespace trochoid {

/// Trains of a box of `trains` are kept in groups of this many, grouped by wavelength: a moving camera changes a patch's
/// counts a fraction as often (row B7).
constexpr size_t filter_group(size_t trains) { return trains < 32 ? 4 : trains / 8; }

/// How many trains of the box, from the longest on, may show at vertices `spacing` metres apart or farther: all beyond
/// have displayed_weight exactly 0 there (row B6). Rounded up to whole groups.
size_t kept_trains(const IndexedBox& box, double spacing);

/// What a result refers to, gathered while its patches are described: boxes, and blocks of their fields.
class Referred {
public:
    explicit Referred(const InterestIndex& index);
    void box(size_t box) { boxes_[box] = 1; }
    /// All existing blocks of the box's field that touch the rectangle.
    void blocks(size_t box, size_t field, const LatticeRect& rect);
    bool has_box(size_t box) const { return boxes_[box] != 0; }
    /// Moves everything referred to into the state.
    void collect(InterestState& state) const;

private:
    const InterestIndex& index_;
    std::vector<uint8_t> boxes_;
    std::vector<std::vector<std::vector<uint8_t>>>
        marks_;  // box, field, block; empty until the field is first needed
};

/// Counts of what is weightless everywhere on its patch and so left out of it.
struct LeftOut {
    uint32_t trains = 0;
    uint32_t wakes = 0;
    uint32_t noises = 0;
    bool operator==(const LeftOut&) const = default;
};

/// The patch as the client is told: which boxes and how many of their trains it needs, E of those left out, and H, the
/// bound of the height error at a fixed place (model: "The two surfaces"): E + E_h G, where E_h = sum of chi A g o is the
/// sideways part of what is missing (at most E where chi and the orbits are at most 1) and
/// G = sum (k A g + A |grad g|) / (1 - S) bounds the slope of the full sea, S <= 0.8 being the world's guarantee.
/// A box with a wake or noise is named, with 0 trains maybe, wherever their longest waves may show; where it is not, both
/// are missing (noise that is only displayed is no part of the full sea). Adds what it refers to.
PatchDescriptor describe(const Selection& selection, const SelectedPatch& patch, double spacing,
                         Referred& referred, LeftOut& left_out);

}  // namespace trochoid
