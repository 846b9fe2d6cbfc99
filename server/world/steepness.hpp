#pragma once
#include <span>

#include "protocol/model/wave_train_box.hpp"

namespace trochoid {

/// Largest steepness S = Σ χ |k'| A g where boxes overlap: below 1 no crest folds (model: "Sum over trains").
inline constexpr double steepness_limit = 0.8;
/// The part of what is left of the limit that one new box may take, so that later winds find some.
inline constexpr double steepness_share = 0.6;
/// Growth of |k'| g by land that is counted with before a box is traced: shoaling raises heights by up to a half.
inline constexpr double expected_land_growth = 1.5;

/// Whether the two boxes' rectangles touch in space (unlimited sides reach everywhere) and their spans [begin, end +
/// decay) in time. Never false for boxes that act on one point at one time.
bool may_overlap(const WaveTrainBox& a, const WaveTrainBox& b);

/// Σ χ k A over the trains, open water, fully grown.
double steepness_of(const WaveTrainBox& box);

/// A box with the factor by which land can make it steeper (1 on open water).
struct SteepBox {
    const WaveTrainBox* box = nullptr;
    double land_growth = 1.0;
};

/// Scales the choppiness of all trains of `box` alike, never an amplitude, so that its steepness times `land_growth` takes
/// at most steepness_share of what the overlapping ones of `others` leave of steepness_limit. A choppiness is never
/// raised. With it the sum over any set of boxes that share a point stays within the limit, in whatever order they came.
void limit_steepness(WaveTrainBox& box, double land_growth, std::span<const SteepBox> others);

}  // namespace trochoid
