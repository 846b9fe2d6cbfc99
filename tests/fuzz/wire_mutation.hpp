#pragma once
#include "protocol/codec/codec.hpp"
#include "tests/fuzz/wire_walk.hpp"
#include "tests/unit/codec/random_messages.hpp"

// Mutations that know the schema: what comes out is a well-formed buffer of another meaning.
namespace trochoid {

/// One of the three root types.
struct WireForm {
    const reflection::Schema& schema;
    bool (*verifies)(const Bytes&);
    Bytes (*random)(Dice&);          ///< a legal message
    Bytes (*through)(const Bytes&);  ///< decoded and encoded again; empty: refused
};
const WireForm& client_form();
const WireForm& server_form();
const WireForm& event_form();

/// Numbers, tags, lists and texts changed, fields dropped, tables shared; now and then a fresh message. Empty where the
/// input is no well-formed buffer or the outcome would be longer than `most`.
Bytes mutate_message(const WireForm& form, const Bytes& input, Dice& dice, size_t most);

/// Where the input is well formed, its size field is made right.
void repair_message(const WireForm& form, std::span<uint8_t> input);

/// A byte and frames behind it, as the session and store targets read them: messages are changed, doubled, dropped, moved.
Bytes mutate_frames(const WireForm& form, const Bytes& input, Dice& dice, size_t most);

/// The payloads of frames one after the other, as far as they are whole.
std::vector<Bytes> payloads_of(std::span<const uint8_t> frames);

}  // namespace trochoid
