#include "client/gpu/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "client/scene/debug_lines.hpp"
#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// As far as the curved sea can be seen, and a little over.
float horizon_m(double altitude_m) {
    const double seen = std::sqrt(2.0 * earth_radius * std::max(altitude_m, 0.0));
    // In steps, so that the disc is not made anew for every metre of climb.
    return static_cast<float>(std::min(std::ceil((seen * 1.1 + 20'000.0) / 10'000.0) * 10'000.0,
                                       to_metres(anchor_reach) - 2'000.0));
}

DepthRange best_depth_range() {
    return epoxy_has_gl_extension("GL_ARB_clip_control") || epoxy_gl_version() >= 45
               ? DepthRange::reversed_zero_to_one
               : DepthRange::classic;
}

size_t texel_buffer_limit() {
    GLint limit = 65'536;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    return static_cast<size_t>(limit);
}

/// Depth of infinity as the vertex shader writes it.
ShaderProgram::Options sky_options(DepthRange range) {
    return {{range == DepthRange::reversed_zero_to_one ? "SKY_DEPTH 0.0" : "SKY_DEPTH 1.0"}, {}};
}

}  // namespace

Renderer::Renderer()
    : depth_range_(best_depth_range()),
      texel_limit_(texel_buffer_limit()),
      sky_({"sky.vert", "sky.frag"}, sky_options(depth_range_)) {
    if (depth_range_ == DepthRange::reversed_zero_to_one) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glGenQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

Renderer::~Renderer() { glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data()); }

void Renderer::take_over(const SceneInput& input) {
    if (input.state && input.state != state_) {
        state_ = input.state;
        if (land_table_.rebuild(*state_, texel_limit_, texel_limit_)) buffers_.set_land(land_table_);
        sea_table_.rebuild(*state_, land_table_);
        buffers_.set_lists(sea_table_.lists());
    }
    if (input.tiles != tiles_ || input.terrain != extent_) {
        tiles_ = input.tiles;
        extent_ = input.terrain;
        bed_ = make_bed_map(extent_, tiles_);
        buffers_.set_bed(bed_);
    }
}

void Renderer::begin_gpu_time() {
    const GLuint query = queries_[frames_ % queries_.size()];
    if (frames_ >= queries_.size()) {
        GLuint64 nanoseconds = 0;
        glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
        gpu_ms_ = static_cast<double>(nanoseconds) * 1e-6;
    }
    glBeginQuery(GL_TIME_ELAPSED, query);
}

void Renderer::end_gpu_time() {
    glEndQuery(GL_TIME_ELAPSED);
    ++frames_;
}

/// What a picture is made of, chosen before anything is drawn.
struct Renderer::Chosen {
    CameraFrame frame;
    MeshEye eye;
    SeaMesh mesh;
    TerrainSelection land;
    DebugLines lines;
};

Renderer::Chosen Renderer::choose(const SceneInput& input, const Camera& camera, const Camera& culling_camera,
                                  const DrawOptions& options) const {
    static const InterestState nothing_known;
    const InterestState& state = state_ ? *state_ : nothing_known;
    Chosen chosen;
    chosen.frame = frame_of(camera, depth_range_);
    const CameraFrame culling = frame_of(culling_camera, depth_range_, chosen.frame.anchor);
    const FrustumPlanes planes = planes_of(culling, depth_range_);
    chosen.eye = mesh_eye(culling, filter_of(camera, options, input.statistics.error_in_force_px));
    chosen.mesh =
        build_sea_mesh(state, sea_table_, culling, planes, {chosen.eye, options.triangles_per_draw});
    chosen.land = select_terrain(tiles_, culling, planes, radians_per_pixel(camera), options.land_error_px);
    chosen.lines = make_debug_lines(input, state, chosen.frame, chosen.mesh, options);
    return chosen;
}

void Renderer::upload(const Chosen& chosen, const Camera& camera, SeaTime now, const DrawOptions& options) {
    buffers_.set_records(sea_table_.records(land_table_, chosen.frame.anchor, now, options.layers));
    ripple_axis_ = ripple_axis_near(sea_table_.heading_at(camera.position, now), ripple_axis_);
    const FrameUniforms uniforms = make_uniforms(
        {camera, chosen.frame, chosen.eye, bed_, now, ripple_axis_, options.authoritative, options.layers});
    uniforms_.fill(GL_UNIFORM_BUFFER, std::span<const FrameUniforms>(&uniforms, 1), GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniforms_.name());
    buffers_.bind();
}

void Renderer::draw_passes(const Chosen& chosen, const Camera& camera, const DrawOptions& options) {
    const bool reversed = depth_range_ == DepthRange::reversed_zero_to_one;
    glClearColor(options.clear_colour[0], options.clear_colour[1], options.clear_colour[2], 1.0F);
    glClearDepth(reversed ? 0.0 : 1.0);
    glClearStencil(0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(reversed ? GL_GREATER : GL_LESS);
    // Land first: the sea's edge is blended over it.
    if (options.land) land_.draw(chosen.land, chosen.frame, options.wireframe);
    sea_.draw(chosen.mesh, options.wireframe);
    if (options.far_sea) far_sea_.draw(horizon_m(camera.altitude_m));
    if (options.sky) {
        glDepthFunc(reversed ? GL_GEQUAL : GL_LEQUAL);
        sky_.use();
        nothing_.bind();
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    lines_.draw(chosen.lines);
}

FrameReport Renderer::report_of(const Chosen& chosen) const {
    FrameReport report;
    report.patches_drawn = static_cast<uint32_t>(chosen.mesh.drawn.size());
    report.patches_known = chosen.mesh.patches_known;
    report.draws = static_cast<uint32_t>(chosen.mesh.batches.size());
    report.sea_triangles = chosen.mesh.triangles;
    report.land_triangles = chosen.land.triangles;
    report.boxes = static_cast<uint32_t>(sea_table_.box_count());
    report.trains = static_cast<uint32_t>(sea_table_.train_count());
    report.land_blocks = static_cast<uint32_t>(land_table_.block_count());
    report.land_blocks_left_out = static_cast<uint32_t>(land_table_.left_out());
    report.vertex_angle = chosen.eye.filter.angle_per_vertex;
    report.gpu_ms = gpu_ms_;
    return report;
}

FrameReport Renderer::draw(const RenderTarget& target, const SceneInput& input, const Camera& camera,
                           const Camera& culling_camera, const DrawOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    take_over(input);
    const Chosen chosen = choose(input, camera, culling_camera, options);
    begin_gpu_time();
    upload(chosen, camera, input.now, options);
    target.bind();
    draw_passes(chosen, camera, options);
    end_gpu_time();
    target.resolve();
    FrameReport report = report_of(chosen);
    report.cpu_ms = milliseconds_since(start);
    return report;
}

}  // namespace trochoid
