#pragma once
#include <random>

#include "server/interest/cull.hpp"
#include "server/interest/interest_index.hpp"

namespace trochoid {

/// Dice of the tests: a fixed generator, ranges by our own arithmetic.
class Dice {
public:
    explicit Dice(uint32_t seed) : engine_(seed) {}
    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
    }
    int64_t lattice(double low_metres, double high_metres) {
        return to_lattice(between(low_metres, high_metres));
    }
    LatticePoint point_in(const LatticeRect& r) {
        return {r.min.x + static_cast<int64_t>(between(0.0, 1.0) * static_cast<double>(r.max.x - r.min.x)),
                r.min.z + static_cast<int64_t>(between(0.0, 1.0) * static_cast<double>(r.max.z - r.min.z))};
    }

private:
    std::mt19937 engine_;
};

struct SampleBox {
    uint32_t id = 1;
    LatticePoint origin;   ///< rear left corner
    double heading = 0.3;  ///< of u, radians from east to south
    double length = 0.0;   ///< m, 0 unlimited
    double width = 0.0;
    size_t trains = 16;
    double shortest = 2.0, longest = 120.0;  ///< wavelengths, m
    double steepness = 0.15;                 ///< sum of chi k A over the box
    float choppiness = 1.0F;
    bool land = false;     ///< two fields around the world's middle
    bool changed = false;  ///< and over each an overlay with two changed blocks and one that is trivial now
    SeaTime begin{0};
    int64_t build_up_us = 0;
    SeaTime end = end_of_time;
    int64_t decay_us = 60'000'000;
    uint32_t front_speed = 0;
    int64_t raised_us = 0;
    int64_t fade_us = 0;
    double share = 0.0;      ///< a/A of irregular heights, groups of 300 m
    double roundness = 0.0;  ///< of the crests, 0 to 1
    double speed = 0.0;      ///< m/s along u from `begin` on
    double turn = 0.0;       ///< radians that a second leg, 900 s later, is turned by
    double ship = 0.0;       ///< m/s of a ship at the front edge's middle whose wake the box holds
    SurfaceNoise noise;
};

std::shared_ptr<const WorldBox> sample_box(const SampleBox& what, Dice& dice);
WorldState sample_world(std::vector<SampleBox> boxes, uint32_t seed,
                        std::shared_ptr<const TerrainGrid> terrain = nullptr);
/// Seven limited boxes of 8 to 30 km that overlap around x = z = 0, one with land, and an unlimited swell.
WorldState eight_box_world(size_t trains_a_box = 16);

/// What session two brought: a storm on a course, round waves over changed land, a ship's wake, noise of 4 m over all the
/// sea, a successor that takes over, a swell.
WorldState live_world();

/// A round island at x = z = 0, 8 m contour at `radius` (m), on a 16 km square of 32 m cells.
std::shared_ptr<const TerrainGrid> island(double radius);

/// Looks towards `heading` (radians from north to east) and `pitch` above the horizon.
ViewState looking(LatticePoint at, double altitude, double heading, double pitch);
/// A key around the view with the default slack and a span of 120 s from sea time 1000 s.
CullKey key_around(const ViewState& view);

/// The view moved by up to the key's slack and turned by up to its tangent, about random axes.
ViewState within_slack(const CullKey& key, Dice& dice);

/// The state's boxes (only the trains told of one patch, or all) with the state's blocks, as a client joins them.
Sea sea_of(const InterestState& state);

}  // namespace trochoid
