#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace trochoid {

/// Light of an hour: colours are linear and relative, the sun's irradiance outside of the air is about 7.
struct SkyLight {
    glm::vec3 towards{0, 1,
                      0};  ///< unit vector to the sun, or to the moon when the sun is well below the horizon
    glm::vec3 irradiance{0};      ///< of it on a plane across its rays, through the clear air
    glm::vec3 ambient{0};         ///< irradiance of the clear sky on a level plane, over pi
    glm::vec3 true_sun{0, 1, 0};  ///< unit vector to the sun, below the horizon at night
    float exposure = 1;  ///< factor that brings radiances to the tone curve; eyes adapt, but not wholly
    float night = 0;     ///< 0 by day, 1 where only the moon shines: colours fade
    bool operator==(const SkyLight&) const = default;
};

/// Unit vector to the sun at a local solar time (hours, 0 to 24) on a latitude (radians) and a day of declination (radians).
/// x east, y up, z south.
glm::vec3 sun_direction(double hour, double latitude, double declination);

/// The clear sky over the sea at an hour (local solar time), from single scattering of sunlight (at night: moonlight) by air, haze
/// and ozone in a spherical atmosphere, with an isotropic term in place of higher orders. Coefficients: Hillaire, "A Scalable and
/// Production Ready Sky and Atmosphere Rendering Technique", 2020, table 1. Latitude 50 N in early August.
class SkyModel {
public:
    explicit SkyModel(double hour);

    const SkyLight& light() const { return light_; }
    /// Radiance towards a unit vector, without the discs of sun and moon; below the horizon as at it.
    glm::vec3 radiance(const glm::vec3& direction) const;
    /// Six faces of `side` squared texels in OpenGL's order (+x, -x, +y, -y, +z, -z), rows as OpenGL wants them.
    std::array<std::vector<glm::vec3>, 6> cube(uint32_t side) const;

private:
    struct Source {
        glm::vec3 towards{0, 1, 0};
        float power = 0;  // relative to the sun
    };
    glm::vec3 scattered(const glm::vec3& direction, const Source& source) const;
    glm::vec3 average_over_sky() const;

    std::array<Source, 2> sources_;  // the sun, the moon
    SkyLight light_;
};

/// Direction through the middle of a cube map's texel, not normalised, in OpenGL's convention.
glm::vec3 cube_direction(uint32_t face, double column, double row, uint32_t side);

}  // namespace trochoid
