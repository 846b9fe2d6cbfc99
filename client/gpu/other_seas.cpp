#include "client/gpu/other_seas.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "client/gpu/shader_program.hpp"

namespace trochoid {

namespace {

constexpr size_t most_octaves = 8;

/// Heights are taken over in steps of a sixteenth, so that a slowly changing sea does not remake its twins every frame.
float stepped_height(float height_m) { return std::max(std::round(height_m * 16.0F) / 16.0F, 0.0625F); }

/// Octaves whose largest cells are half a wave of the peak long, and whose sum has the wanted significant height.
SurfaceNoise noise_of_height(float height_m) {
    SurfaceNoise noise;
    const double cell = 0.5 * peak_wavelength_of(static_cast<double>(height_m)) * 1024.0;
    noise.step_log2 = static_cast<uint8_t>(std::clamp(std::lround(std::log2(cell)), 11L, 20L));
    noise.octaves = static_cast<uint8_t>(std::min<size_t>(most_octaves, noise.step_log2 - 8U));
    noise.persistence = 0x7000;
    const double period_us = 0.5e6 * peak_period_of(static_cast<double>(height_m));
    noise.period_log2 = static_cast<uint8_t>(std::clamp(std::lround(std::log2(period_us)), 20L, 26L));
    noise.amplitude = 1.0F;
    // What a unit of amplitude gives, measured over a few cells.
    double squares = 0;
    constexpr int side = 48;
    const std::vector<NoiseOctave> octaves = octaves_at(noise, SeaTime{0});
    for (int i = 0; i < side * side; ++i) {
        const int64_t step = (int64_t{1} << noise.step_log2) * 3 / 7;
        const double h = static_cast<double>(noise_at(octaves, {i % side * step, i / side * step}).height);
        squares += h * h;
    }
    const double deviation = std::sqrt(squares / (side * side));
    noise.amplitude = static_cast<float>(static_cast<double>(height_m) / 4.0 / deviation);
    return noise;
}

void make_texture(const GlTexture& texture, GLint unit, const FftSea& sea,
                  std::span<const glm::vec4> texels) {
    const auto side = static_cast<GLsizei>(sea.settings().side);
    texture.bind(GL_TEXTURE_2D, unit);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, side, side, 0, GL_RGBA, GL_FLOAT, texels.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    for (const auto axis : std::array<GLenum, 2>{GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glTexParameteri(GL_TEXTURE_2D, axis, GL_REPEAT);
}

}  // namespace

/// The OtherSeas block of shaders/other_seas.glsl (std140).
struct OtherSeas::Block {
    std::array<std::array<int32_t, 4>, most_octaves> noise_layers{};
    std::array<glm::vec4, most_octaves> noise_scale{};
    std::array<int32_t, 4> counts{};
    std::array<float, 12> fft_variance{};
};

OtherSeas::OtherSeas() {
    const Block nothing;
    block_.fill(GL_UNIFORM_BUFFER, std::span<const Block>(&nothing, 1), GL_STREAM_DRAW);
}

void OtherSeas::fill_noise(Block& block, const SeaWeather& weather, SeaTime now) {
    const float height = stepped_height(weather.height_m);
    if (height != noise_height_) {
        noise_height_ = height;
        noise_ = noise_of_height(height);
    }
    const std::vector<NoiseOctave> octaves = octaves_at(noise_, now);
    block.counts[0] = static_cast<int32_t>(octaves.size());
    for (size_t i = 0; i < octaves.size(); ++i) {
        const NoiseOctave& o = octaves[i];
        block.noise_layers[i] = {std::bit_cast<int32_t>(o.early), std::bit_cast<int32_t>(o.late), o.step_log2,
                                 std::bit_cast<int32_t>(o.since)};
        const float wavelength = std::ldexp(2.0F, int{o.step_log2} - 10);
        block.noise_scale[i] = {o.fade, o.height, o.slope, wavelength};
    }
}

void OtherSeas::fill_fft(Block& block, const SeaWeather& weather, SeaTime now) {
    FftSeaSettings settings;
    settings.significant_height = stepped_height(weather.height_m);
    // Turning the tile would tear the picture: the heading stays with the sea that it was made for.
    const float length = glm::length(weather.heading);
    settings.heading = fft_             ? fft_->settings().heading
                       : length > 1e-6F ? weather.heading / length
                                        : glm::vec2(1.0F, 0.0F);
    if (!fft_ || fft_->settings() != settings) fft_ = std::make_unique<FftSea>(settings);
    fft_->transform(static_cast<double>(now.us) * 1e-6);
    make_texture(displaced_, fft_unit, *fft_, fft_->displaced());
    make_texture(slopes_, fft_slope_unit, *fft_, fft_->slopes());
    block.counts[1] = static_cast<int32_t>(settings.tile_log2);
    block.counts[2] = std::countr_zero(settings.side);
    block.fft_variance = fft_->slope_variance();
}

void OtherSeas::prepare(Displacement displacement, const SeaWeather& weather, SeaTime now) {
    if (displacement != Displacement::trains) {
        Block block;
        if (displacement == Displacement::noise)
            fill_noise(block, weather, now);
        else
            fill_fft(block, weather, now);
        block_.fill(GL_UNIFORM_BUFFER, std::span<const Block>(&block, 1), GL_STREAM_DRAW);
    }
    glBindBufferBase(GL_UNIFORM_BUFFER, other_seas_binding, block_.name());
    displaced_.bind(GL_TEXTURE_2D, fft_unit);
    slopes_.bind(GL_TEXTURE_2D, fft_slope_unit);
}

}  // namespace trochoid
