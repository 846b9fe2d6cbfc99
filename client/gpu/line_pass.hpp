#pragma once
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/debug_lines.hpp"

namespace trochoid {

/// Debug lines and points over everything.
class LinePass {
public:
    LinePass();
    void draw(const DebugLines& lines);

private:
    void draw_as(GLenum mode, const std::vector<LineVertex>& vertices);

    ShaderProgram program_{"lines.vert", "lines.frag"};
    GlVertexArray layout_;
    GlBuffer vertices_;
};

}  // namespace trochoid
