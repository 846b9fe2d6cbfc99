#include "tests/support/net/chaos_link.hpp"

#include <algorithm>
#include <utility>

#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

constexpr size_t segment_bytes = 1448;
// What travels as one where no rate and no window asks for segments.
constexpr size_t largest_piece = 16384;

}  // namespace

ChaosLink::ChaosLink(LinkFaults faults, uint64_t seed, int64_t back_us)
    : faults_(std::move(faults)), dice_(seed), back_us_(back_us), window_(faults_.first_window) {}

void ChaosLink::put(std::span<const uint8_t> bytes, int64_t now_us) {
    const bool in_segments = faults_.bytes_per_second != 0 || faults_.first_window != 0;
    const size_t most = in_segments ? segment_bytes : largest_piece;
    inside_ += bytes.size();
    while (!bytes.empty()) {
        const size_t size = std::min(most, bytes.size());
        std::vector<uint8_t> piece(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        for (const Flip& flip : faults_.flips)
            if (flip.at >= put_ && flip.at < put_ + size) piece[flip.at - put_] ^= flip.bits;
        put_ += size;
        waiting_.push_back(std::move(piece));
        bytes = bytes.subspan(size);
    }
    depart(now_us);
}

void ChaosLink::end(int64_t now_us) {
    ending_ = true;
    end_us_ = now_us + faults_.delay_us;
}

bool ChaosLink::may_depart(size_t bytes) const {
    return faults_.first_window == 0 || in_flight_ == 0 || in_flight_ + bytes <= window_;
}

void ChaosLink::depart(int64_t now_us) {
    int64_t moment = now_us;
    while (true) {
        while (!flights_.empty() && flights_.front().acknowledged_us <= now_us) {
            in_flight_ -= flights_.front().bytes;
            window_ += flights_.front().bytes;
            moment = std::max(moment, flights_.front().acknowledged_us);
            flights_.pop_front();
        }
        if (waiting_.empty() || free_us_ > now_us || !may_depart(waiting_.front().size())) return;
        Piece piece{std::move(waiting_.front()), 0, 0};
        waiting_.pop_front();
        if (faults_.bytes_per_second != 0)
            free_us_ = std::max(free_us_, moment) +
                       static_cast<int64_t>(piece.bytes.size() * 1'000'000 / faults_.bytes_per_second);
        else
            free_us_ = 0;
        const int64_t jitter = faults_.jitter_us == 0
                                   ? 0
                                   : static_cast<int64_t>((dice_ = splitmix64(dice_)) %
                                                          static_cast<uint64_t>(faults_.jitter_us + 1));
        arrives_us_ = std::max(arrives_us_, std::max(free_us_, moment) + faults_.delay_us + jitter);
        piece.arrives_us = arrives_us_;
        if (faults_.first_window != 0) {
            in_flight_ += piece.bytes.size();
            flights_.push_back({piece.bytes.size(), arrives_us_ + back_us_});
        }
        flying_.push_back(std::move(piece));
    }
}

// Bytes until something happens to the stream; never more than that are handed out as one.
size_t ChaosLink::until_event() const {
    uint64_t at = UINT64_MAX;
    if (faults_.cut) at = std::min(at, faults_.cut->at - std::min(faults_.cut->at, delivered_));
    if (faults_.stall && !stalled_ && faults_.stall->at >= delivered_)
        at = std::min(at, faults_.stall->at - delivered_);
    return static_cast<size_t>(std::min<uint64_t>(at, SIZE_MAX));
}

ChaosLink::Out ChaosLink::take(int64_t now_us, size_t most) {
    Out out;
    if (over_) return out;
    depart(now_us);
    while (true) {
        if (faults_.cut && delivered_ >= faults_.cut->at) {
            over_ = true;
            out.cut = faults_.cut->kind;
            return out;
        }
        if (faults_.stall && !stalled_ && delivered_ >= faults_.stall->at) {
            stalled_ = true;
            stalled_until_us_ = now_us + faults_.stall->for_us;
        }
        if (now_us < stalled_until_us_ || out.bytes.size() >= most) return out;
        if (flying_.empty() || flying_.front().arrives_us > now_us) break;
        Piece& piece = flying_.front();
        const size_t size =
            std::min({piece.bytes.size() - piece.taken, most - out.bytes.size(), until_event()});
        const auto from = piece.bytes.begin() + static_cast<std::ptrdiff_t>(piece.taken);
        out.bytes.insert(out.bytes.end(), from, from + static_cast<std::ptrdiff_t>(size));
        piece.taken += size;
        delivered_ += size;
        inside_ -= size;
        if (piece.taken == piece.bytes.size()) flying_.pop_front();
    }
    if (ending_ && flying_.empty() && waiting_.empty() && end_us_ <= now_us) over_ = out.ended = true;
    return out;
}

void ChaosLink::heal() {
    faults_.stall.reset();
    faults_.cut.reset();
    stalled_until_us_ = 0;
}

int64_t ChaosLink::next_us(int64_t now_us) const {
    int64_t next = INT64_MAX;
    if (over_) return next;
    if (!waiting_.empty()) {
        if (free_us_ > now_us) next = std::min(next, free_us_);
        if (!may_depart(waiting_.front().size()) && !flights_.empty())
            next = std::min(next, flights_.front().acknowledged_us);
    }
    if (!flying_.empty()) next = std::min(next, flying_.front().arrives_us);
    if (ending_ && flying_.empty() && waiting_.empty()) next = std::min(next, end_us_);
    if (next != INT64_MAX) next = std::max(next, stalled_until_us_);
    return next;
}

}  // namespace trochoid
