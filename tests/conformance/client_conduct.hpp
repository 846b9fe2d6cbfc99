#pragma once
#include <cstdint>

#include "protocol/codec/messages.hpp"

namespace trochoid::conformance {

/// What a client may say in a session, and how often: what no message tells by itself.
class ClientConduct {
public:
    /// A valid message that came at this moment of our clock, in the session that `ours` began. Failed, with the requirement, where it
    /// may not come.
    void judge(const ClientMessage& message, const ServerHello& ours, int64_t at_us);

private:
    /// Fills by `rate` a second and holds as many.
    class Bucket {
    public:
        bool take(uint32_t rate, int64_t now_us);

    private:
        int64_t spent_ = 0;  // millionths of a message, above what has been filled up again
        int64_t at_us_ = 0;
    };

    void judge_rates(const ClientMessage& message, const Limits& limits, int64_t at_us);

    Bucket messages_;
    Bucket views_;
    Bucket commands_;
};

}  // namespace trochoid::conformance
