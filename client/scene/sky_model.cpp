#include "client/scene/sky_model.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace trochoid {

namespace {

constexpr double pi = 3.14159265358979;
constexpr float ground_km = 6360.0F;
constexpr float top_km = 6460.0F;
constexpr float eye_km = ground_km + 0.02F;
// Scattering and absorption at sea level, 1/km; the haze is a sea's, half as much again as over land.
constexpr glm::vec3 rayleigh{5.802e-3F, 13.558e-3F, 33.1e-3F};
constexpr float mie_scattering = 4.4e-3F;
constexpr float mie_extinction = 4.9e-3F;
// Half of the source's ozone: with all of it and no true light of higher orders the dusk turns pink.
constexpr glm::vec3 ozone{0.325e-3F, 0.940e-3F, 0.043e-3F};
constexpr glm::vec3 sunlight{7.3F, 7.0F, 6.7F};  // outside of the air
/// The full moon against the sun. True would be 1 to 400,000; eyes make up for most of it.
constexpr float moon_power = 1.0F / 280.0F;

struct Densities {
    float air = 0;
    float haze = 0;
    float ozone = 0;
};
Densities densities_at(float height_km) {
    const float h = std::max(height_km, 0.0F);
    return {std::exp(-h / 8.0F), std::exp(-h / 1.2F), std::max(0.0F, 1.0F - std::abs(h - 25.0F) / 15.0F)};
}
glm::vec3 extinction_of(const Densities& d) {
    return rayleigh * d.air + glm::vec3(mie_extinction * d.haze) + ozone * d.ozone;
}

/// How far a ray from a radius, with the cosine of its angle to the vertical, goes to the sphere's far side, km.
float way_to_sphere(float radius, float cosine, float sphere) {
    const float in_root = radius * radius * (cosine * cosine - 1.0F) + sphere * sphere;
    return std::max(0.0F, -radius * cosine + std::sqrt(std::max(in_root, 0.0F)));
}

/// Transmittance from a place to the top of the air; the earth takes it softly away, for the sun is no point.
glm::vec3 transmittance_to_top(float radius, float cosine) {
    const float to_ground = radius * radius * (cosine * cosine - 1.0F) + ground_km * ground_km;
    if (cosine < 0.0F && to_ground > 0.0F) return glm::vec3(0.0F);
    const float way = way_to_sphere(radius, cosine, top_km);
    constexpr int steps = 32;
    glm::vec3 depth(0.0F);
    for (int i = 0; i < steps; ++i) {
        // Finer near the start, where the air is thickest.
        const float a = static_cast<float>(i) / steps;
        const float b = static_cast<float>(i + 1) / steps;
        const float t = 0.5F * (a * a + b * b) * way;
        const float r = std::sqrt(radius * radius + t * t + 2.0F * radius * t * cosine);
        depth += extinction_of(densities_at(r - ground_km)) * ((b * b - a * a) * way);
    }
    return glm::exp(-depth);
}

/// The same by table: heights by their root, cosines by the signed root about 0, where dusk happens.
class TransmittanceTable {
public:
    TransmittanceTable() {
        for (int h = 0; h < heights; ++h)
            for (int c = 0; c < cosines; ++c) {
                const float part = static_cast<float>(h) / (heights - 1);
                const float s = 2.0F * static_cast<float>(c) / (cosines - 1) - 1.0F;
                values_[static_cast<size_t>(h * cosines + c)] =
                    transmittance_to_top(ground_km + part * part * (top_km - ground_km), s * std::abs(s));
            }
    }
    glm::vec3 at(float radius, float cosine) const {
        const float part = std::sqrt(std::clamp((radius - ground_km) / (top_km - ground_km), 0.0F, 1.0F));
        const float s = std::copysign(std::sqrt(std::abs(cosine)), cosine);
        const float y = part * (heights - 1);
        const float x = (s + 1.0F) * 0.5F * (cosines - 1);
        const int j = std::min(static_cast<int>(y), heights - 2);
        const int i = std::clamp(static_cast<int>(x), 0, cosines - 2);
        const float fx = x - static_cast<float>(i);
        const float fy = y - static_cast<float>(j);
        const auto value = [&](int c, int r) { return values_[static_cast<size_t>(r * cosines + c)]; };
        return (value(i, j) * (1 - fx) + value(i + 1, j) * fx) * (1 - fy) +
               (value(i, j + 1) * (1 - fx) + value(i + 1, j + 1) * fx) * fy;
    }

private:
    static constexpr int heights = 48;
    static constexpr int cosines = 161;
    std::array<glm::vec3, size_t{heights} * cosines> values_{};
};

const TransmittanceTable& transmittance() {
    static const TransmittanceTable table;
    return table;
}

float smooth(float low, float high, float v) {
    const float t = std::clamp((v - low) / (high - low), 0.0F, 1.0F);
    return t * t * (3.0F - 2.0F * t);
}

float luminance(const glm::vec3& c) { return glm::dot(c, glm::vec3(0.2126F, 0.7152F, 0.0722F)); }

float rayleigh_phase(float cosine) {
    return static_cast<float>(3.0 / (16.0 * pi)) * (1.0F + cosine * cosine);
}
/// Cornette and Shanks, g = 0.76.
float haze_phase(float cosine) {
    constexpr float g = 0.76F;
    constexpr float g2 = g * g;
    return static_cast<float>(3.0 / (8.0 * pi)) * (1.0F - g2) * (1.0F + cosine * cosine) /
           ((2.0F + g2) * std::pow(1.0F + g2 - 2.0F * g * cosine, 1.5F));
}

}  // namespace

