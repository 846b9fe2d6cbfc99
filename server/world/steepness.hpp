#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "protocol/model/wave_train_box.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Largest steepness S = Σ χ |k'| A g where boxes overlap: below 1 no crest folds (model: "Sum over trains").
inline constexpr double steepness_limit = 0.8;
/// The part of what is left of the limit that one new box may take, so that later winds find some.
inline constexpr double steepness_share = 0.6;
/// Growth of |k'| g by land that is counted with before a box is traced: shoaling raises heights by up to a half.
inline constexpr double expected_land_growth = 1.5;

/// Whether a box is a wind whose course may be changed at any time.
bool steerable(const WaveTrainBox& box);

/// Whether the two boxes' rectangles can ever touch at one time within both spans [begin, end + decay). Unlimited sides reach
/// everywhere; a ship is where its course takes it. A steerable wind is where its course takes it until `settled`, the sea time before
/// which no course changes any more, and from then on within all that it can reach at fastest_storm. Never false for boxes
/// that act on one point at one time.
bool may_overlap(const WaveTrainBox& a, const WaveTrainBox& b, SeaTime settled = end_of_time);

/// Σ χ |k'| A (1 + a/A) over trains and wake, open water, fully grown: round waves lengthen k by up to 1.41 where they
/// travel along u, irregular heights raise A by their share a/A. Noise moves water up and down only.
double steepness_of(const WaveTrainBox& box);

/// A box with the factor by which land can make it steeper (1 on open water; gain, shorter waves and longer orbits together).
struct SteepBox {
    const WaveTrainBox* box = nullptr;
    double land_growth = 1.0;
    /// The box whose place this one took when the land changed; while they cross-fade only the steeper of them counts.
    BoxId predecessor{};
};

/// The boxes that a new one has to share the limit with. What does not depend on the new one is worked out once, so that many may
/// be limited against one crowd. The boxes have to outlive it.
class SteepCrowd {
public:
    /// `settled`: as for may_overlap.
    explicit SteepCrowd(std::span<const SteepBox> boxes = {}, SeaTime settled = end_of_time);

    /// The steepness that those that overlap the box leave of steepness_limit, at least 0; the box itself and `predecessor` do not
    /// count. Of a box and the one that took its place the steeper counts.
    double left_to(const WaveTrainBox& box, BoxId predecessor = {}) const;

private:
    struct Member {
        const WaveTrainBox* box = nullptr;
        double steepness = 0.0;  ///< over its land
        size_t predecessor = 0;  ///< index; its own where there is none
    };
    std::vector<Member> members_;
    SeaTime settled_;
};

/// Scales the choppiness of all trains of `box` and of its wake alike, never an amplitude, so that its steepness times `land_growth`
/// takes at most steepness_share of what the overlapping ones of the crowd leave of steepness_limit. A choppiness is never
/// raised. With it the sum over any set of boxes that share a point stays within the limit, in whatever order they came.
void limit_steepness(WaveTrainBox& box, double land_growth, const SteepCrowd& crowd);

/// The same for a box that takes the place of `predecessor`, one of the crowd: it may take all that the rest leaves, so that it
/// keeps its choppiness unless the new land is steeper than there is room for.
void limit_successor(WaveTrainBox& box, BoxId predecessor, double land_growth, const SteepCrowd& crowd);

}  // namespace trochoid
