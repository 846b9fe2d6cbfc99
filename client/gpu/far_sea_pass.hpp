#pragma once
#include <glm/vec4.hpp>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/camera.hpp"

namespace trochoid {

/// The sea beyond the patches, down to the horizon: a fan around the camera where the stencil holds no patch, as fine as the
/// soft ends of wave train boxes ask.
class FarSeaPass {
public:
    FarSeaPass();
    /// Reaches out to `radius_m` within the camera's view.
    void draw(const Camera& camera, float radius_m);

private:
    ShaderProgram program_{"far_sea.vert", "far_sea.frag"};
    GlVertexArray layout_;
    GlBuffer indices_;
    GLsizei index_count_ = 0;
};

/// Yaw at the left edge (radians) and opening of a fan that holds all that a camera sees of a level plane below it, and the
/// distance at which it begins, m; a whole turn from 0 m where the camera looks down.
glm::vec3 seen_fan(const Camera& camera);

}  // namespace trochoid
