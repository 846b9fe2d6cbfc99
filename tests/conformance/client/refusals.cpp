#include "tests/conformance/client/refusals.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/units/version.hpp"
#include "tests/conformance/kit_sea.hpp"

namespace trochoid::conformance::client {

void need_version(const ClientPeer& peer, uint16_t version) {
    if (peer.ours().protocol < version)
        throw Skipped{fmt::format("the client does not offer version {}", version)};
}

Case refused(std::string id, std::string title, Bytes payload, Due due, uint16_t since) {
    return client_case(std::move(id), std::move(title),
                       [payload = std::move(payload), due, since](ClientTrial& trial) {
                           ClientPeer& peer = trial.welcome();
                           need_version(peer, since);
                           peer.send_payload(payload);
                           peer.expect_goodbye(due);
                       });
}

Case refused_first(std::string id, std::string title, Bytes payload, Due due) {
    return client_case(std::move(id), std::move(title),
                       [payload = std::move(payload), due](ClientTrial& trial) {
                           ClientPeer& peer = trial.accept();
                           peer.await_hello();
                           peer.send_payload(payload);
                           peer.expect_goodbye(due);
                       });
}

Case taken(std::string id, std::string title, Bytes payload) {
    return client_case(std::move(id), std::move(title), [payload = std::move(payload)](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome();
        peer.send_payload(payload);
        peer.expect_service();
    });
}

Case hello_refused(std::string id, std::string title, std::function<Bytes(ServerHello)> make, Due due) {
    return client_case(std::move(id), std::move(title), [make = std::move(make), due](ClientTrial& trial) {
        ClientPeer& peer = trial.accept();
        peer.await_hello();
        peer.send_payload(make(peer.usual_hello()));
        peer.expect_goodbye(due);
    });
}

Case hello_taken(std::string id, std::string title, std::function<void(ServerHello&)> change) {
    return client_case(std::move(id), std::move(title), [change = std::move(change)](ClientTrial& trial) {
        trial.welcome(change).expect_service();
    });
}

Delta legal_delta() {
    const InterestState state = laden_sea();
    Delta delta;
    delta.result = 1;
    delta.last = true;
    delta.state_hash = hash_of(state);
    delta.key.regions = {{{0, 0}, 100 * 1024}};
    delta.key.until = {kit_sea_begin.us * 2};
    delta.watermark = kit_sea_begin;
    delta.change = difference({}, state);
    return delta;
}

namespace {

ServerHello plain_hello() {
    ServerHello hello;
    hello.protocol = protocol_version_max;
    hello.model = model_version;
    hello.software = "trochoid-conformance";
    hello.world = "conformance";
    hello.clock.start = kit_sea_begin;
    return hello;
}

TerrainTile flat_tile() {
    constexpr size_t samples = 65 * 65;
    TerrainTile tile;
    tile.spacing_log2 = 15;
    tile.height_step_log2 = 5;
    tile.heights.assign(samples, -40);
    return tile;
}

BoxSummary ship_line() {
    BoxSummary line;
    line.box = {5};
    line.name = "a ship";
    line.end = end_of_time;
    line.trains = 1;
    line.kind = BoxKind::ship;
    line.hull = {120.0F, 17.0F};
    return line;
}

std::vector<LegalMessage> made() {
    ClockReply clock;
    clock.sequence = 1;
    CommandReply command;
    command.sequence = 1;
    command.message = "done";
    BoxList boxes;
    boxes.sequence = 1;
    boxes.boxes = {ship_line(), ship_line()};
    SampleReply samples;
    samples.sequence = 1;
    samples.samples.resize(2);
    RaysReply rays;
    rays.sequence = 1;
    rays.rays.resize(1);
    rays.rays[0].points = {{{1, 2}, ActionKind::shoaling_starts}, {{3, 4}, ActionKind::recovered}};
    Goodbye goodbye;
    goodbye.code = ErrorCode::shutting_down;
    goodbye.message = "until tomorrow";
    ProbeReply probe;
    probe.sequence = 1;
    probe.result = 1;
    probe.points = {{1, {{{1}, 0, 5}, {{1}, 1, 6}}}};
    return {{"ServerHello", plain_hello()}, {"ClockReply", clock},
            {"Delta", legal_delta()},       {"TerrainTiles", TerrainTiles{{flat_tile()}}},
            {"CommandReply", command},      {"BoxList", boxes},
            {"SampleReply", samples},       {"RaysReply", rays},
            {"Goodbye", goodbye},           {"ProbeReply", probe}};
}

}  // namespace

const std::vector<LegalMessage>& legal_messages() {
    static const std::vector<LegalMessage> all = made();
    return all;
}

}  // namespace trochoid::conformance::client
