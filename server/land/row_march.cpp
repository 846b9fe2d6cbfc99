#include "server/land/row_march.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// Largest change across one node, turns: at any angle to the lattice two nodes then differ by less than the 128 turns that a
/// block may step.
constexpr double largest_slope = 60.0;
/// A node holds below 2^14 turns.
constexpr double largest_shift = 8192.0;

/// Enough for waves of 27 nodes' length; longer ones spread less than they should.
constexpr int most_spread_passes = 40;

/// The smaller of two of one sign, else 0 (minmod).
double smaller_bend(double a, double b) {
    return std::max(std::min(a, b), 0.0) + std::min(std::max(a, b), 0.0);
}

void copy_ends(MarchRow& row) {
    row.front() = row[1];
    row.back() = row[row.size() - 2];
}

/// Weights of the seven directions: a triangle, exact in binary, sum 1.
constexpr std::array<double, 7> direction_weights = {1.0 / 16, 2.0 / 16, 3.0 / 16, 4.0 / 16,
                                                     3.0 / 16, 2.0 / 16, 1.0 / 16};
/// Share that passes to either neighbour per node of travel, so that even a straight shadow's edge is soft.
constexpr double leak_per_node = 1.0 / 16;

}  // namespace

PhaseMarch::PhaseMarch(const LandSettings& settings, size_t columns, double open_wave_number, double row_step)
    : refraction_(settings.refraction),
      turn_limit_(settings.turn_limit),
      phase_shift_turns_(settings.phase_shift_turns),
      open_(open_wave_number),
      row_step_(row_step),
      shift_(columns + 2, 0.0),
      next_(columns + 2, 0.0),
      before_(columns + 2, open_wave_number),
      middle_(columns + 2, open_wave_number),
      bend_(columns + 2, 0.0),
      slope_limit_(columns + 2, largest_slope) {
    // Variance per row in nodes^2; a pass of weight w has variance 2 w and is smooth up to w = 1/3.
    const double variance = settings.crest_spread * row_step / open_wave_number;
    while (spread_passes_ < most_spread_passes && variance > 2.0 / 3.0 * static_cast<double>(spread_passes_))
        ++spread_passes_;
    if (spread_passes_ > 0)
        spread_weight_ = std::min(0.5 * variance / static_cast<double>(spread_passes_), 1.0 / 3.0);
}

void PhaseMarch::advance(const MarchRow& wave_numbers) {
    const size_t n = wave_numbers.size();
    switch (refraction_) {
        case Refraction::none: return;
        case Refraction::phase_shift:
            for (size_t j = 0; j < n; ++j) shift_[j] = phase_shift_turns_ * (wave_numbers[j] / open_ - 1.0);
            break;
        case Refraction::straight:
            for (size_t j = 0; j < n; ++j)
                shift_[j] = shift_[j] + row_step_ * ((before_[j] + wave_numbers[j]) * 0.5 - open_);
            break;
        case Refraction::eikonal: {
            for (size_t j = 0; j < n; ++j) middle_[j] = (before_[j] + wave_numbers[j]) * 0.5;
            const int steps = eikonal_steps_needed();
            for (int i = 0; i < steps; ++i) eikonal_step(row_step_ / static_cast<double>(steps));
            spread_crests();
            for (size_t j = 0; j < n; ++j)
                slope_limit_[j] = std::min(turn_limit_ * wave_numbers[j], largest_slope);
            break;
        }
    }
    for (size_t j = 0; j < n; ++j) shift_[j] = std::min(shift_[j], largest_shift);
    limit_slopes(slope_limit_);
    before_ = wave_numbers;
}

/// Upwind (Godunov) differences, second order by ENO, of a Hamilton-Jacobi equation that is convex in the slope: the first arrival wins.
void PhaseMarch::eikonal_step(double step) {
    const size_t last = shift_.size() - 1;
    const double* const s = shift_.data();
    const double* const k = middle_.data();
    double* const bend = bend_.data();
    double* const out = next_.data();
    for (size_t j = 1; j < last; ++j) bend[j] = (s[j - 1] - s[j]) + (s[j + 1] - s[j]);
    for (size_t j = 1; j < last; ++j) {
        const double left = s[j] - s[j - 1];
        const double right = s[j] - s[j + 1];
        // Second order where both neighbours bend alike; never where the difference itself points the other way, so that
        // untouched water stays exactly so.
        const double from_left = left > 0.0 ? left + 0.5 * smaller_bend(bend[j - 1], bend[j]) : 0.0;
        const double from_right = right > 0.0 ? right + 0.5 * smaller_bend(bend[j], bend[j + 1]) : 0.0;
        const double steepest = std::max(std::max(from_left, from_right), 0.0);
        const double slope = std::min(steepest, turn_limit_ * k[j]);
        out[j] = s[j] + step * (std::sqrt(k[j] * k[j] - slope * slope) - open_);
    }
    copy_ends(next_);
    shift_.swap(next_);
}

