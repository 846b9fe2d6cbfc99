#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "protocol/codec/codec.hpp"
#include "protocol/codec/patch_coding.hpp"
#include "protocol/codec/plane_coding.hpp"
#include "server_generated.h"
#include "tests/unit/codec/random_messages.hpp"

// What the FlatBuffers verifier lets through and the standard forbids, server to client.
namespace trochoid {
namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

ErrorCode refusal(const Bytes& bytes) {
    const auto result = decode_server(bytes);
    if (result) return ErrorCode::none;
    EXPECT_FALSE(result.error().message.empty());
    return result.error().code;
}

ErrorCode refusal(const ServerMessage& message) { return refusal(encode(message)); }

template <class Table, class Bend>
ErrorCode bent(const ServerMessage& message, Bend bend) {
    Bytes bytes = encode(message);
    EXPECT_EQ(refusal(bytes), ErrorCode::none);
    bend(*static_cast<Table*>(wire_fb::GetMutableServerEnvelope(bytes.data())->mutable_body()));
    return refusal(bytes);
}

Delta full_delta() {
    Dice dice(31);
    Delta d = std::get<Delta>(random_server_message(dice, 2));
    d.patch_form = PatchForm::lists;
    d.change = random_change(dice, 2, 2, 3, 1);
    // Not a ship: tests bend its trains.
    d.change.boxes[0] = std::make_shared<WaveTrainBox>(random_box(dice, d.change.boxes[0]->id.value, 5));
    for (PatchDescriptor& p : d.change.patches) p.boxes = {{{1}, 2}, {{5}, 6}};
    return d;
}

template <class Bend>
ErrorCode changed_delta(Bend bend) {
    Delta d = full_delta();
    bend(d);
    return refusal(d);
}

template <class Bend>
ErrorCode bent_delta(Bend bend) {
    return bent<wire_fb::Delta>(full_delta(), bend);
}

TEST(HostileServer, DeltasWhoseValuesAreOutOfRange) {
    const auto is = [](ErrorCode code, auto bend) { EXPECT_EQ(changed_delta(bend), code); };
    is(ErrorCode::none, [](Delta&) {});
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.result = 0, d.base = 0; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.base = d.result; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.watermark.us = INT64_MIN; });
    is(ErrorCode::value_out_of_range,
       [](Delta& d) { std::swap(d.key.from, d.key.until), d.key.from.us += 1; });
    is(ErrorCode::not_finite, [](Delta& d) { d.key.slack_tangent = not_a_number; });
    is(ErrorCode::not_a_unit_quaternion, [](Delta& d) { d.key.anchor.qw += 0.5F; });
    is(ErrorCode::too_many_regions, [](Delta& d) { d.key.regions.resize(33); });
    is(ErrorCode::value_out_of_range, [](Delta& d) { std::swap(d.change.boxes[0], d.change.boxes[1]); });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.boxes[1] = d.change.boxes[0]; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.blocks[0].step_log2 = 11; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.blocks[0].field = {0}; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.patches[1].key.level = 14; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.patches[1].key = {26, 512, 0}; });
    is(ErrorCode::not_finite, [](Delta& d) { d.change.patches[2].left_out = not_a_number; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.patches[2].height_error = -1.0F; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.patches[0].boxes = {{{5}, 1}, {{1}, 1}}; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.patches[0].boxes = {{{5}, 257}}; });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.patches.resize(1025); });
    is(ErrorCode::value_out_of_range, [](Delta& d) { d.change.removed_patches[0].level = 40; });
}

ErrorCode with_changed_box(void (*change)(WaveTrainBox&)) {
    return changed_delta([&](Delta& d) {
        WaveTrainBox box = *d.change.boxes[0];
        change(box);
        d.change.boxes[0] = std::make_shared<WaveTrainBox>(box);
    });
}

