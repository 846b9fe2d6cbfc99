#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "client_generated.h"
#include "event_generated.h"
#include "protocol/codec/codec.hpp"
#include "tests/unit/codec/random_messages.hpp"

// What the FlatBuffers verifier lets through and the standard forbids, client to server.
namespace trochoid {
namespace {

using Builder = flatbuffers::FlatBufferBuilder;
using Offset = flatbuffers::Offset<void>;
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

ErrorCode refusal(const Bytes& bytes) {
    const auto result = decode_client(bytes);
    if (result) return ErrorCode::none;
    EXPECT_FALSE(result.error().message.empty());
    return result.error().code;
}

/// A legal message, bent in place through FlatBuffers' mutable accessors.
template <class Table, class Bend>
ErrorCode bent(const ClientMessage& message, Bend bend) {
    Bytes bytes = encode(message);
    EXPECT_EQ(refusal(bytes), ErrorCode::none);
    bend(*static_cast<Table*>(wire_fb::GetMutableClientEnvelope(bytes.data())->mutable_body()));
    return refusal(bytes);
}

/// A message built by hand.
Bytes built(wire_fb::ClientBody tag, const std::function<Offset(Builder&)>& body) {
    Builder b;
    b.ForceDefaults(true);
    const Offset table = body(b);
    wire_fb::FinishClientEnvelopeBuffer(b, wire_fb::CreateClientEnvelope(b, 0, tag, table));
    wire_fb::GetMutableClientEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
    return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

ErrorCode bent_view(const std::function<void(wire_fb::View&)>& bend) {
    return bent<wire_fb::ViewUpdate>(ViewUpdate{1, {}},
                                     [&](wire_fb::ViewUpdate& m) { bend(*m.mutable_view()); });
}

TEST(HostileClient, ViewsOutOfRange) {
    using V = wire_fb::View;
    const auto is = [](ErrorCode code, const std::function<void(V&)>& bend) {
        EXPECT_EQ(bent_view(bend), code);
    };
    is(ErrorCode::none, [](V& v) { v.mutate_altitude(INT32_MIN); });
    is(ErrorCode::not_finite, [](V& v) { v.mutate_qx(not_a_number); });
    is(ErrorCode::not_finite, [](V& v) { v.mutate_vy(-infinite); });
    is(ErrorCode::not_finite, [](V& v) { v.mutate_tan_half_width(infinite); });
    is(ErrorCode::not_a_unit_quaternion, [](V& v) { v.mutate_qw(1.002F); });
    is(ErrorCode::not_a_unit_quaternion, [](V& v) { v.mutate_qw(0.0F); });
    is(ErrorCode::not_a_unit_quaternion, [](V& v) { v.mutate_qx(std::numeric_limits<float>::max()); });
    is(ErrorCode::none, [](V& v) { v.mutate_qw(1.0009F); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_x(world_bound + 1); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_z(INT64_MIN); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_tan_half_height(0.0F); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_tan_half_width(20.5F); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_viewport_width(0); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_viewport_height(16385); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_vx(10001.0F); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_accepted_error_px(0.0F); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_patch_budget(0); });
    is(ErrorCode::value_out_of_range, [](V& v) { v.mutate_patch_budget(1025); });
}

TEST(HostileClient, RegionsAndPoints) {
    const SyncRegion disc{{1, 2}, 3};
    EXPECT_EQ(refusal(encode(ClientMessage{SyncRegions{1, std::vector<SyncRegion>(32, disc)}})),
              ErrorCode::none);
    EXPECT_EQ(refusal(encode(ClientMessage{SyncRegions{1, std::vector<SyncRegion>(33, disc)}})),
              ErrorCode::too_many_regions);
    EXPECT_EQ(refusal(encode(ClientMessage{SyncRegions{1, {{{1, 2}, 2048 * 1024 + 1}}}})),
              ErrorCode::region_too_large);
    EXPECT_EQ(refusal(encode(ClientMessage{SyncRegions{1, {{{world_bound + 1, 0}, 1}}}})),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(refusal(encode(ClientMessage{SampleRequest{1, {}, std::vector<LatticePoint>(240)}})),
              ErrorCode::none);
    EXPECT_EQ(refusal(encode(ClientMessage{SampleRequest{1, {}, std::vector<LatticePoint>(241)}})),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(refusal(encode(ClientMessage{SampleRequest{1, {sea_time_bound + 1}, {}}})),
              ErrorCode::value_out_of_range);
}

TEST(HostileClient, HelloAndClock) {
    const auto hello = [](auto change) {
        ClientHello h;
        change(h);
        return refusal(encode(ClientMessage{h}));
    };
    EXPECT_EQ(hello([](ClientHello& h) { h.token = std::string(1024, 't'); }), ErrorCode::none);
    EXPECT_EQ(hello([](ClientHello& h) { h.token = std::string(1025, 't'); }), ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.world = std::string(257, 'w'); }), ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.software = "clear\x1b[2J"; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.software = "cut \xe6\xb5"; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.software = "long form \xc0\xaf"; }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.software = "surrogate \xed\xa0\x80"; }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.software = "C1 \xc2\x9b"; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.software = std::string("nul\0", 4); }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.protocol_min = 2, h.protocol_max = 1; }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(hello([](ClientHello& h) { h.clock_stamp_us = INT64_MAX; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(refusal(encode(ClientMessage{ClockRequest{1, INT64_MIN}})), ErrorCode::value_out_of_range);
}

TEST(HostileClient, Commands) {
    const auto start = [](auto change) {
        StartWind w;
        change(w);
        return refusal(encode(ClientMessage{Command{1, {}, false, w}}));
    };
    EXPECT_EQ(start([](StartWind&) {}), ErrorCode::none);
    EXPECT_EQ(start([](StartWind& w) { w.speed = 0.5F; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.speed = not_a_number; }), ErrorCode::not_finite);
    EXPECT_EQ(start([](StartWind& w) { w.towards_degrees = 360.0F; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.fetch = -1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.width = longest_side + 1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.trains = 256; }), ErrorCode::none);
    EXPECT_EQ(start([](StartWind& w) { w.trains = 257; }), ErrorCode::too_many_trains);
    EXPECT_EQ(start([](StartWind& w) { w.trains = 0; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.directions = 4; }), ErrorCode::none);
    EXPECT_EQ(start([](StartWind& w) { w.directions = 5; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.directions = 32; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.spectrum = static_cast<Spectrum>(4); }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.spreading = static_cast<Spreading>(3); }),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.reference_depth = 1.0F; }), ErrorCode::none);
    EXPECT_EQ(start([](StartWind& w) { w.reference_depth = 0.9F; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.reference_depth = 12001.0F; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.vx = 60.0F, w.vz = -80.0F; }), ErrorCode::none);
    EXPECT_EQ(start([](StartWind& w) { w.vx = 80.0F, w.vz = -80.0F; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(start([](StartWind& w) { w.vz = -101.0F; }), ErrorCode::value_out_of_range);
    for (float StartWind::*share : {&StartWind::roundness, &StartWind::irregularity, &StartWind::noise,
                                    &StartWind::reference_depth, &StartWind::vx, &StartWind::vz}) {
        EXPECT_EQ(start([&](StartWind& w) { w.*share = 1.0F; }), ErrorCode::none);
        EXPECT_EQ(start([&](StartWind& w) { w.*share = not_a_number; }), ErrorCode::not_finite);
        EXPECT_EQ(start([&](StartWind& w) { w.*share = -infinite; }), ErrorCode::not_finite);
        EXPECT_EQ(start([&](StartWind& w) { w.*share = 12345.0F; }), ErrorCode::value_out_of_range);
    }
    for (float StartWind::*share : {&StartWind::roundness, &StartWind::irregularity, &StartWind::noise}) {
        EXPECT_EQ(start([&](StartWind& w) { w.*share = 1.001F; }), ErrorCode::value_out_of_range);
        EXPECT_EQ(start([&](StartWind& w) { w.*share = -0.001F; }), ErrorCode::value_out_of_range);
    }
    EXPECT_EQ(refusal(encode(ClientMessage{Command{1, {}, false, SetRate{(16U << 16) + 1}}})),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(refusal(encode(ClientMessage{Command{1, {INT64_MAX}, false, ListBoxes{}}})),
              ErrorCode::value_out_of_range);
    EXPECT_EQ(refusal(encode(ClientMessage{Goodbye{static_cast<ErrorCode>(815), "", false, 0, 0, 0}})),
              ErrorCode::value_out_of_range);
}

template <class Action, class Change>
ErrorCode changed_action(Action action, Change change) {
    change(action);
    return refusal(encode(ClientMessage{Command{1, {}, false, action}}));
}

TEST(HostileClient, Ships) {
    const auto is = [](ErrorCode code, auto change) { EXPECT_EQ(changed_action(StartShip{}, change), code); };
    is(ErrorCode::none, [](StartShip&) {});
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.at.x = world_bound + 1; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.at.z = INT64_MIN; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.towards_degrees = 360.0F; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.towards_degrees = -1.0F; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.speed = 0.25F; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.speed = 30.5F; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.length = 0.5F; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.length = 501.0F; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.beam = -1.0F; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.beam = 100.5F; });
    is(ErrorCode::none, [](StartShip& s) { s.beam = 100.0F; });
    for (float StartShip::*field :
         {&StartShip::towards_degrees, &StartShip::speed, &StartShip::length, &StartShip::beam}) {
        is(ErrorCode::not_finite, [&](StartShip& s) { s.*field = not_a_number; });
        is(ErrorCode::not_finite, [&](StartShip& s) { s.*field = infinite; });
    }
    is(ErrorCode::none, [](StartShip& s) { s.name = std::string(64, 'n'); });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.name = std::string(65, 'n'); });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.name = "two\nlines"; });
    is(ErrorCode::value_out_of_range, [](StartShip& s) { s.name = "cut \xe6\xb5"; });
}

