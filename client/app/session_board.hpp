#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/app/ocean_session.hpp"
#include "client/store/clock_estimator.hpp"

namespace trochoid {

/// What a session shows to other threads: the network thread writes, anybody reads.
class SessionBoard {
public:
    /// Bytes of the socket at a moment of our monotonic clock.
    struct Mark {
        int64_t at_us = 0;
        uint64_t bytes = 0;
    };

    mutable std::mutex mutex;
    std::condition_variable news;
    uint64_t changes = 0;  // counts what wakes waiters

    // All below under the mutex.
    LinkState state = LinkState::connecting;
    std::string reason;       // why the last connection ended
    int64_t next_try_us = 0;  // while waiting
    std::shared_ptr<const StoreSnapshot> snapshot = std::make_shared<StoreSnapshot>();
    std::shared_ptr<const ServerHello> hello;
    ClockEstimator clock;
    StoreCounters counters;
    Fidelity fidelity = Fidelity::unknown;
    uint32_t connections = 0;
    uint64_t views_sent = 0;
    std::deque<Mark> marks;  // received bytes over the last seconds
    // What the owner wants the server to know.
    ViewState view;
    std::vector<SyncRegion> regions;
    bool view_posted = false;  // the network thread has been told that the view has changed

    void changed() {
        ++changes;
        news.notify_all();
    }
};

/// Speed over the marks of the last three seconds, after adding the present one. Bytes per second.
double speed_with(std::deque<SessionBoard::Mark>& marks, SessionBoard::Mark now);

/// The state for people.
std::string sentence_of(const SessionBoard& board, const Endpoint& server, int64_t now_us);

}  // namespace trochoid