TEST(HostileServer, BoxesAndBlocksThatMayNotEnterTheSea) {
    EXPECT_EQ(with_changed_box([](WaveTrainBox&) {}), ErrorCode::none);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.trains[0].amplitude = not_a_number; }),
              ErrorCode::not_finite);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.trains[0].amplitude = 33.0F; }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.trains[0].kx = b.trains[0].kz = 0; }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.trains.clear(), b.noise = {}, b.wake = {}; }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.ux = 0, b.uz = 0; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.length = -1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.ramp_side = 0; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(with_changed_box([](WaveTrainBox& b) { b.end = b.begin - 1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(changed_delta([](Delta& d) {
                  LandBlock torn = *d.change.blocks[0].block;
                  torn.shift[5] = (1 << 30) - 1;
                  d.change.blocks[0].block = std::make_shared<LandBlock>(torn);
              }),
              ErrorCode::value_out_of_range);
}

/// A ship, or a box with everything but a wake, changed.
ErrorCode with_laden_box(bool ship, void (*change)(WaveTrainBox&)) {
    return changed_delta([&](Delta& d) {
        Dice dice(33);
        WaveTrainBox box = ship ? random_ship(dice, 1) : random_box(dice, 1, 3);
        if (!ship) {
            box.roundness = full_roundness;
            for (WaveTrain& t : box.trains) t.kx = 40000, t.kz = 3;
            box.length = box.width = 1 << 20;
            box.raised_us = box.fade_us = 1000;
            box.overlays = {{{2}, {1}}, {{3}, {2}}};
            box.course = {{{10}, 1000, {0, 0}, 1, 1}, {{20}, 1000, {5, 5}, 1, 1}};
            box.origin = {0, 0};
            box.irregular = {full_irregularity, 1, 1, 1, 1, 1, 1, 1};
            box.noise = {1.0F, 1, 1, 9, 19, true, 1};
        }
        change(box);
        d.change.boxes = {std::make_shared<WaveTrainBox>(box)};
    });
}

TEST(HostileServer, WhatAPlainBoxIsWithoutIsCheckedToo) {
    const auto is = [](ErrorCode code, void (*change)(WaveTrainBox&)) {
        EXPECT_EQ(with_laden_box(false, change), code);
    };
    constexpr ErrorCode range = ErrorCode::value_out_of_range;
    is(ErrorCode::none, [](WaveTrainBox&) {});
    is(ErrorCode::none, [](WaveTrainBox& b) { b.trains.clear(); });
    is(range, [](WaveTrainBox& b) { b.trains.clear(), b.noise = {}; });
    is(range, [](WaveTrainBox& b) { b.roundness = full_roundness + 1; });
    is(range, [](WaveTrainBox& b) { b.width = 0; });
    is(range, [](WaveTrainBox& b) { b.raised_us = -1; });
    is(range, [](WaveTrainBox& b) { b.raised_us = INT64_MAX; });
    is(range, [](WaveTrainBox& b) { b.fade_us = -1; });
    is(range, [](WaveTrainBox& b) { b.fade_us = INT64_MAX; });
    is(range, [](WaveTrainBox& b) { b.overlays[0].base = {2}; });
    is(range, [](WaveTrainBox& b) { b.overlays[1].base = {9}; });
    is(range, [](WaveTrainBox& b) { b.overlays[1].field = {2}; });
    is(range, [](WaveTrainBox& b) { b.overlays[0].base = {0}; });
    is(range, [](WaveTrainBox& b) { b.overlays.resize(257, {{3}, {2}}); });
    is(ErrorCode::too_many_legs, [](WaveTrainBox& b) {
        b.course.clear();
        for (int64_t i = 0; i < 65; ++i) b.course.push_back({{i}, 10, {0, 0}, 0, 0});
    });
    is(range, [](WaveTrainBox& b) { b.course[1].from = b.course[0].from; });
    is(range, [](WaveTrainBox& b) { b.course[1].duration_us = -1; });
    is(range, [](WaveTrainBox& b) { b.course[1].vx = INT32_MIN; });
    is(range, [](WaveTrainBox& b) { b.course[1].origin.x = world_bound + 1; });
    is(range, [](WaveTrainBox& b) { b.irregular.share = full_irregularity + 1; });
    is(range, [](WaveTrainBox& b) { b.irregular.ukx = INT32_MIN; });
    is(ErrorCode::not_finite, [](WaveTrainBox& b) { b.noise.amplitude = not_a_number; });
    is(range, [](WaveTrainBox& b) { b.noise.amplitude = 33.0F; });
    is(range, [](WaveTrainBox& b) { b.noise.octaves = 0; });
    is(range, [](WaveTrainBox& b) { b.noise.octaves = 13; });
    is(range, [](WaveTrainBox& b) { b.noise.octaves = 7; });
    is(range, [](WaveTrainBox& b) { b.noise.step_log2 = 5; });
    is(range, [](WaveTrainBox& b) { b.noise.step_log2 = 255; });
    is(range, [](WaveTrainBox& b) { b.noise.period_log2 = 13; });
    is(range, [](WaveTrainBox& b) { b.noise.period_log2 = 64; });
}

TEST(HostileServer, ShipsAreCheckedToo) {
    const auto is = [](ErrorCode code, void (*change)(WaveTrainBox&)) {
        EXPECT_EQ(with_laden_box(true, change), code);
    };
    constexpr ErrorCode range = ErrorCode::value_out_of_range;
    is(ErrorCode::none, [](WaveTrainBox&) {});
    is(range, [](WaveTrainBox& b) { b.wake = {}; });
    is(ErrorCode::not_finite, [](WaveTrainBox& b) { b.wake.transverse = not_a_number; });
    is(ErrorCode::not_finite, [](WaveTrainBox& b) { b.wake.diverging = not_a_number; });
    is(ErrorCode::not_finite, [](WaveTrainBox& b) { b.wake.choppiness = not_a_number; });
    is(range, [](WaveTrainBox& b) { b.wake.transverse = 33.0F; });
    is(range, [](WaveTrainBox& b) { b.wake.diverging = -1.0F; });
    is(range, [](WaveTrainBox& b) { b.wake.choppiness = 4.5F; });
    is(range, [](WaveTrainBox& b) { b.wake.inverse_length = 1; });
    is(range, [](WaveTrainBox& b) { b.wake.inverse_length = UINT32_MAX; });
    is(range, [](WaveTrainBox& b) { b.wake.group_speed = 0; });
    is(range, [](WaveTrainBox& b) { b.wake.group_speed = UINT32_MAX; });
    is(ErrorCode::none, [](WaveTrainBox& b) { b.hull = {500.0F, 500.0F}; });
    is(ErrorCode::not_finite, [](WaveTrainBox& b) { b.hull = {not_a_number, 1.0F}; });
    is(ErrorCode::not_finite, [](WaveTrainBox& b) { b.hull = {10.0F, not_a_number}; });
    is(range, [](WaveTrainBox& b) { b.hull = {0.5F, 0.5F}; });
    is(range, [](WaveTrainBox& b) { b.hull = {501.0F, 10.0F}; });
    is(range, [](WaveTrainBox& b) { b.hull = {10.0F, 0.0F}; });
    is(range, [](WaveTrainBox& b) { b.hull = {10.0F, 11.0F}; });
    is(range, [](WaveTrainBox& b) { b.hull = {0.0F, 1.0F}; });
}

TEST(HostileServer, OrbitsThatAreAllOneMayNotBeWritten) {
    Delta d = full_delta();
    LandBlock plain;
    plain.gain.fill(20000);
    Bytes nodes = code_nodes(plain);
    const size_t without = nodes.size();
    append_plane(nodes, std::span<const uint16_t>(plain.orbit), block_nodes);
    LandBlock back;
    ASSERT_TRUE(read_nodes(std::span(nodes).first(without), back));
    EXPECT_EQ(back, plain);
    const auto result = read_nodes(nodes, back);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::value_out_of_range);
}

TEST(HostileServer, DeltasWhoseListsDoNotBelongTogether) {
    using D = wire_fb::Delta;
    const auto is = [](ErrorCode code, auto bend) { EXPECT_EQ(bent_delta(bend), code); };
    is(ErrorCode::value_out_of_range,
       [](D& d) { d.mutable_blocks()->GetMutableObject(0)->mutate_node_bytes(1); });
    is(ErrorCode::value_out_of_range,
       [](D& d) { d.mutable_blocks()->GetMutableObject(1)->mutate_node_bytes(65535); });
    is(ErrorCode::value_out_of_range,
       [](D& d) { d.mutable_patches()->GetMutableObject(0)->mutate_box_count(65535); });
    is(ErrorCode::value_out_of_range,
       [](D& d) { d.mutable_patches()->GetMutableObject(0)->mutate_box_count(1); });
    is(ErrorCode::value_out_of_range,
       [](D& d) { d.mutable_patch_boxes()->GetMutableObject(0)->mutate_box_index(2); });
    // Varints that never end.
    is(ErrorCode::value_out_of_range,
       [](D& d) { std::fill_n(d.mutable_nodes()->Data(), d.nodes()->size(), uint8_t{0x80}); });
    Delta landed = full_delta();
    WaveTrainBox box = *landed.change.boxes[0];
    for (size_t i = 0; i < box.trains.size(); ++i) box.trains[i].field = {static_cast<uint32_t>(1 + i % 2)};
    landed.change.boxes[0] = std::make_shared<WaveTrainBox>(box);
    EXPECT_EQ(
        bent<D>(landed,
                [](D& d) { d.mutable_boxes()->GetMutableObject(0)->mutable_field_of_train()->Mutate(0, 9); }),
        ErrorCode::value_out_of_range);
}

/// A delta built by hand from a legal key and whatever lists.
template <class Lists>
ErrorCode built_delta(Lists lists) {
    flatbuffers::FlatBufferBuilder b;
    b.ForceDefaults(true);
    const wire_fb::View anchor(0, 0, 0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1, 1);
    const auto regions = b.CreateVectorOfStructs(std::vector<wire_fb::Region>{});
    const auto key = wire_fb::CreateCullKey(b, &anchor, 0, 0, 1, 1, regions);
    const auto delta = lists(b, key);
    wire_fb::FinishServerEnvelopeBuffer(
        b, wire_fb::CreateServerEnvelope(b, 0, wire_fb::ServerBody::Delta, delta.Union()));
    wire_fb::GetMutableServerEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
    return refusal(Bytes(b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()));
}

TEST(HostileServer, MissingParts) {
    using flatbuffers::FlatBufferBuilder;
    using Key = flatbuffers::Offset<wire_fb::CullKey>;
    EXPECT_EQ(built_delta([](FlatBufferBuilder& b, Key key) {
                  return wire_fb::CreateDelta(b, 1, 0, true, 0, 0, 0, key);
              }),
              ErrorCode::none);
    EXPECT_EQ(built_delta([](FlatBufferBuilder& b, Key) { return wire_fb::CreateDelta(b, 1); }),
              ErrorCode::missing_field);
    EXPECT_EQ(built_delta([](FlatBufferBuilder& b, Key key) {
                  const std::vector<wire_fb::BlockHead> heads{{1, 0, 0, 5, 16}};
                  const auto blocks = b.CreateVectorOfStructs(heads);
                  return wire_fb::CreateDelta(b, 1, 0, true, 0, 0, 0, key, 0, 0, 0, blocks);
              }),
              ErrorCode::missing_field);
    EXPECT_EQ(built_delta([](FlatBufferBuilder& b, Key key) {
                  const std::vector<wire_fb::Patch> heads{{0, 0, 0, 0, 1, 16}};
                  const auto patches = b.CreateVectorOfStructs(heads);
                  return wire_fb::CreateDelta(b, 1, 0, true, 0, 0, 0, key, 0, 0, 0, 0, 0, 0, 0, patches);
              }),
              ErrorCode::missing_field);
    EXPECT_EQ(built_delta([](FlatBufferBuilder& b, Key key) {
                  const std::vector<flatbuffers::Offset<wire_fb::Box>> list{wire_fb::CreateBox(b)};
                  const auto boxes = b.CreateVector(list);
                  return wire_fb::CreateDelta(b, 1, 0, true, 0, 0, 0, key, 0, boxes);
              }),
              ErrorCode::missing_field);
    EXPECT_EQ(built_delta([](FlatBufferBuilder& b, Key key) {
                  // 4,000 tables in a vector: the verifier's table limit.
                  const std::vector<flatbuffers::Offset<wire_fb::Box>> list(4000, wire_fb::CreateBox(b));
                  const auto boxes = b.CreateVector(list);
                  return wire_fb::CreateDelta(b, 1, 0, true, 0, 0, 0, key, 0, boxes);
              }),
              ErrorCode::verification_failed);
}

TEST(HostileServer, PatchesInBothForms) {
    using flatbuffers::FlatBufferBuilder;
    using Key = flatbuffers::Offset<wire_fb::CullKey>;
    InterestDelta change;
    change.removed_patches = {{16, 1, 1}};
    const Bytes planes = code_patches(change, {});
    const auto code = [&](bool listed, bool removed, const Bytes& bytes) {
        return built_delta([&](FlatBufferBuilder& b, Key key) {
            const auto patches =
                b.CreateVectorOfStructs(std::vector<wire_fb::Patch>{{0, 0, 0.0F, 0.0F, 0, 16}});
            const auto names = b.CreateVectorOfStructs(std::vector<wire_fb::PatchName>{{1, 1, 16}});
            const auto planes_at = b.CreateVector(bytes);
            return wire_fb::CreateDelta(b, 1, 0, true, 0, 0, 0, key, 0, 0, 0, 0, 0, 0, 0,
                                        listed ? patches : 0, 0, removed ? names : 0, planes_at);
        });
    };
    EXPECT_EQ(code(false, false, planes), ErrorCode::none);
    EXPECT_EQ(code(true, false, planes), ErrorCode::value_out_of_range);
    EXPECT_EQ(code(false, true, planes), ErrorCode::value_out_of_range);
    EXPECT_EQ(code(false, false, {}), ErrorCode::value_out_of_range);
}

TEST(HostileServer, AMisalignedVectorOfStructsIsRefused) {
    // Shift the vector of regions by four bytes inside its own buffer: the verifier of 2.0.8 does not look.
    const Bytes good = encode(ServerMessage{full_delta()});
    Bytes bytes = good;
    auto* delta =
        static_cast<wire_fb::Delta*>(wire_fb::GetMutableServerEnvelope(bytes.data())->mutable_body());
    auto* key = delta->mutable_key();
    const auto* field =
        reinterpret_cast<const flatbuffers::Table*>(key)->GetAddressOf(wire_fb::CullKey::VT_REGIONS);
    auto* offset = bytes.data() + (field - bytes.data());
    const auto target = flatbuffers::ReadScalar<uint32_t>(offset);
    // The vector's length moves to the word behind it, with a new length of 0 written there… of 1, so that it has an element.
    flatbuffers::WriteScalar(offset, target + 4);
    flatbuffers::WriteScalar(offset + target + 4, uint32_t{1});
    EXPECT_EQ(refusal(bytes), ErrorCode::verification_failed);
}

TEST(HostileServer, Hello) {
    const auto is = [](ErrorCode code, auto change) {
        ServerHello h;
        h.protocol = 1;
        h.terrain.columns = h.terrain.rows = 100;
        h.terrain.open_sea_depth = -1000;
        change(h);
        EXPECT_EQ(refusal(ServerMessage{h}), code);
    };
    is(ErrorCode::none, [](ServerHello&) {});
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.protocol = 0; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.role = static_cast<Role>(3); });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.clock.epoch = 0; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.clock.rate_q16 = (16U << 16) + 1; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.clock.monotonic_start_us = INT64_MIN; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.limits.frame_after_login = 1023; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.challenge_count = 65537; });
    is(ErrorCode::not_finite, [](ServerHello& h) { h.origin_lon = std::numeric_limits<double>::infinity(); });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.origin_lat = 91.0; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.terrain.columns = 1; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.terrain.rows = 16386; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.terrain.spacing_log2 = 21; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.terrain.origin_x = 5; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.terrain.origin_z = world_bound; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.terrain.open_sea_depth = 1; });
    is(ErrorCode::value_out_of_range, [](ServerHello& h) { h.projection = std::string(4097, 'p'); });
}

