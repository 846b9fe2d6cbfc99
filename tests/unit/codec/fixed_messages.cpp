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
    h.protocol_min = h.protocol_max = h.model = 2;
    h.schema_hash = 0x0123456789abcdefULL;
    h.software = "golden client";
    h.world = "fj\xc3\xb8rd";
    h.token = "";
    h.view = fixed_view();
    h.regions = {{{-17, 4096}, 2048}};
    h.clock_stamp_us = 1'700'000'000'000'000;
    return h;
}

/// Of a client that comes again.
ClientHello client_hello_again() {
    ClientHello h = client_hello();
    h.protocol_max = 3;
    h.capabilities = capability_probes | capability_resume;
    for (uint8_t i = 0; i < 40; ++i) h.ticket.push_back(static_cast<uint8_t>(3 * i));
    ResumeState& r = h.resume.emplace();
    for (size_t i = 0; i < 16; ++i) r.instance.bytes[i] = static_cast<uint8_t>(17 * i);
    r.key.anchor = fixed_view();
    r.key.slack = 4096;
    r.key.regions = h.regions;
    r.key.log_position = {3};
    r.key.until = {60'000'000};
    r.state_hash = 0x2222;
    r.log_position = {4};
    r.log_hash = 0x4444;
    h.last_code = ErrorCode::shutting_down;
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
    w.spectrum = Spectrum::neumann;
    w.spreading = Spreading::hasselmann;
    w.directions = 4;
    w.reference_depth = 12.5F;
    w.roundness = 0.25F;
    w.irregularity = 0.5F;
    w.noise = 0.03125F;
    w.vx = -15.0F;
    w.vz = 2.5F;
    return {7, {1'000'000}, true, w};
}

