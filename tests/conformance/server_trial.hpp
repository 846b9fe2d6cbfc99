#pragma once
#include <deque>
#include <string>
#include <utility>

#include "tests/conformance/server_peer.hpp"

namespace trochoid::conformance {

/// One run of a case that tests a server: its connections, which end with it.
class ServerTrial final : public Trial {
public:
    explicit ServerTrial(const Target& target) : target_(target) {}

    const Target& target() const { return target_; }
    /// A new connection; nothing has been sent.
    ServerPeer& connect(Way way = Way::whole) { return peers_.emplace_back(target_, *this, way); }
    /// A new session.
    ServerPeer& log_in(const ClientHello& hello = ServerPeer::usual_hello()) {
        ServerPeer& peer = connect();
        peer.log_in(hello);
        return peer;
    }
    ServerPeer& log_in_as(Role role, const ClientHello& hello = ServerPeer::usual_hello()) {
        ServerPeer& peer = connect();
        peer.log_in_as(role, hello);
        return peer;
    }

private:
    const Target& target_;
    std::deque<ServerPeer> peers_;
};

using ServerBody = std::function<void(ServerTrial&)>;

/// A case about a server.
inline Case server_case(std::string id, std::string title, ServerBody body) {
    Case made;
    made.id = std::move(id);
    made.title = std::move(title);
    made.side = Side::server;
    made.body = [body = std::move(body)](Trial& trial) { body(dynamic_cast<ServerTrial&>(trial)); };
    return made;
}

// One function a folder's file: each adds its cases.
namespace server {
void add_stream_cases(Catalogue& catalogue);
void add_front_cases(Catalogue& catalogue);
void add_tls_cases(Catalogue& catalogue);
void add_land_change_cases(Catalogue& catalogue);
void add_session_cases(Catalogue& catalogue);
void add_clock_cases(Catalogue& catalogue);
void add_result_cases(Catalogue& catalogue);
void add_evaluation_cases(Catalogue& catalogue);
void add_arithmetic_cases(Catalogue& catalogue);
void add_terrain_cases(Catalogue& catalogue);
void add_command_cases(Catalogue& catalogue);
void add_login_cases(Catalogue& catalogue);
void add_probe_cases(Catalogue& catalogue);
void add_golden_cases(Catalogue& catalogue);
void add_buffer_cases(Catalogue& catalogue);
void add_field_cases(Catalogue& catalogue);
void add_command_field_cases(Catalogue& catalogue);
}  // namespace server

}  // namespace trochoid::conformance