TEST(HostileClient, Steering) {
    const auto is = [](ErrorCode code, auto change) { EXPECT_EQ(changed_action(Steer{}, change), code); };
    is(ErrorCode::none, [](Steer& s) { s.speed = 100.0F; });
    is(ErrorCode::value_out_of_range, [](Steer& s) { s.speed = 100.5F; });
    is(ErrorCode::value_out_of_range, [](Steer& s) { s.speed = -0.5F; });
    is(ErrorCode::not_finite, [](Steer& s) { s.speed = not_a_number; });
    is(ErrorCode::value_out_of_range, [](Steer& s) { s.towards_degrees = 360.0F; });
    is(ErrorCode::not_finite, [](Steer& s) { s.towards_degrees = infinite; });
}

TEST(HostileClient, ChangesOfTheLand) {
    const ChangeLand mole{{{0, 0}, {1024, 0}}, 20.0F, 3.0F, false};
    const auto is = [&](ErrorCode code, auto change) { EXPECT_EQ(changed_action(mole, change), code); };
    is(ErrorCode::none, [](ChangeLand&) {});
    is(ErrorCode::none, [](ChangeLand& c) { c.line.resize(64); });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.line.resize(65); });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.line.resize(1); });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.line.clear(); });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.line[1].x = -world_bound - 1; });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.width = 0.5F; });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.width = 2001.0F; });
    is(ErrorCode::not_finite, [](ChangeLand& c) { c.width = not_a_number; });
    is(ErrorCode::none, [](ChangeLand& c) { c.crest = -200.0F; });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.crest = -201.0F; });
    is(ErrorCode::value_out_of_range, [](ChangeLand& c) { c.crest = 201.0F; });
    is(ErrorCode::not_finite, [](ChangeLand& c) { c.crest = -infinite; });
}

