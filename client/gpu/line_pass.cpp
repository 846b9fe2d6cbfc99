#include "client/gpu/line_pass.hpp"

namespace trochoid {

LinePass::LinePass() {
    layout_.bind();
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(LineVertex), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(LineVertex),
                          buffer_offset(offsetof(LineVertex, tint)));
}

void LinePass::draw_as(GLenum mode, const std::vector<LineVertex>& vertices) {
    if (vertices.empty()) return;
    vertices_.fill(GL_ARRAY_BUFFER, std::span(vertices), GL_STREAM_DRAW);
    glDrawArrays(mode, 0, static_cast<GLsizei>(vertices.size()));
}

void LinePass::draw(const DebugLines& lines) {
    program_.use();
    layout_.bind();
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_PROGRAM_POINT_SIZE);
    draw_as(GL_TRIANGLES, lines.triangles);
    draw_as(GL_LINES, lines.lines);
    draw_as(GL_POINTS, lines.points);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
}

}  // namespace trochoid
