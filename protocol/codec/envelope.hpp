#pragma once
#include <fmt/format.h>

#include "flatbuffers/flatbuffers.h"
#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"

// What all three root types have in common: file identifier, size field, limits of the verifier.
namespace trochoid {

inline constexpr size_t largest_buffer = size_t{1} << 24;
inline constexpr flatbuffers::uoffset_t deepest_nesting = 16;

/// Finishes the buffer and writes its size into the root's size field, which must have been created with any value.
template <class Envelope>
Bytes finish_envelope(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Envelope> root,
                      const char* identifier) {
    builder.Finish(root, identifier);
    TROCHOID_ASSERT(builder.GetSize() <= largest_buffer, "message of {} bytes", builder.GetSize());
    auto* envelope = flatbuffers::GetMutableRoot<Envelope>(builder.GetBufferPointer());
    const bool written = envelope->mutate_size(builder.GetSize());
    TROCHOID_ASSERT(written, "the {} envelope has no size field", identifier);
    return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

/// The root after the cheap checks, in the standard's order: length, file identifier, verifier, trailing bytes.
template <class Envelope>
Result<const Envelope*> open_envelope(std::span<const uint8_t> data, const char* identifier,
                                      flatbuffers::uoffset_t most_tables) {
    TROCHOID_ASSERT(reinterpret_cast<uintptr_t>(data.data()) % 8 == 0, "buffer at {} is not 8-byte aligned",
                    static_cast<const void*>(data.data()));
    if (data.size() > largest_buffer)
        return Error{ErrorCode::frame_too_long,
                     fmt::format("a message of {} bytes is longer than any may be", data.size())};
    if (data.size() < 8)
        return Error{ErrorCode::verification_failed,
                     fmt::format("{} bytes are too few for a message", data.size())};
    if (!flatbuffers::BufferHasIdentifier(data.data(), identifier))
        return Error{ErrorCode::unknown_message, fmt::format("the file identifier is not {}", identifier)};
    flatbuffers::Verifier::Options limits;
    limits.max_depth = deepest_nesting;
    limits.max_tables = most_tables;
    flatbuffers::Verifier verifier(data.data(), data.size(), limits);
    if (!verifier.VerifyBuffer<Envelope>(identifier))
        return Error{ErrorCode::verification_failed,
                     "the buffer is not a well-formed FlatBuffer within the depth and table limits"};
    const auto* envelope = flatbuffers::GetRoot<Envelope>(data.data());
    if (envelope->size() != data.size())
        return Error{ErrorCode::trailing_bytes,
                     fmt::format("the size field says {} bytes but {} came", envelope->size(), data.size())};
    return envelope;
}

}  // namespace trochoid