TEST(HostileClient, UnknownTagsAndMissingParts) {
    using wire_fb::ClientBody;
    const auto clock = [](Builder& b) { return wire_fb::CreateClockRequest(b, 1, 2).Union(); };
    EXPECT_EQ(refusal(built(ClientBody::ClockRequest, clock)), ErrorCode::none);
    EXPECT_EQ(refusal(built(static_cast<ClientBody>(12), clock)), ErrorCode::unknown_message);
    EXPECT_EQ(refusal(built(static_cast<ClientBody>(255), clock)), ErrorCode::unknown_message);
    EXPECT_EQ(refusal(built(ClientBody::NONE, clock)), ErrorCode::unknown_message);
    EXPECT_EQ(refusal(built(ClientBody::ClockRequest, [](Builder&) { return Offset(0); })),
              ErrorCode::missing_field);
    EXPECT_EQ(refusal(built(ClientBody::ViewUpdate,
                            [](Builder& b) { return wire_fb::CreateViewUpdate(b, 1).Union(); })),
              ErrorCode::missing_field);
    EXPECT_EQ(refusal(built(ClientBody::SyncRegions,
                            [](Builder& b) { return wire_fb::CreateSyncRegions(b, 1).Union(); })),
              ErrorCode::missing_field);
    EXPECT_EQ(refusal(built(ClientBody::SampleRequest,
                            [](Builder& b) { return wire_fb::CreateSampleRequest(b, 1).Union(); })),
              ErrorCode::missing_field);
    EXPECT_EQ(
        refusal(built(ClientBody::Goodbye, [](Builder& b) { return wire_fb::CreateGoodbye(b).Union(); })),
        ErrorCode::missing_field);
    EXPECT_EQ(refusal(built(ClientBody::ClientHello,
                            [](Builder& b) {
                                const auto name = b.CreateString("x");
                                return wire_fb::CreateClientHello(b, 1, 1, 1, 0, name, name, 0).Union();
                            })),
              ErrorCode::missing_field);
    const auto command = [](wire_fb::Action tag, bool with_table) {
        return refusal(built(ClientBody::Command, [=](Builder& b) {
            const Offset action = with_table ? wire_fb::CreateListBoxes(b).Union() : Offset(0);
            return wire_fb::CreateCommand(b, 1, 0, false, tag, action).Union();
        }));
    };
    EXPECT_EQ(command(wire_fb::Action::ListBoxes, true), ErrorCode::none);
    EXPECT_EQ(command(static_cast<wire_fb::Action>(9), true), ErrorCode::unknown_message);
    for (const auto tag : {wire_fb::Action::StartWind, wire_fb::Action::StartShip, wire_fb::Action::Steer,
                           wire_fb::Action::ChangeLand})
        EXPECT_EQ(command(tag, false), ErrorCode::missing_field);
    const auto bare = [](wire_fb::Action tag, const std::function<Offset(Builder&)>& action) {
        return refusal(built(ClientBody::Command, [&](Builder& b) {
            const Offset table = action(b);
            return wire_fb::CreateCommand(b, 1, 0, false, tag, table).Union();
        }));
    };
    EXPECT_EQ(
        bare(wire_fb::Action::StartShip,
             [](Builder& b) { return wire_fb::CreateStartShip(b, nullptr, b.CreateString("x")).Union(); }),
        ErrorCode::missing_field);
    EXPECT_EQ(bare(wire_fb::Action::StartShip,
                   [](Builder& b) {
                       const wire_fb::Ship ship(0, 0, 0.0F, 5.0F, 100.0F, 0.0F);
                       return wire_fb::CreateStartShip(b, &ship).Union();
                   }),
              ErrorCode::missing_field);
    EXPECT_EQ(bare(wire_fb::Action::ChangeLand,
                   [](Builder& b) { return wire_fb::CreateChangeLand(b, 0, 20.0F, 3.0F).Union(); }),
              ErrorCode::missing_field);
    EXPECT_EQ(refusal(built(ClientBody::Command,
                            [](Builder& b) {
                                const auto start = wire_fb::CreateStartWind(b);
                                return wire_fb::CreateCommand(b, 1, 0, false, wire_fb::Action::StartWind,
                                                              start.Union())
                                    .Union();
                            })),
              ErrorCode::missing_field);
}