glm::vec3 sun_direction(double hour, double latitude, double declination) {
    const double turn = (hour - 12.0) * pi / 12.0;
    const double north = std::sin(declination) * std::cos(latitude) -
                         std::cos(declination) * std::sin(latitude) * std::cos(turn);
    const double west = std::cos(declination) * std::sin(turn);
    const double up = std::sin(declination) * std::sin(latitude) +
                      std::cos(declination) * std::cos(latitude) * std::cos(turn);
    return {static_cast<float>(-west), static_cast<float>(up), static_cast<float>(-north)};
}

SkyModel::SkyModel(double hour) {
    constexpr double latitude = 50.0 * pi / 180.0;
    constexpr double declination = 17.0 * pi / 180.0;
    const glm::vec3 sun = sun_direction(hour, latitude, declination);
    // A full moon of summer: opposite to the sun, so it stands in the south at midnight; lifted, so that it is seen for long.
    const glm::vec3 moon = glm::normalize(glm::vec3(-sun.x, std::max(-sun.y, -0.2F) * 0.8F + 0.12F, -sun.z));
    sources_[0] = {sun, 1.0F};
    sources_[1] = {moon, moon_power * smooth(-0.02F, -0.14F, sun.y)};
    light_.true_sun = sun;
    light_.night = smooth(-0.06F, -0.17F, sun.y);
    const Source& source = sun.y > -0.035F ? sources_[0] : sources_[1];
    light_.towards = source.towards;
    // The disc sinks into the horizon over its own width.
    light_.irradiance = sunlight * source.power *
                        transmittance().at(eye_km, std::max(source.towards.y, 0.0F)) *
                        smooth(-0.012F, 0.006F, source.towards.y);
    light_.ambient = average_over_sky();
    const float brightness = luminance(light_.ambient) + luminance(light_.irradiance) *
                                                             std::max(light_.towards.y, 0.0F) /
                                                             static_cast<float>(pi);
    // At dusk eyes, and cameras, hold to the bright strip of sky.
    const float low = (1.0F - smooth(0.02F, 0.30F, sun.y)) * (1.0F - light_.night);
    light_.exposure = 0.92F * std::pow(1.6F / std::max(brightness, 1e-5F), 0.50F) * (1.0F - 0.55F * low);
}

namespace {

/// Light of higher orders, which comes from the whole lit air above: taken so high up, and where the sun is so much higher
/// (sine). At dusk that is the air which still has sun: blue where air scatters it again, reddish in haze, and less in all.
struct HigherOrders {
    float lift_km;
    float rise;
    glm::vec3 by_air;
    glm::vec3 by_haze;
};
HigherOrders higher_orders(float sun_height) {
    const float dusk = 1.0F - smooth(-0.08F, 0.10F, sun_height);
    const float deep = 1.0F - smooth(-0.16F, -0.02F, sun_height);
    const float power = 0.045F * (1.0F - 0.45F * dusk);
    const glm::vec3 blue = glm::vec3(0.55F, 0.90F, 1.20F) * (1.0F - 0.3F * deep);
    return {16.0F + 2.0F * dusk + 5.0F * deep, 0.05F + 0.006F * dusk + 0.022F * deep,
            glm::mix(glm::vec3(1.0F), blue, dusk) * power,
            glm::mix(glm::vec3(1.0F), glm::vec3(1.0F, 0.8F, 0.5F), dusk) * power};
}

}  // namespace

