#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"
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
    /// A guest's TLS hello is whole: `begin_tls` is to be called when it is its turn.
    std::function<void(uint64_t id)> wants_handshake;
    /// Its handshake is done, or has failed.
    std::function<void(uint64_t id)> handshake_over;
    /// Called once when a guest is in or gone, last thing.
    std::function<void(uint64_t id)> left;
    /// Microseconds that handshakes have taken since the last turn of them.
    int64_t handshake_us = 0;
};

/// One connection at the door, on the io thread: until its first bytes have told what it is, its TLS handshake is done, its
/// HTTP request is answered or its first frame is whole; then it is a session's, or gone. Owns at most 4 KiB of what the peer has
/// sent. What ends here is told so here: whoever is not in takes nothing from the sessions.
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
    /// It is its turn to shake hands.
    void begin_tls();
    /// Ends it without a word.
    void leave(ErrorCode code);
    /// Ends it because the server does: with a goodbye where its form is known.
    void shut_out();

    bool beyond_limit() const { return beyond_limit_; }
    const PeerAddress& address() const { return address_; }

private:
    enum class Stage : uint8_t {
        first_bytes,  ///< also while shaking hands
        tls_hello,    ///< it is TLS
        tls_turn,     ///< its hello is whole, others shake hands first
        head,         ///< it is HTTP
        first_frame,  ///< it is a raw stream, or looks like one
        answering,
        lingering,
        gone
    };

    void arm_reading();
    void on_readable();
    Transport::Moved read(std::span<uint8_t> into);
    bool take_first_bytes();
    bool take_tls_hello();
    bool take_head();
    bool take_first_frame();
    bool judge_frame(std::span<const uint8_t> bytes);
    void drop_bytes();
    void on_fault(const StreamFault& fault);
    void refuse_tls(ErrorCode code);
    void watch_handshake();
    void end_handshake(bool done);
    void begin_frame();
    void hand_over(const Bytes& payload, std::span<const uint8_t> rest);
    void part(Goodbye goodbye);
    void part(const Error& why);
    void on_request(const HttpRequest& request, std::span<const uint8_t> rest);
    void upgrade(const HttpRequest& request, std::span<const uint8_t> rest);
    void answer(const HttpAnswer& what, bool head_only);
    void say(std::string bytes, ErrorCode finish_with);
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
    bool web_ = false;  // transport_ is a WebSocket
    bool handshaking_ = false;
    bool peer_done_ = false;  // nothing more comes; what was asked for is still answered
    Stage stage_ = Stage::first_bytes;
    int64_t started_us_;
    int64_t until_us_;
    std::array<uint8_t, tls_hello_begin> first_{};
    size_t first_count_ = 0;
    FrameReader frames_;
    std::string head_;          // of an HTTP request; or the TLS hello
    size_t head_searched_ = 0;  // the head does not end before this
    size_t dropped_bytes_ = 0;  // that came after the last word to it
    std::string answer_;
    size_t answer_taken_ = 0;
    ErrorCode finish_with_ = ErrorCode::none;
};

}  // namespace trochoid
