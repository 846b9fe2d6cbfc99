#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "server/app/land_change.hpp"
#include "server/app/terrain_choice.hpp"
#include "server/interest/interest_index.hpp"
#include "server/land/land_cache.hpp"
#include "server/net/io_loop.hpp"

namespace trochoid {

/// All that follows from a change of the land: what is published together.
struct ChangedLand {
    LandOutcome outcome;
    /// One a change: the error of one that cannot be after those before it. It stands only if they all come to be.
    std::vector<std::optional<Error>> refused;
    uint64_t terrain_hash = 0;
    std::shared_ptr<const TerrainChoice> choice;
    IndexedLand indexed;  ///< terrain and fields, for culls
};

/// Changes of the land to be traced together, as if they were one.
struct LandTask {
    std::shared_ptr<const WorldState> world;
    std::vector<ChangeLand> changes;
    std::vector<BoxId> boxes;
    std::shared_ptr<const TerrainChoice> choice;
    std::shared_ptr<const InterestIndex> index;  ///< of `world`; may be null
    size_t most_blocks = std::numeric_limits<size_t>::max();
    /// What the very same changes came to on an earlier state of the world; null: nothing is known.
    std::shared_ptr<const ChangedLand> earlier{};
};

struct LandAnswer {
    /// One a change, where all are refused: `changed` is null then, and there is no `error`.
    std::vector<std::optional<Error>> refused;
    std::shared_ptr<const ChangedLand> changed;  ///< null where all are refused, or where there is an `error`
    std::optional<Error> error;                  ///< too_much_land
};

/// Traces the land of new boxes, and of all that a change of the land can reach, and indexes it for culls, on a thread of its own, so
/// that the io thread goes on meanwhile. Destruction waits for the trace in progress and drops the others.
class LandWorker {
public:
    /// Without terrain every trace is open water at once.
    LandWorker(IoLoop& loop, std::shared_ptr<const TerrainGrid> terrain, const LandSettings& settings);
    LandWorker(const LandWorker&) = delete;
    LandWorker& operator=(const LandWorker&) = delete;
    ~LandWorker();

    /// Calls back on the io thread, in order of asking.
    void trace(WaveTrainBox box, FieldId first_field, std::function<void(TracedLand, IndexedLand)> done);
    /// For the time before the loop runs.
    TracedLand trace_and_wait(const WaveTrainBox& box, FieldId first_field);
    /// Edits the terrain and traces the boxes again. Calls back on the io thread, in order of asking.
    void change(LandTask task, std::function<void(LandAnswer)> done);
    LandAnswer change_and_wait(LandTask task);
    /// Whether the outcome is still that of these boxes of the world.
    bool still_holds(const LandOutcome& outcome, const WorldState& world, std::span<const BoxId> boxes) const;
    /// The trace of a box that no land acts on, which takes no time: without terrain, without trains, or beside the terrain. Else none.
    std::optional<TracedLand> open_water(const WaveTrainBox& box, FieldId first_field) const;
    /// The terrain that traces asked for from now on are over.
    void take_terrain(std::shared_ptr<const TerrainGrid> terrain, uint64_t terrain_hash);
    /// Names all that a trace of the box depends on; equal keys, equal land.
    uint64_t key_of(const WaveTrainBox& box) const;

private:
    struct Ground {
        std::shared_ptr<const TerrainGrid> terrain;
        uint64_t hash = 0;
    };
    void work();
    void ask(std::function<void()> job);
    TracedLand trace_now(const WaveTrainBox& box, FieldId first_field, const Ground& ground);
    LandAnswer change_now(const LandTask& task) const;
    std::shared_ptr<ChangedLand> ground_of(const LandTask& task, LandAnswer& answer) const;
    static void index_fields(const LandTask& task, ChangedLand& changed);

    IoLoop& loop_;
    Ground ground_;  // the io thread's
    LandSettings settings_;
    LandCache cache_;  // the worker's thread only

    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::function<void()>> jobs_;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace trochoid
