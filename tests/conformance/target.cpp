#include "tests/conformance/target.hpp"

#include <algorithm>
#include <chrono>

#include "tests/conformance/server_trial.hpp"
#include "tests/conformance/tls_stream.hpp"
#include "tests/conformance/web_stream.hpp"

namespace trochoid::conformance {

std::unique_ptr<Stream> stream_by(const Endpoint& server, Way way, Milliseconds within) {
    auto stream = connect_tcp(server, within);
    if (is_encrypted(server.transport) && way != Way::plain) {
        TlsOffer offer;
        offer.host = server.host;
        offer.ca_file = server.ca_file;
        if (is_web(server.transport)) offer.protocols = {"http/1.1"};
        stream = begin_tls(std::move(stream), offer, within);
    }
    if (is_web(server.transport) && way == Way::whole)
        stream = begin_web(std::move(stream), host_and_port(server), within);
    return stream;
}

ViewState view_of_sky() {
    constexpr float half_turn = 0.70710678F;  // sine and cosine of an eighth of a turn: looks straight up
    ViewState view;
    view.altitude = 1000 * static_cast<int32_t>(lattice_per_metre);
    view.qx = half_turn;
    view.qw = half_turn;
    view.tan_half_width = view.tan_half_height = 0.1F;
    view.viewport_width = view.viewport_height = 16;
    view.accepted_error_px = 100.0F;
    view.patch_budget = 1;
    return view;
}

ViewState view_of_water(const Target& target, double altitude_m) {
    ViewState view;
    view.position = target.place;
    view.altitude = static_cast<int32_t>(altitude_m * static_cast<double>(lattice_per_metre));
    view.qx = -0.17364818F;  // down by 20 degrees: sine and cosine of 10
    view.qw = 0.98480775F;
    view.patch_budget = 256;
    return view;
}

UnixSeconds unix_now() {
    return {static_cast<uint64_t>(
        std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
            .count())};
}

LoginToken usual_token(Role role, const std::string& world) {
    LoginToken token;
    token.role = role;
    token.issued = unix_now();
    token.expiry = {token.issued.value + usual_token_life};
    token.nonce = random_nonce();
    token.world = world;
    return token;
}

const SigningKey& Tokens::key() const {
    if (!key_) throw Skipped{"needs the key that signs tokens: --sign-with"};
    return *key_;
}

std::string Tokens::token(Role role, const std::string& world) const {
    if (!fixed_.empty()) return fixed_;
    if (!key_) throw Skipped{"needs the right to change the sea: --sign-with or --token-file"};
    return sign_token(usual_token(role, world), *key_);
}

void explore(Target& target) {
    ServerTrial trial(target);
    ServerPeer& peer = trial.log_in();
    target.hello = peer.hello();
    target.boxes = peer.ask_boxes().boxes;
    const TerrainInfo& terrain = target.hello.terrain;
    if (terrain.columns > 0) {
        target.place = {terrain.origin_x + ((int64_t{terrain.columns} / 2) << terrain.spacing_log2),
                        terrain.origin_z + ((int64_t{terrain.rows} / 2) << terrain.spacing_log2)};
    } else if (!target.boxes.empty()) {
        constexpr int64_t most = world_bound / 2;
        const LatticePoint at = target.boxes.front().at;
        const auto inside = [most](int64_t v) { return std::clamp(v, -most, most); };
        target.place = {inside(at.x), inside(at.z)};
    }
    Goodbye goodbye;
    goodbye.message = "looked around";
    peer.send(goodbye);
}

}  // namespace trochoid::conformance
