#include "server/net/state_lane.hpp"

#include <algorithm>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

StateLane::StateLane() : base_(std::make_shared<const InterestState>()), base_hash_(hash_of(*base_)) {}

void StateLane::begin(MadeResult made, const InterestDelta& change, size_t most_piece_bytes) {
    TROCHOID_ASSERT(!writing(), "result {} begun while {} is being written", result_ + 1, result_);
    Delta header;
    header.result = ++result_;
    header.base = base_result_;
    header.base_hash = base_hash_;
    header.state_hash = made.state == base_ ? base_hash_ : hash_of(*made.state);
    header.key = made.key;
    header.watermark = made.watermark;
    header.patch_form = patch_form_;
    patches_begun_ = static_cast<uint32_t>(change.patches.size());
    pieces_ = split(header, change, most_piece_bytes);
    next_piece_ = 0;
    TROCHOID_ASSERT(!pieces_.empty() && pieces_.back().last, "result {} was split in {} pieces", result_,
                    pieces_.size());

    base_ = std::move(made.state);
    base_hash_ = result_hash_ = header.state_hash;
    base_result_ = result_;
    key_ = std::move(made.key);
    has_key_ = true;
}

void StateLane::resume(MadeResult held) {
    TROCHOID_ASSERT(result_ == 0, "a session resumes after result {}", result_);
    result_ = base_result_ = acknowledged_ = 1;
    base_ = std::move(held.state);
    base_hash_ = result_hash_ = hash_of(*base_);
    key_ = std::move(held.key);
    has_key_ = true;
}

void StateLane::begin_marker(SeaTime watermark) {
    TROCHOID_ASSERT(has_key_, "a marker before the first result");
    begin({key_, base_, watermark, 0}, {}, window_bytes);
}

Delta StateLane::take_piece() {
    TROCHOID_ASSERT(writing(), "no piece of result {} left", result_);
    Delta piece = std::move(pieces_[next_piece_++]);
    if (!writing()) {
        pieces_ = {};
        next_piece_ = 0;
        if (forget_after_result_) forget();
    }
    return piece;
}

void StateLane::wrote(size_t bytes, bool closes_result, int64_t now_us) {
    written_bytes_ += bytes;
    if (!closes_result) return;
    bytes_at_result_ = written_bytes_;
    // One that a resync cut short of its meaning is passed by without an ack: it must not hold up the snapshot either.
    if (result_ < resync_from_) {
        acknowledged_bytes_ = written_bytes_;
        return;
    }
    outstanding_.push_back({result_, result_hash_, written_bytes_, patches_begun_, now_us});
}

bool StateLane::has_credit() const {
    if (unacknowledged_bytes() >= window_bytes || outstanding_.size() >= window_results) return false;
    if (patches_per_second_ == 0) return true;
    // A client that says how fast it takes patches is not sent more than about a second's worth ahead.
    uint64_t patches = 0;
    for (const Outstanding& o : outstanding_) patches += o.patches;
    return patches <= std::max<uint64_t>(patches_per_second_, 64);
}

bool StateLane::marker_due() const { return has_key_ && written_bytes_ - bytes_at_result_ >= marker_bytes; }

StateLane::Acknowledged StateLane::acknowledge(const Ack& ack, int64_t now_us) {
    // A client may notice by the first piece that a result does not fit what it holds: that is no ack of the whole.
    const bool objection = writing() && ack.result == result_ && ack.state_hash != result_hash_;
    if (objection) return Acknowledged::out_of_step;
    const uint32_t closed = writing() ? result_ - 1 : result_;
    if (ack.result > closed) return Acknowledged::never_written;
    patches_per_second_ = ack.patches_per_second;
    if (ack.result <= acknowledged_) return Acknowledged::superseded;
    acknowledged_ = ack.result;

    while (!outstanding_.empty() && outstanding_.front().result < ack.result) outstanding_.pop_front();
    if (outstanding_.empty() || outstanding_.front().result != ack.result) return Acknowledged::superseded;
    const Outstanding mark = outstanding_.front();
    outstanding_.pop_front();
    acknowledged_bytes_ = std::max(acknowledged_bytes_, mark.bytes_until);
    const int64_t sample = std::max<int64_t>(now_us - mark.written_at_us, 1);
    round_trip_us_ = round_trip_us_ == 0 ? sample : round_trip_us_ + (sample - round_trip_us_) / 8;

    if (ack.result < resync_from_) return Acknowledged::superseded;
    return ack.state_hash == mark.state_hash ? Acknowledged::in_step : Acknowledged::out_of_step;
}

void StateLane::resync() {
    resync_from_ = result_ + 1;
    // A client out of step passes over what is on its way without an ack: that must not hold up the snapshot.
    outstanding_.clear();
    acknowledged_bytes_ = written_bytes_;
    forget_after_result_ = writing();
    if (!writing()) forget();
}

void StateLane::forget() {
    base_ = std::make_shared<const InterestState>();
    base_hash_ = hash_of(*base_);
    base_result_ = 0;
    has_key_ = false;
    forget_after_result_ = false;
}

}  // namespace trochoid
