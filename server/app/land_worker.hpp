#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "protocol/model/terrain.hpp"
#include "server/land/land_cache.hpp"
#include "server/net/io_loop.hpp"

namespace trochoid {

/// Traces the land of new boxes on a thread of its own, so that the io thread goes on meanwhile. Destruction waits for the
/// trace in progress and drops the others.
class LandWorker {
public:
    /// Without terrain every trace is open water at once.
    LandWorker(IoLoop& loop, std::shared_ptr<const TerrainGrid> terrain, const LandSettings& settings);
    LandWorker(const LandWorker&) = delete;
    LandWorker& operator=(const LandWorker&) = delete;
    ~LandWorker();

    /// Calls back on the io thread, in order of asking.
    void trace(WaveTrainBox box, FieldId first_field, std::function<void(TracedLand)> done);
    /// For the time before the loop runs.
    TracedLand trace_and_wait(const WaveTrainBox& box, FieldId first_field);
    /// Names all that a trace of the box depends on; equal keys, equal land.
    uint64_t key_of(const WaveTrainBox& box) const;

private:
    void work();
    TracedLand trace_now(const WaveTrainBox& box, FieldId first_field);

    IoLoop& loop_;
    std::shared_ptr<const TerrainGrid> terrain_;
    uint64_t terrain_hash_ = 0;
    LandSettings settings_;
    LandCache cache_;  // the worker's thread only

    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::function<void()>> jobs_;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace trochoid
