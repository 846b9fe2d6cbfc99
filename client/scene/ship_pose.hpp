#pragma once
#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <vector>

#include "client/scene/camera.hpp"
#include "client/scene/scene_input.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/model/simd/workers.hpp"

namespace trochoid {

/// A ship as her box tells her (ship_place).
struct Ship {
    BoxId box;
    LatticePoint place;        ///< amidships
    glm::dvec2 heading{1, 0};  ///< unit vector (east, south)
    double speed = 0;          ///< m/s; 0 where she lies still
    double length = 0;         ///< m
    double beam = 0;           ///< m
    bool operator==(const Ship&) const = default;
};

/// A hull's size, metres.
struct HullSize {
    double length = 0;
    double beam = 0;
    bool operator==(const HullSize&) const = default;
};

/// The hull that makes such waves, for boxes without a hull (of a server that does not tell it): the server's law of ship waves turned round. Above Froude number 1/2 the transverse waves tell the
/// number, hence the length. Below, the law's waves follow from speed and slimness alone: the length is that of a usual ship of
/// this speed, in steps, so that few changes of speed change it. The beam follows from the diverging waves, a tenth to a third of the length.
HullSize hull_size(const ShipWake& wake);

/// The ships at a sea time, by ascending box: a box's ship is there from its `begin` until before its `end`, so of a steered ship's boxes
/// the newest counts. One that has stopped lies still, as a box with a hull and no wake. Where the box of the course before is known the heading
/// eases over from it.
std::vector<Ship> ships_of(const InterestState& state, SeaTime now);

/// How a hull lies on the water.
struct ShipPose {
    double heave = 0;  ///< of the waterline amidships above still water, m
    double pitch = 0;  ///< slope of the keel, positive where the bow is up
    double roll = 0;   ///< slope across, positive where the starboard side (right) is up
    bool operator==(const ShipPose&) const = default;
};

/// Mean height of the water within the hull's waterline and the plane that fits it best: waves that are short against the hull
/// average out. A function of the sea alone: nothing swings on, and each viewer sees the same.
ShipPose pose_of(const Ship& ship, const SeaInstant& water, Workers& workers);

struct FloatingShip {
    Ship ship;
    ShipPose pose;
    bool operator==(const FloatingShip&) const = default;
};

/// Floats the ships that are seen on the authoritative sea: the input's own, or one that is prepared here once for each state.
class ShipWaters {
public:
    /// Ships that take up half a pixel at least, the nearest `most_ships` of them. Their own waves leave them alone.
    std::vector<FloatingShip> ships(const SceneInput& input, const Camera& camera);

    static constexpr size_t most_ships = 48;

private:
    const Sea& sea_of(const SceneInput& input);

    std::shared_ptr<const InterestState> state_;  // of which any_ship_ speaks
    bool any_ship_ = false;
    std::shared_ptr<const InterestState> prepared_of_;
    Sea prepared_;
    Workers one_core_{1};
};

}  // namespace trochoid
