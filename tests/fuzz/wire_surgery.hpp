#pragma once
#include "protocol/codec/codec.hpp"
#include "tests/fuzz/wire_walk.hpp"

// Changes to a buffer that keep it well formed for the FlatBuffers verifier: what moves goes to the end.
namespace trochoid {

/// Writes a scalar in its width; floats and doubles take the bits given.
void set_scalar(Bytes& bytes, const WireSlot& slot, uint64_t bits);
/// The envelope's size field, if it has one, says how long the buffer is.
void set_size_field(Bytes& bytes);
/// The table with the slot's field has it no longer (its vtable is copied: others may share it).
void drop_field(Bytes& bytes, const WireSlot& slot);
/// The list or text is another one: `count` entries from `entries`, at an address that is `skew` bytes off the alignment of 8
/// behind the length (4 is legal for the verifier).
void replace_list(Bytes& bytes, const WireSlot& slot, uint32_t count, std::span<const uint8_t> entries,
                  size_t skew = 0);
/// A list of structs or numbers gets `count` entries, which repeat those that it has (zeros where it has none). False for a
/// list of tables: references only point forwards, so such a list cannot go to the end.
bool resize_list(Bytes& bytes, const WireSlot& slot, uint32_t count, size_t skew = 0);

}  // namespace trochoid
