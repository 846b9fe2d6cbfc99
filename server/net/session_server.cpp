#include "server/net/session_server.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "protocol/units/hash.hpp"
#include "server/net/monotonic.hpp"

namespace trochoid {

namespace {

constexpr std::chrono::milliseconds sweep_interval{100};
constexpr size_t read_buffer_bytes = 16 * 1024;

}  // namespace

SessionServer::SessionServer(IoLoop& loop, SeaProvider& sea, const Limits& limits)
    : loop_(loop),
      read_buffer_(read_buffer_bytes),
      around_{loop, sea, stats_, limits, read_buffer_, [this](uint64_t id) { forget(id); }},
      sweep_timer_(loop) {
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

void SessionServer::accept(std::unique_ptr<Transport> transport) {
    loop_.assert_here();
    ++stats_.connections;
    const uint64_t id = next_id_++;
    const auto session = std::make_shared<Session>(around_, id, std::move(transport));
    sessions_.emplace(id, session);
    stats_.sessions_now = sessions_.size();
    session->start();
    if (draining_)
        session->part(
            farewell({ErrorCode::shutting_down, "this server is shutting down: connect again later"}, id));
    else if (sessions_.size() > around_.limits.sessions)
        session->part(
            farewell({ErrorCode::too_many_sessions,
                      fmt::format("all {} sessions are taken: connect again later", around_.limits.sessions)},
                     id));
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

void SessionServer::forget(uint64_t id) {
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
