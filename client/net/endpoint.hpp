#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace trochoid {

/// Where clients look for a server that is not named.
inline constexpr const char* default_server = "127.0.0.1:7421";

/// What programs say of --connect and --ca.
inline constexpr const char* connect_help =
    "Server: HOST:PORT, tls://HOST:PORT, ws://HOST:PORT or wss://HOST:PORT";
inline constexpr const char* ca_help =
    "tls, wss: PEM file of the certificates to trust (default: the system's)";

/// How bytes reach a server: a server's one port takes all four.
enum class Transport : uint8_t {
    tcp,  ///< frames on a plain stream
    tls,  ///< frames inside TLS
    ws,   ///< messages of a WebSocket
    wss,  ///< messages of a WebSocket inside TLS
};

/// Where a server listens, how to get there, and whom to believe on the way.
struct Endpoint {
    std::string host = "127.0.0.1";
    uint16_t port = 0;
    Transport transport = Transport::tcp;
    /// tls, wss: PEM file of the certificates that are trusted; empty: the system's. Not part of the text.
    std::string ca_file = {};
    bool operator==(const Endpoint&) const = default;
};

bool is_encrypted(Transport transport);
/// Whether tokens and tickets may travel there: encrypted, or within this machine. Whoever listened on the way could use them first.
bool keeps_secrets(const Endpoint& endpoint);
/// Throws OperatorError where a token would travel in the clear.
void require_secrecy(const Endpoint& endpoint);
bool is_web(Transport transport);
/// The same server with the transport inside TLS, or without.
Endpoint with_encryption(Endpoint endpoint, bool encrypted);

/// "HOST:PORT" or "[V6]:PORT" (tcp), or one of these behind "tcp://", "tls://", "ws://" or "wss://", with a "/" at the end or
/// none. ws and wss may be without the port: 80 and 443. Anything else is an OperatorError that shows an example.
Endpoint parse_endpoint(std::string_view text);
/// Reads back: HOST:PORT for tcp, with the scheme in front for all others, always with the port.
std::string to_text(const Endpoint& endpoint);
/// "HOST:PORT", "[V6]:PORT", whatever the transport.
std::string host_and_port(const Endpoint& endpoint);

/// What a program was given as --connect and --ca (empty: not given). OperatorError besides where --ca has no use, or is not
/// a file of certificates.
Endpoint endpoint_from_options(std::string_view connect, const std::string& ca_file);

}  // namespace trochoid
