#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace trochoid {

/// Writes `value` at the place, least significant byte first.
inline void put_u64(std::span<uint8_t> bytes, size_t at, uint64_t value) {
    for (size_t i = 0; i < 8; ++i) bytes[at + i] = static_cast<uint8_t>(value >> (8 * i));
}

inline uint64_t u64_at(std::span<const uint8_t> bytes, size_t at) {
    uint64_t value = 0;
    for (size_t i = 0; i < 8; ++i) value |= uint64_t{bytes[at + i]} << (8 * i);
    return value;
}

template <size_t N>
void put_array(std::span<uint8_t> bytes, size_t at, const std::array<uint8_t, N>& value) {
    std::copy(value.begin(), value.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

template <size_t N>
std::array<uint8_t, N> array_at(std::span<const uint8_t> bytes, size_t at) {
    std::array<uint8_t, N> value{};
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), N, value.begin());
    return value;
}

}  // namespace trochoid
