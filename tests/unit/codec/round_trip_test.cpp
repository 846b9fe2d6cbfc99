#include <gtest/gtest.h>

#include <string_view>

#include "event_generated.h"
#include "protocol/codec/codec.hpp"
#include "tests/unit/codec/random_messages.hpp"

namespace trochoid {
namespace {

constexpr int repetitions = 60;

TEST(RoundTrip, EveryClientMessageComesBackEqualAndEncodesToTheSameBytes) {
    Dice dice(1);
    for (int i = 0; i < repetitions; ++i)
        for (size_t kind = 0; kind < client_kinds; ++kind) {
            const ClientMessage message = random_client_message(dice, kind);
            ASSERT_EQ(message.index(), kind);
            const Bytes bytes = encode(message);
            const auto back = decode_client(bytes);
            ASSERT_TRUE(back) << "kind " << kind << ": " << back.error().message;
            EXPECT_EQ(*back, message) << "kind " << kind;
            EXPECT_EQ(encode(*back), bytes) << "kind " << kind;
        }
}

TEST(RoundTrip, EveryServerMessageComesBackEqualAndEncodesToTheSameBytes) {
    Dice dice(2);
    for (int i = 0; i < repetitions; ++i)
        for (size_t kind = 0; kind < server_kinds; ++kind) {
            const ServerMessage message = random_server_message(dice, kind);
            ASSERT_EQ(message.index(), kind);
            const Bytes bytes = encode(message);
            const auto back = decode_server(bytes);
            ASSERT_TRUE(back) << "kind " << kind << ": " << back.error().message;
            EXPECT_TRUE(same(*back, message)) << "kind " << kind;
            EXPECT_EQ(encode(*back), bytes) << "kind " << kind;
        }
}

TEST(RoundTrip, EveryEventComesBackEqualAndEncodesToTheSameBytes) {
    Dice dice(3);
    for (int i = 0; i < repetitions; ++i)
        for (size_t kind = 0; kind < event_kinds; ++kind) {
            const LogEvent event = random_event(dice, kind);
            ASSERT_EQ(event.what.index(), kind);
            const Bytes bytes = encode(event);
            const auto back = decode_event(bytes);
            ASSERT_TRUE(back) << "kind " << kind << ": " << back.error().message;
            EXPECT_EQ(*back, event) << "kind " << kind;
            EXPECT_EQ(encode(*back), bytes) << "kind " << kind;
        }
}

TEST(RoundTrip, DefaultsTravelToo) {
    for (const ClientMessage& message :
         {ClientMessage{ViewUpdate{}}, ClientMessage{SyncRegions{}}, ClientMessage{Ack{}},
          ClientMessage{Command{}}, ClientMessage{SampleRequest{}}, ClientMessage{Goodbye{}}}) {
        const auto back = decode_client(encode(message));
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(*back, message);
    }
    ServerHello hello;
    hello.protocol = 1;
    const auto back = decode_server(encode(ServerMessage{hello}));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_TRUE(same(*back, hello));
}

TEST(RoundTrip, ABoxWhereEveryTrainHasItsOwnField) {
    Dice dice(4);
    LogEvent event{1, {}, BoxStarted{random_box(dice, 7, 256), "shore", {}}};
    auto& trains = std::get<BoxStarted>(event.what).box.trains;
    for (size_t i = 0; i < trains.size(); ++i) trains[i].field = {static_cast<uint32_t>(i)};
    const auto back = decode_event(encode(event));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, event);
}

WaveTrainBox plain_box(Dice& dice, size_t trains) {
    const WaveTrainBox any = random_box(dice, 7, trains);
    WaveTrainBox box;
    box.id = any.id;
    box.first_train = any.first_train;
    box.trains = any.trains;
    for (WaveTrain& train : box.trains) train.field = {};
    return box;
}

TEST(RoundTrip, ATrainRecordTakes28Bytes) {
    Dice dice(5);
    const auto size_of = [&](size_t trains) {
        return encode(LogEvent{1, {}, BoxStarted{plain_box(dice, trains), "swell", {}}}).size();
    };
    EXPECT_EQ(size_of(102) - size_of(2), 2800U);
}

/// What a change of a plain box of three trains adds to its event.
template <class Change>
size_t added_bytes(Change change) {
    Dice dice(6);
    WaveTrainBox box = plain_box(dice, 3);
    const size_t plain = encode(LogEvent{1, {}, BoxStarted{box, "swell", {}}}).size();
    change(box);
    return encode(LogEvent{1, {}, BoxStarted{box, "swell", {}}}).size() - plain;
}

/// The byte costs that the standard states (chapter 10).
TEST(RoundTrip, ABoxPaysForWhatItHas) {
    EXPECT_EQ(added_bytes([](WaveTrainBox& b) { b.roundness = 1; }), 0U);
    EXPECT_LE(added_bytes([](WaveTrainBox& b) { b.fade_us = 1; }), 16U + 8U);
    EXPECT_LE(added_bytes([](WaveTrainBox& b) { b.overlays = {{{2}, {1}}}; }), 8U + 8U + 8U);
    EXPECT_LE(added_bytes([](WaveTrainBox& b) { b.course.resize(1); }), 40U + 8U + 12U);
    EXPECT_LE(added_bytes([](WaveTrainBox& b) { b.irregular.share = 1; }), 36U + 12U);
    EXPECT_LE(added_bytes([](WaveTrainBox& b) { b.noise.seed = 1; }), 16U + 16U);
    EXPECT_LE(added_bytes([](WaveTrainBox& b) { b.wake.group_speed = 1; }), 20U + 16U);
    EXPECT_LE(added_bytes([](WaveTrainBox& b) { b.hull = {100.0F, 14.0F}; }), 8U + 16U);
    const auto legs = [](size_t n) { return added_bytes([n](WaveTrainBox& b) { b.course.resize(n); }); };
    EXPECT_EQ(legs(64) - legs(2), 62U * 40U);
    const auto overlays = [](size_t n) {
        return added_bytes([n](WaveTrainBox& b) { b.overlays.resize(n); });
    };
    EXPECT_EQ(overlays(256) - overlays(2), 254U * 8U);
}

/// The boxes of a delta as a program reads them that was made before there were hulls: the table's slots up to the wake.
TEST(RoundTrip, ProgramsWithoutHullsReadTheRest) {
    Dice dice(7);
    const auto event_of = [](const WaveTrainBox& box) {
        return encode(LogEvent{1, {}, BoxStarted{box, "ferry", {}}});
    };
    const auto box_of = [](const Bytes& bytes) {
        return flatbuffers::GetRoot<wire_fb::EventEnvelope>(bytes.data())->body_as_BoxStarted()->box();
    };
    WaveTrainBox ship = random_ship(dice, 3);
    ship.hull = {};
    const Bytes old_bytes = event_of(ship);
    ship.hull = {140.0F, 21.0F};
    const Bytes new_bytes = event_of(ship);
    ASSERT_NE(new_bytes, old_bytes);
    const wire_fb::Box* with = box_of(new_bytes);
    const wire_fb::Box* without = box_of(old_bytes);
    EXPECT_EQ(with->hull()->length(), 140.0F);
    EXPECT_EQ(without->hull(), nullptr) << "what an old program writes says nothing of a hull";
    constexpr auto last_old = wire_fb::Box::VT_WAKE;
    const auto* table = reinterpret_cast<const flatbuffers::Table*>(with);
    const auto* old_table = reinterpret_cast<const flatbuffers::Table*>(without);
    for (flatbuffers::voffset_t slot = 4; slot <= last_old; slot += 2)
        EXPECT_EQ(table->GetOptionalFieldOffset(slot) != 0, old_table->GetOptionalFieldOffset(slot) != 0)
            << slot;
    const auto bytes_of = [](const auto* part) {
        return std::string_view(reinterpret_cast<const char*>(part), sizeof(*part));
    };
    EXPECT_EQ(bytes_of(with->head()), bytes_of(without->head()));
    EXPECT_EQ(bytes_of(with->wake()), bytes_of(without->wake()));
    EXPECT_EQ(with->course()->size(), without->course()->size());
    // And the other way round.
    const auto read = decode_event(old_bytes);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(std::get<BoxStarted>(read->what).box.hull, Hull{});
}

/// A ship that lies still is a legal box to whoever drops her hull, and of the same hash.
TEST(RoundTrip, ALyingShipIsABoxWithoutHerHull) {
    WaveTrainBox lying;
    lying.id = {9};
    lying.first_train = {90};
    lying.length = 140 * 1024;
    lying.width = 21 * 1024;
    lying.hull = {140.0F, 21.0F};
    lying.trains.push_back({1 << 26, 0, 0, 0, 0.0F, 0.0F, {}});
    const auto read = decode_event(encode(LogEvent{1, {}, BoxStarted{lying, "ferry", {}}}));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(std::get<BoxStarted>(read->what).box, lying);
    WaveTrainBox dropped = lying;
    dropped.hull = {};
    EXPECT_TRUE(validate(dropped));
    EXPECT_EQ(hash_of(dropped), hash_of(lying));
}

TEST(RoundTrip, SentencesAreCutAtACharactersBorderAndLoseControlCharacters) {
    std::string sentence = "line\nbreak \x1b[31m";
    while (sentence.size() < 600) sentence += "\xe6\xb5\xb7";
    const auto back =
        decode_client(encode(ClientMessage{Goodbye{ErrorCode::internal_error, sentence, false, 0, 0, 0}}));
    ASSERT_TRUE(back) << back.error().message;
    const std::string& came = std::get<Goodbye>(*back).message;
    EXPECT_EQ(came.substr(0, 16), "line break  [31m");
    EXPECT_LE(came.size(), 512U);
    EXPECT_GT(came.size(), 508U);
}

TEST(RoundTrip, TheSchemasHashIsSteadyAndNotThatOfNothing) {
    EXPECT_EQ(schema_hash(), schema_hash());
    EXPECT_NE(schema_hash(), Hash64{}.value());
}

}  // namespace
}  // namespace trochoid
