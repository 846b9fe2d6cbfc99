#pragma once
#include <functional>

#include "client_generated.h"
#include "protocol/codec/codec.hpp"
#include "server_generated.h"

// Buffers that no encoder of ours would write: built and bent through the generated code itself.
namespace trochoid::conformance {

using Builder = flatbuffers::FlatBufferBuilder;
using TableOffset = flatbuffers::Offset<void>;

/// A legal message of a client, bent in place by FlatBuffers' mutable accessors; `Table` is the body's.
template <class Table, class Bend>
Bytes bent(const ClientMessage& message, Bend bend) {
    Bytes bytes = encode(message);
    bend(*static_cast<Table*>(wire_fb::GetMutableClientEnvelope(bytes.data())->mutable_body()));
    return bytes;
}

/// A message of a client built by hand, with its size field right.
inline Bytes built(wire_fb::ClientBody tag, const std::function<TableOffset(Builder&)>& body) {
    Builder b;
    b.ForceDefaults(true);
    const TableOffset table = body(b);
    wire_fb::FinishClientEnvelopeBuffer(b, wire_fb::CreateClientEnvelope(b, 0, tag, table));
    wire_fb::GetMutableClientEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
    return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

/// A command with an action built by hand.
inline Bytes built_command(wire_fb::Action tag, const std::function<TableOffset(Builder&)>& action) {
    return built(wire_fb::ClientBody::Command, [&](Builder& b) {
        const TableOffset table = action(b);
        return wire_fb::CreateCommand(b, 1, 0, false, tag, table).Union();
    });
}

/// A vector of 64-bit-aligned structs (`words` 32-bit words each) that lies 4 bytes off: all zero.
flatbuffers::uoffset_t misaligned_vector(Builder& b, size_t count, size_t words, size_t lead);

}  // namespace trochoid::conformance
