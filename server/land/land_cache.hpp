#pragma once
#include <cstddef>
#include <cstdint>
#include <list>

#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/land_settings.hpp"
#include "server/world/traced_land.hpp"

namespace trochoid {

/// Names all that a trace depends on: the box's geometry and where it lies at its beginning, its trains' wave vectors and amplitudes,
/// the terrain (its terrain_hash) and the settings but for the threads. Times, phases, choppiness and ids do not matter: what the log
/// carries is enough.
uint64_t land_key(const WaveTrainBox& box, uint64_t terrain_hash, const LandSettings& settings);

/// Remembers the latest traces of a process over one terrain, so that a scene that starts again or a box that comes back is not traced
/// anew. What was traced over another terrain is forgotten: it does not come back. One owner, one thread.
class LandCache {
public:
    /// At most so many traces, with at most so many land blocks (2.3 KiB each) in all but the latest.
    explicit LandCache(size_t capacity = 16, size_t most_blocks = size_t{1} << 16)
        : capacity_(capacity), most_blocks_(most_blocks) {}
    LandCache(const LandCache&) = delete;
    LandCache& operator=(const LandCache&) = delete;

    /// Like trace_land. terrain_hash must be the terrain's.
    TracedLand trace(const WaveTrainBox& box, const TerrainGrid& terrain, uint64_t terrain_hash,
                     FieldId first_field, const LandSettings& settings);
    uint64_t hits() const { return hits_; }
    uint64_t misses() const { return misses_; }

private:
    struct Entry {
        uint64_t key;
        TracedLand land;
        size_t blocks;
    };
    size_t capacity_;
    size_t most_blocks_;
    size_t blocks_ = 0;
    uint64_t terrain_hash_ = 0;
    /// Latest use first.
    std::list<Entry> entries_;
    uint64_t hits_ = 0;
    uint64_t misses_ = 0;
};

}  // namespace trochoid
