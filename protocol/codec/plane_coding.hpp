#pragma once
#include <cstdint>
#include <span>

#include "protocol/codec/codec.hpp"

namespace trochoid {

/// Appends a row-major plane of integers (protocol/README.md, "Plane coding"): each value less its prediction left + up -
/// up-left, zigzag, base-128 varint, runs of zeros counted. Smooth planes take little more than a byte a value.
template <class T>
void append_plane(Bytes& out, std::span<const T> values, size_t columns);

/// Reads a plane from the front of `in` and moves `in` past it. False where the bytes end early, a varint is not the
/// shortest, a run is split or too long, or a value does not fit T.
template <class T>
bool read_plane(std::span<const uint8_t>& in, std::span<T> values, size_t columns);

/// A land block's shifts, gains and orbits, one plane after the other, orbits only where they are not all 1; the key is not
/// among them.
Bytes code_nodes(const LandBlock& block);
Result<Done> read_nodes(std::span<const uint8_t> in, LandBlock& block);

Bytes code_heights(const TerrainTile& tile);
Result<Done> read_heights(std::span<const uint8_t> in, TerrainTile& tile);

}  // namespace trochoid
