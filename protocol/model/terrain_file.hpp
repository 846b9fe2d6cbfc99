#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// The `.terrain` format, version 1; everything little-endian, nothing padded:
///   8 bytes  "TROCHTER"          u32 version (1)
///   i64 origin_x, origin_z       u32 spacing_log2, columns, rows
///   i32 height_step_log2, open_sea_depth
///   f64 origin_lon, origin_lat   (IEEE 754 bits)
///   u16 length + UTF-8 projection, u16 length + UTF-8 provenance (each <= 4096 bytes)
///   i16 heights, columns * rows
///   u64 FNV-1a over every byte before it
/// Units and ranges are those of TerrainGrid.
inline constexpr uint32_t terrain_file_version = 1;
inline constexpr std::size_t terrain_text_max = 4096;

/// The grid's bytes. The grid must be without `terrain_fault` and its texts within terrain_text_max.
std::vector<uint8_t> encode_terrain(const TerrainGrid& grid);

/// The grid in the bytes, or why there is none: wrong_magic, protocol_version (a newer format), malformed_frame (cut
/// short), trailing_bytes, verification_failed (hash), value_out_of_range (terrain_fault). Never allocates more
/// than the bytes given account for.
Result<TerrainGrid> decode_terrain(std::span<const uint8_t> bytes);

/// The hash that closes the encoded file: names the content.
uint64_t terrain_hash(const TerrainGrid& grid);

}  // namespace trochoid
