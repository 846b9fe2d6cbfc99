#include "server/app/land_queue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/units/assert.hpp"

namespace trochoid {

Result<Done> LandQueue::has_room(uint64_t session) const {
    const auto of_session = std::count_if(waiting_.begin(), waiting_.end(), [session](const auto& waiting) {
        return session != 0 && waiting.session == session;
    });
    if (static_cast<size_t>(of_session) >= most_of_a_session)
        return Error{
            ErrorCode::queue_overflow,
            fmt::format("busy: {} of your commands wait for land to be traced, as many as may; wait for an "
                        "answer and try again",
                        of_session)};
    if (waiting_.size() >= most_waiting)
        return Error{
            ErrorCode::queue_overflow,
            fmt::format("busy: {} commands wait for land to be traced, as many as may; try again later",
                        waiting_.size())};
    return Done{};
}

WaitingCommand LandQueue::pop() {
    TROCHOID_ASSERT(!waiting_.empty(), "no command waits");
    WaitingCommand first = std::move(waiting_.front());
    waiting_.pop_front();
    return first;
}

size_t LandQueue::drop(uint64_t session) {
    return std::erase_if(
        waiting_, [session](const auto& waiting) { return waiting.session == session && !waiting.begun; });
}

}  // namespace trochoid
