#include "client/gpu/foam_pass.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "client/scene/foam_detail.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr uint32_t detail_side = 256;
/// After a longer gap there is no history worth keeping: the map begins with what the wind says on average.
constexpr int64_t longest_gap_steps = 20;

void upload_detail(const GlTexture& texture) {
    const FoamDetail detail = make_foam_detail(detail_side, 11);
    texture.bind(GL_TEXTURE_2D, foam_detail_unit);
    uint32_t side = detail.side;
    for (size_t level = 0; level<detail.levels.size(); ++level, side = side> 1 ? side / 2 : 1)
        glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA8, static_cast<GLsizei>(side),
                     static_cast<GLsizei>(side), 0, GL_RGBA, GL_FLOAT, detail.levels[level].data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

int64_t floor_to(int64_t value, int64_t step) {
    const int64_t rest = value % step;
    return value - (rest < 0 ? rest + step : rest);
}

}  // namespace

FoamPass::FoamPass() {
    glGenFramebuffers(1, &framebuffer_);
    upload_detail(detail_);
}

FoamPass::~FoamPass() { glDeleteFramebuffers(1, &framebuffer_); }

void FoamPass::resize(uint32_t side) {
    TROCHOID_ASSERT(std::has_single_bit(side) && side >= 64 && side <= 1024, "foam map of {} texels", side);
    side_ = side;
    done_step_.reset();
    const std::vector<float> nothing(size_t{side} * side * 4, 0.0F);
    for (const GlTexture& map : maps_) {
        map.bind(GL_TEXTURE_2D, foam_unit);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, static_cast<GLsizei>(side), static_cast<GLsizei>(side), 0,
                     GL_RGBA, GL_FLOAT, nothing.data());
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }
}

glm::vec4 FoamPass::place(const Camera& camera, const CameraFrame& frame, SeaTime now, uint32_t side) {
    if (side == 0) {
        done_step_.reset();
        return glm::vec4(0.0F);
    }
    if (side != side_) resize(side);
    wanted_step_ = floor_to(now.us, step_us) / step_us;
    anchor_ = frame.anchor;
    // Most of the map lies before the camera; its middle moves in steps of eight texels.
    const int64_t grain = 8 * (to_lattice(map_side_m) / side);
    const double ahead = 0.28 * map_side_m * std::cos(camera.pitch);
    middle_ = {floor_to(camera.position.x + to_lattice(std::sin(camera.yaw) * ahead), grain),
               floor_to(camera.position.z - to_lattice(std::cos(camera.yaw) * ahead), grain)};
    const glm::vec2 middle = metres_from_anchor(frame, middle_);
    return {middle, map_side_m,
            static_cast<float>(static_cast<double>(now.us - wanted_step_ * step_us) / 1e6)};
}

void FoamPass::run(const SeaWeather& weather, int64_t steps) {
    const bool history = steps > 0;
    const float caps = whitecap_share(weather.wind_m_s);
    // What breaks at one moment is a part of the foam that lies there, the less the longer crests break; without a history all of
    // it is taken at once.
    const float part = std::clamp(0.7F - 0.035F * (weather.wind_m_s - 12.0F), 0.25F, 0.7F);
    const float breaking = std::max(caps * (history ? part : 0.8F), 1e-5F);
    program_.use();
    const auto texel = static_cast<int32_t>(to_lattice(map_side_m) / side_);
    glUniform4i(program_.uniform("window"), static_cast<GLint>(middle_.x - anchor_.x),
                static_cast<GLint>(middle_.z - anchor_.z), std::countr_zero(static_cast<uint32_t>(texel)),
                static_cast<GLint>(side_));
    glUniform4i(program_.uniform("window_before"), static_cast<GLint>(done_middle_.x - anchor_.x),
                static_cast<GLint>(done_middle_.z - anchor_.z), history ? 1 : 0, 0);
    glUniform4f(program_.uniform("passing"), static_cast<float>(static_cast<double>(steps * step_us) / 1e6),
                caps > 2e-4F ? normal_quantile(breaking) : 9.0F, history ? 0.025F * weather.wind_m_s : 0.0F,
                weather.wind_m_s);
}

void FoamPass::update(bool wanted, const SeaWeather& weather) {
    detail_.bind(GL_TEXTURE_2D, foam_detail_unit);
    place_known_ = wanted;
    if (!wanted) return;
    if (wanted_step_ != done_step_) {
        const int64_t gap = done_step_ ? wanted_step_ - *done_step_ : 0;
        const int64_t moved =
            std::max(std::abs(middle_.x - done_middle_.x), std::abs(middle_.z - done_middle_.z));
        const bool keep = gap > 0 && gap <= longest_gap_steps && moved < to_lattice(map_side_m);
        run(weather, keep ? gap : 0);
        maps_[current_].bind(GL_TEXTURE_2D, foam_unit);
        current_ = 1 - current_;
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, maps_[current_].name(),
                               0);
        glViewport(0, 0, static_cast<GLsizei>(side_), static_cast<GLsizei>(side_));
        glDisable(GL_DEPTH_TEST);
        nothing_.bind();
        glDrawArrays(GL_TRIANGLES, 0, 3);
        done_step_ = wanted_step_;
        done_middle_ = middle_;
    }
    bind();
}

void FoamPass::set_smaller_filter(GLenum filter) {
    detail_.bind(GL_TEXTURE_2D, foam_detail_unit);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
}

void FoamPass::bind() const { maps_[current_].bind(GL_TEXTURE_2D, foam_unit); }

}  // namespace trochoid
