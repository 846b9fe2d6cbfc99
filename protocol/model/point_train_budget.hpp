#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/model/sea.hpp"

namespace trochoid {

/// What evaluating a layer costs at one point of one box, in point-trains (one train evaluated at one point). Measured with
/// tests/bench (P2); only their ratios matter.
struct LayerCosts {
    double shelter = 0.15;      ///< for each train with a land field; pays refraction's look-up too
    double refraction = 0.05;   ///< for each train with a land field
    double wakes = 8.0;         ///< for each wake
    double irregular = 2.0;     ///< for each box with irregular heights
    double orbits = 0.05;       ///< for each train with a land field
    double round = 0.3;         ///< for each train of a box of round waves
    double noise_octave = 4.0;  ///< for each octave of a box's noise
};

/// What is asked: so many points, spread evenly over a rectangle, within a span of sea time.
struct BudgetQuestion {
    LatticeRect region;
    SeaTime from;
    SeaTime until;
    double points = 0.0;        ///< number of points in the region, above 0
    double point_trains = 0.0;  ///< what may be spent on all of them together
    Layers wanted = displayed_layers;
    LayerCosts costs;
};

/// The trains of a box that are kept, as indices of its record, ascending.
struct BoxShare {
    BoxId box;
    std::vector<uint16_t> trains;
    bool operator==(const BoxShare&) const = default;
};

/// The answer, with what it costs and what it loses.
struct BudgetChoice {
    std::vector<BoxShare> boxes;  ///< boxes that reach the region while alive, ascending id
    Layers layers;                ///< those of the wanted layers that fit, in order of importance
    double spent = 0.0;           ///< point-trains
    double asked = 0.0;           ///< what everything would have cost
    /// Bound, metres, of the change of the vertical displacement of any rest point by trains that are left out: sum of A * g_max.
    double trains_lost = 0.0;
    /// The same for layers that are left out altogether.
    double layers_lost = 0.0;
    /// Whether no other subset of trains within the budget loses less (sum of A * g_max weighted by the share of the region that a box
    /// covers); where the search was cut short the subset is within `gap` metres of the best.
    bool best = true;
    double gap = 0.0;
};

/// The best that a budget buys (paper A, section 5, "layers in order of importance"; row A9). Layers are bought in the order of
/// Layer: first the trains, as many as fit and those that matter most; a layer is taken whole or not at all, and the first one that does not fit
/// ends the list, so that a growing budget only ever adds. Trains are chosen to keep the largest sum of (A * g_max * share of the region
/// covered) for sum of (points covered) <= budget: an exact branch and bound, ended after 20,000 nodes.
/// Deterministic: equal questions, equal answers on every machine.
BudgetChoice choose_within(const Sea& sea, const BudgetQuestion& question);

/// The sea with the chosen trains alone; boxes that are not in the choice are left out. Evaluate it with choice.layers.
Sea reduced(const Sea& sea, const BudgetChoice& choice);

}  // namespace trochoid
