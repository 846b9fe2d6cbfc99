// Paper D's coherent tessellation: a pass from the last mesh against tessellation from the base, on a slow flight and right after a
// cut (bar P8); and its figure 8, time by number of triangles to draw, to animate and to tessellate (row D8).
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "client/gpu/coherent_mesher.hpp"
#include "client/gpu/frame_uniforms.hpp"
#include "client/gpu/gl_health.hpp"
#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/render_target.hpp"
#include "client/gpu/sea_buffers.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid::bench {
namespace {

/// A sea of 60 trains, or a flat one, with all that a mesher needs.
class Stage {
public:
    explicit Stage(bool waves) {
        FixtureSource source(TerrainGrid{});
        WaveTrainBox more;
        more.id = {3};
        more.first_train = {300};
        more.trains = wind_sea(40.0, 0.4, 1.0, 28, 5);
        source.add_box(more);
        if (waves) state_ = source.state();
        LandTable land;
        land.rebuild(state_, 1U << 27U, 1U << 27U);
        table_.rebuild(state_, land);
        directory_.rebuild(state_, table_);
        buffers_.set_land(land);
        buffers_.set_lists(table_.lists());
        buffers_.set_directory(directory_);
        buffers_.set_records(table_.records(land, {0, 0}, SeaTime{5'000'000}, options.layers));
    }
    /// Makes what follows the eye current.
    void look_from(const Camera& camera, const DisplayFilter& filter) {
        frame_ = frame_of(camera, DepthRange::classic, {0, 0});
        planes_ = planes_of(frame_, DepthRange::classic);
        eye_ = mesh_eye(frame_, filter, options.refinement, planes_, 3.0F);
        FrameUniforms u;
        u.clip_from_camera = frame_.clip_from_camera;
        u.camera_from_clip = frame_.camera_from_clip;
        u.camera_cell = {frame_.cell, 0, 0};
        u.camera_eye = {frame_.fraction, frame_.altitude, 7.8e-8F};
        u.mesh_cell = {eye_.cell, options.layers.bits, 0};
        u.mesh_eye = {eye_.fraction, eye_.altitude, 0.0F};
        u.mesh_filter = {filter.finest_spacing, filter.angle_per_vertex, 0.0F, 0.0F};
        u.choice = {0, 0, static_cast<int>(options.refinement), 0};
        u.mesh_sides = eye_.sides;
        uniforms_.fill(GL_UNIFORM_BUFFER, std::span<const FrameUniforms>(&u, 1), GL_STREAM_DRAW);
        glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniforms_.name());
        buffers_.bind();
    }
    CoherentWork update(CoherentMesh& mesh) const {
        return mesh.update({0, 0}, eye_, options.most_triangles);
    }
    MeshCounts prepare(Mesher& mesher) const {
        return mesher.prepare({state_, table_, frame_, planes_, eye_, options});
    }

    DrawOptions options;

private:
    InterestState state_;
    SeaTable table_;
    PatchDirectory directory_;
    SeaBuffers buffers_;
    CameraFrame frame_{};
    FrustumPlanes planes_{};
    MeshEye eye_{};
    GlBuffer uniforms_;
};

Camera camera_at(double x, double z, double altitude, double yaw = 0.0) {
    Camera camera;
    move(camera, x, 0.0, z);
    camera.altitude_m = altitude;
    camera.yaw = yaw;
    camera.pitch = -0.12;
    return camera;
}

/// Seconds until the GPU has done it.
double finished(const std::function<void()>& work) {
    glFinish();
    return seconds([&] {
        work();
        glFinish();
    });
}

struct Flight {
    double coherent = 0;  // s a frame
    double from_base = 0;
    double passes = 0;
    double base_passes = 0;
    uint32_t triangles = 0;
};

/// Both ways side by side over the same frames.
Flight fly(Stage& stage, const DisplayFilter& filter, int frames, const std::function<Camera(int)>& path) {
    CoherentMesh kept;
    CoherentMesh anew;
    std::vector<double> coherent;
    std::vector<double> base;
    Flight flight;
    for (int i = 0; i < frames; ++i) {
        stage.look_from(path(i), filter);
        CoherentWork work;
        const double t = finished([&] { work = stage.update(kept); });
        anew.forget();
        CoherentWork again;
        const double u = finished([&] { again = stage.update(anew); });
        if (i < 2) continue;  // buffers grow
        coherent.push_back(t);
        base.push_back(u);
        flight.passes += work.passes / (frames - 2.0);
        flight.base_passes += again.passes / (frames - 2.0);
        flight.triangles = work.triangles;
    }
    flight.coherent = median(coherent);
    flight.from_base = median(base);
    return flight;
}

