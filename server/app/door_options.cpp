#include "server/app/door_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr uint32_t most_connections = 1U << 20;
constexpr uint32_t most_logins = 1U << 20;
constexpr uint32_t longest_drain_ms = 600'000;

std::string refuse_empty(const std::string& value) { return value.empty() ? "is empty: give a value" : ""; }

}  // namespace

void add_door_options(CLI::App& app, DoorOptions& options) {
    app.add_option("--tls-cert", options.tls_cert,
                   "Certificate chain (PEM) for TLS, the server's own first; read again at SIGHUP")
        ->check(refuse_empty);
    app.add_option("--tls-key", options.tls_key, "Key of the certificate (PEM, without a passphrase)")
        ->check(refuse_empty);
    app.add_flag("--allow-plaintext", options.allow_plaintext,
                 "Let other machines in without TLS: whoever is on the way reads and changes all");
    app.add_option(
           "--allow-origin", options.origins,
           "Origin of web pages that may connect, as https://sea.example; may be given more than once")
        ->check(refuse_empty)
        ->allow_extra_args(false);
    app.add_option("--allow-host", options.hosts,
                   "Name under which WebSockets and /metrics may be asked for; may be given more than once")
        ->check(refuse_empty)
        ->allow_extra_args(false);
    app.add_option("--connections-per-address", options.connections_per_address,
                   "Most connections at once of one address (IPv6: a /64), 0 for any number (default 16; on "
                   "loopback any number)")
        ->check(CLI::Range(0U, most_connections));
    app.add_option(
           "--logins-per-address", options.logins_per_address,
           "Most logins a second of one address (IPv6: a /64), also on loopback, 0 for any number; four times as many at once, "
           "and twice as many wait for their turn")
        ->check(CLI::Range(0U, most_logins))
        ->capture_default_str();
    app.add_option("--drain-ms", options.drain_ms,
                   "Milliseconds from SIGTERM, when /readyz turns 503, until the port is closed")
        ->check(CLI::Range(0U, longest_drain_ms))
        ->capture_default_str();
}

void check(const DoorOptions& options) {
    if (options.tls_cert.empty() != options.tls_key.empty())
        throw OperatorError(options.tls_cert.empty()
                                ? "--tls-key needs the certificate too: give --tls-cert FILE"
                                : "--tls-cert needs its key too: give --tls-key FILE");
}

std::string text_of(const DoorOptions& options) {
    const auto list = [](const std::vector<std::string>& names) {
        return names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, " "));
    };
    return fmt::format(
        "TLS {}, plaintext {}, origins {}, hosts {}, connections per address {}, logins per address {}, drain {} ms",
        options.tls() ? fmt::format("{} {}", options.tls_cert.string(), options.tls_key.string()) : "none",
        options.allow_plaintext ? "for all" : "on loopback only", list(options.origins), list(options.hosts),
        options.connections_per_address ? fmt::format("{}", *options.connections_per_address)
                                        : "16 (loopback: any)",
        options.logins_per_address == 0 ? "any" : fmt::format("{} a second", options.logins_per_address),
        options.drain_ms);
}

DoorPolicy policy_of(const DoorOptions& options, const std::vector<std::string>& bind) {
    DoorPolicy policy;
    policy.allow_plaintext = options.allow_plaintext;
    policy.origins = options.origins;
    policy.hosts = options.hosts;
    policy.addresses = bind;
    if (options.connections_per_address)
        policy.connections_per_address = policy.connections_per_loopback_address =
            *options.connections_per_address;
    return policy;
}

}  // namespace trochoid
