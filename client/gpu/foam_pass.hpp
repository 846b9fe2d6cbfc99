#pragma once
#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <optional>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/camera.hpp"
#include "client/scene/sea_weather.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Foam with a history (row A11): a map of the water around the camera, in places at rest, that gains foam where the surface
/// folds and loses it again in seconds, sooner between the streaks that the wind draws. Fixed steps of sea time, so the same
/// sequence of sea times gives the same map. Texels lie on the lattice and wrap around, so a moving camera keeps them.
class FoamPass {
public:
    FoamPass();
    FoamPass(const FoamPass&) = delete;
    FoamPass& operator=(const FoamPass&) = delete;
    ~FoamPass();

    static constexpr float map_side_m = 256.0F;
    static constexpr int64_t step_us = 200'000;

    /// Of the Frame block: where the map of this frame lies; all 0 for no map. `side` texels, a power of two from 64 to 1024.
    glm::vec4 place(const Camera& camera, const CameraFrame& frame, SeaTime now, uint32_t side);
    /// Brings the map to the sea time of place(), at most one update a call. The Frame block and the sea's buffers must be
    /// bound; framebuffer and viewport are changed.
    void update(bool wanted, const SeaWeather& weather);
    void bind() const;
    /// Of what foam looks like, where it is smaller than its finest level.
    void set_smaller_filter(GLenum filter);
    /// Texels along the map; 0 where there is none.
    uint32_t side() const { return place_known_ ? side_ : 0; }
    /// Wavelength from which waves fold here, m.
    static float shortest_wave_m(uint32_t side) { return 3.0F * map_side_m / static_cast<float>(side); }

private:
    void resize(uint32_t side);
    void run(const SeaWeather& weather, int64_t steps);

    ShaderProgram program_{"whole_picture.vert", "foam.frag"};
    std::array<GlTexture, 2> maps_;
    GlTexture detail_;
    GlVertexArray nothing_;
    GLuint framebuffer_ = 0;
    uint32_t side_ = 0;
    bool place_known_ = false;
    size_t current_ = 0;
    // In steps of sea time and lattice units.
    int64_t wanted_step_ = 0;
    std::optional<int64_t> done_step_;
    LatticePoint anchor_;
    LatticePoint middle_;
    LatticePoint done_middle_;
};

}  // namespace trochoid