/// Worst ratios over the criteria.
struct Ratios {
    double slow = 0;
    double cut = 0;
};
Ratios flights(Report& report) {
    Ratios worst;
    Stage stage(true);
    const int frames = report.quick() ? 10 : 30;
    fmt::print("{:>10} {:>14} {:>10} {:>12} {:>14} {:>7} {:>8} {:>12}\n", "criterion", "flight", "triangles",
               "coherent, ms", "from base, ms", "ratio", "passes", "base passes");
    for (const Refinement refinement : {Refinement::distance, Refinement::screen, Refinement::frustum}) {
        stage.options.refinement = refinement;
        const DisplayFilter filter{0.5F, report.quick() ? 1.0F / 31.0F : 1.0F / 62.0F};
        const auto show = [&](const char* name, const Flight& f, double bar, double& greatest) {
            const double ratio = f.coherent / f.from_base;
            fmt::print("{:>10} {:>14} {:>10} {:>12.2f} {:>14.2f} {:>7.2f} {:>8.1f} {:>12.1f}\n",
                       name_of(refinement), name, f.triangles, f.coherent * 1e3, f.from_base * 1e3, ratio,
                       f.passes, f.base_passes);
            greatest = std::max(greatest, ratio);
            report.at_most(fmt::format("{}, by {}", name, name_of(refinement)), ratio, bar, "x");
        };
        // 10 m/s at 60 pictures a second, and as slow a turn.
        show("slow flight",
             fly(stage, filter, frames, [](int i) { return camera_at(0.17 * i, 0.02 * i, 20, 0.005 * i); }),
             1.0, worst.slow);
        show("each a cut",
             fly(stage, filter, frames,
                 [](int i) {
                     return camera_at(i % 2 == 0 ? 0 : 1'500, 700.0 * (i % 3), i % 2 == 0 ? 20 : 60, 2.1 * i);
                 }),
             1.15, worst.cut);
    }
    return worst;
}

/// Their figure 8: triangles are tessellated all around, drawn and animated where they are in view.
void figure_8(Report& report) {
    const RenderTarget target(480, 270, 1);
    target.bind();
    Stage flat(false);
    Stage sea(true);
    flat.options.layers = sea.options.layers;
    nlohmann::json count = nlohmann::json::array();
    nlohmann::json draw = count;
    nlohmann::json animate = count;
    nlohmann::json tessellate = count;
    fmt::print("\n{:>10} {:>10} {:>18} {:>24} {:>34}\n", "triangles", "in view", "draw, ms",
               "animate + draw, ms", "tessellate + animate + draw, ms");
    const int rounds = report.quick() ? 3 : 7;
    const double most = report.quick() ? 20'000 : 600'000;
    for (double wanted = 4'096; wanted <= most; wanted *= 4) {
        CoherentMesher mesher(MesherUse::picture);
        // About 2 pi / angle^2 * (1/2 + ln(farthest / nearest)) triangles about the eye.
        const auto angle = static_cast<float>(std::sqrt(2 * 3.14159 * 5 / wanted));
        const DisplayFilter filter{0.5F, angle};
        std::vector<double> draws, animations, tessellations;
        uint32_t triangles = 0;
        const auto picture = [&] {
            glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
            mesher.bind();
            mesher.draw();
        };
        glEnable(GL_DEPTH_TEST);
        flat.look_from(camera_at(0, 0, 300), filter);
        flat.prepare(mesher);
        picture();  // drivers finish their shaders at the first use
        for (int i = 0; i < rounds; ++i) {
            const Camera camera = camera_at(0.17 * i, 0, 300);
            flat.look_from(camera, filter);
            triangles = flat.prepare(mesher).triangles;
            draws.push_back(finished(picture));
            sea.look_from(camera, filter);
            animations.push_back(finished(picture));
            mesher.mesh().forget();
            tessellations.push_back(animations.back() + finished([&] { sea.prepare(mesher); }));
        }
        fmt::print("{:>10} {:>10} {:>18.2f} {:>24.2f} {:>34.2f}\n", triangles, mesher.mesh().visible(),
                   median(draws) * 1e3, median(animations) * 1e3, median(tessellations) * 1e3);
        count.push_back(triangles);
        draw.push_back(median(draws) * 1e3);
        animate.push_back(median(animations) * 1e3);
        tessellate.push_back(median(tessellations) * 1e3);
        report.figure(fmt::format("{} triangles: animate + draw, ms", triangles), median(animations) * 1e3);
    }
    report.plot({{"title", "Paper D, figure 8: time by number of triangles, 60 trains, whole tessellation"},
                 {"x", "triangles"},
                 {"y", "ms"},
                 {"curves",
                  {{{"name", "draw"}, {"x", count}, {"y", draw}},
                   {{"name", "animate, draw"}, {"x", count}, {"y", animate}},
                   {{"name", "tessellate, animate, draw"}, {"x", count}, {"y", tessellate}}}}});
}

void bench(Report& report) {
    const OffscreenContext context;
    fmt::print("{}\n", describe_gl());
    Ratios worst;
    {
        const RenderTarget target(16, 16, 1);
        target.bind();
        worst = flights(report);
    }
    figure_8(report);
    report.write(fmt::format("{:.2f}x of re-tessellation on a slow flight, {:.2f}x after a cut", worst.slow,
                             worst.cut));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
