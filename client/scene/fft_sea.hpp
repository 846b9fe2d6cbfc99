#pragma once
#include <array>
#include <complex>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

namespace trochoid {

/// A patch of sea made by inverse Fourier transform, for comparison with the sum of wave trains (papers B and D; Tessendorf, Simulating
/// Ocean Water): a periodic tile whose spectrum is Pierson and Moskowitz', spread by cos^2 about a heading. Purely visual, nobody
/// else computes the same.
struct FftSeaSettings {
    uint32_t side = 256;              ///< samples along a side, a power of two, 16 to 1024
    uint32_t tile_log2 = 19;          ///< side of the tile, 2^n lattice units: 512 m
    float significant_height = 1.0F;  ///< 4 sqrt(m0) of the whole spectrum, m, 0 to 30
    glm::vec2 heading{1.0F, 0.0F};    ///< unit vector of travel (x east, z south)
    uint32_t seed = 1;
    bool operator==(const FftSeaSettings&) const = default;
};

/// Wavelength and period at the peak of Pierson and Moskowitz' spectrum with this significant height: m, s.
double peak_wavelength_of(double significant_height);
double peak_period_of(double significant_height);

class FftSea {
public:
    explicit FftSea(const FftSeaSettings& settings);
    FftSea(const FftSea&) = delete;
    FftSea& operator=(const FftSea&) = delete;
    ~FftSea();

    const FftSeaSettings& settings() const { return settings_; }
    /// The tile at a time, seconds. displaced(): (aX, height, aZ, daX/dz) and slopes(): (dh/dx, dh/dz, daX/dx, daZ/dz), row by row
    /// from the north-west; a place's displacement is (-aX, height, -aZ), as in the model.
    void transform(double seconds);
    std::span<const glm::vec4> displaced() const { return displaced_; }
    std::span<const glm::vec4> slopes() const { return slopes_; }

    /// Slope variance of the waves that are at least two samples long when every 2^level samples are averaged; [0] is the whole tile.
    const std::array<float, 12>& slope_variance() const { return slope_variance_; }

private:
    struct Transform;
    void make_spectrum();

    FftSeaSettings settings_;
    std::vector<std::complex<float>> amplitude_;  // h0 of each wave vector
    std::vector<double> omega_;                   // rad/s
    std::vector<glm::vec4> displaced_;
    std::vector<glm::vec4> slopes_;
    std::array<float, 12> slope_variance_{};
    std::unique_ptr<Transform> transform_;
};

}  // namespace trochoid
