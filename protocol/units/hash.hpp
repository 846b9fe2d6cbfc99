#pragma once
#include <bit>
#include <cstdint>
#include <span>
#include <string_view>

namespace trochoid {

/// FNV-1a, 64 bits, over values written little-endian: the same on every machine. For content names and
/// comparisons of state, not for security.
class Hash64 {
public:
    constexpr Hash64& bytes(std::span<const uint8_t> data) {
        for (const uint8_t b : data) byte(b);
        return *this;
    }
    constexpr Hash64& text(std::string_view s) {
        for (const char c : s) byte(static_cast<uint8_t>(c));
        return u64(s.size());
    }
    constexpr Hash64& u8(uint8_t v) { return byte(v); }
    constexpr Hash64& u16(uint16_t v) { return little_endian(v, 2); }
    constexpr Hash64& u32(uint32_t v) { return little_endian(v, 4); }
    constexpr Hash64& u64(uint64_t v) { return little_endian(v, 8); }
    constexpr Hash64& i16(int16_t v) { return u16(static_cast<uint16_t>(v)); }
    constexpr Hash64& i32(int32_t v) { return u32(static_cast<uint32_t>(v)); }
    constexpr Hash64& i64(int64_t v) { return u64(static_cast<uint64_t>(v)); }
    /// The float's bits; +0 and -0 differ, as they do on the wire.
    Hash64& f32(float v) { return u32(std::bit_cast<uint32_t>(v)); }
    Hash64& f64(double v) { return u64(std::bit_cast<uint64_t>(v)); }
    constexpr uint64_t value() const { return state_; }

private:
    constexpr Hash64& byte(uint8_t b) {
        state_ = (state_ ^ b) * 0x100000001b3ULL;
        return *this;
    }
    constexpr Hash64& little_endian(uint64_t v, int count) {
        for (int i = 0; i < count; ++i) byte(static_cast<uint8_t>(v >> (8 * i)));
        return *this;
    }
    uint64_t state_ = 0xcbf29ce484222325ULL;
};

/// SplitMix64: one well-mixed 64-bit value per input; the model's only source of "random" numbers.
constexpr uint64_t splitmix64(uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

}  // namespace trochoid
