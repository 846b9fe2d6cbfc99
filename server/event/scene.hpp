#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/model/surface_noise.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// How land acts on waves; server/app turns it into the tracer's settings. Keys, units and ranges: scene-reference.md.
struct SceneLand {
    enum class Refraction : uint8_t { none, phase_shift, straight, eikonal };
    enum class Shoaling : uint8_t { paper, linear, decrease, none };
    enum class Diffraction : uint8_t { none, wedge, parabolic };
    uint8_t node_step_log2 = 15;  ///< distance of field nodes, 2^n lattice units (15 = 32 m), 12 to 18
    Refraction refraction = Refraction::eikonal;
    Shoaling shoaling = Shoaling::linear;
    double depth_min_m = 1.0;      ///< depth below which waves get no shorter
    double breaking_ratio = 0.78;  ///< largest significant height over depth; 0 = no limit
    /// Distance behind land over which a shadowed wave grows back to full height.
    double recovery_m = 2000.0;
    double spread = 0.2;           ///< half width of the directions that reach into a lee, as a tangent
    double run_up_m = 0.0;         ///< how far waves run up the beach: the water counts as higher by it
    double shore_decrease = 0.75;  ///< loss at the shore line of Shoaling::decrease
    Diffraction diffraction = Diffraction::wedge;
    bool shallow_orbits = false;  ///< flatter orbits over shallow water
    bool operator==(const SceneLand&) const = default;
};

/// From a sea time on a box, or a ship, moves this way.
struct SceneLeg {
    SeaTime at;
    double towards_degrees = 0.0;  ///< clockwise from north, [0, 360)
    double speed = 0.0;            ///< m/s
    bool operator==(const SceneLeg&) const = default;
};

/// A wind that blows from some sea time on; with legs a storm cell on a track.
struct SceneWind {
    std::string name;
    StartWind wind;  ///< its velocity is 0: the legs have it
    SeaTime begin;   ///< may lie before the clock's start, so that the sea has grown when the scene opens
    std::vector<SceneLeg> legs{};  ///< ascending; the box stands still before the first
    bool operator==(const SceneWind&) const = default;
};

/// A train written by hand (row A1).
struct SceneTrain {
    double wavelength_m = 0.0;
    double towards_degrees = 0.0;  ///< clockwise from north, [0, 360)
    double amplitude_m = 0.0;
    double phase_turns = 0.0;  ///< at x = z = 0 and sea time 0, [0, 1)
    double choppiness = 1.0;
    bool operator==(const SceneTrain&) const = default;
};

/// Irregular heights (paper A, eq. 8; row A8) as a scene gives them.
struct SceneIrregular {
    enum class Form : uint8_t {
        groups,  ///< groups of higher waves that travel at the group speed
        paper,   ///< the paper's literal sin(t + u) sin(v f): 1 rad/s and 1 rad/m, against the waves
    };
    Form form = Form::groups;
    double share = 0.0;     ///< a/A, 0 to 1; 0 = none
    double along_m = 0.0;   ///< from group to group along the travel; 0: six wave lengths, or the paper's
    double across_m = 0.0;  ///< across; 0: as along
    uint64_t seed = 1;      ///< where the groups stand; the paper's form counts from the box's corner
    bool operator==(const SceneIrregular&) const = default;
};

/// A wave train box written by hand (rows A1, A4).
struct SceneBox {
    std::string name;
    double towards_degrees = 0.0;  ///< heading of u
    LatticePoint origin;           ///< middle of the rear edge
    int64_t length = 0;            ///< lattice units; 0 = unlimited
    int64_t width = 0;
    int64_t ramp_rear = 0;  ///< lattice units
    int64_t ramp_front = 0;
    int64_t ramp_side = 0;
    SeaTime begin;
    int64_t build_up_us = 0;
    int64_t life_us = 0;  ///< 0 = until stopped
    int64_t decay_us = 0;
    double front_speed = 0.0;        ///< m/s; 0 fills the whole box at once
    std::vector<SceneTrain> trains;  ///< may be empty where there is noise
    double reference_depth_m = 0.0;  ///< depth that the trains' frequencies are for (row B2); 0 = deep
    double roundness = 0.0;          ///< round waves (eq. 10), 0 to 1
    SceneIrregular irregular{};
    SurfaceNoise noise{};
    std::vector<SceneLeg> legs{};  ///< as of a wind
    bool operator==(const SceneBox&) const = default;
};

/// A ship with its wake (rows A12, B11); its first course is that of `ship`.
struct SceneShip {
    StartShip ship;
    SeaTime begin;
    std::vector<SceneLeg> legs;  ///< further courses, ascending, all after `begin`; speed 0 stops it
    bool operator==(const SceneShip&) const = default;
};

/// All that a scene file says, checked.
struct Scene {
    std::string name;
    std::filesystem::path terrain;  ///< joined to the scene file's folder; empty: open sea of unlimited depth
    SeaTime clock_start;
    uint32_t rate_q16 = 1U << 16;
    SceneLand land;
    std::vector<ChangeLand> breakwaters;  ///< applied to the terrain when the scene opens
    std::vector<SceneWind> winds;
    std::vector<SceneBox> boxes;  ///< the last one is [ripples], where the scene has it
    std::vector<SceneShip> ships;
    bool operator==(const Scene&) const = default;
};

/// Reads a scene file (TOML; scene-reference.md). A missing or unreadable file, a syntax error, an unknown key and a value
/// of another type or outside its range each throw OperatorError naming file, line, key, range and what to do.
Scene load_scene(const std::filesystem::path& file);

}  // namespace trochoid