ChangeLand breakwater() { return {{{1024, -2048}, {512'000, 0}, {600'000, 300'000}}, 12.5F, 4.0F, false}; }

/// A box with all that a plain one is without; no sea of use.
WaveTrainBox laden_box() {
    WaveTrainBox b;
    b.id = {12};
    b.first_train = {301};
    b.origin = {-1'000'000, 2'000'000};
    b.length = 40'960'000;
    b.width = 20'480'000;
    b.begin = {7'000'000};
    b.raised_us = 900'000'000;
    b.fade_us = 10'000'000;
    b.build_up_us = 600'000'000;
    b.end = {7'200'000'000};
    b.decay_us = 60'000'000;
    b.roundness = 9000;
    b.trains = {{40018, 8021, 1613943558211ULL, 77, 0.75F, 0.5F, {6}}};
    b.overlays = {{{5}, {3}}, {{6}, {5}}};
    b.course = {{{7'000'000}, 3'600'000'000, b.origin, 171'800, -85'900},
                {{900'000'000}, 1'800'000'000, {0, 0}, 0, 171'800}};
    b.irregular = {13107, 6000, 1200, -1500, 7000, 240'000'000'000ULL, 1U << 30, 3U << 30};
    b.noise = {0.0625F, 30000, 4, 10, 20, false, 99};
    return b;
}

WaveTrainBox ship_box() {
    WaveTrainBox b;
    b.id = {13};
    b.first_train = {302};
    b.length = 4'096'000;
    b.width = 2'048'000;
    b.begin = {8'000'000};
    b.course = {{{8'000'000}, 3'600'000'000, {0, 0}, 171'800, 0}};
    b.wake = {0.5F, 0.75F, 1.0F, 16'777'216, 85'900};
    return b;
}

ServerHello server_hello() {
    ServerHello h;
    h.protocol = h.model = 2;
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

ServerHello server_hello_again() {
    ServerHello h = server_hello();
    h.protocol = 3;
    h.role = Role::admin;
    h.capabilities = capability_probes | capability_resume;
    h.resumed = true;
    for (uint8_t i = 0; i < 40; ++i) h.ticket.push_back(static_cast<uint8_t>(255 - i));
    h.ticket_life_ms = 600'000;
    h.last_session = 98;
    h.last_code = ErrorCode::no_progress;
    return h;
}

ProbeReply probe_reply() {
    return {12,
            5,
            false,
            {77'000'000},
            {{0x1111, {{{1}, 0, 0x2222}, {{1}, 1, 0x3333}}}, {0x4444, {}}, {0x5555, {{{13}, 0, 0x6666}}}}};
}

/// The first and the last block of a field.
void add_two_blocks(Delta& d, const LandField& field) {
    const auto blocks = field.blocks();
    for (const auto& block : {blocks.front(), blocks.back()})
        d.change.blocks.push_back({field.id(), field.step_log2(), block, 0});
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
        for (const auto& top : box->fields)
            for (const LandField* field = top.get(); field != nullptr; field = field->base().get())
                add_two_blocks(d, *field);
    }
    d.change.patches = {{{16, -1, 7}, {{{1}, 2}, {{2}, 3}}, 0.125F, 0.25F},
                        {{20, 0, 0}, {{{2}, 1}}, 0.0F, 0.5F}};
    d.change.removed_boxes = {{9}};
    d.change.removed_blocks = {{{4}, {-3, 3}}};
    d.change.removed_patches = {{18, 5, -6}};
    return d;
}

Delta laden_delta() {
    Delta d;
    d.result = 6;
    d.last = true;
    d.base = 5;
    d.key.anchor = fixed_view();
    for (const WaveTrainBox& box : {laden_box(), ship_box()})
        d.change.boxes.push_back(std::make_shared<WaveTrainBox>(box));
    auto block = std::make_shared<LandBlock>();
    block->key = {-1, 2};
    for (size_t i = 0; i < block->orbit.size(); ++i) {
        block->shift[i] = static_cast<int32_t>(100 * i);
        block->gain[i] = static_cast<uint16_t>(unit_node_gain - 10 * i);
        block->orbit[i] = static_cast<uint16_t>(unit_node_orbit + 20 * i);
    }
    d.change.blocks = {{{6}, 16, block, 0}};
    return d;
}

/// Patches as planes: runs, boxes that come and go, counts of 0 and 256, levels and signs that change.
Delta delta_of_patches() {
    Delta d;
    d.result = 7;
    d.last = true;
    d.base = 6;
    d.key.anchor = fixed_view();
    d.patch_form = PatchForm::planes;
    for (int32_t z = -3; z < 4; ++z)
        d.change.patches.push_back(
            {{15, -2, z}, {{{1}, 8}, {{7}, 256}}, 0.0F, 0.001F * static_cast<float>(z + 4)});
    d.change.patches.push_back({{16, 0, 2}, {{{7}, 255}}, 0.125F, 0.25F});
    d.change.patches.push_back({{16, 1, -2}, {}, 0.125F, 0.25F});
    d.change.patches.push_back({{26, -512, 511}, {{{1}, 0}, {{7}, 4}, {{300'000}, 1}}, 1.5F, 3.4e38F});
    d.change.removed_patches = {{15, -1, -1}, {15, -1, 0}, {22, 8191, -8192}};
    return d;
}

BoxSummary summary() {
    return {{13}, "MS M\xc3\xa5ke", {8'000'000}, end_of_time, 60'000'000, 0, 0.5F, 0.0F, 67.5F,
            1.0F, BoxKind::ship,    {4096, 0},   10.0F,       -0.5F,      {}};
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
    const StartShip ship{{4096, -8192}, 67.5F, 10.0F, 120.0F, 18.0F, "MS M\xc3\xa5ke"};
    const ClientMessage client[] = {
        client_hello(),
        ViewUpdate{2, fixed_view()},
        Ack{5, 0x2222, 900, 0x3333},
        start_wind(),
        Command{8, {2'000'000}, false, ship},
        Command{9, {3'000'000}, false, Steer{{13}, 90.0F, 7.5F}},
        Command{10, {4'000'000}, true, breakwater()},
        client_hello_again(),
        Command{11, {5'000'000}, false, SkipTime{600'000'000}},
        Probe{12, 5, {77'000'000}, {{100'003, -51'001}, {4096, -8192}}},
        Desync{13, 5, {77'000'000}, {100'003, -51'001}, {16, 1, -1}, {12}, 2, 0x7777, 0x8888}};
    const char* client_names[] = {"hello",      "view",  "ack",         "start_wind",
                                  "start_ship", "steer", "change_land", "hello_again",
                                  "skip_time",  "probe", "desync"};
    const BoxList list{4, {9'000'000}, {summary()}, true};
    const ServerMessage server[] = {
        server_hello(),
        delta(),
        laden_delta(),
        tiles(),
        samples(),
        list,
        Goodbye{ErrorCode::shutting_down, "come back in a second", true, 1000, 0, 0},
        server_hello_again(),
        probe_reply(),
        delta_of_patches()};
    const char* server_names[] = {
        "hello",    "delta",   "delta_of_laden_boxes", "terrain_tile", "samples",
        "box_list", "goodbye", "hello_again",          "probe_reply",  "delta_of_patches"};
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
    all.push_back({"event", "box_steered",
                   encode(LogEvent{3, {900'000'000}, BoxSteered{{12}, laden_box().course[1]}})});
    all.push_back({"event", "land_changed",
                   encode(LogEvent{4, {7'000'000}, LandChanged{breakwater(), {{{3}, laden_box()}}}})});
    return all;
}

Bytes encoded_again(const FixedMessage& message) {
    const auto again = [](const auto& result) { return result ? encode(*result) : Bytes{}; };
    if (message.direction == "client") return again(decode_client(message.bytes));
    if (message.direction == "server") return again(decode_server(message.bytes));
    return again(decode_event(message.bytes));
}

}  // namespace trochoid
