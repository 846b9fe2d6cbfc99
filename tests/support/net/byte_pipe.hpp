#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace trochoid {

/// Bytes to and from a server on loopback, in the clear or inside TLS: does only what a test tells it, blocking, with a
/// deadline on every wait.
class BytePipe {
public:
    using Milliseconds = std::chrono::milliseconds;
    static constexpr Milliseconds patience{5000};

    BytePipe() = default;
    BytePipe(const BytePipe&) = delete;
    BytePipe& operator=(const BytePipe&) = delete;
    virtual ~BytePipe() = default;

    /// False where the server takes nothing more.
    virtual bool write(std::span<const uint8_t> bytes) = 0;
    /// Bytes read; 0 where nothing came in time or the stream has ended (see `ended`).
    virtual size_t read(std::span<uint8_t> into, Milliseconds within = patience) = 0;
    virtual bool ended() const = 0;
    /// Says that nothing more comes, and goes on reading.
    virtual void finish_writing() = 0;
    /// Hangs up.
    virtual void close() = 0;
    /// The stream has ended as its form has it (TLS: close_notify; TCP: not by a reset).
    virtual bool ended_properly() const = 0;

    bool write(const std::string& text);
    /// Everything until the end of the stream, or the deadline.
    std::string read_all(Milliseconds within = patience);
};

struct TlsWish {
    std::string trusted;             ///< PEM of whom to trust; empty: anybody
    std::string host = "localhost";  ///< that the certificate has to name, where somebody is trusted
    bool drip = false;               ///< every byte on its own
    bool old_tls = false;            ///< nothing above TLS 1.2
    std::string protocols;           ///< ALPN, each behind its length; empty: none
    std::string groups;              ///< for the key exchange, as "X25519:P-256"; empty: the library's
    std::string from;                ///< the address to connect from, as "127.0.0.5"; empty: the system's
};

/// `from`: the address to connect from; empty: the system's.
std::unique_ptr<BytePipe> connect_tcp(uint16_t port, const std::string& address = "127.0.0.1",
                                      const std::string& from = "");
/// With the handshake; nullptr where it fails.
std::unique_ptr<BytePipe> connect_tls(uint16_t port, const TlsWish& wish = {});
/// The protocol that ALPN chose on a TLS pipe; empty: none.
std::string chosen_protocol(const BytePipe& tls);

}  // namespace trochoid
