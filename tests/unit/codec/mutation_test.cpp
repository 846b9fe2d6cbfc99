#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "protocol/codec/codec.hpp"
#include "tests/unit/codec/random_messages.hpp"

// Cut and flipped buffers: never a crash (run under sanitizers too), always a code, and whatever is accepted is legal.
namespace trochoid {
namespace {

struct Direction {
    std::function<Bytes(Dice&, size_t)> make;
    std::function<Error(const Bytes&)> refusal;  // code none: accepted
    std::function<Bytes(const Bytes&)> encoded_again;
    size_t kinds;
};

template <class Decode>
Direction direction(Decode decode, size_t kinds, std::function<Bytes(Dice&, size_t)> make) {
    return {std::move(make),
            [decode](const Bytes& bytes) {
                const auto result = decode(bytes);
                return result ? Error{} : result.error();
            },
            [decode](const Bytes& bytes) { return encode(*decode(bytes)); }, kinds};
}

std::vector<Direction> directions() {
    return {direction([](const Bytes& b) { return decode_client(b); }, client_kinds,
                      [](Dice& d, size_t kind) { return encode(random_client_message(d, kind)); }),
            direction([](const Bytes& b) { return decode_server(b); }, server_kinds,
                      [](Dice& d, size_t kind) { return encode(random_server_message(d, kind)); }),
            direction([](const Bytes& b) { return decode_event(b); }, event_kinds,
                      [](Dice& d, size_t kind) { return encode(random_event(d, kind)); })};
}

TEST(Mutation, EveryTruncationIsRefused) {
    Dice dice(41);
    for (const Direction& way : directions())
        for (size_t kind = 0; kind < way.kinds; ++kind) {
            const Bytes whole = way.make(dice, kind);
            // Every length of the first 2 KiB, then in steps, so that long messages do not take minutes.
            for (size_t cut = 0; cut < whole.size(); cut += cut < 2048 ? 1 : 61) {
                const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
                const Error error = way.refusal(part);
                ASSERT_NE(error.code, ErrorCode::none)
                    << "kind " << kind << " cut to " << cut << " of " << whole.size();
                ASSERT_FALSE(error.message.empty());
            }
        }
}

TEST(Mutation, EveryFlippedBitIsRefusedWithACodeOrGivesALegalMessage) {
    Dice dice(42);
    size_t accepted = 0;
    size_t refused = 0;
    for (const Direction& way : directions())
        for (size_t kind = 0; kind < way.kinds; ++kind) {
            Bytes bytes = way.make(dice, kind);
            const size_t stride = 1 + bytes.size() / 1500;
            for (size_t at = 0; at < bytes.size(); at += at < 400 ? 1 : stride)
                for (int bit = 0; bit < 8; ++bit) {
                    bytes[at] ^= static_cast<uint8_t>(1 << bit);
                    const Error error = way.refusal(bytes);
                    if (error.code == ErrorCode::none) {
                        ++accepted;
                        const Bytes again = way.encoded_again(bytes);
                        ASSERT_EQ(way.refusal(again).code, ErrorCode::none)
                            << "kind " << kind << " byte " << at;
                        ASSERT_EQ(way.encoded_again(again), again);
                    } else {
                        ++refused;
                        ASSERT_FALSE(error.message.empty());
                    }
                    bytes[at] ^= static_cast<uint8_t>(1 << bit);
                }
        }
    EXPECT_GT(accepted, 1000U);
    EXPECT_GT(refused, 1000U);
}

TEST(Mutation, RandomBytesBehindAnIdentifierAreRefused) {
    Dice dice(43);
    for (int i = 0; i < 3000; ++i) {
        Bytes bytes(static_cast<size_t>(dice.between(8, 300)));
        for (uint8_t& b : bytes) b = dice.coin() ? uint8_t{0} : static_cast<uint8_t>(dice.between(0, 40));
        const char* identifier = i % 3 == 0 ? "TRCC" : i % 3 == 1 ? "TRCS" : "TRLE";
        std::copy_n(identifier, 4, bytes.begin() + 4);
        for (const Direction& way : directions()) EXPECT_NE(way.refusal(bytes).code, ErrorCode::none);
    }
}

}  // namespace
}  // namespace trochoid
