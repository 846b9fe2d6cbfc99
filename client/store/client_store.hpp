#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "client/store/store_limits.hpp"
#include "protocol/codec/messages.hpp"
#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid {

/// Order of terrain tiles in a snapshot: coarse before fine.
struct TerrainTileOrder {
    bool operator()(const TerrainTileKey& a, const TerrainTileKey& b) const {
        if (a.level != b.level) return a.level > b.level;
        return a.z != b.z ? a.z < b.z : a.x < b.x;
    }
};
using TerrainTileMap = std::map<TerrainTileKey, std::shared_ptr<const TerrainTile>, TerrainTileOrder>;

/// What the client knows after some result: immutable, shared between threads by pointer. Parts that did not change from
/// one snapshot to the next keep their pointer. No pointer is null.
struct StoreSnapshot {
    uint32_t result = 0;  ///< number of the result applied last in this session, 0 = none yet
    /// Boxes, land blocks and patches as told.
    std::shared_ptr<const InterestState> interest = std::make_shared<InterestState>();
    Sea sea;                          ///< the same boxes, prepared for evaluation
    std::vector<SyncRegion> regions;  ///< discs in which `sea` is the whole authoritative sea
    TerrainInfo terrain;
    std::shared_ptr<const TerrainTileMap> tiles = std::make_shared<TerrainTileMap>();
    CullKey key;  ///< what the result was culled for
    LogPosition log_position;
    SeaTime watermark{-sea_time_bound};  ///< samples up to here are confirmed, beyond expected
};

/// Counters that an overlay shows; nothing is dropped silently.
struct StoreCounters {
    uint64_t results = 0;
    uint64_t pieces = 0;
    uint64_t passed_by = 0;  ///< pieces not applied because a resync had been asked for
    uint64_t resyncs = 0;    ///< results that did not fit or hashed differently: asked again from nothing
    uint64_t tiles = 0;
    /// Boxes that came or changed with an event, from before the watermark in force on. Where an event makes patches finer, an older box that
    /// only now shows counts, too.
    uint64_t late_events = 0;
    uint64_t resumed = 0;  ///< sessions that went on with what an earlier one had left
    uint64_t probed = 0;   ///< points at which our sums were compared with the server's
    uint64_t desyncs = 0;  ///< differences found there: told, and begun anew from nothing
    bool operator==(const StoreCounters&) const = default;
};

/// Applies the server's messages. One thread owns it. After an error (the server broke the standard, or sends more than StoreLimits) the session has to
/// end; the last snapshot stays good.
class ClientStore {
public:
    explicit ClientStore(StoreLimits limits = {}) : limits_(limits) {}

    /// A new session. Everything is dropped when the world instance has changed, and kept (until the first snapshot
    /// replaces it) when it is the same. Where the hello says `resumed`, the last whole result counts as the session's first.
    void begin(const ServerHello& hello);
    /// What the next session may go on with: the last whole result. None where there is none that can be trusted. The log's part is left
    /// to the caller.
    std::optional<ResumeState> resume_state() const;
    /// Sums were compared at so many points.
    void probed(size_t points) { counters_.probed += points; }
    /// What is held is not what the server has sent: results pass by until the next snapshot.
    void distrust();
    const std::optional<ServerHello>& hello() const { return hello_; }

    /// Applies one piece. Gives the ack to send when a result is complete; an ack with hash 0 asks for a resync (the result
    /// did not build on what we hold, or hashed differently): until the next snapshot results pass by.
    Result<std::optional<Ack>> apply(const Delta& delta);
    Result<Done> apply(const TerrainTiles& message);
    /// The watermark of a clock reply, which holds for all events before `position`: here it only rises (a result of an earlier log position
    /// than what was held, from a node that lags, brings its own).
    void confirm(SeaTime watermark, LogPosition position);

    /// The newest snapshot; the same pointer until something changes.
    std::shared_ptr<const StoreSnapshot> snapshot() const { return snapshot_; }
    const StoreCounters& counters() const { return counters_; }

private:
    using Fields = std::map<FieldId, std::shared_ptr<const LandField>>;
    using PreparedBoxes = std::map<BoxId, std::shared_ptr<const PreparedBox>>;

    Result<Done> take_turn(const Delta& piece);
    bool builds_on_ours(const Delta& first_piece);
    std::optional<Ack> ask_resync(uint32_t result);
    Result<Done> within_limits(bool whole) const;
    Result<Done> finish_result(const Delta& last_piece);
    bool hulls_changed(const InterestState& before) const;
    PreparedBoxes prepare_boxes(const Fields& fields) const;
    void count_late_events(const CullKey& key);

    StoreLimits limits_;
    std::optional<ServerHello> hello_;
    InterestState state_;
    uint64_t state_hash_ = 0;  // of state_ after the last whole result
    bool whole_ = false;       // the snapshot's interest is a whole result of this instance, trusted so far
    uint64_t whole_hash_ = 0;  // its hash
    Fields fields_;
    PreparedBoxes prepared_;
    uint32_t applied_ = 0;  // last result applied whole, 0 = state_ is nothing a delta can build on
    // The result whose pieces come: its number, the next piece (0 = it is whole), what it builds on.
    uint32_t begun_ = 0;
    uint16_t next_piece_ = 0;
    uint32_t base_ = 0;
    enum class Course : uint8_t { apply, pass_by, ask_resync } course_ = Course::apply;
    bool resync_asked_ = false;
    // What it changes.
    std::set<BoxId> touched_boxes_;
    std::set<FieldId> touched_fields_;
    std::shared_ptr<const StoreSnapshot> snapshot_ = std::make_shared<StoreSnapshot>();
    StoreCounters counters_;
};

}  // namespace trochoid
