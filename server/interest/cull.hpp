#pragma once
#include "server/interest/wave_train_filter.hpp"

namespace trochoid {

/// What a cull left out and why; nothing is dropped silently.
struct CullReport {
    SelectionCounts selection;
    uint32_t delivered = 0;      ///< patches in the state
    uint32_t over_limit = 0;     ///< patches in view beyond the key's limit, lowest priority
    uint32_t trains_kept = 0;    ///< summed over delivered patches
    LeftOut left_out;            ///< weightless everywhere on their patch
    uint32_t boxes_alive = 0;    ///< over the key's span
    uint32_t blocks = 0;         ///< land blocks in the state
    double visibility = 0.0;     ///< m along the sea to which water is shown
    float largest_error = 0.0F;  ///< largest H of any patch, m
    bool operator==(const CullReport&) const = default;
};

struct CullResult {
    InterestState state;
    CullReport report;
};

/// Rest points that a query inside a sync region may visit lie within four Newton steps of 64 m along each axis.
inline constexpr int64_t sync_margin = int64_t{4} * 64 * lattice_per_metre;

/// What a client gets (wire: "Cull key", "Interest"; rows A10, B6): a pure function of index and key, the same
/// bits on every machine. Sync regions hold every box that touches them, over its whole life, with all its land
/// blocks there, so that any query in them at a time after key.from - sync_history_us gives the world's bits.
CullResult cull(const InterestIndex& index, const CullKey& key);
/// Makes an index for this one cull.
CullResult cull(const WorldState& world, const CullKey& key);

}  // namespace trochoid
