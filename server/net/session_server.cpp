#include "server/net/session_server.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <random>
#include <utility>

#include "protocol/units/hash.hpp"
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

SessionServer::SessionServer(IoLoop& loop, SeaProvider& sea, const Limits& limits)
    : loop_(loop),
      read_buffer_(read_buffer_bytes),
      around_{loop,
              sea,
              stats_,
              limits,
              read_buffer_,
              [this](uint64_t id, ErrorCode code) { forget(id, code); },
              [this](uint64_t id) { return how_ended(id); }},
      sweep_timer_(loop),
      next_id_(first_session()) {
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

Session& SessionServer::open(std::unique_ptr<Transport> transport, int64_t since_us) {
    loop_.assert_here();
    ++stats_.connections;
    const uint64_t id = next_id_++;
    const auto session = std::make_shared<Session>(around_, id, std::move(transport));
    sessions_.emplace(id, session);
    stats_.sessions_now = sessions_.size();
    session->start(since_us);
    return *session;  // in the map at least until the loop's next turn
}

void SessionServer::accept(std::unique_ptr<Transport> transport) {
    accept(std::move(transport), monotonic_us());
}

void SessionServer::accept(std::unique_ptr<Transport> transport, int64_t since_us) {
    Session& session = open(std::move(transport), since_us);
    if (draining_)
        session.part(farewell({ErrorCode::shutting_down, "this server is shutting down: connect again later"},
                              session.id()));
    else if (sessions_.size() > around_.limits.sessions)
        session.part(
            farewell({ErrorCode::too_many_sessions,
                      fmt::format("all {} sessions are taken: connect again later", around_.limits.sessions)},
                     session.id()));
}

void SessionServer::turn_away(std::unique_ptr<Transport> transport, const Error& why, int64_t since_us) {
    Session& session = open(std::move(transport), since_us);
    const bool later = why.code == ErrorCode::too_many_connections;
    session.part(later ? farewell(why, session.id()) : goodbye_for(why));
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
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

ErrorCode SessionServer::how_ended(uint64_t id) const {
    const auto known = ends_.find(id);
    return known == ends_.end() ? ErrorCode::none : known->second;
}

void SessionServer::forget(uint64_t id, ErrorCode code) {
    ends_[id] = code;
    if (ends_.size() > most_ends) ends_.erase(ends_.begin());
    // Not at once: the session is still on the stack.
    loop_.post([this, id] {
        sessions_.erase(id);
        around_.sea.session_over(id);
        stats_.sessions_now = sessions_.size();
        if (draining_ && sessions_.empty() && drained_) std::exchange(drained_, nullptr)();
    });
}

// With a retry time of one to three seconds that differs, so that not all come back at once.
Goodbye SessionServer::farewell(const Error& error, uint64_t id) {
    Goodbye goodbye = goodbye_for(error);
    goodbye.retry = true;
    goodbye.retry_after_ms =
        static_cast<uint32_t>(1000 + splitmix64(id ^ static_cast<uint64_t>(monotonic_us())) % 2000);
    return goodbye;
}

void SessionServer::drain(std::function<void()> drained) {
    loop_.assert_here();
    if (draining_) return;
    draining_ = true;
    drained_ = std::move(drained);
    for (const auto& session : all())
        session->part(farewell(
            {ErrorCode::shutting_down, "this server is shutting down: connect again later"}, session->id()));
    if (sessions_.empty() && drained_) std::exchange(drained_, nullptr)();
}

}  // namespace trochoid
