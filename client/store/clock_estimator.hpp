#pragma once
#include <array>
#include <cstdint>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// Where the server's monotonic clock stands on ours, from four timestamps a round trip (wire: "Sea time"; after RFC
/// 5905): the estimate follows the exchange with the smallest error bound among the recent ones. A bound is half the delay
/// (however unequal its two ways) plus what two clocks may drift apart since. Within one time epoch of a world shown sea
/// time is slewed and never steps back. All stamps in microseconds.
class ClockEstimator {
public:
    /// Two clocks drift apart by at most this: 1 microsecond in 10,000 (quartz keeps 50 ppm each).
    static constexpr int64_t drift_divisor = 10'000;
    /// Within an epoch shown time runs at most 1 part in 64 faster or slower than the estimate.
    static constexpr int64_t slew_divisor = 64;
    /// Farther behind than this (this machine has slept) shown time jumps forwards.
    static constexpr int64_t longest_lag_us = 1'000'000;

    /// The hello's stamps: a first estimate, with the whole round trip as delay.
    void begin(const ServerHello& hello, int64_t client_received_us);
    void add(const ClockReply& reply, int64_t client_received_us);

    bool known() const { return known_; }
    /// Sea time at a moment of our monotonic clock; steps back only at a new epoch or world. Asks in ascending order of time.
    SeaTime sea_time(int64_t client_now_us);
    /// Bound of the error of sea_time in microseconds of real time: the best exchange's bound plus what is still to slew.
    int64_t error_bound_us(int64_t client_now_us) const;
    /// Delay of the best recent round trip.
    int64_t round_trip_us() const { return best_.delay_us; }
    /// The server's monotonic clock minus ours, by that round trip.
    int64_t offset_us() const { return best_.offset_us; }
    const SeaClock& clock() const { return clock_; }

private:
    struct Exchange {
        int64_t offset_us = 0;  // server minus client
        int64_t delay_us = 0;
        int64_t at_us = 0;  // client's clock
        int64_t bound_at(int64_t now_us) const;
    };
    void take(int64_t sent, int64_t received, int64_t replied, int64_t back);

    static constexpr int recent = 8;
    std::array<Exchange, recent> exchanges_{};
    int count_ = 0;
    SeaClock clock_;
    WorldInstance instance_;
    bool known_ = false;
    Exchange best_;
    // The offset in use approaches the best one by at most 1/64 of elapsed time, so time never runs backwards.
    int64_t slewed_offset_us_ = 0;
    int64_t slewed_at_us_ = 0;
    bool slewing_ = false;
};

}  // namespace trochoid
