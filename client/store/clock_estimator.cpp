#include "client/store/clock_estimator.hpp"

#include <algorithm>

namespace trochoid {

int64_t ClockEstimator::Exchange::bound_at(int64_t now_us) const {
    return delay_us / 2 + 1 + std::max<int64_t>(0, now_us - at_us) / drift_divisor;
}

void ClockEstimator::begin(const ServerHello& hello, int64_t client_received_us) {
    // A reconnect to the same epoch goes on from the time shown; anything else starts afresh.
    if (!known_ || hello.instance != instance_ || hello.clock.epoch != clock_.epoch) slewing_ = false;
    count_ = 0;
    instance_ = hello.instance;
    clock_ = hello.clock;
    known_ = true;
    take(hello.client_stamp_us, hello.server_now_us, hello.server_now_us, client_received_us);
}

void ClockEstimator::add(const ClockReply& reply, int64_t client_received_us) {
    if (reply.clock.epoch != clock_.epoch) slewing_ = false;
    clock_ = reply.clock;
    known_ = true;
    take(reply.client_sent_us, reply.server_received_us, reply.server_sent_us, client_received_us);
}

void ClockEstimator::take(int64_t sent, int64_t received, int64_t replied, int64_t back) {
    Exchange exchange;
    exchange.delay_us = std::max<int64_t>(0, (back - sent) - (replied - received));
    exchange.offset_us = ((received - sent) + (replied - back)) / 2;
    exchange.at_us = back;
    exchanges_[static_cast<size_t>(count_ % recent)] = exchange;
    ++count_;
    const auto last = exchanges_.begin() + std::min(count_, recent);
    best_ = *std::min_element(exchanges_.begin(), last, [back](const Exchange& a, const Exchange& b) {
        return a.bound_at(back) < b.bound_at(back);
    });
}

SeaTime ClockEstimator::sea_time(int64_t client_now_us) {
    const int64_t behind = best_.offset_us - slewed_offset_us_;
    if (!slewing_ || behind > longest_lag_us) {
        slewed_offset_us_ = best_.offset_us;
        slewed_at_us_ = client_now_us;
        slewing_ = true;
    }
    const int64_t most = std::max<int64_t>(0, client_now_us - slewed_at_us_) / slew_divisor;
    slewed_offset_us_ += std::clamp(best_.offset_us - slewed_offset_us_, -most, most);
    // Asked so often that 1/64 of the time between rounds to nothing, that time still counts; once there, none is saved up.
    if (most > 0 || slewed_offset_us_ == best_.offset_us) slewed_at_us_ = client_now_us;
    return sea_time_at(clock_, client_now_us + slewed_offset_us_);
}

int64_t ClockEstimator::error_bound_us(int64_t client_now_us) const {
    const int64_t to_slew = slewing_ ? std::abs(best_.offset_us - slewed_offset_us_) : 0;
    return best_.bound_at(client_now_us) + to_slew;
}

}  // namespace trochoid