TEST(HostileServer, TilesAndReplies) {
    const auto tile = [](auto change) {
        TerrainTile t;
        t.key = {1, 3, 2};
        t.spacing_log2 = 16;
        t.origin_x = int64_t{3} * 64 * 65536 + 32768;
        t.origin_z = int64_t{2} * 64 * 65536 - 32768;
        t.height_step_log2 = 5;
        t.heights.assign(65 * 65, 7);
        change(t);
        return refusal(ServerMessage{TerrainTiles{{t}}});
    };
    EXPECT_EQ(tile([](TerrainTile&) {}), ErrorCode::none);
    EXPECT_EQ(tile([](TerrainTile& t) { t.key.level = 9; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(tile([](TerrainTile& t) { t.key.x = 128; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(tile([](TerrainTile& t) { t.key.z = -1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(tile([](TerrainTile& t) { t.origin_x += 1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(tile([](TerrainTile& t) { t.spacing_log2 = 0; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(tile([](TerrainTile& t) { t.height_step_log2 = 11; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(tile([](TerrainTile& t) { t.heights.pop_back(); }), ErrorCode::value_out_of_range);
    EXPECT_EQ(tile([](TerrainTile& t) { t.heights.push_back(-7); }), ErrorCode::value_out_of_range);

    SurfaceSample broken;
    broken.vz = not_a_number;
    EXPECT_EQ(refusal(ServerMessage{SampleReply{1, {}, {}, {broken}}}), ErrorCode::not_finite);
    EXPECT_EQ(refusal(ServerMessage{SampleReply{1, {}, {}, std::vector<SurfaceSample>(241)}}),
              ErrorCode::value_out_of_range);
    const WaveRay strange{{}, {}, {{{}, static_cast<ActionKind>(5)}}};
    EXPECT_EQ(refusal(ServerMessage{RaysReply{1, {1}, {strange}, true}}), ErrorCode::value_out_of_range);
    CommandReply unknown_code;
    unknown_code.code = static_cast<ErrorCode>(999);
    EXPECT_EQ(refusal(ServerMessage{unknown_code}), ErrorCode::value_out_of_range);
    ClockReply backwards;
    backwards.server_received_us = 2;
    EXPECT_EQ(refusal(ServerMessage{backwards}), ErrorCode::value_out_of_range);
    ClockReply undecided;
    undecided.verdict = static_cast<Verdict>(3);
    EXPECT_EQ(refusal(ServerMessage{undecided}), ErrorCode::value_out_of_range);
    BoxSummary nameless;
    nameless.name = "two\nlines";
    EXPECT_EQ(refusal(ServerMessage{BoxList{1, {}, {nameless}, true}}), ErrorCode::value_out_of_range);
    const auto summary = [](auto change) {
        BoxSummary s;
        change(s);
        return refusal(ServerMessage{BoxList{1, {}, {s}, true}});
    };
    EXPECT_EQ(summary([](BoxSummary& s) { s.kind = BoxKind::noise; }), ErrorCode::none);
    EXPECT_EQ(summary([](BoxSummary& s) { s.kind = static_cast<BoxKind>(4); }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(summary([](BoxSummary& s) { s.at.z = world_bound + 1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(summary([](BoxSummary& s) { s.vx = not_a_number; }), ErrorCode::not_finite);
    EXPECT_EQ(summary([](BoxSummary& s) { s.vz = not_a_number; }), ErrorCode::not_finite);
    EXPECT_EQ(summary([](BoxSummary& s) { s.hull.length = not_a_number; }), ErrorCode::not_finite);
    EXPECT_EQ(summary([](BoxSummary& s) { s.hull = {10.0F, -1.0F}; }), ErrorCode::value_out_of_range);
}

TEST(HostileServer, EveryCodeOfTheStandardTravels) {
    for (uint32_t code = 0; code <= UINT16_MAX; ++code) {
        Goodbye g;
        g.code = static_cast<ErrorCode>(code);
        // Codes of later versions count as their class; there are seven.
        const bool of_a_class = code == 0 || (code > 100 && code < 800);
        EXPECT_EQ(refusal(ServerMessage{g}) == ErrorCode::none, of_a_class) << code;
    }
    for (const ErrorCode code : {ErrorCode::base_mismatch, ErrorCode::queue_overflow, ErrorCode::too_late,
                                 ErrorCode::internal_error})
        EXPECT_EQ(refusal(ServerMessage{Goodbye{code, "x", false, 0, 0, 0}}), ErrorCode::none);
}

}  // namespace
}  // namespace trochoid
