#include "tests/gpu/sea_probe.hpp"

#include "client/gpu/frame_uniforms.hpp"
#include "client/gpu/other_seas.hpp"
#include "client/gpu/render_target.hpp"
#include "client/gpu/sea_buffers.hpp"

namespace trochoid {

namespace {

/// Planes that nothing lies outside of.
constexpr FrustumPlanes everything{glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1),
                                   glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1)};

/// `planes`: null for those of the camera.
Probe probe(const InterestState& state, SeaTime now, const Camera& camera, const DrawOptions& options,
            float error_px, const FrustumPlanes* planes) {
    LandTable land;
    land.rebuild(state, 1U << 27, 1U << 27);
    SeaTable table;
    table.rebuild(state, land);
    PatchDirectory directory;
    directory.rebuild(state, table);
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    const MeshEye eye = mesh_eye(frame, display_filter(view_of(camera, glm::dvec3(0)), error_px),
                                 options.refinement, planes_of(frame, DepthRange::classic), 0.0F);
    const FrustumPlanes in_view = planes_of(frame, DepthRange::classic);

    SeaBuffers buffers;
    buffers.set_land(land);
    buffers.set_lists(table.lists());
    buffers.set_directory(directory);
    buffers.set_records(table.records(land, frame.anchor, now, options.layers));
    const FrameUniforms uniforms = make_uniforms({camera, frame, eye, BedMap{}, now, 0, options});
    GlBuffer uniform_buffer;
    uniform_buffer.fill(GL_UNIFORM_BUFFER, std::span<const FrameUniforms>(&uniforms, 1), GL_STATIC_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniform_buffer.name());
    buffers.bind();
    OtherSeas other_seas;
    other_seas.prepare(options.displacement, table.weather_at(camera.position, now, 1.0F), now);

    // Nothing is drawn, yet OpenGL wants a complete framebuffer.
    const RenderTarget target(16, 16, 1);
    target.bind();
    const std::unique_ptr<Mesher> mesher = make_mesher(options.mesher, MesherUse::probe);
    const MeshCounts counts =
        mesher->prepare({state, table, frame, planes != nullptr ? *planes : in_view, eye, options});

    Probe result;
    result.anchor = frame.anchor;
    // Edges finer than the inside add to the estimate.
    result.vertices.resize(size_t{counts.triangles} * 6 + 65'536);
    GlBuffer captured;
    captured.fill(GL_TRANSFORM_FEEDBACK_BUFFER, std::span<const ProbedVertex>(result.vertices),
                  GL_DYNAMIC_READ);
    GLuint query = 0;
    glGenQueries(1, &query);
    glEnable(GL_RASTERIZER_DISCARD);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, captured.name());
    glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, query);
    mesher->bind();
    glBeginTransformFeedback(GL_TRIANGLES);
    mesher->draw();
    glEndTransformFeedback();
    glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
    glDisable(GL_RASTERIZER_DISCARD);
    GLuint triangles = 0;
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &triangles);
    glDeleteQueries(1, &query);
    result.vertices.resize(size_t{triangles} * 3);
    glBindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, captured.name());
    glGetBufferSubData(GL_TRANSFORM_FEEDBACK_BUFFER, 0,
                       static_cast<GLsizeiptr>(result.vertices.size() * sizeof(ProbedVertex)),
                       result.vertices.data());
    return result;
}

}  // namespace

Probe probe_sea(const InterestState& state, SeaTime now, const Camera& camera, const DrawOptions& options) {
    return probe(state, now, camera, options, 12.0F, &everything);
}

Probe probe_view(const InterestState& state, SeaTime now, const Camera& camera, const DrawOptions& options) {
    return probe(state, now, camera, options, options.error_px, nullptr);
}

Probe probe_sea(const InterestState& state, SeaTime now, const Camera& camera, Layers layers) {
    DrawOptions options;
    options.authoritative = true;
    options.layers = layers;
    return probe_sea(state, now, camera, options);
}

}  // namespace trochoid
