#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "server/net/io_loop.hpp"
#include "server/net/sea_provider.hpp"
#include "server/net/server_stats.hpp"
#include "server/net/session.hpp"
#include "server/net/session_admission.hpp"
#include "server/net/session_turns.hpp"

namespace trochoid {

/// All sessions of one server, on the io thread.
class SessionServer {
public:
    /// `logins_per_second`: of one address (SessionAdmission); 0: any number.
    SessionServer(IoLoop& loop, SeaProvider& sea, const Limits& limits, uint32_t logins_per_second = 0);
    SessionServer(const SessionServer&) = delete;
    SessionServer& operator=(const SessionServer&) = delete;

    /// Takes a new connection, which came at `since_us` (monotonic, microseconds); beyond Limits::sessions it only gets a
    /// goodbye. One beyond the logins of its address waits for its turn, or gets a goodbye where too many wait.
    void accept(std::unique_ptr<Transport> transport, int64_t since_us);
    void accept(std::unique_ptr<Transport> transport);
    /// Counts the end of a connection that never became a session.
    void count_end(ErrorCode code);
    /// The world has changed: every session decides its next result.
    void sea_changed();
    /// Says goodbye (shutting_down, with a retry time that differs from session to session) to all, takes nobody new,
    /// and calls back once the last one is gone, two seconds later at the latest.
    void drain(std::function<void()> drained);

    const ServerStats& stats() const { return stats_; }

private:
    void sweep();
    void forget(uint64_t id, ErrorCode code);
    ErrorCode how_ended(uint64_t id) const;
    void admit(int64_t now_us);
    void take_turns();
    Session& enter(std::unique_ptr<Transport> transport);
    std::vector<std::shared_ptr<Session>> all() const;

    IoLoop& loop_;
    ServerStats stats_;
    std::vector<uint8_t> read_buffer_;
    SessionSurroundings around_;
    LoopTimer sweep_timer_;
    std::map<uint64_t, std::shared_ptr<Session>> sessions_;
    /// A session's number: of this node above, in order below. 0 is none.
    uint64_t next_id_;
    std::map<uint64_t, ErrorCode> ends_;  // of the sessions that ended last
    std::deque<uint64_t> ends_in_order_;  // ends_, the oldest first
    SessionAdmission admission_;
    std::map<uint64_t, int64_t>
        held_back_;  // sessions that wait, and what they had used of their hello deadline, microseconds
    FairQueue<std::weak_ptr<Session>> turns_;  // of what is computed aside
    bool computing_ = false;
    bool draining_ = false;
    std::function<void()> drained_;
};

}  // namespace trochoid
