#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "protocol/codec/messages.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// A command whose turn is still to come.
struct WaitingCommand {
    Command command;
    std::function<void(CommandReply)> reply;
    uint64_t session = 0;  ///< that sent it; 0: none, it came from this process
    bool begun =
        false;  ///< its land has been traced, alone or with others: carried out whatever becomes of its session
};

/// Commands that wait for land to be traced, in the order in which they came; bounded in all and for each session, so that nobody
/// waits long without an answer.
class LandQueue {
public:
    static constexpr size_t most_waiting = 64;
    static constexpr size_t most_of_a_session = 8;

    bool empty() const { return waiting_.empty(); }
    /// Whether one more may wait: queue_overflow.
    Result<Done> has_room(uint64_t session) const;
    void push(WaitingCommand waiting) { waiting_.push_back(std::move(waiting)); }
    /// Back to where it was taken from.
    void put_back(WaitingCommand waiting) { waiting_.push_front(std::move(waiting)); }
    /// nullptr: none waits.
    const WaitingCommand* front() const { return waiting_.empty() ? nullptr : &waiting_.front(); }
    /// There must be one.
    WaitingCommand pop();
    /// Takes out what a session that is over has left and was not begun; how many.
    size_t drop(uint64_t session);

private:
    std::deque<WaitingCommand> waiting_;
};

}  // namespace trochoid
