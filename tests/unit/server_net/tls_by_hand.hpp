#pragma once
#include <memory>
#include <string>

#include "protocol/codec/codec.hpp"
#include "tests/support/net/byte_pipe.hpp"

namespace trochoid {

/// A TLS client whose every record is in the test's hands: held back, repeated, or made as no library would.
class TlsByHand {
public:
    /// Connects, and says nothing yet. `from`: the address to connect from; empty: the system's.
    explicit TlsByHand(uint16_t port, const std::string& from = "");
    TlsByHand(const TlsByHand&) = delete;
    TlsByHand& operator=(const TlsByHand&) = delete;
    ~TlsByHand();

    /// The first record, a ClientHello; it is not sent.
    Bytes hello();
    /// Sends it, and all else that the handshake takes.
    bool shake_hands();
    /// Sends bytes in one record.
    bool write(std::span<const uint8_t> bytes);
    /// The next bytes; none at the deadline or at the end.
    Bytes read(BytePipe::Milliseconds within = BytePipe::patience);
    /// Records that change the client's key one after the other; not sent.
    Bytes key_updates(int count);
    /// A record of this type (22: handshake) with these bytes, encrypted as the next one; not sent. Nothing may be written by `write` behind
    /// it, nor any key be changed.
    Bytes record(uint8_t type, std::span<const uint8_t> bytes);
    BytePipe& pipe() { return *pipe_; }

private:
    struct Impl;
    bool send_pending();
    Bytes pending();

    std::unique_ptr<BytePipe> pipe_;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
