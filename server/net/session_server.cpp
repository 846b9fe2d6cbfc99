#include "server/net/session_server.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <random>
#include <utility>

#include "server/net/farewell.hpp"
#include "server/net/monotonic.hpp"

namespace trochoid {

namespace {

constexpr std::chrono::milliseconds sweep_interval{100};
constexpr size_t read_buffer_bytes = 16 * 1024;
// Ends of sessions that can be told of: what comes back comes back soon.
constexpr size_t most_ends = 4096;

// Nodes of a world do not ask each other for numbers, and a session's must not be taken for another node's.
uint64_t first_session() {
    std::random_device device;
    return (uint64_t{device() & 0x7fffffff} << 32) + 1;
}

}  // namespace

SessionServer::SessionServer(IoLoop& loop, SeaProvider& sea, const Limits& limits, uint32_t logins_per_second)
    : loop_(loop),
      read_buffer_(read_buffer_bytes),
      around_{loop,
              sea,
              stats_,
              limits,
              read_buffer_,
              [this](uint64_t id, ErrorCode code) { forget(id, code); },
              [this](uint64_t id) { return how_ended(id); },
              [this](const std::shared_ptr<Session>& session) {
                  turns_.push(line_of(peer_address(session->peer())), session);
                  if (!computing_) take_turns();
              }},
      sweep_timer_(loop),
      next_id_(first_session()),
      admission_(logins_per_second) {
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

Session& SessionServer::enter(std::unique_ptr<Transport> transport) {
    loop_.assert_here();
    ++stats_.connections;
    const uint64_t id = next_id_++;
    const auto session = std::make_shared<Session>(around_, id, std::move(transport));
    sessions_.emplace(id, session);
    stats_.sessions_now = sessions_.size();
    return *session;  // in the map at least until the loop's next turn
}

void SessionServer::accept(std::unique_ptr<Transport> transport) {
    accept(std::move(transport), monotonic_us());
}

void SessionServer::accept(std::unique_ptr<Transport> transport, int64_t since_us) {
    Session& session = enter(std::move(transport));
    const auto part_with = [&](const Error& why) {
        session.start(since_us);
        session.part(farewell(why, session.id()));
    };
    if (draining_) return part_with(shutting_down());
    if (sessions_.size() > around_.limits.sessions)
        return part_with(
            {ErrorCode::too_many_sessions,
             fmt::format("all {} sessions are taken: connect again later", around_.limits.sessions)});
    const int64_t now_us = monotonic_us();
    switch (admission_.ask(peer_address(session.peer()), session.id(), now_us)) {
        case SessionAdmission::Verdict::at_once: return session.start(since_us);
        case SessionAdmission::Verdict::later:
            ++stats_.held_back;
            // The hello deadline stands still while it waits.
            held_back_.emplace(session.id(), now_us - since_us);
            return;
        case SessionAdmission::Verdict::never:
            return part_with({ErrorCode::too_many_connections,
                              "too many logins from this address: keep connections, or connect again later"});
    }
}

// Those whose turn has come. What has ended meanwhile has had its turn.
void SessionServer::admit(int64_t now_us) {
    for (const uint64_t id : admission_.due(now_us)) {
        const auto waiting = held_back_.extract(id);
        const auto session = sessions_.find(id);
        if (waiting.empty() || session == sessions_.end()) continue;
        session->second->start(now_us - waiting.mapped());
    }
}

// One result is computed aside at a time; the next one begins in a turn of its own.
void SessionServer::take_turns() {
    if (const auto next = turns_.pop()) {
        const std::shared_ptr<Session> session = next->lock();
        computing_ = true;
        const auto done = [this] {
            loop_.post([this] {
                computing_ = false;
                take_turns();
            });
        };
        if (session)
            session->compute_aside(done);
        else
            done();
    }
}

void SessionServer::count_end(ErrorCode code) {
    loop_.assert_here();
    ++stats_.ended[code];
}

std::vector<std::shared_ptr<Session>> SessionServer::all() const {
    std::vector<std::shared_ptr<Session>> sessions;
    sessions.reserve(sessions_.size());
    for (const auto& [id, session] : sessions_) sessions.push_back(session);
    return sessions;
}

void SessionServer::sea_changed() {
    loop_.assert_here();
    for (const auto& session : all()) session->sea_changed();
}

void SessionServer::sweep() {
    const int64_t now_us = monotonic_us();
    for (const auto& session : all()) session->sweep(now_us);
    admit(now_us);
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

ErrorCode SessionServer::how_ended(uint64_t id) const {
    // One that parts still waits for its client to close: it has ended all the same.
    if (const auto parting = sessions_.find(id); parting != sessions_.end())
        return parting->second->end_code();
    const auto known = ends_.find(id);
    return known == ends_.end() ? ErrorCode::none : known->second;
}

void SessionServer::forget(uint64_t id, ErrorCode code) {
    ends_[id] = code;
    ends_in_order_.push_back(id);
    if (ends_in_order_.size() > most_ends) {
        ends_.erase(ends_in_order_.front());
        ends_in_order_.pop_front();
    }
    held_back_.erase(id);
    // Not at once: the session is still on the stack.
    loop_.post([this, id] {
        sessions_.erase(id);
        around_.sea.session_over(id);
        stats_.sessions_now = sessions_.size();
        if (draining_ && sessions_.empty() && drained_) std::exchange(drained_, nullptr)();
    });
}

void SessionServer::drain(std::function<void()> drained) {
    loop_.assert_here();
    if (draining_) return;
    draining_ = true;
    drained_ = std::move(drained);
    for (const auto& session : all()) session->part(farewell(shutting_down(), session->id()));
    if (sessions_.empty() && drained_) std::exchange(drained_, nullptr)();
}

}  // namespace trochoid
