#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
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
    uint64_t terrain_hash = 0;
    std::shared_ptr<const TerrainChoice> choice;
    IndexedLand indexed;  ///< terrain and fields, for culls
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
    /// Edits the terrain and traces these boxes again; `index` is the one of `world`. Calls back on the io thread, in order of asking.
    void change(std::shared_ptr<const WorldState> world, ChangeLand change, std::vector<BoxId> boxes,
                std::shared_ptr<const TerrainChoice> choice, std::shared_ptr<const InterestIndex> index,
                std::function<void(Result<ChangedLand>)> done);
    Result<ChangedLand> change_and_wait(std::shared_ptr<const WorldState> world, const ChangeLand& change,
                                        std::vector<BoxId> boxes,
                                        std::shared_ptr<const TerrainChoice> choice);
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
    Result<ChangedLand> change_now(const WorldState& world, const ChangeLand& change,
                                   std::span<const BoxId> boxes, const TerrainChoice& choice,
                                   const InterestIndex* index) const;

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
