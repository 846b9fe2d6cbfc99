#pragma once
#include <cstdint>

namespace trochoid {

/// How depth bends the crests (row A7). All three keep every train's frequency, so none queues towards land.
enum class Refraction : uint8_t {
    none = 0,
    /// The paper's phase shift from local depth alone. It prints no formula; ours: shift = c * (k(D)/k0 - 1) turns with
    /// c = phase_shift_turns and k0 the open sea's wave number, so crests lag over shoals and bend towards the shore.
    phase_shift = 1,
    /// Integral of k(D) - k0 along straight rays: good below about 30 degrees of incidence.
    straight = 2,
    /// One-way eikonal along the travel direction u: d psi/du = sqrt(k(D)^2 - (d psi/dv)^2), shift = psi - k0 u.
    eikonal = 3,
};

/// How the amplitude grows over a rising bottom (row A5).
enum class Shoaling : uint8_t {
    /// The paper's slight growth: 1 + growth * (1 - k0 D / pi) once k0 D < pi.
    paper = 0,
    /// Linear theory: sqrt(cg0 / cg(D)) at fixed frequency.
    linear = 1,
    /// The paper's remedy for land that peeks through troughs: the amplitude falls instead, 1 - shore_decrease * (1 - k0 D / pi).
    decrease = 2,
    /// The open sea's amplitude up to where waves break.
    none = 3,
};

/// How waves reach the water beside and behind an obstacle, from its sides (beyond the paper, whose shadow only recovers along
/// the ray). All three recover over LandSettings::recovery besides (parabolic: 86 % of it).
enum class Diffraction : uint8_t {
    /// The paper's: nothing crosses from ray to ray. Shadows have hard edges.
    none = 0,
    /// The energy is the triangularly weighted mean over seven directions within `spread`: a sea whose directions spread, as
    /// wind seas do (0.71 of the height at the edge of a shadow; Goda's value for random seas).
    wedge = 1,
    /// Parabolic approximation (Radder 1979) of one long-crested wave over even depth: Fresnel's integral behind a breakwater,
    /// half the height at the edge of the shadow, up to 1.17 of it beside. Phases stay those of the refraction.
    parabolic = 2,
};

/// What a trace of land may be told. Same settings, box and terrain: same fields, bit by bit, on every machine.
struct LandSettings {
    /// Node spacing of the fields = 2^step_log2 lattice units, 12 (4 m) to 18 (256 m); 15 is 32 m. A box that covers more
    /// than nodes_max nodes is traced with the next coarser steps, up to 20.
    uint8_t step_log2 = 15;
    /// Rows marched per node along the travel direction, 1 to 8: the march step is node step / rows_per_node.
    uint8_t rows_per_node = 1;
    Refraction refraction = Refraction::eikonal;
    Shoaling shoaling = Shoaling::linear;
    /// Depth in metres below which waves get no shorter, also over land; 0.1 to 100.
    double depth_min = 1.0;
    /// Metres by which the water counts as higher, for land, depth and breaking alike: waves run up the beach that far (row A6); 0 to 10.
    double run_up = 0.0;
    /// Largest significant height over depth, 0.1 to 2; the box's trains are lowered alike. 0 switches the limit off.
    double breaking_ratio = 0.78;
    /// Metres behind land over which the gain climbs linearly from 0 back to 1; 1 to 100000.
    double recovery = 2000.0;
    Diffraction diffraction = Diffraction::wedge;
    /// Half width of Diffraction::wedge as a tangent, 0 to 0.5 (0.2 is 11.3 degrees): shadows end within recovery or this wedge.
    double spread = 0.2;
    /// Growth at the shore line of Shoaling::paper, 0 to 1.
    double growth = 0.25;
    /// Loss at the shore line of Shoaling::decrease, 0 to 1 (1: no wave is left there).
    double shore_decrease = 0.75;
    /// Flatter orbits over shallow water (row B14): the fields' third plane, coth(k(D) D) over the open sea's, below 4.
    bool shallow_orbits = false;
    /// c of Refraction::phase_shift in turns, 0 to 16.
    double phase_shift_turns = 1.0;
    /// Steepness (sum of |k'| * A * gain over the box's trains) from which on the land's waves break, 0.1 to 0.8. A box may
    /// grow by expected_land_growth (server/world/steepness.hpp) in any case, so choppiness need not fall for it. Choppiness
    /// does not enter: it is lowered after a trace, and a replayed log traces with what was lowered.
    double steepness_max = 0.45;
    /// |d psi/dv| <= turn_limit * k: crests turn by at most asin of it; 0.1 to 0.97. The eikonal takes one step a row up to 0.707,
    /// two up to 0.894 (63 degrees) and four beyond.
    double turn_limit = 0.89;
    /// Variance across the travel direction, per wave length and distance, by which Refraction::eikonal lets crests even out, 0 to 4:
    /// diffraction smears a crest over sqrt(wave length * distance), where rays alone would leave it kinked for good. Not with
    /// Diffraction::none.
    double crest_spread = 1.0;
    /// Metres beyond the terrain over which shift and gain fade back to the open sea's; 256 to 100000.
    double run_out = 4096.0;
    /// Bands with more wave lengths than this in a node step get gains but no shift (nodes cannot carry it); 0.25 to 16.
    double waves_per_node_max = 4.0;
    /// Most nodes of one field, 2^10 to 2^26.
    uint32_t nodes_max = uint32_t{1} << 22;
    /// Threads to trace bands on; 0: as many as the machine has. Never changes the result.
    uint32_t threads = 0;
    bool operator==(const LandSettings&) const = default;
};

/// Null where all settings keep their ranges, else a sentence naming the first that does not.
const char* land_settings_fault(const LandSettings& settings);

}  // namespace trochoid
