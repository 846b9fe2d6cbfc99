#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "client/scene/camera.hpp"
#include "protocol/model/displayed.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid {

enum class Quality : uint8_t { low, medium, high };
std::optional<Quality> quality_named(std::string_view name);

/// What to draw and how finely.
struct DrawOptions {
    /// Height error that the mesh may show, pixels; vertices are twice that apart (displayed.hpp).
    float error_px = 6.0F;
    float land_error_px = 4.0F;
    uint32_t samples = 1;  ///< per pixel
    uint32_t triangles_per_draw = 4'000;
    bool wireframe = false;
    bool boxes = false;                ///< outlines of wave train boxes
    bool rays = false;                 ///< wave rays and action points
    bool patches = false;              ///< outlines of sea patches, coloured by level
    bool fields = false;               ///< gain of land fields in false colours
    Layers layers = displayed_layers;  ///< what the sea's sum is made of
    bool authoritative = false;        ///< no train fades with distance: for tests
    bool land = true;
    bool far_sea = true;
    bool sky = true;
    std::array<float, 3> clear_colour{0.0F, 0.0F, 0.0F};
    bool operator==(const DrawOptions&) const = default;
};

/// low: 9 px; medium: 6 px, meant for software rendering; high: 2 px, four samples a pixel.
DrawOptions options_for(Quality quality);

/// How vertices are spaced: by the coarser of what we want and of what the server culls by (finer would show trains that
/// it has left out in one patch and not in the next).
DisplayFilter filter_of(const Camera& camera, const DrawOptions& options, float error_in_force_px);

}  // namespace trochoid