TEST(HostileClient, SizeIdentifierAndStructure) {
    const Bytes good = encode(ClientMessage{ViewUpdate{1, {}}});
    for (size_t more = 1; more <= 16; ++more) {
        Bytes longer = good;
        longer.resize(good.size() + more);
        EXPECT_EQ(refusal(longer), ErrorCode::trailing_bytes);
    }
    EXPECT_EQ(refusal({}), ErrorCode::verification_failed);
    EXPECT_EQ(refusal(encode(ServerMessage{CommandReply{}})), ErrorCode::unknown_message)
        << "a server's message";
    EXPECT_EQ(decode_server(good).error().code, ErrorCode::unknown_message);
    EXPECT_EQ(decode_event(good).error().code, ErrorCode::unknown_message);
    Bytes lost = good;
    lost[0] = 0xff, lost[1] = 0xff;
    EXPECT_EQ(refusal(lost), ErrorCode::verification_failed) << "a root outside the buffer";
    EXPECT_EQ(refusal(Bytes((size_t{1} << 24) + 8)), ErrorCode::frame_too_long);
}

TEST(HostileClient, AnEventFromAnotherVersionOrWithoutParts) {
    const auto event = [](wire_fb::EventBody tag, const std::function<Offset(Builder&)>& body) {
        Builder b;
        b.ForceDefaults(true);
        const Offset table = body(b);
        wire_fb::FinishEventEnvelopeBuffer(b, wire_fb::CreateEventEnvelope(b, 0, 1, 2, tag, table));
        wire_fb::GetMutableEventEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
        const Bytes bytes(b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize());
        const auto result = decode_event(bytes);
        return result ? ErrorCode::none : result.error().code;
    };
    const auto ending = [](Builder& b) { return wire_fb::CreateBoxEnding(b, 1, 2).Union(); };
    EXPECT_EQ(event(wire_fb::EventBody::BoxEnding, ending), ErrorCode::none);
    EXPECT_EQ(event(static_cast<wire_fb::EventBody>(6), ending), ErrorCode::unknown_message);
    EXPECT_EQ(event(wire_fb::EventBody::NONE, ending), ErrorCode::unknown_message);
    EXPECT_EQ(event(wire_fb::EventBody::BoxStarted,
                    [](Builder& b) { return wire_fb::CreateBoxStarted(b).Union(); }),
              ErrorCode::missing_field);
    EXPECT_EQ(event(wire_fb::EventBody::ClockChanged,
                    [](Builder& b) { return wire_fb::CreateClockChanged(b).Union(); }),
              ErrorCode::missing_field);
    EXPECT_EQ(event(wire_fb::EventBody::BoxSteered,
                    [](Builder& b) { return wire_fb::CreateBoxSteered(b, 1).Union(); }),
              ErrorCode::missing_field);
    EXPECT_EQ(event(wire_fb::EventBody::LandChanged,
                    [](Builder& b) {
                        const std::vector<flatbuffers::Offset<wire_fb::BoxSucceeded>> none;
                        return wire_fb::CreateLandChanged(b, 0, b.CreateVector(none)).Union();
                    }),
              ErrorCode::missing_field);
    EXPECT_EQ(event(wire_fb::EventBody::LandChanged,
                    [](Builder& b) {
                        const std::vector<wire_fb::Point> line{{0, 0}, {1, 1}};
                        const auto line_at = b.CreateVectorOfStructs(line);
                        const auto change = wire_fb::CreateChangeLand(b, line_at, 20.0F, 3.0F);
                        const std::vector<flatbuffers::Offset<wire_fb::BoxSucceeded>> bare{
                            wire_fb::CreateBoxSucceeded(b, 1)};
                        return wire_fb::CreateLandChanged(b, change, b.CreateVector(bare)).Union();
                    }),
              ErrorCode::missing_field);
    WaveTrainBox no_trains;
    no_trains.id = {1};
    no_trains.first_train = {1};
    EXPECT_EQ(decode_event(encode(LogEvent{1, {}, BoxStarted{no_trains, "", {}}})).error().code,
              ErrorCode::value_out_of_range);
}

