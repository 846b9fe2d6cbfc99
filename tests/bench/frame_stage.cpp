#include "tests/bench/frame_stage.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "client/gpu/gl_health.hpp"
#include "protocol/model/displayed.hpp"
#include "tests/bench/stopwatch.hpp"

namespace trochoid::bench {

namespace {

/// Options for a fineness in [0, 1]: more triangles with each step.
DrawOptions as_fine_as(MesherKind kind, double fineness) {
    DrawOptions options;
    options.mesher = kind;
    options.error_px = static_cast<float>(24.0 * std::pow(0.01, fineness));
    options.grid_cells = 32 + 32 * static_cast<uint32_t>(std::lround(31 * fineness));
    options.grid_spacing_m = 2.0F;
    options.projected_rows = 2 + static_cast<uint32_t>(510 * fineness);
    options.projected_columns = std::max(2U, options.projected_rows * 3 / 4);
    return options;
}

/// Of all threads of this program.
double core_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

WaveTrainBox wind_box(int trains) {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    box.begin = {-sea_time_bound};
    box.trains = wind_sea(60.0, 0.4, 1.5, trains, 5);
    return box;
}

SceneInput scene_of(const KnownSea& sea, const Camera& camera, const DrawOptions& options) {
    auto state = std::make_shared<InterestState>();
    for (const WaveTrainBox& box : sea.boxes)
        state->boxes[box.id] = std::make_shared<const WaveTrainBox>(box);
    for (const FieldBlock& block : sea.blocks) state->blocks[{block.field, block.block->key}] = block;
    const auto angle = static_cast<double>(
        display_filter(view_of(camera, glm::dvec3(0)), options.error_px).angle_per_vertex);
    for (const PatchKey key : ring_of_patches(camera.position, camera.altitude_m, 13'000, angle)) {
        PatchDescriptor patch;
        patch.key = key;
        for (const WaveTrainBox& box : sea.boxes)
            if (overlap(bounds_of(box), rect_of(key)))
                patch.boxes.push_back({box.id, static_cast<uint16_t>(box.trains.size())});
        state->patches[key] = patch;
    }
    SceneInput input;
    input.state = std::move(state);
    input.now = {60'000'000};
    input.statistics.error_in_force_px = options.error_px;
    return input;
}

std::unique_ptr<FixtureSource> sea_of_60_trains(const TerrainGrid& terrain) {
    auto source = std::make_unique<FixtureSource>(terrain);
    WaveTrainBox more;
    more.id = {3};
    more.first_train = {300};
    more.trains = wind_sea(40.0, 0.4, 1.0, 28, 5);
    source->add_box(more);
    return source;
}

SceneInput scene_of(FixtureSource& source, const Camera& camera, const DrawOptions& options) {
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source.set_view(view);
    SceneInput input = source.snapshot();
    input.statistics.error_in_force_px = options.error_px;
    return input;
}

Camera looking(double altitude, double pitch, uint32_t width, uint32_t height) {
    Camera camera;
    camera.altitude_m = altitude;
    camera.pitch = pitch;
    camera.width = width;
    camera.height = height;
    return camera;
}

double FrameCost::work_ms() const { return is_software_gl() ? core_ms : ms; }

FrameCost Stage::measure(SceneInput scene, Camera camera, const DrawOptions& options, int frames, int warm,
                         double metres_a_frame) {
    FrameCost cost;
    std::vector<double> times;
    std::vector<double> core_times;
    std::vector<std::vector<double>> passes;
    for (int i = 0; i < frames + warm; ++i) {
        scene.now = scene.now + 16'667;
        move(camera, metres_a_frame * std::sin(camera.yaw), 0.0, -metres_a_frame * std::cos(camera.yaw));
        glFinish();
        const double core = core_seconds();
        const double taken = seconds([&] {
            cost.report = renderer_.draw(target_, scene, camera, camera, options);
            glFinish();
        });
        if (i < warm) continue;
        times.push_back(taken * 1e3);
        core_times.push_back((core_seconds() - core) * 1e3);
        passes.resize(std::max(passes.size(), cost.report.passes.size()));
        for (size_t k = 0; k < cost.report.passes.size(); ++k) passes[k].push_back(cost.report.passes[k].ms);
    }
    cost.ms = median(times);
    cost.core_ms = *std::min_element(core_times.begin(), core_times.end());
    for (size_t k = 0; k < cost.report.passes.size(); ++k) cost.report.passes[k].ms = median(passes[k]);
    return cost;
}

DrawOptions options_for_triangles(MesherKind kind, double triangles, const Camera& camera, double off) {
    // Triangles do not depend on the target's size: a small one is quick.
    Stage stage(32, 18);
    double low = 0;
    double high = 1;
    DrawOptions best;
    double least_off = 1e30;
    for (int step = 0; step < 9; ++step) {
        const double middle = (low + high) / 2;
        DrawOptions options = as_fine_as(kind, middle);
        const auto source = sea_of_60_trains(TerrainGrid{});
        const double count =
            stage.measure(scene_of(*source, camera, options), camera, options, 1, 0).report.sea_triangles;
        if (std::abs(count - triangles) < least_off) {
            least_off = std::abs(count - triangles);
            best = options;
        }
        (count < triangles ? low : high) = middle;
        if (least_off < off * triangles) break;
    }
    return best;
}

DrawOptions bare_options(MesherKind kind) {
    DrawOptions options;
    options.mesher = kind;
    options.sky = options.far_sea = options.land = options.ships = options.spray = options.foam_history =
        false;
    return options;
}

}  // namespace trochoid::bench
