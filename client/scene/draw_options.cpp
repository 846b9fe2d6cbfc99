#include "client/scene/draw_options.hpp"

#include <algorithm>

namespace trochoid {

std::optional<Quality> quality_named(std::string_view name) {
    if (name == "low") return Quality::low;
    if (name == "medium") return Quality::medium;
    if (name == "high") return Quality::high;
    return std::nullopt;
}

DrawOptions options_for(Quality quality) {
    DrawOptions options;
    switch (quality) {
        case Quality::low:
            options.error_px = 9.0F;
            options.land_error_px = 8.0F;
            break;
        case Quality::medium: break;
        case Quality::high:
            options.error_px = 2.0F;
            options.land_error_px = 1.0F;
            options.samples = 4;
            options.triangles_per_draw = 20'000;
            break;
    }
    return options;
}

DisplayFilter filter_of(const Camera& camera, const DrawOptions& options, float error_in_force_px) {
    return display_filter(view_of(camera, glm::dvec3(0)), std::max(options.error_px, error_in_force_px));
}

}  // namespace trochoid
