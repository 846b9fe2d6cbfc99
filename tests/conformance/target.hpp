#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/net/endpoint.hpp"
#include "protocol/codec/messages.hpp"
#include "protocol/login/login_token.hpp"
#include "protocol/login/signing_key.hpp"
#include "tests/conformance/stream.hpp"

namespace trochoid::conformance {

/// Where a login's right to change the sea comes from.
class Tokens {
public:
    Tokens() = default;
    /// One token for all logins, for servers that take it more than once; what it allows is seen at the login.
    explicit Tokens(std::string fixed) : fixed_(std::move(fixed)) {}
    /// A fresh one for each login.
    explicit Tokens(SigningKey key) : key_(std::move(key)) {}

    bool any() const { return !fixed_.empty() || key_; }
    /// Skipped where there are none.
    std::string token(Role role, const std::string& world) const;
    /// For cases about tokens themselves; Skipped where there is none.
    const SigningKey& key() const;

private:
    std::string fixed_;
    std::optional<SigningKey> key_;
};
/// The wall clock.
UnixSeconds unix_now();
/// A token that a server has to take once, now.
LoginToken usual_token(Role role, const std::string& world);

/// How far a way goes that --connect, or --transport, tells.
enum class Way : uint8_t {
    whole,  ///< up to where messages of the protocol go
    bytes,  ///< inside TLS where the address says so, but without a WebSocket
    plain,  ///< TCP alone
};
/// A new connection. Failed where none comes about.
std::unique_ptr<Stream> stream_by(const Endpoint& server, Way way, Milliseconds within);

/// The server under test, and what a first look at it has told: cases take their places and limits from here.
struct Target {
    Endpoint server;
    Tokens tokens;
    Milliseconds patience{5000};      ///< for an answer
    Milliseconds longest_wait{8000};  ///< longer deadlines of the server are not waited for

    ServerHello hello;
    std::vector<BoxSummary> boxes;
    LatticePoint place;  ///< where there are waves to look at, inside the world
};

/// Connects once and looks: Failed where no session comes about.
void explore(Target& target);

/// A camera over the target's place that sees water all round: altitude in metres, looking down by 20 degrees.
ViewState view_of_water(const Target& target, double altitude_m = 20.0);
/// A camera that sees no water at all.
ViewState view_of_sky();

}  // namespace trochoid::conformance