glm::vec3 SkyModel::scattered(const glm::vec3& d, const Source& source) const {
    if (source.power <= 0.0F) return glm::vec3(0.0F);
    const float cosine = glm::dot(d, source.towards);
    const float by_air = rayleigh_phase(cosine);
    const float by_haze = haze_phase(cosine);
    const float way = way_to_sphere(eye_km, d.y, top_km);
    const HigherOrders higher = higher_orders(source.towards.y);
    constexpr int steps = 22;
    glm::vec3 sum(0.0F);
    glm::vec3 through(1.0F);
    for (int i = 0; i < steps; ++i) {
        const float a = static_cast<float>(i) / steps;
        const float b = static_cast<float>(i + 1) / steps;
        const float length = (b * b - a * a) * way;
        const float t = 0.5F * (a * a + b * b) * way;
        const float radius = std::sqrt(eye_km * eye_km + t * t + 2.0F * eye_km * t * d.y);
        const float sun_cosine = (eye_km * source.towards.y + t * cosine) / radius;
        const Densities at = densities_at(radius - ground_km);
        const glm::vec3 step_through = glm::exp(-extinction_of(at) * length);
        const glm::vec3 arriving = transmittance().at(radius, sun_cosine);
        const glm::vec3 lit_air =
            transmittance().at(radius + higher.lift_km, std::min(sun_cosine + higher.rise, 1.0F));
        const glm::vec3 air = rayleigh * at.air;
        const glm::vec3 haze(mie_scattering * at.haze);
        const glm::vec3 source_here = arriving * (air * by_air + haze * by_haze) +
                                      lit_air * (air * higher.by_air + haze * higher.by_haze);
        // Integral over the step with its own extinction (Hillaire, "Physically Based Sky", 2016).
        const glm::vec3 extinction = glm::max(extinction_of(at), glm::vec3(1e-7F));
        sum += through * source_here * (glm::vec3(1.0F) - step_through) / extinction;
        through *= step_through;
    }
    return sum * sunlight * source.power;
}

glm::vec3 SkyModel::radiance(const glm::vec3& direction) const {
    glm::vec3 d = direction;
    d.y = std::max(d.y, 0.0F);
    d = glm::normalize(d);
    // Starlight and airglow keep the night from black.
    const glm::vec3 airglow = glm::vec3(0.9F, 1.1F, 1.5F) * (0.00025F * (1.0F + 2.0F * (1.0F - d.y)));
    return scattered(d, sources_[0]) + scattered(d, sources_[1]) + airglow;
}

glm::vec3 SkyModel::average_over_sky() const {
    glm::vec3 sum(0.0F);
    constexpr int rings = 6;
    constexpr int sectors = 12;
    for (int ring = 0; ring < rings; ++ring)
        for (int sector = 0; sector < sectors; ++sector) {
            // Even in the square of the sine: weighted by the cosine as a level plane is.
            const float across = std::sqrt((static_cast<float>(ring) + 0.5F) / rings);
            const float turn = static_cast<float>(2.0 * pi) * (static_cast<float>(sector) + 0.5F) / sectors;
            sum += radiance(
                {across * std::cos(turn), std::sqrt(1.0F - across * across), across * std::sin(turn)});
        }
    return sum / static_cast<float>(rings * sectors);
}

glm::vec3 cube_direction(uint32_t face, double column, double row, uint32_t side) {
    const auto s = static_cast<float>(2.0 * (column + 0.5) / side - 1.0);
    const auto t = static_cast<float>(2.0 * (row + 0.5) / side - 1.0);
    switch (face) {
        case 0: return {1, -t, -s};
        case 1: return {-1, -t, s};
        case 2: return {s, 1, t};
        case 3: return {s, -1, -t};
        case 4: return {s, -t, 1};
        default: return {-s, -t, -1};
    }
}

std::array<std::vector<glm::vec3>, 6> SkyModel::cube(uint32_t side) const {
    std::array<std::vector<glm::vec3>, 6> faces;
    for (uint32_t face = 0; face < 6; ++face) {
        std::vector<glm::vec3>& texels = faces[face];
        texels.resize(size_t{side} * side);
        for (uint32_t row = 0; row < side; ++row)
            for (uint32_t column = 0; column < side; ++column) {
                glm::vec3& texel = texels[size_t{row} * side + column];
                const bool below = face != 2 && face != 3 && row > side / 2;
                // Below the horizon the last row goes on; the floor is the horizon's mean, which nobody sees.
                if (face == 3)
                    texel = faces[0][size_t{side - 1} * side + side / 2];
                else if (below)
                    texel = texels[size_t{row - 1} * side + column];
                else
                    texel = radiance(glm::normalize(cube_direction(face, column, row, side)));
            }
    }
    return faces;
}

}  // namespace trochoid
