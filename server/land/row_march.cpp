#include "server/land/row_march.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/finite_depth.hpp"

namespace trochoid {

namespace {

/// Largest change across one node, turns: at any angle to the lattice two nodes then differ by less than the 128 turns that a
/// block may step.
constexpr float largest_slope = 60.0F;
/// A node holds below 2^14 turns.
constexpr float largest_shift = 8192.0F;

/// Enough for waves of 27 nodes' length; longer ones spread less than they should.
constexpr int most_spread_passes = 40;
/// A pass of limit_slopes lets neighbours exceed the limit by what a row adds: at most this many turns.
constexpr double slope_excess = 24.0;
constexpr int most_limit_passes = 16;

/// The smaller of two of one sign, else 0 (minmod).
float smaller_bend(float a, float b) {
    return std::max(std::min(a, b), 0.0F) + std::min(std::max(a, b), 0.0F);
}

void copy_ends(MarchRow& row) {
    row.front() = row[1];
    row.back() = row[row.size() - 2];
}

/// Weights of the seven directions, the outermost first: a triangle, exact in binary; both sides and the middle sum to 1.
constexpr std::array<float, 4> direction_weights = {1.0F / 16, 2.0F / 16, 3.0F / 16, 4.0F / 16};
/// Share that passes to either neighbour per node of travel, so that even a straight shadow's edge is soft.
constexpr double leak_per_node = 1.0 / 16;
/// The same for the parabolic march, against ripples from node to node; less, as it also damps what runs deep into a shadow.
constexpr double parabolic_leak_per_node = 1.0 / 128;
/// Turn of the parabolic step per column pair; the leapfrog is stable below 1/2.
constexpr double largest_parabolic_turn = 0.4;
constexpr int most_parabolic_steps = 16;
/// Below this height a wave has no phase to keep.
constexpr float no_wave = 1e-6F;

const float* take(MarchRow& row, const float* state) {
    std::copy_n(state, row.size(), row.begin());
    return state + row.size();
}

}  // namespace

PhaseMarch::PhaseMarch(const LandSettings& settings, size_t columns, double open_wave_number,
                       double largest_wave_number, double row_step)
    : refraction_(settings.refraction),
      turn_limit_(static_cast<float>(settings.turn_limit)),
      phase_shift_turns_(static_cast<float>(settings.phase_shift_turns)),
      open_(static_cast<float>(open_wave_number)),
      row_step_(static_cast<float>(row_step)),
      shift_(columns + 2, 0.0F),
      next_(columns + 2, 0.0F),
      before_(columns + 2, open_),
      middle_(columns + 2, open_),
      bend_(columns + 2, 0.0F),
      slope_limit_(columns + 2, largest_slope) {
    // No crest moves farther across than one column a step: tan(asin(turn_limit)) columns a node.
    const double per_node = settings.turn_limit <= 0.7071 ? 1.0 : (settings.turn_limit <= 0.8944 ? 2.0 : 4.0);
    while (static_cast<double>(eikonal_steps_) < per_node * row_step) ++eikonal_steps_;
    const double added = (largest_wave_number - open_wave_number) * row_step;
    while (limit_passes_ < most_limit_passes && added > slope_excess * static_cast<double>(limit_passes_))
        ++limit_passes_;
    if (settings.diffraction == Diffraction::none) return;
    // Variance per row in nodes^2; a pass of weight w has variance 2 w and is smooth up to w = 1/3.
    const double variance = settings.crest_spread * row_step / open_wave_number;
    while (spread_passes_ < most_spread_passes && variance > 2.0 / 3.0 * static_cast<double>(spread_passes_))
        ++spread_passes_;
    if (spread_passes_ > 0)
        spread_weight_ =
            static_cast<float>(std::min(0.5 * variance / static_cast<double>(spread_passes_), 1.0 / 3.0));
}

void PhaseMarch::advance(const MarchRow& wave_numbers) {
    const size_t n = wave_numbers.size();
    const float* const k = wave_numbers.data();
    float* const s = shift_.data();
    switch (refraction_) {
        case Refraction::none: return;
        case Refraction::phase_shift:
            for (size_t j = 0; j < n; ++j) s[j] = phase_shift_turns_ * (k[j] / open_ - 1.0F);
            break;
        case Refraction::straight: straight_step(k); break;
        case Refraction::eikonal:
            for (size_t j = 0; j < n; ++j) middle_[j] = (before_[j] + k[j]) * 0.5F;
            for (int i = 0; i < eikonal_steps_; ++i)
                eikonal_step(row_step_ / static_cast<float>(eikonal_steps_));
            spread_crests();
            for (size_t j = 0; j < n; ++j) slope_limit_[j] = std::min(turn_limit_ * k[j], largest_slope);
            break;
    }
    for (int pass = 0; pass < limit_passes_; ++pass) limit_slopes();
    std::copy_n(k, n, before_.data());
}

TROCHOID_WIDE_ROWS void PhaseMarch::straight_step(const float* wave_numbers) {
    const size_t n = shift_.size();
    const float* __restrict const k = wave_numbers;
    const float* __restrict const before = before_.data();
    float* __restrict const s = shift_.data();
    for (size_t j = 0; j < n; ++j) s[j] = s[j] + row_step_ * ((before[j] + k[j]) * 0.5F - open_);
}

/// Upwind (Godunov) differences, second order by ENO, of a Hamilton-Jacobi equation that is convex in the slope: the first arrival wins.
TROCHOID_WIDE_ROWS void PhaseMarch::eikonal_step(float step) {
    const size_t last = shift_.size() - 1;
    const float* const s = shift_.data();
    const float* const k = middle_.data();
    float* const bend = bend_.data();
    float* const out = next_.data();
    for (size_t j = 1; j < last; ++j) bend[j] = (s[j - 1] - s[j]) + (s[j + 1] - s[j]);
    for (size_t j = 1; j < last; ++j) {
        const float left = s[j] - s[j - 1];
        const float right = s[j] - s[j + 1];
        // Second order where both neighbours bend alike; never where the difference itself points the other way, so that
        // untouched water stays exactly so.
        const float from_left = left > 0.0F ? left + 0.5F * smaller_bend(bend[j - 1], bend[j]) : 0.0F;
        const float from_right = right > 0.0F ? right + 0.5F * smaller_bend(bend[j], bend[j + 1]) : 0.0F;
        const float steepest = std::max(std::max(from_left, from_right), 0.0F);
        const float slope = std::min(steepest, turn_limit_ * k[j]);
        out[j] = s[j] + step * (std::sqrt(k[j] * k[j] - slope * slope) - open_);
    }
    copy_ends(next_);
    shift_.swap(next_);
}

/// Diffusion across the travel direction with variance crest_spread * wave length * distance, of ridges of the shift alone: there
/// crests meet that came round from two sides. Elsewhere bends are refraction, and untouched water stays untouched.
TROCHOID_WIDE_ROWS void PhaseMarch::spread_crests() {
    const size_t last = shift_.size() - 1;
    for (int pass = 0; pass < spread_passes_; ++pass) {
        const float* const s = shift_.data();
        float* const out = next_.data();
        for (size_t j = 1; j < last; ++j) {
            const float bend = (s[j - 1] - s[j]) + (s[j + 1] - s[j]);
            out[j] = s[j] + spread_weight_ * std::min(bend, 0.0F);
        }
        copy_ends(next_);
        shift_.swap(next_);
    }
}

/// Cuts peaks so that neighbours hardly differ by more than the limit: waves that come round from the side arrive first.
TROCHOID_WIDE_ROWS void PhaseMarch::limit_slopes() {
    const size_t last = shift_.size() - 1;
    const float* const s = shift_.data();
    const float* const limit = slope_limit_.data();
    float* const out = next_.data();
    uint32_t cut = 0;
    for (size_t j = 1; j < last; ++j) {
        const float reach = std::min(std::min(s[j - 1], s[j + 1]) + limit[j], largest_shift);
        cut += s[j] > reach && limit[j] == largest_slope ? 1U : 0U;
        out[j] = std::min(s[j], reach);
    }
    cut_slopes_ += cut;
    copy_ends(next_);
    shift_.swap(next_);
}

void PhaseMarch::save(std::vector<float>& state) const {
    state.insert(state.end(), shift_.begin(), shift_.end());
    state.insert(state.end(), before_.begin(), before_.end());
}

const float* PhaseMarch::load(const float* state) { return take(before_, take(shift_, state)); }

ShelterMarch::ShelterMarch(const LandSettings& settings, size_t columns, double node_metres,
                           double wave_number, double row_step)
    : diffraction_(settings.diffraction),
      recovered_per_row_(static_cast<float>(node_metres * row_step / settings.recovery)),
      leak_(static_cast<float>(
          (diffraction_ == Diffraction::parabolic ? parabolic_leak_per_node : leak_per_node) * row_step)),
      next_(columns + 2, 1.0F),
      shelter_(columns + 2, 1.0F) {
    switch (diffraction_) {
        case Diffraction::none: break;
        case Diffraction::wedge:
            for (size_t d = 0; d < directions; ++d)
                drift_[d] =
                    static_cast<float>(settings.spread * row_step) * ((static_cast<float>(d) - 3.0F) / 3.0F);
            share_.assign(directions, MarchRow(columns + 2, 1.0F));
            break;
        case Diffraction::parabolic: {
            // dA/du = i / (2 k) d2A/dv2 with k = 2 pi wave_number.
            const double turn = row_step / (2.0 * two_pi_f64 * wave_number);
            while (parabolic_steps_ < most_parabolic_steps &&
                   turn > largest_parabolic_turn * static_cast<double>(parabolic_steps_))
                ++parabolic_steps_;
            parabolic_turn_ = static_cast<float>(
                std::min(turn / static_cast<double>(parabolic_steps_), largest_parabolic_turn));
            share_.assign(2, MarchRow(columns + 2, 1.0F));
            std::fill(share_[1].begin(), share_[1].end(), 0.0F);
            break;
        }
    }
}

void ShelterMarch::advance(const MarchRow& limits) {
    switch (diffraction_) {
        case Diffraction::none: recover(limits); break;
        case Diffraction::wedge: advance_wedge(limits); break;
        case Diffraction::parabolic: advance_parabolic(limits); break;
    }
    copy_ends(shelter_);
}

TROCHOID_WIDE_ROWS void ShelterMarch::recover(const MarchRow& limits) {
    const size_t n = shelter_.size();
    const float* __restrict const most = limits.data();
    float* __restrict const shelter = shelter_.data();
    for (size_t j = 0; j < n; ++j)
        shelter[j] = std::min(std::min(shelter[j] + recovered_per_row_, 1.0F), most[j]);
}

TROCHOID_WIDE_ROWS void ShelterMarch::step_direction(size_t direction, const MarchRow& limits) {
    const size_t last = shelter_.size() - 1;
    const float from_left = leak_ + std::max(drift_[direction], 0.0F);
    const float from_right = leak_ + std::max(-drift_[direction], 0.0F);
    const float* const q = share_[direction].data();
    const float* const most = limits.data();
    float* const out = next_.data();
    for (size_t j = 1; j < last; ++j) {
        const float moved = q[j] + (from_left * (q[j - 1] - q[j]) + from_right * (q[j + 1] - q[j]));
        out[j] = std::min(std::min(moved + recovered_per_row_, 1.0F), most[j]);
    }
    copy_ends(next_);
    share_[direction].swap(next_);
}

/// Root of the directions' mean energy; pairs of mirrored directions first.
TROCHOID_WIDE_ROWS void ShelterMarch::advance_wedge(const MarchRow& limits) {
    const size_t last = shelter_.size() - 1;
    for (size_t d = 0; d < directions; ++d) step_direction(d, limits);
    const auto row = [&](size_t d) { return share_[d].data(); };
    const float* const q0 = row(0);
    const float* const q1 = row(1);
    const float* const q2 = row(2);
    const float* const q3 = row(3);
    const float* const q4 = row(4);
    const float* const q5 = row(5);
    const float* const q6 = row(6);
    float* const out = shelter_.data();
    for (size_t j = 1; j < last; ++j) {
        const float outer = direction_weights[0] * (q0[j] * q0[j] + q6[j] * q6[j]) +
                            direction_weights[1] * (q1[j] * q1[j] + q5[j] * q5[j]);
        const float inner =
            direction_weights[2] * (q2[j] * q2[j] + q4[j] * q4[j]) + direction_weights[3] * (q3[j] * q3[j]);
        out[j] = std::sqrt(outer + inner);
    }
}

TROCHOID_WIDE_ROWS void ShelterMarch::turn_real(float by) {
    const size_t last = shelter_.size() - 1;
    float* const r = share_[0].data();
    const float* const i = share_[1].data();
    for (size_t j = 1; j < last; ++j) r[j] = r[j] - by * ((i[j - 1] - i[j]) + (i[j + 1] - i[j]));
    copy_ends(share_[0]);
}

TROCHOID_WIDE_ROWS void ShelterMarch::turn_imaginary(float by) {
    const size_t last = shelter_.size() - 1;
    const float* const r = share_[0].data();
    float* const i = share_[1].data();
    for (size_t j = 1; j < last; ++j) i[j] = i[j] + by * ((r[j - 1] - r[j]) + (r[j + 1] - r[j]));
    copy_ends(share_[1]);
}

/// Leapfrog of real and imaginary part (half, whole, half), some leak against ripples that nodes cannot carry, recovery towards the
/// open sea's wave (86 % over LandSettings::recovery; the height alone must not grow, or what comes round a corner would meet
/// it out of step), then what the depth allows.
TROCHOID_WIDE_ROWS void ShelterMarch::advance_parabolic(const MarchRow& limits) {
    for (int step = 0; step < parabolic_steps_; ++step) {
        turn_real(0.5F * parabolic_turn_);
        turn_imaginary(parabolic_turn_);
        turn_real(0.5F * parabolic_turn_);
    }
    const size_t last = shelter_.size() - 1;
    const float back = std::min(2.0F * recovered_per_row_, 1.0F);
    for (size_t part = 0; part < 2; ++part) {
        const float open = part == 0 ? 1.0F : 0.0F;
        const float* const q = share_[part].data();
        float* const out = next_.data();
        for (size_t j = 1; j < last; ++j)
            out[j] = (q[j] + leak_ * ((q[j - 1] - q[j]) + (q[j + 1] - q[j]))) + back * (open - q[j]);
        share_[part].swap(next_);
    }
    float* const r = share_[0].data();
    float* const i = share_[1].data();
    const float* const most = limits.data();
    float* const out = shelter_.data();
    for (size_t j = 1; j < last; ++j) {
        const float height = std::sqrt(r[j] * r[j] + i[j] * i[j]);
        const float kept = most[j] < 1.0F ? std::min(height, most[j]) : height;
        const float scale = height > no_wave ? kept / std::max(height, no_wave) : 0.0F;
        r[j] = r[j] * scale;
        i[j] = i[j] * scale;
        out[j] = kept;
    }
    copy_ends(share_[0]);
    copy_ends(share_[1]);
}

void ShelterMarch::save(std::vector<float>& state) const {
    state.insert(state.end(), shelter_.begin(), shelter_.end());
    for (const MarchRow& row : share_) state.insert(state.end(), row.begin(), row.end());
}

const float* ShelterMarch::load(const float* state) {
    state = take(shelter_, state);
    for (MarchRow& row : share_) state = take(row, state);
    return state;
}

}  // namespace trochoid
