#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "server/net/sea_provider.hpp"

namespace trochoid {

/// Results of one session: what was written last, what the client has acknowledged, and how much may be on its way. It
/// keeps no queue of results: one is begun only when it can go out, from the last one written to now. No socket here.
class StateLane {
public:
    enum class Acknowledged {
        in_step,       ///< the client holds what we wrote
        out_of_step,   ///< another hash: begin again from nothing
        superseded,    ///< from before the last resync, or known already: only credit
        never_written  ///< a result that was not written yet: the peer's mistake
    };

    /// Unacknowledged bytes and results beyond which nothing is begun.
    static constexpr uint64_t window_bytes = 64 * 1024;
    static constexpr size_t window_results = 32;
    /// Bytes of other lanes after which an empty result asks for an ack, so that terrain never fills the window.
    static constexpr uint64_t marker_bytes = 24 * 1024;

    StateLane();

    /// As the session's protocol version has them: lists in version 2, planes after. Before anything is begun.
    void set_patch_form(PatchForm form) { patch_form_ = form; }
    /// Key of the last result begun; nullptr: the client holds nothing.
    const CullKey* key() const { return has_key_ ? &key_ : nullptr; }
    const std::shared_ptr<const InterestState>& base() const { return base_; }
    uint32_t result() const { return result_; }

    /// True while pieces of a begun result wait to be written.
    bool writing() const { return next_piece_ < pieces_.size(); }
    /// Begins a result: `change` leads from base() to made.state, patches in order of priority.
    void begin(MadeResult made, const InterestDelta& change, size_t most_piece_bytes);
    /// What the client holds from an earlier session counts as result 1, acknowledged. Before anything is begun.
    void resume(MadeResult held);
    /// Number of the result that base() is and that the client has been sent whole; 0: none, one is being written or base() was forgotten.
    uint32_t held() const { return writing() || forget_after_result_ ? 0 : base_result_; }
    /// An empty result under the last key: its ack tells that what was written before has been read.
    void begin_marker(SeaTime watermark);
    /// The next piece, to be written now; `wrote` follows.
    Delta take_piece();
    /// Counts bytes handed to the socket, of a piece or of terrain; `closes_result` with a result's last piece.
    void wrote(size_t bytes, bool closes_result, int64_t now_us);

    bool has_credit() const;
    /// Enough was written on other lanes since the last result to ask for an ack.
    bool marker_due() const;
    uint64_t unacknowledged_bytes() const { return written_bytes_ - acknowledged_bytes_; }
    Acknowledged acknowledge(const Ack& ack, int64_t now_us);
    /// Forgets what the client holds: the next result is a snapshot. A result that is being written is still written whole,
    /// as results come without gaps.
    void resync();

    /// Smoothed, from a result's last byte to its ack; 0: none yet.
    int64_t round_trip_us() const { return round_trip_us_; }

private:
    void forget();

    struct Outstanding {
        uint32_t result = 0;
        uint64_t state_hash = 0;
        uint64_t bytes_until = 0;  // written_bytes_ after its last piece
        uint32_t patches = 0;
        int64_t written_at_us = 0;
    };

    PatchForm patch_form_ = PatchForm::lists;
    uint32_t result_ = 0;       // number of the last result begun
    uint32_t base_result_ = 0;  // number that the next delta names as its base; 0: nothing
    std::shared_ptr<const InterestState> base_;
    uint64_t base_hash_ = 0;
    uint64_t result_hash_ = 0;  // of the last result begun, also after a resync
    bool has_key_ = false;
    CullKey key_;

    std::vector<Delta> pieces_;
    size_t next_piece_ = 0;
    uint32_t patches_begun_ = 0;
    bool forget_after_result_ = false;

    std::deque<Outstanding> outstanding_;
    uint32_t acknowledged_ = 0;  // highest result acknowledged
    uint32_t resync_from_ = 1;   // acks of earlier results say nothing about what the client holds now
    uint64_t written_bytes_ = 0;
    uint64_t acknowledged_bytes_ = 0;
    uint64_t bytes_at_result_ = 0;  // written_bytes_ when the last result closed
    uint32_t patches_per_second_ = 0;
    int64_t round_trip_us_ = 0;
};

}  // namespace trochoid
