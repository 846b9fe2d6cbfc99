#pragma once
#include <span>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/ship_hull.hpp"
#include "client/scene/ship_pose.hpp"

namespace trochoid {

/// The hulls of ships, lit as everything else. Drawn before the sea, which then covers what lies below the water.
class ShipPass {
public:
    ShipPass();
    /// Depth test and framebuffer are the caller's.
    void draw(std::span<const FloatingShip> ships, const CameraFrame& frame, bool wireframe);

    /// Shorter ships are launches, metres.
    static constexpr double shortest_freighter_m = 30.0;

private:
    struct Hull {
        GlVertexArray layout;
        GlBuffer vertices;
        GLsizei count = 0;
    };
    static void fill(Hull& hull, std::span<const HullVertex> vertices);

    ShaderProgram program_{"ship.vert", "ship.frag"};
    GLint place_uniform_ = -1;
    GLint axes_uniform_ = -1;
    GLint size_uniform_ = -1;
    GLint wash_uniform_ = -1;
    Hull freighter_;
    Hull launch_;
};

}  // namespace trochoid
