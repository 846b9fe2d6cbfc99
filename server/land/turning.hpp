#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/model/land_field.hpp"

namespace trochoid {

/// Rows to columns of a plane of nz rows of nx values: nx rows of nz.
std::vector<float> turned(std::span<const float> values, size_t nx, size_t nz);

/// The nodes of a block out of a plane whose rows are `pitch` values apart, rows to columns.
void turn_block(const int32_t* from, size_t pitch, int32_t* to);
void turn_block(const uint16_t* from, size_t pitch, uint16_t* to);

}  // namespace trochoid
