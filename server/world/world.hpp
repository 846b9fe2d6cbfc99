#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/event/scene.hpp"
#include "server/world/land_room.hpp"
#include "server/world/steepness.hpp"
#include "server/world/traced_land.hpp"
#include "server/world/wind_box.hpp"
#include "server/world/world_state.hpp"

namespace trochoid {

/// A box that was traced again over changed land, with what it is traced to now.
struct Retraced {
    BoxId box;
    TracedLand land;
};

/// What each node derives from an event by itself.
struct Derived {
    /// Of the event's box, or of the boxes that go on after a change of the land, in their order.
    std::vector<TracedLand> lands;
    /// The changed terrain, where the caller has it already; made by `apply` otherwise.
    std::shared_ptr<const TerrainGrid> terrain;
    /// Boxes whose fields the change leaves as they are: their rays, and what the next change is traced from.
    std::vector<Retraced> untouched{};
};

/// What a new course means for the log.
struct Steering {
    /// In this order, to be applied together: readers see all or none of them.
    std::vector<decltype(LogEvent::what)> events;
    SeaTime effective;
    BoxId box;  ///< the one that moves on: a ship's new course is a new box
};

/// Sea time in which a box cross-fades to the one that takes its place when the land changes, microseconds.
inline constexpr int64_t land_fade_us = 10 * microseconds_per_second;
/// Most overlays of one box: where another change might make more, its land is traced whole again.
inline constexpr size_t most_overlays = 256;

/// The authoritative world: folds the event log into states and plans the events that commands ask for.
///
/// A command goes plan → trace the box's land → fit_to_land → append to the log → apply. Planning changes nothing. A planned event fits
/// only the state that it was planned on: after a conflict in the log plan again. Both run on the one strand that owns
/// the world; the states handed out are immutable and may be read from anywhere.
class World {
public:
    /// The world at log position 0. Terrain may be null: open sea of unlimited depth. `most_land_blocks`: WorldState's; the same
    /// on all that follow one log.
    World(std::string name, std::shared_ptr<const TerrainGrid> terrain, SeaClock clock,
          size_t most_land_blocks = usual_land_blocks);
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    std::shared_ptr<const WorldState> state() const { return state_; }

    /// The sea time at which plans are made. What falls still only later makes no room for a new box, however late that begins.
    void set_present(SeaTime present) { present_ = present; }
    SeaTime present() const { return present_; }

    /// The box of a wind that starts to blow at `begin` (rows A2, A4), its choppiness scaled for the boxes around.
    /// An empty name becomes "wind N"; seed 0 one drawn from the box's id and time. Errors: value_out_of_range,
    /// too_many_trains, too_many_boxes.
    Result<BoxStarted> plan(const StartWind& wind, SeaTime begin, std::string name = {}) const;
    /// A scene's wind with its track. Besides: too_many_legs.
    Result<BoxStarted> plan(const SceneWind& wind) const;
    /// The same for a hand-written box (row A1).
    Result<BoxStarted> plan(const SceneBox& box) const;
    /// The box of a ship's first course (rows A12, B11), which begins on water. An empty name becomes "ship N"; one that a ship under
    /// way has is refused. Errors: value_out_of_range, too_many_boxes.
    Result<BoxStarted> plan(const StartShip& ship, SeaTime begin) const;
    /// A planned box after its land is known: lowers the choppiness where the land steepens waves by more than
    /// expected_land_growth. Between tracing and appending.
    BoxStarted fit_to_land(BoxStarted planned, const TracedLand& land) const;
    /// The end of a wind: its decay starts at `effective`, or at its beginning where that is still to come (then the wind never
    /// blows). A ship is taken out. Errors: unknown_box; already_ending where its decay starts by then anyway.
    Result<BoxEnding> plan(const StopWind& stop, SeaTime effective) const;
    /// A moving wind's new leg, or a ship's new course from where it is then (a box that begins, or a ship that sets out, only later
    /// takes it at its beginning). At speed 0 a ship lies still from then on, as a box of its own. Errors: unknown_box, already_ending, not_moving,
    /// too_many_legs, too_many_boxes, value_out_of_range.
    Result<Steering> plan(const Steer& steer, SeaTime effective) const;
    /// A new rate from a moment of the server's monotonic clock on; sea time is continuous there. To be applied when that
    /// moment has come. Errors: value_out_of_range.
    Result<ClockChanged> plan(const SetRate& rate, int64_t monotonic_us) const;
    /// Sea time goes on later, at the same rate. value_out_of_range beyond longest_skip_us and the end of time.
    Result<ClockChanged> plan(const SkipTime& skip, int64_t monotonic_us) const;

    /// When the land may change next: while boxes still cross-fade from the last change it may not.
    SeaTime land_settled() const;
    /// The boxes to trace again when the land changes at `effective`: those with trains whose decay has not begun by the end of the
    /// cross-fade.
    std::vector<BoxId> on_land_at(SeaTime effective) const;
    /// The land's change, with `also` after it, and the successors of the boxes that it touches, ascending. `effective` from
    /// land_settled() on. Errors: no_terrain, too_many_boxes, too_much_land, value_out_of_range (edited() has said already
    /// that something changes).
    Result<LandChanged> plan(const ChangeLand& change, SeaTime effective, std::span<const Retraced> touched,
                             std::vector<ChangeLand> also = {}) const;
    /// How much land may still come at `effective`: what boxes that have fallen still hold can be let go.
    LandRoom room_for_land(SeaTime effective) const;

    /// Takes in the event that the log holds next; `bytes` are the log's own, `land` what the event's box was traced to. The
    /// new state is a pure function of the old one, the event and its bytes. An event that does not fit the state is our
    /// bug.
    ///
    /// A box whose decay is over stays (the past may be asked for) until the list is full; then each new box takes the
    /// place of the one that fell still first, if it did before the new one begins.
    std::shared_ptr<const WorldState> apply(const LogEvent& event, std::span<const uint8_t> bytes,
                                            TracedLand land = {});
    std::shared_ptr<const WorldState> apply(const LogEvent& event, std::span<const uint8_t> bytes,
                                            Derived derived);

private:
    Result<Done> has_room(SeaTime begin, size_t boxes = 1) const;
    Result<std::shared_ptr<const WorldBox>> going_on(BoxId box, SeaTime effective) const;
    Result<BoxStarted> plan_course(const StartShip& ship, SeaTime begin) const;
    Result<BoxStarted> plan_lying(const WorldBox& ship, SeaTime effective) const;
    Result<Steering> steer_ship(const WorldBox& ship, const Steer& steer, SeaTime effective) const;
    SteepCrowd crowd(std::span<const SteepBox> boxes) const;
    SteepCrowd crowd_over(std::span<const Retraced> touched) const;
    Result<BoxStarted> admit(WaveTrainBox box, std::string name, const StartWind& wind) const;
    NewIds new_ids() const { return {{state_->next_box}, {state_->next_train}}; }

    std::shared_ptr<const WorldState> state_;
    SeaTime present_ = end_of_time;
};

/// World::on_land_at of a state.
std::vector<BoxId> boxes_on_land(const WorldState& state, SeaTime effective);

/// One line a box, by ascending id, as of a sea time.
std::vector<BoxSummary> summaries(const WorldState& state, SeaTime now);

/// Hash over all of a state: log position and hash, clock, terrain, next ids, every box's record, name, wind, rays and blocks of
/// land. Equal logs give equal hashes on every machine.
uint64_t hash_of(const WorldState& state);

}  // namespace trochoid
