#include "tests/gpu/foam_coverage.hpp"

#include <algorithm>
#include <cmath>

#include "client/scene/land_table.hpp"
#include "client/scene/sea_table.hpp"

namespace trochoid {

namespace {

/// Of a sea raised by a wind: significant height, m. Grown up as Pierson and Moskowitz's up to 12 m/s, younger beyond.
double height_of(double wind_m_s) {
    return 0.0246 * wind_m_s * wind_m_s * std::pow(std::min(1.0, 12.0 / wind_m_s), 0.7);
}

WaveTrainBox box_of(double peak_m, double height_m) {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    box.trains = wind_sea(peak_m, -0.7, height_m, 30, 7);
    box.gain_max = 41'000;
    return box;
}

double wind_told_by(const InterestState& state, SeaTime now) {
    LandTable land;
    land.rebuild(state, 65'536, 65'536);
    SeaTable table;
    table.rebuild(state, land);
    return table.weather_at({}, now, 6.0F).wind_m_s;
}

Camera straight_down(double side_m) {
    Camera camera;
    camera.vertical_angle = 0.5;
    camera.altitude_m = 0.5 * side_m / std::tan(0.25);
    camera.pitch = -1.570796;
    camera.yaw = 0.3;
    camera.width = camera.height = FoamCoverage::pixels;
    return camera;
}

/// The sea shows the square root of its share, so that 8 bits hold small shares too.
double share_of(uint8_t shown) { return shown * shown / 65025.0; }

}  // namespace

double monahan_share(double wind_m_s) { return 2.95e-6 * std::pow(wind_m_s, 3.52); }

FoamCoverage::FoamCoverage(double wind_m_s) {
    // The swell of the fixture's own must not take part.
    WaveTrainBox none;
    none.id = {2};
    none.first_train = {100};
    source_.add_box(none);
    double shorter = 2.0;
    double longer = 900.0;
    for (int i = 0; i < 30; ++i) {
        const double peak = std::sqrt(shorter * longer);
        source_.add_box(box_of(peak, height_of(wind_m_s)));
        wind_m_s_ = wind_told_by(source_.state(), now_);
        (wind_m_s_ > wind_m_s ? shorter : longer) = peak;
    }
}

Picture FoamCoverage::draw(const RenderTarget& target, const Camera& camera, const DrawOptions& options) {
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source_.set_view(view);
    source_.set_time(now_);
    renderer_.draw(target, source_.snapshot(), camera, camera, options);
    return target.read();
}

void FoamCoverage::pass_time(double seconds, const Camera& camera) {
    Camera small = camera;
    small.width = small.height = 16;
    DrawOptions options;
    options.far_sea = options.sky = options.spray = options.ships = false;
    options.error_px = 40.0F;
    constexpr int64_t step_us = 200'000;
    for (int64_t left = std::llround(seconds * 1e6); left > 0; left -= step_us) {
        now_.us += step_us;
        draw(unseen_, small, options);
    }
}

double FoamCoverage::mean(double side_m, int moments, double apart_s) {
    const Camera camera = straight_down(side_m);
    DrawOptions options;
    options.foam_share = true;
    options.error_px = 2.0F;
    options.spray = false;
    double sum = 0;
    pass_time(12.0 - apart_s, camera);
    for (int i = 0; i < moments; ++i) {
        pass_time(apart_s, camera);
        const Picture picture = draw(target_, camera, options);
        for (size_t p = 0; p < picture.rgb.size(); p += 3) sum += share_of(picture.rgb[p]);
    }
    return sum / (static_cast<double>(moments) * pixels * pixels);
}

FoamCoverage::Look FoamCoverage::look(double side_m, double hour) {
    const Camera camera = straight_down(side_m);
    pass_time(12.0, camera);
    DrawOptions options;
    options.error_px = 2.0F;
    options.spray = false;
    options.hour = hour;
    Look look;
    look.colours = draw(target_, camera, options);
    options.foam_share = true;
    const Picture shares = draw(target_, camera, options);
    for (size_t p = 0; p < shares.rgb.size(); p += 3) look.share.push_back(share_of(shares.rgb[p]));
    return look;
}

}  // namespace trochoid