/// Diffusion across the travel direction with variance crest_spread * wave length * distance, of ridges of the shift alone: there
/// crests meet that came round from two sides. Elsewhere bends are refraction, and untouched water stays untouched.
void PhaseMarch::spread_crests() {
    const size_t last = shift_.size() - 1;
    for (int pass = 0; pass < spread_passes_; ++pass) {
        const double* const s = shift_.data();
        double* const out = next_.data();
        for (size_t j = 1; j < last; ++j) {
            const double bend = (s[j - 1] - s[j]) + (s[j + 1] - s[j]);
            out[j] = s[j] + spread_weight_ * std::min(bend, 0.0);
        }
        copy_ends(next_);
        shift_.swap(next_);
    }
}

/// Steps within the row so that no crest moves farther across than one column a step.
int PhaseMarch::eikonal_steps_needed() const {
    const size_t last = shift_.size() - 1;
    double over_mild = -1.0;
    double over_steep = -1.0;
    for (size_t j = 1; j < last; ++j) {
        const double slope = std::max(shift_[j] - shift_[j - 1], shift_[j] - shift_[j + 1]);
        const double positive = std::max(slope, 0.0);
        const double square = positive * positive;
        const double k_square = middle_[j] * middle_[j];
        // slope / sqrt(k^2 - slope^2) <= 1 up to slope^2 = k^2 / 2, and <= 2 up to 4/5.
        over_mild = std::max(over_mild, square - 0.49 * k_square);
        over_steep = std::max(over_steep, square - 0.79 * k_square);
    }
    const double per_node = over_steep > 0.0 ? 4.0 : (over_mild > 0.0 ? 2.0 : 1.0);
    int steps = 1;
    while (static_cast<double>(steps) < per_node * row_step_) ++steps;
    return steps;
}

/// Cuts peaks so that no neighbours differ by more than the limit: waves that come round from the side arrive first.
void PhaseMarch::limit_slopes(const MarchRow& largest) {
    const size_t last = shift_.size() - 1;
    double worst = -1.0;
    for (size_t j = 1; j < last; ++j) {
        const double slope = std::max(shift_[j] - shift_[j - 1], shift_[j] - shift_[j + 1]);
        worst = std::max(worst, slope - largest[j]);
    }
    if (worst <= 0.0) return;
    for (size_t j = 2; j < last; ++j) {
        const double reach = shift_[j - 1] + largest[j];
        if (shift_[j] > reach) {
            shift_[j] = reach;
            if (largest[j] == largest_slope) ++cut_slopes_;
        }
    }
    for (size_t j = last - 2; j >= 1; --j) {
        const double reach = shift_[j + 1] + largest[j];
        if (shift_[j] > reach) {
            shift_[j] = reach;
            if (largest[j] == largest_slope) ++cut_slopes_;
        }
    }
    copy_ends(shift_);
}

ShelterMarch::ShelterMarch(const LandSettings& settings, size_t columns, double node_metres, double row_step)
    : recovered_per_row_(node_metres * row_step / settings.recovery),
      leak_(leak_per_node * row_step),
      next_(columns + 2, 1.0),
      shelter_(columns + 2, 1.0) {
    for (size_t d = 0; d < directions; ++d) {
        drift_[d] = settings.spread * row_step * (static_cast<double>(d) - 3.0) / 3.0;
        share_[d].assign(columns + 2, 1.0);
    }
}

void ShelterMarch::advance(const MarchRow& limits) {
    const size_t last = shelter_.size() - 1;
    std::fill(shelter_.begin(), shelter_.end(), 0.0);
    for (size_t d = 0; d < directions; ++d) {
        const double from_left = leak_ + std::max(drift_[d], 0.0);
        const double from_right = leak_ + std::max(-drift_[d], 0.0);
        const double* const q = share_[d].data();
        double* const out = next_.data();
        double* const energy = shelter_.data();
        for (size_t j = 1; j < last; ++j) {
            const double moved = q[j] + from_left * (q[j - 1] - q[j]) + from_right * (q[j + 1] - q[j]);
            const double grown = std::min(moved + recovered_per_row_, 1.0);
            out[j] = std::min(grown, limits[j]);
            energy[j] = energy[j] + direction_weights[d] * (out[j] * out[j]);
        }
        copy_ends(next_);
        share_[d].swap(next_);
    }
    for (size_t j = 1; j < last; ++j) shelter_[j] = std::sqrt(shelter_[j]);
    copy_ends(shelter_);
}

}  // namespace trochoid
