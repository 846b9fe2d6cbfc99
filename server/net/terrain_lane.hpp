#pragma once
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "protocol/model/terrain.hpp"

namespace trochoid {

/// Which tiles a client has been sent and which it waits for; lowest priority, no queue of bytes.
class TerrainLane {
public:
    /// Replaces what the client waits for, most needed first; what it has been sent is left out.
    void want(const std::vector<TerrainTileKey>& keys) {
        wanted_.clear();
        for (const TerrainTileKey& key : keys)
            if (!sent_.contains(place(key))) wanted_.push_back(key);
        next_ = 0;
    }
    bool idle() const { return next_ == wanted_.size(); }
    std::optional<TerrainTileKey> take() {
        if (idle()) return std::nullopt;
        const TerrainTileKey key = wanted_[next_++];
        sent_.insert(place(key));
        return key;
    }
    size_t sent() const { return sent_.size(); }

private:
    using Place = std::tuple<uint8_t, int32_t, int32_t>;
    static Place place(const TerrainTileKey& key) { return {key.level, key.x, key.z}; }

    std::vector<TerrainTileKey> wanted_;
    size_t next_ = 0;
    std::set<Place> sent_;
};

}  // namespace trochoid
