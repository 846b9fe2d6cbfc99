#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/units/hash.hpp"
#include "server/net/message_room.hpp"
#include "server/net/web_frame_count.hpp"
#include "tests/support/net/form_client.hpp"

namespace trochoid {
namespace {

TEST(WebFrameCounts, WhatCarriesNoWholeMessageCounts) {
    uint64_t seed = 3;
    const auto draw = [&seed](uint64_t below) { return splitmix64(seed++) % below; };
    for (int round = 0; round < 200; ++round) {
        Bytes stream;
        uint32_t expected = 0;
        for (uint64_t frames = draw(20); frames > 0; --frames) {
            WebFrame next;
            const std::array<uint8_t, 5> opcodes{0, 1, 2, 9, 10};
            next.opcode = opcodes[draw(opcodes.size())];
            next.last = draw(2) == 0;
            next.masked = draw(4) != 0;
            const std::array<size_t, 6> lengths{0, 1, 125, 126, 300, 66'000};
            next.payload.assign(lengths[draw(lengths.size())], 0x81);
            const Bytes bytes = next.bytes();
            stream.insert(stream.end(), bytes.begin(), bytes.end());
            if (!next.last || next.opcode == 0 || next.opcode > 2) ++expected;
        }
        WebFrameCount count;
        uint32_t counted = 0;
        for (size_t at = 0; at < stream.size();) {
            const size_t piece = std::min<size_t>(stream.size() - at, 1 + draw(round % 2 == 0 ? 3 : 5000));
            counted += count.take(std::span(stream).subspan(at, piece));
            at += piece;
        }
        ASSERT_EQ(counted, expected);
    }
}

// Byte by byte: every byte is where it belongs, and the room grew a dozen times, not sixty thousand.
TEST(MessageRooms, GrowByDoublingWithWhatHasCome) {
    constexpr size_t most = 65'537;
    MessageRoom room;
    int grown = 0;
    const uint8_t* where = nullptr;
    for (size_t i = 0; i < most; ++i) {
        const auto next = room.room(most);
        ASSERT_GE(next.size(), 1U);
        ASSERT_LE(next.size() + i, most);
        ASSERT_LE(room.allocated(), 2 * std::max(i, MessageRoom::first_step) + 2 * frame_header_bytes);
        if (next.data() - i != where) ++grown;
        where = next.data() - i;
        next[0] = static_cast<uint8_t>(i);
        room.took(1);
    }
    EXPECT_LE(grown, 12);
    EXPECT_EQ(room.held(), most);
    const Bytes framed = room.take_frame();
    ASSERT_EQ(framed.size(), most + frame_header_bytes);
    for (size_t i = 0; i < most; ++i) ASSERT_EQ(framed[frame_header_bytes + i], static_cast<uint8_t>(i));
    EXPECT_EQ(room.held(), 0U);
    EXPECT_EQ(room.allocated(), 0U);
}

}  // namespace
}  // namespace trochoid