ErrorCode event_refusal(const LogEvent& event) {
    const auto result = decode_event(encode(event));
    return result ? ErrorCode::none : result.error().code;
}

TEST(HostileClient, EventsOfMovingBoxesAndLand) {
    const auto leg = [](auto change) {
        CourseLeg l{{5}, 1'000'000, {0, 0}, 17180, -17180};
        change(l);
        return event_refusal(LogEvent{1, {}, BoxSteered{{3}, l}});
    };
    EXPECT_EQ(leg([](CourseLeg&) {}), ErrorCode::none);
    EXPECT_EQ(leg([](CourseLeg& l) { l.from.us = INT64_MAX; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(leg([](CourseLeg& l) { l.duration_us = -1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(leg([](CourseLeg& l) { l.duration_us = longest_leg_us + 1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(leg([](CourseLeg& l) { l.origin.x = world_bound + 1; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(leg([](CourseLeg& l) { l.origin.x = world_bound; }), ErrorCode::value_out_of_range)
        << "it leaves the world";
    EXPECT_EQ(leg([](CourseLeg& l) { l.vx = INT32_MIN; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(leg([](CourseLeg& l) { l.vz = fastest_leg; }), ErrorCode::value_out_of_range);

    Dice dice(51);
    LandChanged legal;
    legal.change = {{{0, 0}, {1024, 0}}, 20.0F, 3.0F, true};
    legal.boxes = {{{3}, random_box(dice, 8, 2)}, {{4}, random_box(dice, 9, 2)}};
    const auto land = [&](auto change) {
        LandChanged l = legal;
        change(l);
        return event_refusal(LogEvent{1, {}, l});
    };
    EXPECT_EQ(land([](LandChanged&) {}), ErrorCode::none);
    EXPECT_EQ(land([](LandChanged& l) { l.boxes.clear(); }), ErrorCode::none);
    EXPECT_EQ(land([](LandChanged& l) { l.change.line.pop_back(); }), ErrorCode::value_out_of_range);
    EXPECT_EQ(land([](LandChanged& l) { l.change.width = not_a_number; }), ErrorCode::not_finite);
    EXPECT_EQ(land([](LandChanged& l) { l.boxes[0].predecessor = {0}; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(land([](LandChanged& l) { l.boxes[1].predecessor = {3}; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(land([](LandChanged& l) { l.boxes[0].box.id = {3}; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(land([](LandChanged& l) { l.boxes[1].box.ramp_side = 0; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(land([](LandChanged& l) { l.boxes.resize(1025, l.boxes[0]); }), ErrorCode::too_many_boxes);
    EXPECT_EQ(land([](LandChanged& l) { l.also.resize(63, l.change); }), ErrorCode::none);
    EXPECT_EQ(land([](LandChanged& l) { l.also.resize(64, l.change); }), ErrorCode::value_out_of_range);
    EXPECT_EQ(land([](LandChanged& l) {
                  l.also = {l.change, l.change};
                  l.also[1].crest = 201.0F;
              }),
              ErrorCode::value_out_of_range);
}

TEST(HostileClient, WindsOfTheLog) {
    Dice dice(52);
    const auto logged = [&](auto change) {
        BoxStarted started{random_box(dice, 8, 2), "w", {}};
        change(started.wind);
        return event_refusal(LogEvent{1, {}, started});
    };
    EXPECT_EQ(logged([](StartWind& w) { w.speed = 0.0F, w.trains = 0; }), ErrorCode::none);
    EXPECT_EQ(logged([](StartWind& w) { w.trains = 0, w.directions = 2; }), ErrorCode::value_out_of_range);
    EXPECT_EQ(logged([](StartWind& w) { w.noise = infinite; }), ErrorCode::not_finite);
}

}  // namespace
}  // namespace trochoid
