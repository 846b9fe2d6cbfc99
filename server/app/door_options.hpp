#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/net/door_policy.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace trochoid {

/// What the operator decides about the server's one port: encryption, and whom it lets in.
struct DoorOptions {
    std::filesystem::path tls_cert;    ///< PEM chain; with tls_key, or neither: no TLS
    std::filesystem::path tls_key;     ///< PEM, without a passphrase
    bool allow_plaintext = false;      ///< sessions and metrics without TLS for other machines
    std::vector<std::string> origins;  ///< of web pages that may connect, beside those on loopback
    std::vector<std::string> hosts;    ///< names under which pages may ask, beside loopback and what is bound
    /// Connections at once of one address (IPv6: a /64), 0 any number; not given: 16, on loopback any number.
    std::optional<uint32_t> connections_per_address;
    /// Logins a second of one address (IPv6: a /64), loopback like any other, 0 any number: four seconds' worth at once, two wait.
    uint32_t logins_per_address = 10;
    uint32_t drain_ms =
        0;  ///< from SIGTERM, when /readyz turns 503, until nobody is accepted any more, 0 to 600,000
    bool operator==(const DoorOptions&) const = default;

    bool tls() const { return !tls_cert.empty(); }
};

void add_door_options(CLI::App& app, DoorOptions& options);
/// Throws OperatorError for options that do not go together.
void check(const DoorOptions& options);
std::string text_of(const DoorOptions& options);
DoorPolicy policy_of(const DoorOptions& options, const std::vector<std::string>& bind);

}  // namespace trochoid
