#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/land/land_settings.hpp"
#include "server/land/wide_rows.hpp"

namespace trochoid {

/// The state of one row of a march with a spare column at either end (copies of the outermost). Every step reaches a fixed number
/// of columns to either side and treats both sides alike, so that mirrored land gives mirrored bits.
using MarchRow = std::vector<float>;

/// Phase shift in turns from row to row. Wave numbers are in turns per node, rows per the march step.
class PhaseMarch {
public:
    /// open_wave_number: of the open sea, turns per node; largest_wave_number: over the shallowest bed; row_step: nodes per row.
    PhaseMarch(const LandSettings& settings, size_t columns, double open_wave_number,
               double largest_wave_number, double row_step);

    /// One row on, given the wave numbers of the new row (spare columns included).
    void advance(const MarchRow& wave_numbers);
    const MarchRow& shift() const { return shift_; }
    uint64_t cut_slopes() const { return cut_slopes_; }
    /// Appends the state, takes it back.
    void save(std::vector<float>& state) const;
    const float* load(const float* state);

private:
    TROCHOID_WIDE_ROWS void straight_step(const float* wave_numbers);
    TROCHOID_WIDE_ROWS void eikonal_step(float step);
    TROCHOID_WIDE_ROWS void spread_crests();
    TROCHOID_WIDE_ROWS void limit_slopes();

    Refraction refraction_;
    float turn_limit_;
    float phase_shift_turns_;
    float open_;
    float row_step_;
    int eikonal_steps_ = 1;
    int limit_passes_ = 1;
    int spread_passes_ = 0;
    float spread_weight_ = 0.0F;
    MarchRow shift_;
    MarchRow next_;
    MarchRow before_;
    MarchRow middle_;
    MarchRow bend_;
    MarchRow slope_limit_;
    uint64_t cut_slopes_ = 0;
};

/// Share of the open sea's height behind land and breakers (LandSettings::diffraction).
class ShelterMarch {
public:
    /// wave_number: of the open sea, turns per node.
    ShelterMarch(const LandSettings& settings, size_t columns, double node_metres, double wave_number,
                 double row_step);

    /// One row on; `limits` is the largest share that the new row's depth allows (0 on land, 1 in open water).
    void advance(const MarchRow& limits);
    /// Share of the height.
    const MarchRow& shelter() const { return shelter_; }
    void save(std::vector<float>& state) const;
    const float* load(const float* state);

private:
    static constexpr size_t directions = 7;
    TROCHOID_WIDE_ROWS void recover(const MarchRow& limits);
    TROCHOID_WIDE_ROWS void advance_wedge(const MarchRow& limits);
    TROCHOID_WIDE_ROWS void step_direction(size_t direction, const MarchRow& limits);
    TROCHOID_WIDE_ROWS void advance_parabolic(const MarchRow& limits);
    TROCHOID_WIDE_ROWS void turn_real(float by);
    TROCHOID_WIDE_ROWS void turn_imaginary(float by);

    Diffraction diffraction_;
    float recovered_per_row_;
    float leak_;
    int parabolic_steps_ = 1;
    float parabolic_turn_ = 0.0F;
    std::array<float, directions> drift_{};
    /// none: one share; wedge: one a direction; parabolic: real and imaginary part.
    std::vector<MarchRow> share_;
    MarchRow next_;
    MarchRow shelter_;
};

}  // namespace trochoid
