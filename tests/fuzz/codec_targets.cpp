#include "protocol/wire/session_rules.hpp"
#include "tests/fuzz/allocation_meter.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/wire_mutation.hpp"

// What decodes, encodes; that decodes to the same value and encodes to the same bytes. Decoding takes memory in proportion.
namespace trochoid {

void check_refusal(const Error& error) {
    TROCHOID_ASSERT(error.code != ErrorCode::none, "a refusal without a code: {}", error.message);
    TROCHOID_ASSERT(error.message.size() > 10, "a refusal without a sentence: {}",
                    static_cast<int>(error.code));
    const Goodbye goodbye = goodbye_for(error);
    const auto back = decode_client(encode(ClientMessage{goodbye}));
    TROCHOID_ASSERT(back.has_value(), "the goodbye for '{}' cannot be sent", error.message);
    TROCHOID_ASSERT(std::get<Goodbye>(*back).code == error.code, "another code");
}

namespace {

bool same(const ClientMessage& a, const ClientMessage& b) { return a == b; }
bool same(const LogEvent& a, const LogEvent& b) { return a == b; }

/// `amplification`: bytes allocated per byte of a message, at most; lists may be shared and planes hold runs.
template <class Decode>
void check_codec(std::span<const uint8_t> input, Decode decode, size_t amplification) {
    const Bytes bytes = owned(input);
    const AllocationMeter meter;
    const auto first = decode(bytes);
    const size_t spent = meter.bytes();
    TROCHOID_ASSERT(spent <= 16384 + amplification * bytes.size(), "{} bytes for a message of {}", spent,
                    bytes.size());
    if (!first) return check_refusal(first.error());
    const Bytes again = encode(*first);
    const auto second = decode(again);
    TROCHOID_ASSERT(second.has_value(), "decoded, but not after encoding: {}", second.error().message);
    TROCHOID_ASSERT(same(*first, *second), "another value after {} bytes were encoded", again.size());
    TROCHOID_ASSERT(encode(*second) == again, "other bytes the second time");
}

}  // namespace

const FuzzTarget client_target{
    "decode_client",
    [](std::span<const uint8_t> in) {
        check_codec(
            in, [](const Bytes& b) { return decode_client(b); }, 16);
    },
    8192,
    [](const Bytes& in, Dice& dice, size_t most) { return mutate_message(client_form(), in, dice, most); },
    [](std::span<uint8_t> in) { repair_message(client_form(), in); }};

const FuzzTarget server_target{
    "decode_server",
    [](std::span<const uint8_t> in) {
        check_codec(
            in, [](const Bytes& b) { return decode_server(b); }, 512);
    },
    20'000,
    [](const Bytes& in, Dice& dice, size_t most) { return mutate_message(server_form(), in, dice, most); },
    [](std::span<uint8_t> in) { repair_message(server_form(), in); }};

const FuzzTarget event_target{
    "decode_event",
    [](std::span<const uint8_t> in) {
        check_codec(
            in, [](const Bytes& b) { return decode_event(b); }, 512);
    },
    20'000,
    [](const Bytes& in, Dice& dice, size_t most) { return mutate_message(event_form(), in, dice, most); },
    [](std::span<uint8_t> in) { repair_message(event_form(), in); }};

}  // namespace trochoid
