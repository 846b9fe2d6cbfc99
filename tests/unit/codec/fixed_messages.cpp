#include "tests/unit/codec/fixed_messages.hpp"

#include "protocol/model/self_check.hpp"

namespace trochoid {

namespace {

ViewState fixed_view() {
    ViewState v;
    v.position = {-5'000'000'000, 1'234'567};
    v.altitude = 20 * 1024;
    v.qx = 0.0F, v.qy = 0.6F, v.qz = 0.0F, v.qw = 0.8F;
    v.vx = -12.5F;
    return v;
}

ClientHello client_hello() {
    ClientHello h;
    h.protocol_min = h.protocol_max = h.model = 1;
    h.schema_hash = 0x0123456789abcdefULL;
    h.software = "golden client";
    h.world = "fj\xc3\xb8rd";
    h.token = "";
    h.view = fixed_view();
    h.regions = {{{-17, 4096}, 2048}};
    h.clock_stamp_us = 1'700'000'000'000'000;
    return h;
}

Command start_wind() {
    StartWind w;
    w.speed = 12.5F;
    w.towards_degrees = 202.5F;
    w.origin = {1024, -2048};
    w.fetch = 20'480'000;
    w.width = 10'240'000;
    w.seed = 42;
    return {7, {1'000'000}, true, w};
}

ServerHello server_hello() {
    ServerHello h;
    h.protocol = h.model = 1;
    h.schema_hash = 0xfedcba9876543210ULL;
    h.software = "golden server";
    h.session = 99;
    h.world = "fj\xc3\xb8rd";
    for (size_t i = 0; i < 16; ++i) h.instance.bytes[i] = static_cast<uint8_t>(17 * i);
    h.log_position = {3};
    h.clock = {2, {5'000'000}, 123'456'789, 1U << 15};
    h.client_stamp_us = 1'700'000'000'000'000;
    h.server_now_us = 123'999'999;
    h.challenge_seed = 2024;
    h.challenge_count = 64;
    h.projection = "+proj=utm +zone=32";
    h.origin_lon = 5.25;
    h.origin_lat = 60.5;
    h.terrain = {-65536, 131072, 15, 513, 257, 5, -61440};
    return h;
}

Delta delta() {
    Delta d;
    d.result = 5;
    d.piece = 1;
    d.last = true;
    d.base = 4;
    d.base_hash = 0x1111;
    d.state_hash = 0x2222;
    d.key.anchor = fixed_view();
    d.key.slack = 4096;
    d.key.regions = {{{0, 0}, 1024}};
    d.key.log_position = {3};
    d.key.until = {60'000'000};
    d.watermark = {5'500'000};
    const Sea sea = reference_sea();
    for (const auto& box : sea.boxes()) {
        d.change.boxes.push_back(std::make_shared<WaveTrainBox>(box->record));
        for (const auto& field : box->fields)
            for (const BlockKey key : {BlockKey{-2, -2}, BlockKey{0, 1}})
                d.change.blocks.push_back({field->id(), field->step_log2(), field->share(key), 0});
    }
    d.change.patches = {{{16, -1, 7}, {{{1}, 2}, {{2}, 3}}, 0.125F, 0.25F},
                        {{20, 0, 0}, {{{2}, 1}}, 0.0F, 0.5F}};
    d.change.removed_boxes = {{9}};
    d.change.removed_blocks = {{{4}, {-3, 3}}};
    d.change.removed_patches = {{18, 5, -6}};
    return d;
}

TerrainTiles tiles() {
    TerrainTile t;
    t.key = {2, 1, 0};
    t.origin_x = -65536 + (int64_t{64} << 17);
    t.origin_z = 131072;
    t.spacing_log2 = 17;
    t.height_step_log2 = 5;
    for (int x = 0; x < 65; ++x)
        for (int z = 0; z < 65; ++z) t.heights.push_back(static_cast<int16_t>(x * x - 40 * z + (x * z) % 7));
    return {{t}};
}

SampleReply samples() {
    SampleReply r{11, {77'000'000}, {3}, {}};
    const SeaInstant sea(reference_sea(), r.time);
    for (int64_t i = 0; i < 4; ++i) r.samples.push_back(sea.evaluate({i * 100'003, -i * 51'001}));
    return r;
}

}  // namespace

std::vector<FixedMessage> fixed_messages() {
    const ClientMessage client[] = {client_hello(), ViewUpdate{2, fixed_view()}, Ack{5, 0x2222, 900, 0x3333},
                                    start_wind()};
    const char* client_names[] = {"hello", "view", "ack", "start_wind"};
    const ServerMessage server[] = {
        server_hello(), delta(), tiles(), samples(),
        Goodbye{ErrorCode::shutting_down, "come back in a second", true, 1000, 0, 0}};
    const char* server_names[] = {"hello", "delta", "terrain_tile", "samples", "goodbye"};
    std::vector<FixedMessage> all;
    for (size_t i = 0; i < std::size(client); ++i)
        all.push_back({"client", client_names[i], encode(client[i])});
    for (size_t i = 0; i < std::size(server); ++i)
        all.push_back({"server", server_names[i], encode(server[i])});
    const Sea sea = reference_sea();
    const WaveTrainBox& box = sea.boxes()[1]->record;
    all.push_back({"event", "box_started", encode(LogEvent{1, {3'000'000}, BoxStarted{box, "wind 1", {}}})});
    all.push_back({"event", "clock_changed",
                   encode(LogEvent{2, {5'000'000}, ClockChanged{{2, {5'000'000}, 123'456'789, 0}}})});
    return all;
}

Bytes encoded_again(const FixedMessage& message) {
    const auto again = [](const auto& result) { return result ? encode(*result) : Bytes{}; };
    if (message.direction == "client") return again(decode_client(message.bytes));
    if (message.direction == "server") return again(decode_server(message.bytes));
    return again(decode_event(message.bytes));
}

}  // namespace trochoid
