#include "client/scene/frustum.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "protocol/model/displayed.hpp"

namespace trochoid {

FrustumPlanes planes_of(const CameraFrame& frame, DepthRange range) {
    const glm::mat4 rows = glm::transpose(frame.clip_from_camera);
    FrustumPlanes planes{rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1],
                         range == DepthRange::classic ? rows[3] + rows[2] : rows[3] - rows[2]};
    for (glm::vec4& plane : planes) plane /= glm::length(glm::vec3(plane));
    return planes;
}

Bounds bounds_of_square(const CameraFrame& frame, LatticePoint corner, int64_t side, float height_m,
                        float displacement_m) {
    const glm::vec3 low = metres_from_camera(frame, corner, 0.0);
    const glm::vec3 high = metres_from_camera(frame, {corner.x + side, corner.z + side}, 0.0);
    const float far_x = std::max(std::abs(low.x), std::abs(high.x));
    const float far_z = std::max(std::abs(low.z), std::abs(high.z));
    const auto drop = static_cast<float>(
        (static_cast<double>(far_x) * far_x + static_cast<double>(far_z) * far_z) / (2 * earth_radius));
    return {low - glm::vec3(displacement_m, height_m + drop, displacement_m),
            high + glm::vec3(displacement_m, height_m, displacement_m)};
}

bool may_see(const FrustumPlanes& planes, const Bounds& bounds) {
    return std::all_of(planes.begin(), planes.end(), [&](const glm::vec4& plane) {
        const glm::vec3 normal(plane);
        const glm::vec3 farthest(normal.x > 0 ? bounds.high.x : bounds.low.x,
                                 normal.y > 0 ? bounds.high.y : bounds.low.y,
                                 normal.z > 0 ? bounds.high.z : bounds.low.z);
        return glm::dot(normal, farthest) + plane.w >= 0;
    });
}

}  // namespace trochoid
