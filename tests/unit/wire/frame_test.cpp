#include "protocol/wire/frame.hpp"

#include <gtest/gtest.h>

namespace trochoid {
namespace {

using Opening = FrameReader::Opening;

Bytes stream_of(const std::vector<Bytes>& payloads, bool with_magic = true) {
    Bytes out;
    if (with_magic) out.assign(stream_magic.begin(), stream_magic.end());
    for (const Bytes& p : payloads) {
        const Bytes framed = frame(p);
        out.insert(out.end(), framed.begin(), framed.end());
    }
    return out;
}

/// Everything that comes out of the chunk; stops at an error.
std::vector<Bytes> take_all(FrameReader& reader, std::span<const uint8_t> chunk, ErrorCode* code = nullptr) {
    std::vector<Bytes> out;
    for (;;) {
        const auto payload = reader.next(chunk);
        if (!payload) {
            if (code != nullptr) *code = payload.error().code;
            return out;
        }
        if (!payload->has_value()) return out;
        EXPECT_EQ(reinterpret_cast<uintptr_t>((*payload)->data()) % 8, 0U);
        out.push_back(**payload);
    }
}

ErrorCode error_of(const Bytes& stream, Opening opening = Opening::magic, uint32_t longest = 4096) {
    FrameReader reader(opening, longest);
    ErrorCode code = ErrorCode::none;
    take_all(reader, stream, &code);
    return code;
}

const std::vector<Bytes> three{{1, 2, 3}, Bytes(100, 7), {9}};

TEST(Frame, TheHeaderIsLengthAndZeroLittleEndian) {
    EXPECT_EQ(frame(Bytes(0x0102, 5)).size(), 0x0102U + 8U);
    const Bytes framed = frame(Bytes(0x0102, 5));
    EXPECT_EQ(Bytes(framed.begin(), framed.begin() + 9), (Bytes{2, 1, 0, 0, 0, 0, 0, 0, 5}));
}

TEST(FrameReader, WhateverTheCutsThePayloadsAreTheSame) {
    const Bytes stream = stream_of(three);
    for (size_t first = 0; first <= stream.size(); ++first)
        for (size_t second = first; second <= stream.size(); second += 7) {
            FrameReader reader(Opening::magic, 4096);
            std::vector<Bytes> out;
            const std::span<const uint8_t> all(stream);
            for (const auto chunk :
                 {all.first(first), all.subspan(first, second - first), all.subspan(second)})
                for (Bytes& p : take_all(reader, chunk)) out.push_back(std::move(p));
            ASSERT_EQ(out, three) << first << ", " << second;
            EXPECT_TRUE(reader.between_frames());
        }
}

TEST(FrameReader, ByteByByteFromAServer) {
    FrameReader reader(Opening::frames, 4096);
    std::vector<Bytes> out;
    for (const uint8_t byte : stream_of(three, false))
        for (Bytes& p : take_all(reader, {&byte, 1})) out.push_back(std::move(p));
    EXPECT_EQ(out, three);
}

TEST(FrameReader, KnowsWhereAStreamMayEnd) {
    const Bytes stream = stream_of({{1, 2, 3}});
    for (size_t cut = 0; cut <= stream.size(); ++cut) {
        FrameReader reader(Opening::magic, 4096);
        take_all(reader, std::span(stream).first(cut));
        EXPECT_EQ(reader.between_frames(), cut == 8 || cut == stream.size()) << cut;
    }
}

TEST(FrameReader, RefusesWrongMagicAtItsFirstWrongByte) {
    for (size_t i = 0; i < 8; ++i) {
        Bytes magic(stream_magic.begin(), stream_magic.end());
        magic[i] ^= 0x20;
        magic.resize(i + 1);
        EXPECT_EQ(error_of(magic), ErrorCode::wrong_magic) << i;
    }
    const std::string http = "GET / HTTP/1.1\r\n\r\n";
    EXPECT_EQ(error_of(Bytes(http.begin(), http.end())), ErrorCode::wrong_magic);
}

TEST(FrameReader, RefusesBadHeaders) {
    EXPECT_EQ(error_of({1, 0, 0, 0, 0, 0, 0, 1, 5}, Opening::frames), ErrorCode::malformed_frame);
    EXPECT_EQ(error_of({0, 0, 0, 0, 0, 0, 0, 0}, Opening::frames), ErrorCode::malformed_frame);
    EXPECT_EQ(error_of({0, 16, 0, 0, 0, 0, 0, 0}, Opening::frames, 4096), ErrorCode::none);
    EXPECT_EQ(error_of({1, 16, 0, 0, 0, 0, 0, 0}, Opening::frames, 4096), ErrorCode::frame_too_long);
    EXPECT_EQ(error_of({255, 255, 255, 255, 0, 0, 0, 0}, Opening::frames), ErrorCode::frame_too_long);
}

TEST(FrameReader, AnErrorStays) {
    FrameReader reader(Opening::frames, 16);
    const Bytes bad{17, 0, 0, 0, 0, 0, 0, 0};
    std::span<const uint8_t> input(bad);
    EXPECT_FALSE(reader.next(input));
    const Bytes good = frame(Bytes{1});
    input = good;
    EXPECT_FALSE(reader.next(input));
}

TEST(FrameReader, AHeaderThatAnnouncesMuchAllocatesNothing) {
    FrameReader reader(Opening::frames, UINT32_MAX);
    Bytes stream = {255, 255, 255, 255, 0, 0, 0, 0};
    take_all(reader, stream);
    EXPECT_LE(reader.allocated(), FrameReader::read_ahead);
    size_t arrived = 0;
    for (const size_t more : {1U, 10U, 5000U, 1U, 70000U}) {
        take_all(reader, Bytes(more));
        arrived += more;
        EXPECT_LE(reader.allocated(), arrived + FrameReader::read_ahead);
    }
}

TEST(FrameReader, OwnsNothingBetweenFrames) {
    FrameReader reader(Opening::magic, 4096);
    EXPECT_EQ(take_all(reader, stream_of(three)).size(), 3U);
    EXPECT_EQ(reader.allocated(), 0U);
}

TEST(FrameReader, ANewLimitHoldsForTheRestOfTheChunk) {
    const Bytes stream = stream_of({Bytes(10, 1), Bytes(100, 2), Bytes(100, 3)});
    FrameReader reader(Opening::magic, 10);
    std::span<const uint8_t> input(stream);
    ASSERT_TRUE(reader.next(input)->has_value());
    reader.set_longest(100);
    ASSERT_TRUE(reader.next(input)->has_value());
    reader.set_longest(99);
    EXPECT_EQ(reader.next(input).error().code, ErrorCode::frame_too_long);
}

}  // namespace
}  // namespace trochoid
