#include "tests/gpu/mesher_cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/scene/camera_floor.hpp"
#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

/// Waves of 10 m significant height, some 17 m from trough to crest.
WaveTrainBox storm_box() {
    WaveTrainBox box;
    box.id = {3};
    box.first_train = {200};
    box.trains = wind_sea(180.0, 0.6, 10.0, 32, 11);
    return box;
}

}  // namespace

Camera standing_at(double x, double z, double altitude, double yaw, double pitch) {
    Camera camera;
    camera.position = {to_lattice(x), to_lattice(z)};
    camera.fraction_x = 0.25;
    camera.fraction_z = 0.75;
    camera.altitude_m = altitude;
    camera.yaw = yaw;
    camera.pitch = pitch;
    camera.width = 512;
    camera.height = 288;
    return camera;
}

Camera probing(Camera camera) {
    camera.width = 1280;
    camera.height = 720;
    return camera;
}

std::vector<NamedView> demanding_views() {
    return {{"eye height", standing_at(10.3, 7.1, 3, 0.7, -0.05)},
            {"in the waves of a storm", standing_at(-777.7, 1'234.5, 2, 2.9, -0.1), true},
            {"up from the trough of a storm", standing_at(300.1, -98.7, 2, 4.4, 0.35), true},
            {"above a storm", standing_at(55.5, 44.4, 25, -0.4, -0.6), true},
            {"just above the water, down", standing_at(-50.5, -3'141.5, 1.2, 1.0, -std::numbers::pi / 2)},
            {"straight down", standing_at(4'000.5, -3'141.5, 60, -1.1, -std::numbers::pi / 2)},
            {"straight down from a kilometre", standing_at(0.5, 0.5, 1'000, 0.3, -std::numbers::pi / 2)},
            {"past straight down", standing_at(-777.7, 1'234.5, 45, 2.9, -1.35)},
            {"horizon at the picture's top", standing_at(31'415'926, -2'718'281, 20, 3.3, -0.44)},
            {"over the horizon", standing_at(1.5, 2.5, 40, 1.6, 0.6)},
            {"from a hill", standing_at(-5'000.5, 141.5, 200, 5.0, -0.2)},
            {"from an aeroplane", standing_at(4'000.5, -3'141.5, 3'000, -1.1, -0.4)},
            {"from ten kilometres", standing_at(9'999.5, 3.5, 10'000, 0.1, -0.25)},
            {"through a long lens", [] {
                 Camera camera = standing_at(100.5, 3.5, 15, 2.2, -0.02);
                 camera.vertical_angle = 0.1;
                 return camera;
             }()}};
}

std::unique_ptr<FixtureSource> open_sea(Camera& camera, bool storm, const DrawOptions& options) {
    auto source = std::make_unique<FixtureSource>(TerrainGrid{});
    if (storm) source->add_box(storm_box());
    CameraFloor().lift(camera, source->snapshot());
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source->set_view(view);
    return source;
}

Picture Painter::picture(FixtureSource& source, const Camera& camera, const Camera& meshed,
                         const DrawOptions& options) {
    if (!target_ || target_->width() != camera.width || target_->height() != camera.height)
        target_ = std::make_unique<RenderTarget>(camera.width, camera.height, 1);
    report_ = renderer_.draw(*target_, source.snapshot(), camera, meshed, options);
    return target_->read();
}

DrawOptions bare(MesherKind kind) {
    DrawOptions options;
    options.mesher = kind;
    options.sky = options.far_sea = options.land = options.ships = options.spray = options.foam_history =
        false;
    options.clear_colour = {1.0F, 0.0F, 1.0F};
    return options;
}

bool is_background(const Picture& picture, uint32_t x, uint32_t y) {
    const uint8_t* rgb = &picture.rgb[(size_t{y} * picture.width + x) * 3];
    return rgb[0] > 250 && rgb[1] < 5 && rgb[2] > 250;
}

double water_distance(const Camera& camera, uint32_t x, uint32_t y, double below_m) {
    const double tan_y = std::tan(camera.vertical_angle / 2);
    const double tan_x = tan_y * camera.width / camera.height;
    const double right = tan_x * ((x + 0.5) / camera.width * 2 - 1);
    const double up = tan_y * (1 - (y + 0.5) / camera.height * 2);
    const double ahead = std::cos(camera.pitch) - std::sin(camera.pitch) * up;
    const double rise = std::sin(camera.pitch) + std::cos(camera.pitch) * up;
    // height + rise t + (ahead^2 + right^2) t^2 / 2R = 0, the nearer root.
    const double level = ahead * ahead + right * right;
    const double height = camera.altitude_m + below_m;
    const double root = rise * rise - 2 * height * level / earth_radius;
    if (rise >= 0 || root < 0) return -1;
    return std::sqrt(level) * 2 * height / (-rise + std::sqrt(root));
}

}  // namespace trochoid
