#pragma once
#include <span>
#include <string_view>

#include "protocol/codec/codec.hpp"
#include "tests/unit/codec/random_messages.hpp"

namespace trochoid {

/// A parser under test. `run` says what must hold of any input with TROCHOID_ASSERT, which aborts.
struct FuzzTarget {
    std::string_view name;
    void (*run)(std::span<const uint8_t> input);
    size_t longest;  ///< bytes of an input
    /// Another input that goes deep where single bytes do not; empty: none came of it.
    Bytes (*mutate)(const Bytes& input, Dice& dice, size_t most) = nullptr;
    /// Makes checksums and lengths right again, in place.
    void (*repair)(std::span<uint8_t> input) = nullptr;
};

extern const FuzzTarget frames_target;
extern const FuzzTarget client_target;
extern const FuzzTarget server_target;
extern const FuzzTarget event_target;
extern const FuzzTarget planes_target;
extern const FuzzTarget session_target;
extern const FuzzTarget store_target;
extern const FuzzTarget terrain_target;
extern const FuzzTarget scene_target;
extern const FuzzTarget png_target;
extern const FuzzTarget geotiff_target;
extern const FuzzTarget http_target;
extern const FuzzTarget login_target;
/// Has a bug on purpose: that the fuzzers find it is a test of them (`tests/fuzz/run --self-test`).
extern const FuzzTarget planted_target;

/// Every refusal has a code and a sentence that may travel.
void check_refusal(const Error& error);

/// The input in memory of its own, so that a sanitizer sees the first byte read beyond it.
inline Bytes owned(std::span<const uint8_t> input) { return {input.begin(), input.end()}; }

/// Reads numbers off the front of an input; 0 where it has ended.
class InputReader {
public:
    explicit InputReader(std::span<const uint8_t> input) : rest_(input) {}
    uint8_t byte() {
        if (rest_.empty()) return 0;
        const uint8_t first = rest_.front();
        rest_ = rest_.subspan(1);
        return first;
    }
    uint32_t word() {
        uint32_t value = 0;
        for (int i = 0; i < 4; ++i) value |= uint32_t{byte()} << (8 * i);
        return value;
    }
    uint64_t long_word() {
        const uint64_t low = word();
        return low | (uint64_t{word()} << 32);
    }
    std::span<const uint8_t> rest() const { return rest_; }

private:
    std::span<const uint8_t> rest_;
};

}  // namespace trochoid
