#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// How land acts on waves; server/app turns it into the tracer's settings. Keys, units and ranges: scene-reference.md.
struct SceneLand {
    enum class Refraction : uint8_t { none, phase_shift, straight, eikonal };
    enum class Shoaling : uint8_t { paper, linear };
    uint8_t node_step_log2 = 15;  ///< distance of field nodes, 2^n lattice units (15 = 32 m), 12 to 18
    Refraction refraction = Refraction::eikonal;
    Shoaling shoaling = Shoaling::linear;
    double depth_min_m = 1.0;      ///< depth below which waves get no shorter
    double breaking_ratio = 0.78;  ///< largest significant height over depth; 0 = no limit
    double recovery_m =
        2000.0;           ///< distance behind land over which a shadowed wave grows back to full height
    double spread = 0.2;  ///< half width of the directions that reach into a lee, as a tangent
    bool operator==(const SceneLand&) const = default;
};

/// A wind that blows from some sea time on.
struct SceneWind {
    std::string name;
    StartWind wind;
    SeaTime begin;  ///< may lie before the clock's start, so that the sea has grown when the scene opens
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
    double front_speed = 0.0;  ///< m/s; 0 fills the whole box at once
    std::vector<SceneTrain> trains;
    bool operator==(const SceneBox&) const = default;
};

/// All that a scene file says, checked.
struct Scene {
    std::string name;
    std::filesystem::path terrain;  ///< joined to the scene file's folder; empty: open sea of unlimited depth
    SeaTime clock_start;
    uint32_t rate_q16 = 1U << 16;
    SceneLand land;
    std::vector<SceneWind> winds;
    std::vector<SceneBox> boxes;
    bool operator==(const Scene&) const = default;
};

/// Reads a scene file (TOML; scene-reference.md). A missing or unreadable file, a syntax error, an unknown key and a value
/// of another type or outside its range each throw OperatorError naming file, line, key, range and what to do.
Scene load_scene(const std::filesystem::path& file);

}  // namespace trochoid
