#include "tests/gpu/sea_probe.hpp"

#include "client/gpu/frame_uniforms.hpp"
#include "client/gpu/render_target.hpp"

namespace trochoid {

namespace {

/// Planes that nothing lies outside of.
constexpr FrustumPlanes everything{glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1),
                                   glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1)};

}  // namespace

Probe probe_sea(const InterestState& state, SeaTime now, const Camera& camera, Layers layers) {
    const ShaderProgram program(
        {"sea.vert", "sea.tesc", "sea.tese"},
        {{"TROCHOID_PROBE 1"}, {"probe_place", "probe_shift", "probe_normal", "probe_phases"}});
    LandTable land;
    land.rebuild(state, 1U << 27, 1U << 27);
    SeaTable table;
    table.rebuild(state, land);
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    const MeshEye eye = mesh_eye(frame, display_filter(view_of(camera, glm::dvec3(0)), 12.0F));
    const SeaMesh mesh = build_sea_mesh(state, table, frame, everything, {eye, 4'000});

    SeaBuffers buffers;
    buffers.set_land(land);
    buffers.set_lists(table.lists());
    buffers.set_records(table.records(land, frame.anchor, now, layers));
    const FrameUniforms uniforms = make_uniforms({camera, frame, eye, BedMap{}, now, 0, true, layers});
    GlBuffer uniform_buffer;
    uniform_buffer.fill(GL_UNIFORM_BUFFER, std::span<const FrameUniforms>(&uniforms, 1), GL_STATIC_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniform_buffer.name());
    buffers.bind();

    // Nothing is drawn, yet OpenGL wants a complete framebuffer.
    const RenderTarget target(16, 16, 1);
    target.bind();
    GlVertexArray layout;
    layout.bind();
    GlBuffer quads;
    quads.fill(GL_ARRAY_BUFFER, std::span(mesh.quads), GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribIPointer(0, 4, GL_INT, sizeof(SeaQuad), nullptr);
    glPatchParameteri(GL_PATCH_VERTICES, 1);

    Probe probe;
    probe.anchor = frame.anchor;
    GlBuffer captured;
    GLuint query = 0;
    glGenQueries(1, &query);
    program.use();
    glEnable(GL_RASTERIZER_DISCARD);
    for (const SeaBatch& batch : mesh.batches) {
        // Edges finer than the inside add to the estimate.
        std::vector<ProbedVertex> room(size_t{batch.triangles} * 6 + 4096);
        captured.fill(GL_TRANSFORM_FEEDBACK_BUFFER, std::span<const ProbedVertex>(room), GL_DYNAMIC_READ);
        glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, captured.name());
        glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, query);
        glBeginTransformFeedback(GL_TRIANGLES);
        glDrawArrays(GL_PATCHES, static_cast<GLint>(batch.first), static_cast<GLsizei>(batch.count));
        glEndTransformFeedback();
        glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
        GLuint triangles = 0;
        glGetQueryObjectuiv(query, GL_QUERY_RESULT, &triangles);
        room.resize(size_t{triangles} * 3);
        glGetBufferSubData(GL_TRANSFORM_FEEDBACK_BUFFER, 0,
                           static_cast<GLsizeiptr>(room.size() * sizeof(ProbedVertex)), room.data());
        probe.vertices.insert(probe.vertices.end(), room.begin(), room.end());
    }
    glDisable(GL_RASTERIZER_DISCARD);
    glDeleteQueries(1, &query);
    return probe;
}

}  // namespace trochoid
