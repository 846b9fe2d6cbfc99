#include "server/net/front_door.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
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
// A turn of handshakes ends after so many, or so long; a pause of as long as they took follows, in which everybody else is served.
constexpr int most_a_turn = 4;
constexpr int64_t turn_us = 500;
constexpr int64_t most_pause_us = 20'000;

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
              [this](uint64_t id) { wants_handshake(id); },
              [this](uint64_t id) { handshake_over(id); },
              [this](uint64_t id) { forget(id); }},
      world_(std::move(world)),
      sweep_timer_(loop),
      turns_timer_(loop) {
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

void FrontDoor::accept(std::unique_ptr<Transport> transport) {
    around_.loop.assert_here();
    ++around_.stats.accepted;
    const PeerAddress address = peer_address(transport->peer());
    const uint32_t most = around_.policy.most_connections(address);
    const bool beyond = most > 0 && addresses_.count(address) >= most;
    if (around_.sessions.stats().sessions_now >= around_.limits.sessions + most_farewells) {
        close_at_once(std::move(transport), ErrorCode::too_many_sessions);
        return;
    }
    if (beyond && beyond_limit_now_ >= most_beyond_limit) {
        close_at_once(std::move(transport), ErrorCode::too_many_connections);
        return;
    }
    if (crowd_.size() >= around_.policy.guests) make_room(crowd_);
    const uint64_t id = next_id_++;
    const auto guest =
        std::make_shared<Guest>(around_, id, std::move(transport),
                                beyond ? std::shared_ptr<void>() : addresses_.enter(address), beyond);
    if (beyond) ++beyond_limit_now_;
    guests_.emplace(id, guest);
    crowd_.enter(line_of(address), id);
    around_.stats.guests_now = crowd_.size();
    guest->start();
}

// For one more.
void FrontDoor::make_room(const AddressCrowd& crowd) {
    const auto first = crowd.first_to_go();
    if (!first) return;
    ++around_.stats.made_room;
    guests_.at(*first)->leave(ErrorCode::too_many_connections);
}

void FrontDoor::wants_handshake(uint64_t id) {
    handshake_turns_.wait(line_of(guests_.at(id)->address()), id);
    if (std::exchange(turns_due_, true)) return;
    around_.loop.post([this] { take_turns(); });  // the guest is still on the stack
}

void FrontDoor::take_turns() {
    if (handshake_turns_.empty()) {
        turns_due_ = false;
        return;
    }
    ++around_.stats.handshake_turns;
    const int64_t until_us = monotonic_us() + turn_us;
    for (int i = 0; i < most_a_turn && monotonic_us() < until_us; ++i) {
        const auto id = handshake_turns_.next();
        if (!id) break;
        if (handshakes_.size() >= around_.policy.handshakes) make_room(handshakes_);
        const auto guest = guests_.at(*id);
        handshakes_.enter(line_of(guest->address()), *id);
        guest->begin_tls();
    }
    pause_turns();
}

// One pause a turn, however busy those are kept that have begun: what they cost meanwhile lengthens the next.
void FrontDoor::pause_turns() {
    const int64_t spent_us = std::min(std::exchange(around_.handshake_us, 0), most_pause_us);
    turns_timer_.start(std::chrono::milliseconds(spent_us / 1000 + 1), [this] { take_turns(); });
}

void FrontDoor::handshake_over(uint64_t id) { handshakes_.leave(line_of(guests_.at(id)->address()), id); }

void FrontDoor::close_at_once(std::unique_ptr<Transport> transport, ErrorCode code) {
    spdlog::debug("connection from {} closed: {} {}", transport->peer(), static_cast<unsigned>(code),
                  error_class(code));
    transport->close();
    around_.sessions.count_end(code);
}

void FrontDoor::forget(uint64_t id) {
    const auto known = guests_.find(id);
    TROCHOID_ASSERT(known != guests_.end(), "guest {} left twice", id);
    const PeerAddress line = line_of(known->second->address());
    crowd_.leave(line, id);
    handshake_turns_.forget(line, id);
    if (known->second->beyond_limit()) --beyond_limit_now_;
    around_.stats.guests_now = crowd_.size();
    // Not at once: the guest is still on the stack.
    around_.loop.post([this, id] { guests_.erase(id); });
}

void FrontDoor::sweep() {
    const int64_t now_us = monotonic_us();
    const auto guests = guests_;
    for (const auto& [id, guest] : guests) guest->sweep(now_us);
    if (now_us - begun_since_us_ >= microseconds_per_second) {
        begun_since_us_ = now_us;
        handshake_turns_.forget_begun();
    }
    sweep_timer_.start(sweep_interval, [this] { sweep(); });
}

void FrontDoor::close() {
    around_.draining = true;
    const auto guests = guests_;
    for (const auto& [id, guest] : guests) guest->shut_out();
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
        "handshakes {} done {} failed; {} made room; HTTP answers {}",
        s.accepted, s.raw, s.raw_over_tls, s.websocket, s.websocket_over_tls, s.handshakes,
        s.handshakes_failed, s.made_room, answers.empty() ? "none" : answers);
}

}  // namespace trochoid
