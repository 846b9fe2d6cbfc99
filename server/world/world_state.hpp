#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_ray.hpp"

namespace trochoid {

struct LandMemory;

/// What a land block costs with its slot, its place in an index and its share of what traces remember, bytes: 2.8 KB were measured over
/// the Isles of Scilly.
inline constexpr size_t land_block_bytes = 2816;
/// Land blocks that the fields of a world's boxes may have in all where nobody says otherwise: 4 GiB.
inline constexpr size_t usual_land_blocks = (size_t{4} << 30) / land_block_bytes;

/// A box as the server holds it.
struct WorldBox {
    std::shared_ptr<const PreparedBox>
        sea;  ///< record (with field ids and gain_max filled in), constants, fields
    std::string name;
    StartWind wind;
    std::vector<WaveRay> rays;                      ///< traced along u for debug views, at most 128
    std::shared_ptr<const LandMemory> land_memory;  ///< for tracing it again; no part of the state's value
    double land_growth = 1.0;  ///< how much steeper land makes it at most, for the steepness guard
    BoxId predecessor;         ///< the box whose place this one took when the land changed; none (0)
    BoxId successor;           ///< the box that took this one's place then; none (0)
};

/// The world after some prefix of the log: an immutable value that a tick, a cull or a query reads without locks.
struct WorldState {
    std::string name;
    LogPosition log_position;
    uint64_t log_hash = 0;
    SeaClock clock;
    std::shared_ptr<const TerrainGrid> terrain;  ///< nullptr: open sea of unlimited depth
    std::map<BoxId, std::shared_ptr<const WorldBox>> boxes;
    uint32_t next_box = 1;
    uint32_t next_train = 1;
    uint32_t next_field = 1;
    Sea sea;  ///< over all boxes
    /// How much land the boxes may hold, in blocks. Not part of the state's value, but all that follow one log need the same.
    size_t most_land_blocks = usual_land_blocks;
};

}  // namespace trochoid
