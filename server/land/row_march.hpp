#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/land/land_settings.hpp"

namespace trochoid {

/// The state of one row of a march with a spare column at either end (copies of the outermost).
using MarchRow = std::vector<double>;

/// Phase shift in turns from row to row. Wave numbers are in turns per node, rows per the march step.
class PhaseMarch {
public:
    /// open_wave_number: of the open sea, turns per node; row_step: nodes per row.
    PhaseMarch(const LandSettings& settings, size_t columns, double open_wave_number, double row_step);

    /// One row on, given the wave numbers of the new row (spare columns included).
    void advance(const MarchRow& wave_numbers);
    const MarchRow& shift() const { return shift_; }
    uint64_t cut_slopes() const { return cut_slopes_; }

private:
    void eikonal_step(double step);
    void spread_crests();
    int eikonal_steps_needed() const;
    void limit_slopes(const MarchRow& largest);

    Refraction refraction_;
    double turn_limit_;
    double phase_shift_turns_;
    double open_;
    double row_step_;
    int spread_passes_ = 0;
    double spread_weight_ = 0.0;
    MarchRow shift_;
    MarchRow next_;
    MarchRow before_;
    MarchRow middle_;
    MarchRow bend_;
    MarchRow slope_limit_;
    uint64_t cut_slopes_ = 0;
};

/// Share of the open sea's height behind land and breakers, over seven directions (LandSettings::spread).
class ShelterMarch {
public:
    ShelterMarch(const LandSettings& settings, size_t columns, double node_metres, double row_step);

    /// One row on; `limits` is the largest share that the new row's depth allows (0 on land, 1 in open water).
    void advance(const MarchRow& limits);
    /// Share of the height: root of the directions' mean energy.
    const MarchRow& shelter() const { return shelter_; }

private:
    static constexpr size_t directions = 7;
    double recovered_per_row_;
    double leak_;
    std::array<double, directions> drift_{};
    std::array<MarchRow, directions> share_;
    MarchRow next_;
    MarchRow shelter_;
};

}  // namespace trochoid
