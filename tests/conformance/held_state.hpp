#pragma once
#include <optional>

#include "protocol/codec/messages.hpp"
#include "tests/conformance/verdict.hpp"

namespace trochoid::conformance {

/// What a client holds, applied from a server's deltas, every rule of chapter 8 checked on the way (Failed with its number).
class HeldState {
public:
    /// Applies a piece. True with the last one of a result.
    bool take(const Delta& piece);
    /// The server has taken what we still held from an earlier session: it counts as result 1.
    void adopt(const InterestState& state);
    /// What has been sent counts as nothing from here on: the next result has to be a snapshot.
    void expect_snapshot() { snapshot_due_ = true; }
    /// A resync was asked for: results on the old base may still come before the snapshot.
    void await_snapshot() { snapshot_awaited_ = true; }

    const InterestState& state() const { return state_; }
    uint64_t hash() const { return hash_; }
    uint32_t result() const { return result_; }
    /// No result has begun that has not come whole: the state is that of the last one.
    bool between_results() const { return whole_; }
    /// The last piece of the last whole result.
    const std::optional<Delta>& last() const { return last_; }
    /// Pieces and snapshots so far, and whether the last whole result was one.
    uint32_t pieces() const { return pieces_; }
    uint32_t snapshots() const { return snapshots_; }
    bool last_was_snapshot() const { return base_ == 0; }

private:
    void take_turn(const Delta& piece);
    void take_base(const Delta& piece);
    void check_change(const Delta& piece) const;
    void finish(const Delta& piece);

    InterestState state_;
    uint64_t hash_ = 0;
    uint32_t result_ = 0;  // whole ones
    bool whole_ = true;
    uint32_t begun_ = 0;
    uint16_t next_piece_ = 0;
    uint32_t base_ = 0;
    uint64_t base_hash_ = 0;
    CullKey key_;
    bool snapshot_due_ = true;
    bool snapshot_awaited_ = false;
    bool passing_by_ = false;
    uint32_t pieces_ = 0;
    uint32_t snapshots_ = 0;
    std::optional<Delta> last_;
};

/// What has to hold of every whole state, whatever it was culled for: patches apart from each other, their boxes and trains known, bounds
/// finite, blocks of fields that some box reads. Failed with the number of the requirement.
void check_state(const InterestState& state, const CullKey& key);

}  // namespace trochoid::conformance
