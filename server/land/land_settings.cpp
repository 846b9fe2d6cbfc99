#include "server/land/land_settings.hpp"

namespace trochoid {

namespace {

/// False for NaN too.
bool within(double value, double least, double most) { return value >= least && value <= most; }

}  // namespace

const char* land_settings_fault(const LandSettings& s) {
    if (s.step_log2 < 12 || s.step_log2 > 18)
        return "land: the node step is outside 4 m to 256 m (2^12..2^18 lattice units)";
    if (s.rows_per_node < 1 || s.rows_per_node > 8) return "land: rows_per_node is outside 1..8";
    if (s.refraction > Refraction::eikonal)
        return "land: refraction is none of none, phase_shift, straight, eikonal";
    if (s.shoaling > Shoaling::none) return "land: shoaling is none of paper, linear, decrease, none";
    if (s.diffraction > Diffraction::parabolic) return "land: diffraction is none of none, wedge, parabolic";
    if (!within(s.depth_min, 0.1, 100.0)) return "land: depth_min is outside 0.1..100 m";
    if (!within(s.run_up, 0.0, 10.0)) return "land: run_up is outside 0..10 m";
    if (s.breaking_ratio != 0.0 && !within(s.breaking_ratio, 0.1, 2.0))
        return "land: breaking_ratio is neither 0 nor in 0.1..2";
    if (!within(s.recovery, 1.0, 100000.0)) return "land: recovery is outside 1..100000 m";
    if (!within(s.spread, 0.0, 0.5)) return "land: spread is outside 0..0.5";
    if (!within(s.growth, 0.0, 1.0)) return "land: growth is outside 0..1";
    if (!within(s.shore_decrease, 0.0, 1.0)) return "land: shore_decrease is outside 0..1";
    if (!within(s.phase_shift_turns, 0.0, 16.0)) return "land: phase_shift_turns is outside 0..16";
    if (!within(s.steepness_max, 0.1, 0.8)) return "land: steepness_max is outside 0.1..0.8";
    if (!within(s.turn_limit, 0.1, 0.97)) return "land: turn_limit is outside 0.1..0.97";
    if (!within(s.crest_spread, 0.0, 4.0)) return "land: crest_spread is outside 0..4";
    if (!within(s.run_out, 256.0, 100000.0)) return "land: run_out is outside 256..100000 m";
    if (!within(s.waves_per_node_max, 0.25, 16.0)) return "land: waves_per_node_max is outside 0.25..16";
    if (s.nodes_max < (1U << 10) || s.nodes_max > (1U << 26)) return "land: nodes_max is outside 2^10..2^26";
    return nullptr;
}

}  // namespace trochoid
