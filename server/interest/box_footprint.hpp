#pragma once
#include <vector>

#include "server/interest/interest_index.hpp"

namespace trochoid {

/// A square around a patch relative to the anchor, metres: middle and half of its side.
struct SquareOnSea {
    double x = 0.0;
    double z = 0.0;
    double half = 0.0;
};
SquareOnSea square_on_sea(const LatticeRect& square, LatticePoint anchor, double reach);

/// A wave train box as it lies on the sea over a span of time, relative to an anchor (paper A's oriented bounding box;
/// row A10): of a moving box (row A12) the rectangle along its own axes that it sweeps, of one that only has a ship's wake
/// the rectangle around the wake's wedge; a hull lies within it too. Heights are bounds of what it may add anywhere in the span.
struct BoxFootprint {
    const IndexedBox* box = nullptr;
    double share = 0.0;         ///< largest time part of the envelope over the span, rounded up to sixteenths
    double height = 0.0;        ///< most that it lifts or lowers the water, m
    double displacement = 0.0;  ///< most that it shifts the water sideways, m
    double x = 0.0, z = 0.0;    ///< the corner u = v = 0 at the beginning of the span, m
    double ux = 1.0, uz = 0.0;
    double least_u = 0.0, least_v = 0.0;  ///< where the rectangle begins, m from that corner
    double length = 0.0, width = 0.0;     ///< m; unlimited sides are flagged and say nothing here
    bool limited_length = false, limited_width = false;
    double min_x = 0.0, min_z = 0.0, max_x = 0.0, max_z = 0.0;  ///< of a box limited on both sides
};

/// The box as far as its front has come by `until`. share is 0 for a box that is still water over the whole span.
BoxFootprint footprint_over(const IndexedBox& box, LatticePoint anchor, SeaTime from, SeaTime until);
/// The whole box wherever it comes from `from` on.
BoxFootprint whole_footprint(const IndexedBox& box, LatticePoint anchor, SeaTime from);

/// False only where no point of the square lies in the box (separating axes: the world's and the box's).
bool touches(const BoxFootprint& footprint, const SquareOnSea& square);

/// Upper bound of the time part of the envelope over [from, until], in sixteenths rounded up so that a box that grows or
/// takes over from another changes it at most 32 times.
double largest_share(const WaveTrainBox& box, SeaTime from, SeaTime until);

}  // namespace trochoid
