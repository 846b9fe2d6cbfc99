#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "server/land/bilinear.hpp"
#include "server/land/depth_response.hpp"

namespace trochoid {

/// A band's DepthResponse as a table over depth: 128 cells an octave from 2^-10 m (a lattice unit) to `untouched`, told apart by the bits
/// of the float32 depth and linear in between, so within 6e-6 of a wave number. One look-up gives all that a node needs.
class DepthTable {
public:
    explicit DepthTable(const DepthResponse& response);

    /// 0: k(D) / k of the open sea; 1: growth; 2: largest gain before breaking; 3: largest share that passes. The depth
    /// lies in (0, untouched); below 2^-10 m it counts as that.
    FourFloats at(float depth) const {
        const uint32_t bits = std::max(std::bit_cast<uint32_t>(depth), first_bits);
        const float fraction = static_cast<float>(static_cast<int32_t>(bits & low_mask)) * per_cell;
        const Row& row = rows_[(bits - first_bits) >> low_bits];
        return row.value + row.step * fraction;
    }
    /// On land: 0 gain, growth and wave number of the shore line.
    FourFloats land() const { return land_; }
    float deep() const { return deep_; }
    float untouched() const { return untouched_; }
    float shallowest() const { return shallowest_; }
    /// Depth in metres from which on the box's waves do not break: the largest gain is not below 2 and all passes.
    float breaking() const { return breaking_; }

    /// out[i] = open * k(D) / k for `count` depths > 0, exactly `open` from `deep` on.
    void wave_numbers(const float* depths, size_t count, float open, float* out) const;
    /// out[i] = growth, exactly 1 from `untouched` on, on land the shore line's.
    void growths(const float* depths, size_t count, float* out) const;
    /// out[i] = largest gain before breaking, 0 on land, `beyond` from `breaking` on; what `at` gives, but for many.
    void breaking_gains(const float* depths, size_t count, float beyond, float* out) const;
    /// out[i] = largest share that passes, likewise, exactly 1 from `breaking` on.
    void shares(const float* depths, size_t count, float* out) const;

private:
    static constexpr uint32_t low_bits = 16;
    static constexpr uint32_t low_mask = (1U << low_bits) - 1;
    static constexpr float per_cell = 1.0F / static_cast<float>(1U << low_bits);
    static constexpr uint32_t first_bits = std::bit_cast<uint32_t>(0x1p-10F);
    struct Row {
        FourFloats value;
        FourFloats step;
    };
    float deep_;
    float untouched_;
    float shallowest_;
    FourFloats land_{};
    float breaking_ = 0.0F;
    std::vector<Row> rows_;
    /// One column of the rows each, value and step in turn, so that little memory is touched.
    std::vector<float> wave_numbers_;
    std::vector<float> growths_;
    std::vector<float> breaking_gains_;
    std::vector<float> shares_;
};

}  // namespace trochoid
