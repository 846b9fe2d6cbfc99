#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "protocol/model/terrain.hpp"

namespace trochoid {

/// Which tiles a client has been sent, at which revision, and which it waits for; lowest priority, no queue of bytes.
class TerrainLane {
public:
    /// Replaces what the client waits for, most needed first; what it has at its present revision is left out. Tiles that the client
    /// has but that have changed since follow, whether the view calls for them or not: it would go on showing them.
    /// `revision` gives a tile's present one.
    template <class Revision>
    void want(const std::vector<TerrainTileKey>& keys, Revision revision) {
        wanted_.clear();
        next_ = 0;
        std::map<Place, uint32_t> asked;
        const auto ask = [&](const TerrainTileKey& key, uint32_t now) {
            if (asked.emplace(place(key), now).second) wanted_.push_back({key, now});
        };
        for (const TerrainTileKey& key : keys) {
            const uint32_t now = revision(key);
            const auto had = sent_.find(place(key));
            if (had == sent_.end() || had->second != now) ask(key, now);
        }
        for (const auto& [where, had] : sent_) {
            const TerrainTileKey key{where.level, where.x, where.z};
            const uint32_t now = revision(key);
            if (had != now) ask(key, now);
        }
    }
    bool idle() const { return next_ == wanted_.size(); }
    std::optional<TerrainTileKey> take() {
        if (idle()) return std::nullopt;
        const Wanted& next = wanted_[next_++];
        sent_[place(next.key)] = next.revision;
        return next.key;
    }
    size_t sent() const { return sent_.size(); }

private:
    struct Place {
        uint8_t level = 0;
        int32_t x = 0;
        int32_t z = 0;
        auto operator<=>(const Place&) const = default;
    };
    struct Wanted {
        TerrainTileKey key;
        uint32_t revision = 0;
    };
    static Place place(const TerrainTileKey& key) { return {key.level, key.x, key.z}; }

    std::vector<Wanted> wanted_;
    size_t next_ = 0;
    std::map<Place, uint32_t> sent_;
};

}  // namespace trochoid
