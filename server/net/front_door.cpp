#include "server/net/front_door.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "protocol/units/assert.hpp"
#include "server/net/metrics_text.hpp"
#include "server/net/monotonic.hpp"

namespace trochoid {

namespace {

constexpr std::chrono::milliseconds sweep_interval{100};
constexpr size_t read_buffer_bytes = 4096;
// Connections beyond their address's limit that are told so, at once; the rest are closed without a word.
constexpr uint32_t most_beyond_limit = 64;
// Sessions beyond the limit that get a goodbye, at once; the rest are closed without a word.
constexpr uint64_t most_farewells = 256;

}  // namespace

FrontDoor::FrontDoor(IoLoop& loop, SessionServer& sessions, const Limits& limits, DoorPolicy policy,
                     const TlsIdentity* tls, std::string world)
    : read_buffer_(read_buffer_bytes),
      around_{loop,
              sessions,
              std::move(policy),
              tls,
              limits,
              {},
              false,
              false,
              read_buffer_,
              [this] { return metrics(); },
              [this](uint64_t id) { forget(id); }},
      world_(std::move(world)),
      sweep_timer_(loop) {
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

void FrontDoor::accept(std::unique_ptr<Transport> transport) {
    around_.loop.assert_here();
    ++around_.stats.accepted;
    const PeerAddress address = peer_address(transport->peer());
    const uint32_t most = around_.policy.most_connections(address);
    const bool beyond = most > 0 && addresses_.count(address) >= most;
    if (around_.sessions.stats().sessions_now >= around_.limits.sessions + most_farewells ||
        guests_.size() >= around_.policy.guests) {
        close_at_once(std::move(transport), ErrorCode::too_many_sessions);
        return;
    }
    if (beyond && beyond_limit_now_ >= most_beyond_limit) {
        close_at_once(std::move(transport), ErrorCode::too_many_connections);
        return;
    }
    const uint64_t id = next_id_++;
    const auto guest =
        std::make_shared<Guest>(around_, id, std::move(transport),
                                beyond ? std::shared_ptr<void>() : addresses_.enter(address), beyond);
    if (beyond) ++beyond_limit_now_;
    guests_.emplace(id, guest);
    around_.stats.guests_now = guests_.size();
    guest->start();
}

void FrontDoor::close_at_once(std::unique_ptr<Transport> transport, ErrorCode code) {
    spdlog::debug("connection from {} closed: {} {}", transport->peer(), static_cast<unsigned>(code),
                  error_class(code));
    transport->close();
    around_.sessions.count_end(code);
}

void FrontDoor::forget(uint64_t id) {
    // Not at once: the guest is still on the stack.
    around_.loop.post([this, id] {
        const auto at = guests_.find(id);
        TROCHOID_ASSERT(at != guests_.end(), "guest {} left twice", id);
        if (at->second->beyond_limit()) --beyond_limit_now_;
        guests_.erase(at);
        around_.stats.guests_now = guests_.size();
    });
}

void FrontDoor::sweep() {
    const int64_t now_us = monotonic_us();
    const auto guests = guests_;
    for (const auto& [id, guest] : guests) guest->sweep(now_us);
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

void FrontDoor::close() {
    around_.draining = true;
    const auto guests = guests_;
    for (const auto& [id, guest] : guests) guest->leave(ErrorCode::shutting_down);
}

std::string FrontDoor::metrics() const {
    return metrics_text(around_.sessions.stats(), around_.stats,
                        {world_, around_.ready && !around_.draining});
}

std::string text_of(const DoorStats& s) {
    std::string answers;
    for (const auto& [status, count] : s.http_answers)
        answers += fmt::format("{}{}: {}", answers.empty() ? "" : ", ", status, count);
    return fmt::format(
        "{} connections accepted; streams raw {}, raw over TLS {}, WebSocket {}, WebSocket over TLS {}; TLS "
        "handshakes {} done {} failed; HTTP answers {}",
        s.accepted, s.raw, s.raw_over_tls, s.websocket, s.websocket_over_tls, s.handshakes,
        s.handshakes_failed, answers.empty() ? "none" : answers);
}

}  // namespace trochoid
