// Row A10: what a wave train box costs by the share of it that is in view. The camera turns away from a box of 256 trains; each
// line is a mesher, the turn in degrees, the visible share, trains evaluated (all vertices of all triangles together) over those
// with the whole box in view, milliseconds with and without the box, the difference over that with the whole box in view, triangles:
// clipping_cost [meshers=patches,uniform,projected,coherent] [steps=16] [repeats=7] [cells=512] [refinement=distance]
// The picture is small and the mesh as fine as for one ten times as wide: vertices cost, not pixels.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/renderer.hpp"
#include "client/scene/frustum.hpp"
#include "tests/gpu/fixture_sea.hpp"
#include "tests/gpu/sea_probe.hpp"

using namespace trochoid;

namespace {

constexpr double box_side_m = 300.0;
constexpr double box_ahead_m = 260.0;  // its middle

/// A box ahead of a camera that looks north from the origin.
WaveTrainBox box_ahead() {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    box.begin = {-sea_time_bound};
    box.origin = {to_lattice(-box_side_m / 2), to_lattice(-box_ahead_m - box_side_m / 2)};
    box.length = box.width = to_lattice(box_side_m);
    box.ramp_rear = box.ramp_front = box.ramp_side = static_cast<int32_t>(to_lattice(20.0));
    box.trains = wind_sea(60.0, 0.7, 1.5, 256, 7);
    return box;
}

std::shared_ptr<const InterestState> sea_with(bool box, const Camera& camera, const DrawOptions& options) {
    auto state = std::make_shared<InterestState>();
    const WaveTrainBox record = box_ahead();
    if (box) state->boxes[record.id] = std::make_shared<const WaveTrainBox>(record);
    const double angle = static_cast<double>(
        display_filter(view_of(camera, glm::dvec3(0)), options.error_px).angle_per_vertex);
    for (const PatchKey key : ring_of_patches(camera.position, camera.altitude_m, 4'000, angle)) {
        PatchDescriptor patch;
        patch.key = key;
        const LatticePoint corner{int64_t{key.x} << key.level, int64_t{key.z} << key.level};
        const int64_t side = int64_t{1} << key.level;
        if (box && overlap(bounds_of(record), {corner, {corner.x + side, corner.z + side}}))
            patch.boxes.push_back({record.id, static_cast<uint16_t>(record.trains.size())});
        state->patches[key] = patch;
    }
    return state;
}

/// Share of the box's area in view.
double visible_share(const Camera& camera) {
    const CameraFrame frame = frame_of(camera, DepthRange::reversed_zero_to_one);
    const FrustumPlanes planes = planes_of(frame, DepthRange::reversed_zero_to_one);
    constexpr int samples = 200;
    int seen = 0;
    for (int i = 0; i < samples; ++i)
        for (int k = 0; k < samples; ++k) {
            const LatticePoint p{to_lattice(box_side_m * ((i + 0.5) / samples - 0.5)),
                                 to_lattice(-box_ahead_m + box_side_m * ((k + 0.5) / samples - 0.5))};
            const glm::vec3 at = metres_from_camera(frame, p, 0.0);
            if (may_see(planes, {at, at})) ++seen;
        }
    return static_cast<double>(seen) / (samples * samples);
}

struct Cost {
    double ms = 1e9;
    uint32_t triangles = 0;
};

/// The least of some pictures, until the renderer has done all of it.
Cost cost_of(Renderer& renderer, const RenderTarget& target, const SceneInput& input, const Camera& camera,
             const DrawOptions& options, int repeats) {
    Cost cost;
    for (int i = 0; i <= repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const FrameReport report = renderer.draw(target, input, camera, camera, options);
        glFinish();
        const double ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        if (i > 0) cost = {std::min(cost.ms, ms), report.sea_triangles};
    }
    return cost;
}

/// Trains that the vertices in view evaluate.
double work_of(const InterestState& state, SeaTime now, const Camera& camera, const DrawOptions& options) {
    double work = 0;
    for (const ProbedVertex& v : probe_view(state, now, camera, options).vertices) work += v.trains_evaluated;
    return work;
}

void measure(MesherKind kind, Camera camera, DrawOptions options, int steps, int repeats) {
    options.mesher = kind;
    Renderer renderer;
    const RenderTarget target(camera.width, camera.height, 1);
    SceneInput with;
    SceneInput without;
    with.now = without.now = {1'000'000};
    with.state = sea_with(true, camera, options);
    without.state = sea_with(false, camera, options);
    with.statistics.error_in_force_px = without.statistics.error_in_force_px = options.error_px;
    double whole = 0;
    double whole_work = 0;
    for (int step = 0; step <= steps; ++step) {
        const double degrees = 90.0 * step / steps;
        camera.yaw = degrees / 57.29577951;
        const Cost a = cost_of(renderer, target, with, camera, options, repeats);
        const Cost b = cost_of(renderer, target, without, camera, options, repeats);
        const double work = work_of(*with.state, with.now, camera, options);
        if (step == 0) whole = a.ms - b.ms;
        if (step == 0) whole_work = work;
        fmt::print("{},{:.2f},{:.4f},{:.4f},{:.3f},{:.3f},{:.4f},{}\n", name_of(kind), degrees,
                   visible_share(camera), work / whole_work, a.ms, b.ms, (a.ms - b.ms) / whole, a.triangles);
    }
}

}  // namespace

int main(int argc, char** argv) {
    std::map<std::string, std::string> values{{"meshers", "patches,uniform,projected,coherent"},
                                              {"steps", "16"},
                                              {"repeats", "7"},
                                              {"cells", "512"},
                                              {"refinement", "distance"}};
    for (int i = 1; i < argc; ++i) {
        const std::string text = argv[i];
        const size_t sign = text.find('=');
        if (sign == std::string::npos || !values.contains(text.substr(0, sign))) return 2;
        values[text.substr(0, sign)] = text.substr(sign + 1);
    }
    OffscreenContext context;
    Camera camera;
    camera.altitude_m = 120;
    camera.pitch = -0.45;
    camera.width = 64;
    camera.height = 36;
    DrawOptions options;
    options.sky = options.far_sea = options.land = options.ships = options.spray = options.foam_history =
        false;
    options.error_px = 0.3F;
    options.grid_cells = static_cast<uint32_t>(std::atoi(values["cells"].c_str()));
    options.grid_spacing_m = 2.0F;
    options.refinement = refinement_named(values["refinement"]).value_or(Refinement::distance);
    fmt::print("mesher,degrees,visible_share,work,with_ms,without_ms,cost,triangles\n");
    std::istringstream names(values["meshers"]);
    for (std::string name; std::getline(names, name, ',');) {
        const auto kind = mesher_named(name);
        if (!kind) return 2;
        measure(*kind, camera, options, std::atoi(values["steps"].c_str()),
                std::atoi(values["repeats"].c_str()));
    }
    return 0;
}
