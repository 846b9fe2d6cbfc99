#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/event/scene.hpp"
#include "server/world/traced_land.hpp"
#include "server/world/world_state.hpp"

namespace trochoid {

/// The authoritative world: folds the event log into states and plans the events that commands ask for.
///
/// A command goes plan → trace the box's land → fit_to_land → append to the log → apply. Planning changes nothing. A planned event fits
/// only the state that it was planned on: after a conflict in the log plan again. Both run on the one strand that owns
/// the world; the states handed out are immutable and may be read from anywhere.
class World {
public:
    /// The world at log position 0. Terrain may be null: open sea of unlimited depth.
    World(std::string name, std::shared_ptr<const TerrainGrid> terrain, SeaClock clock);
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    std::shared_ptr<const WorldState> state() const { return state_; }

    /// The box of a wind that starts to blow at `begin` (rows A2, A4), its choppiness scaled for the boxes around.
    /// An empty name becomes "wind N"; seed 0 one drawn from the box's id and time. Errors: value_out_of_range,
    /// too_many_trains, too_many_boxes.
    Result<BoxStarted> plan(const StartWind& wind, SeaTime begin, std::string name = {}) const;
    /// The same for a hand-written box (row A1).
    Result<BoxStarted> plan(const SceneBox& box) const;
    /// A planned box after its land is known: lowers the choppiness where the land steepens waves by more than
    /// expected_land_growth. Between tracing and appending.
    BoxStarted fit_to_land(BoxStarted planned, const TracedLand& land) const;
    /// The end of a wind: its decay starts at `effective`, or at its beginning where that is still to come (then the wind never
    /// blows). Errors: unknown_box; already_ending where its decay starts by then anyway.
    Result<BoxEnding> plan(const StopWind& stop, SeaTime effective) const;
    /// A new rate from a moment of the server's monotonic clock on; sea time is continuous there. To be applied when that
    /// moment has come. Errors: value_out_of_range.
    Result<ClockChanged> plan(const SetRate& rate, int64_t monotonic_us) const;

    /// Takes in the event that the log holds next; `bytes` are the log's own, `land` what the event's box was traced to. The
    /// new state is a pure function of the old one, the event and its bytes. An event that does not fit the state is our
    /// bug.
    ///
    /// A box whose decay is over stays (the past may be asked for) until the list is full; then each new box takes the
    /// place of the one that fell still first, if it did before the new one begins.
    std::shared_ptr<const WorldState> apply(const LogEvent& event, std::span<const uint8_t> bytes,
                                            TracedLand land = {});

private:
    Result<Done> has_room(SeaTime begin) const;
    BoxStarted admit(WaveTrainBox box, std::string name, StartWind wind) const;

    std::shared_ptr<const WorldState> state_;
};

/// One line a box, by ascending id, as of a sea time.
std::vector<BoxSummary> summaries(const WorldState& state, SeaTime now);

/// Hash over all that decides the sea of a state: log position and hash, clock, next ids, every box's record, name and
/// blocks of land. Equal logs give equal hashes on every machine.
uint64_t hash_of(const WorldState& state);

}  // namespace trochoid
