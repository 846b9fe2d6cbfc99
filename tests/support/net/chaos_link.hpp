#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "tests/support/net/chaos_schedule.hpp"

namespace trochoid {

/// One direction of a connection that suffers faults, without sockets and clocks: bytes go in at a time and come out
/// at a time. Times in microseconds, ascending from call to call.
class ChaosLink {
public:
    /// Bytes that may be inside; then the sender has to wait.
    static constexpr size_t most_inside = size_t{4} << 20;

    /// `seed` for the jitter; `back_us`: the other direction's delay, for acknowledgements.
    ChaosLink(LinkFaults faults, uint64_t seed, int64_t back_us);

    bool takes_more() const { return inside_ < most_inside && !ending_; }
    void put(std::span<const uint8_t> bytes, int64_t now_us);
    /// The sender has ended its stream; the end follows its bytes.
    void end(int64_t now_us);

    struct Out {
        std::vector<uint8_t> bytes;
        bool ended = false;          ///< all bytes have come out, and now the stream's end
        std::optional<CutKind> cut;  ///< after these bytes
    };
    /// What comes out now, at most `most` bytes.
    Out take(int64_t now_us, size_t most);
    /// When `take` may have more to say; INT64_MAX: only after a `put` or an `end`.
    int64_t next_us(int64_t now_us) const;

    uint64_t delivered() const { return delivered_; }
    /// From now on neither stalls nor cuts; delays and the rate stay.
    void heal();

private:
    struct Piece {
        std::vector<uint8_t> bytes;
        size_t taken = 0;
        int64_t arrives_us = 0;
    };
    struct Flight {
        size_t bytes = 0;
        int64_t acknowledged_us = 0;
    };
    void depart(int64_t now_us);
    bool may_depart(size_t bytes) const;
    size_t until_event() const;

    LinkFaults faults_;
    uint64_t dice_;
    int64_t back_us_;
    std::deque<std::vector<uint8_t>> waiting_;  // not sent yet: rate or window
    std::deque<Piece> flying_;
    std::deque<Flight> flights_;  // bytes that count against the window
    uint64_t window_;
    uint64_t in_flight_ = 0;
    int64_t free_us_ = 0;     // when the last piece has left the sender, at the rate
    int64_t arrives_us_ = 0;  // of the last piece: none overtakes another
    int64_t stalled_until_us_ = 0;
    bool stalled_ = false;  // the stall has begun, and maybe ended
    bool ending_ = false;
    bool over_ = false;  // ended or cut
    int64_t end_us_ = 0;
    uint64_t put_ = 0;
    uint64_t delivered_ = 0;
    size_t inside_ = 0;
};

}  // namespace trochoid
