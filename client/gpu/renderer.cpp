#include "client/gpu/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "client/gpu/gl_health.hpp"
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

}  // namespace

Renderer::Renderer()
    : depth_range_(best_depth_range()), texel_limit_(texel_buffer_limit()), sky_(depth_range_) {
    if (depth_range_ == DepthRange::reversed_zero_to_one) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

void Renderer::take_over(const SceneInput& input) {
    if (input.state && input.state != state_) {
        state_ = input.state;
        if (land_table_.rebuild(*state_, texel_limit_, texel_limit_)) buffers_.set_land(land_table_);
        sea_table_.rebuild(*state_, land_table_);
        buffers_.set_lists(sea_table_.lists());
        directory_.rebuild(*state_, sea_table_);
        buffers_.set_directory(directory_);
    }
    if (input.tiles != tiles_ || input.terrain != extent_) {
        tiles_ = input.tiles;
        extent_ = input.terrain;
        bed_ = make_bed_map(extent_, tiles_);
        buffers_.set_bed(bed_);
    }
}

/// What a picture is made of, chosen before anything is drawn.
struct Renderer::Chosen {
    CameraFrame frame;
    CameraFrame culling;
    FrustumPlanes planes;
    MeshEye eye;
    TerrainSelection land;
    DebugLines lines;
    std::vector<FloatingShip> ships;
};

const InterestState& Renderer::known_state() const {
    static const InterestState nothing_known;
    return state_ ? *state_ : nothing_known;
}

Renderer::Chosen Renderer::choose(const SceneInput& input, const Camera& camera, const Camera& culling_camera,
                                  const DrawOptions& options) const {
    Chosen chosen;
    chosen.frame = frame_of(camera, depth_range_);
    chosen.culling = frame_of(culling_camera, depth_range_, chosen.frame.anchor);
    chosen.planes = planes_of(chosen.culling, depth_range_);
    const WaveBounds waves = sea_table_.bounds_of_list(0);
    chosen.eye = mesh_eye(chosen.culling, filter_of(camera, options, input.statistics.error_in_force_px),
                          refinement_in_force(options), chosen.planes, waves.height + waves.displacement);
    chosen.land = select_terrain(tiles_, chosen.culling, chosen.planes, radians_per_pixel(camera),
                                 options.land_error_px);
    SeaMesh patches;
    if (options.patches)
        patches = build_sea_mesh(known_state(), sea_table_, chosen.culling, chosen.planes,
                                 {chosen.eye, options.triangles_per_draw});
    chosen.lines = make_debug_lines(input, known_state(), chosen.frame, patches, options);
    return chosen;
}

void Renderer::upload(const Chosen& chosen, const Camera& camera, SeaTime now, const DrawOptions& options) {
    buffers_.set_records(sea_table_.records(land_table_, chosen.frame.anchor, now, options.layers));
    const bool remembers = options.foam_history && options.far_method != FarMethod::texture;
    const uint32_t foam_side = remembers ? options.foam_map_side : 0;
    weather_ = sea_table_.weather_at(camera.position, now,
                                     FoamPass::shortest_wave_m(std::max(foam_side, uint32_t{128})));
    other_seas_.prepare(options.displacement, weather_, now);
    ripple_axis_ = ripple_axis_near(weather_.heading, ripple_axis_);
    scroll_.advance(now, weather_.wind_m_s);
    const FrameUniforms uniforms = make_uniforms(
        {camera, chosen.frame, chosen.eye, bed_, now, ripple_axis_, options, sky_.light_at(options.hour),
         weather_, scroll_.tiles(), foam_.place(camera, chosen.frame, now, foam_side)});
    uniforms_.fill(GL_UNIFORM_BUFFER, std::span<const FrameUniforms>(&uniforms, 1), GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniforms_.name());
    buffers_.bind();
    if (options.land && options.coherent_land) {
        if (!coherent_land_) coherent_land_ = std::make_unique<CoherentLand>();
        coherent_land_->prepare(uniforms, uniforms_.name(), chosen.culling.anchor, chosen.eye, chosen.planes,
                                bed_, options.most_triangles);
    }
    sky_.prepare(now, uniforms);
    timers_.begin_pass("foam");
    foam_.update(foam_side != 0, weather_);
}

Mesher& Renderer::mesher_of(MesherKind kind) {
    std::unique_ptr<Mesher>& mesher = meshers_[static_cast<size_t>(kind)];
    if (!mesher) mesher = make_mesher(kind, MesherUse::picture);
    return *mesher;
}

void Renderer::draw_near_sea(Mesher& mesher, bool wireframe) {
    // Behind land too: the far sea must not show through where a patch is merely hidden.
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_ALWAYS, 1, 0xff);
    glStencilOp(GL_KEEP, GL_REPLACE, GL_REPLACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    if (wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    mesher.bind();
    mesher.draw();
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDisable(GL_BLEND);
    glDisable(GL_STENCIL_TEST);
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
    timers_.begin_pass("land");
    if (options.land && options.coherent_land)
        coherent_land_->draw(uniforms_.name(), options.wireframe);
    else if (options.land)
        land_.draw(chosen.land, chosen.frame, options.wireframe);
    timers_.begin_pass("ships");
    ships_.draw(chosen.ships, chosen.frame, options.wireframe);
    timers_.begin_pass("sea");
    begin_drawing();
    draw_near_sea(mesher_of(options.mesher), options.wireframe);
    timers_.begin_pass("far sea");
    // Between the lines of a wireframe it would look like the water that they stand for.
    if (options.far_sea && !options.wireframe) far_sea_.draw(camera, horizon_m(camera.altitude_m));
    timers_.begin_pass("sky");
    if (options.sky) {
        glDepthFunc(reversed ? GL_GEQUAL : GL_LEQUAL);
        sky_.draw();
    }
    timers_.begin_pass("spray");
    glDepthFunc(reversed ? GL_GREATER : GL_LESS);
    if (options.spray) spray_.draw(foam_, weather_.wind_m_s, camera.height);
    timers_.begin_pass("lines");
    lines_.draw(chosen.lines);
}

/// Which levels of a texture a look-up mixes; where the processor draws, each costs as much as the first.
void Renderer::set_lean(bool lean) {
    if (lean == lean_) return;
    lean_ = lean;
    const GLenum smaller = lean ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_LINEAR;
    buffers_.set_smaller_filter(smaller);
    foam_.set_smaller_filter(smaller);
    sky_.set_smaller_filter(smaller);
}

FrameReport Renderer::report_of(const Chosen& chosen, const MeshCounts& mesh) const {
    FrameReport report;
    report.patches_drawn = mesh.patches_drawn;
    report.patches_known = static_cast<uint32_t>(known_state().patches.size());
    report.draws = mesh.draws;
    report.sea_triangles = mesh.triangles;
    report.land_triangles = chosen.land.triangles;
    report.boxes = static_cast<uint32_t>(sea_table_.box_count());
    report.trains = static_cast<uint32_t>(sea_table_.train_count());
    report.land_blocks = static_cast<uint32_t>(land_table_.block_count());
    report.land_blocks_left_out = static_cast<uint32_t>(land_table_.left_out());
    report.vertex_angle = chosen.eye.filter.angle_per_vertex;
    report.gpu_ms = timers_.total_ms();
    report.passes = timers_.passes();
    report.passes_waited = timers_.waited();
    return report;
}

FrameReport Renderer::draw(const RenderTarget& target, const SceneInput& input, const Camera& camera,
                           const Camera& culling_camera, const DrawOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    take_over(input);
    Chosen chosen = choose(input, camera, culling_camera, options);
    if (options.ships) chosen.ships = ship_waters_.ships(input, camera);
    set_lean(options.lean);
    timers_.begin_frame(options.time_passes);
    // Passes that only make a mesh draw nothing, yet OpenGL wants a complete framebuffer for them, too.
    target.bind();
    timers_.begin_pass("light");
    upload(chosen, camera, input.now, options);
    timers_.begin_pass("mesh");
    const MeshCounts mesh =
        mesher_of(options.mesher)
            .prepare({known_state(), sea_table_, chosen.culling, chosen.planes, chosen.eye, options});
    target.bind();
    draw_passes(chosen, camera, options);
    timers_.end_frame();
    target.resolve();
    FrameReport report = report_of(chosen, mesh);
    if (options.coherent_land && coherent_land_) report.land_triangles = coherent_land_->work().triangles;
    report.cpu_ms = milliseconds_since(start);
    return report;
}

}  // namespace trochoid
