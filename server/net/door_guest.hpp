#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "server/net/door_policy.hpp"
#include "server/net/door_stats.hpp"
#include "server/net/first_bytes.hpp"
#include "server/net/http_answer.hpp"
#include "server/net/session_server.hpp"
#include "server/net/tls_transport.hpp"

namespace trochoid {

/// What all guests of a door share; outlives them.
struct DoorSurroundings {
    IoLoop& loop;
    SessionServer& sessions;
    DoorPolicy policy;
    const TlsIdentity* tls = nullptr;  ///< nullptr: no TLS here
    Limits limits;
    DoorStats stats;
    bool ready = false;
    bool draining = false;
    /// Reading happens into one buffer for all.
    std::span<uint8_t> read_buffer;
    std::function<std::string()> metrics;
    /// Called once when a guest is in or gone, last thing.
    std::function<void(uint64_t id)> left;
};

/// One connection at the door, on the io thread: until its first bytes have told what it is, its TLS handshake is done, its
/// HTTP request is answered; then it is a session's, or gone. Owns at most 4 KiB of what the peer has sent.
class Guest : public std::enable_shared_from_this<Guest> {
public:
    /// `place`: what is counted while the connection lasts. `beyond_limit`: its address has too many; it is only told so.
    Guest(DoorSurroundings& around, uint64_t id, std::unique_ptr<Transport> transport,
          std::shared_ptr<void> place, bool beyond_limit);
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;

    void start();
    /// Deadlines; to be called about ten times a second.
    void sweep(int64_t now_us);
    /// Ends it without a word: its form is not known.
    void leave(ErrorCode code);

    bool beyond_limit() const { return beyond_limit_; }

private:
    enum class Stage : uint8_t { first_bytes, head, answering, lingering, gone };

    void arm_reading();
    void on_readable();
    bool take_first_bytes();
    bool take_head();
    void drop_bytes();
    void begin_tls();
    void refuse_tls();
    void watch_handshake();
    void end_handshake(bool done);
    void hand_over();
    void turn_away(const Error& why);
    void on_request(const HttpRequest& request, std::span<const uint8_t> rest);
    void upgrade(const HttpRequest& request, std::span<const uint8_t> rest);
    void answer(const HttpAnswer& what, bool head_only);
    void on_writable();
    void linger(ErrorCode code);
    void out();

    DoorSurroundings& around_;
    uint64_t id_;
    std::unique_ptr<Transport> transport_;
    TlsTransport* tls_ = nullptr;  // transport_, where it is that
    std::shared_ptr<void> place_;
    PeerAddress address_;
    bool beyond_limit_;
    bool handshaking_ = false;
    Stage stage_ = Stage::first_bytes;
    int64_t started_us_;
    int64_t until_us_;
    std::array<uint8_t, 8> first_{};
    size_t first_count_ = 0;
    std::string head_;
    size_t head_searched_ = 0;  // the head does not end before this
    std::string answer_;
    size_t answer_taken_ = 0;
};

}  // namespace trochoid
