#include "server/interest/frustum.hpp"

#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

using Matrix = std::array<std::array<double, 4>, 4>;

constexpr double near_plane = 0.1;
/// Below this cosine between the axis and the padded corner of the picture no plane bounds the view any more.
constexpr double least_corner_cosine = 0.05;

double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double magnitude(double v) { return v < 0.0 ? -v : v; }

/// Axes of the camera in the world: right, up, backward. The quaternion need not be exactly of unit length.
std::array<Vec3, 3> axes_of(const ViewState& v) {
    const double x = v.qx, y = v.qy, z = v.qz, w = v.qw;
    const double s = 2.0 / (x * x + y * y + z * z + w * w);
    return {Vec3{1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
            Vec3{s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)},
            Vec3{s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)}};
}

Matrix projection_of(const ViewState& view, double n, double f) {
    Matrix m{};
    m[0][0] = 1.0 / static_cast<double>(view.tan_half_width);
    m[1][1] = 1.0 / static_cast<double>(view.tan_half_height);
    m[2][2] = -(f + n) / (f - n);
    m[2][3] = -2.0 * f * n / (f - n);
    m[3][2] = -1.0;
    return m;
}

/// World (relative to the camera) to camera.
Matrix view_matrix_of(const ViewState& view) {
    Matrix m{};
    const auto axes = axes_of(view);
    for (size_t row = 0; row < 3; ++row) m[row] = {axes[row].x, axes[row].y, axes[row].z, 0.0};
    m[3][3] = 1.0;
    return m;
}

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix m{};
    for (size_t row = 0; row < 4; ++row)
        for (size_t column = 0; column < 4; ++column)
            for (size_t i = 0; i < 4; ++i) m[row][column] += a[row][i] * b[i][column];
    return m;
}

/// Last row plus or minus another one, scaled to a unit normal.
Plane plane_from(const Matrix& m, size_t row, double sign) {
    const Vec3 normal{m[3][0] + sign * m[row][0], m[3][1] + sign * m[row][1], m[3][2] + sign * m[row][2]};
    const double length = std::sqrt(dot(normal, normal));
    return {{normal.x / length, normal.y / length, normal.z / length}, (m[3][3] + sign * m[row][3]) / length};
}

}  // namespace

Vec3 forward_of(const ViewState& view) {
    const Vec3 back = axes_of(view)[2];
    return {-back.x, -back.y, -back.z};
}

SixPlanes planes_of(const ViewState& view, double near_distance, double far_distance) {
    const Matrix combined = product(projection_of(view, near_distance, far_distance), view_matrix_of(view));
    return {plane_from(combined, 0, 1.0),  plane_from(combined, 0, -1.0), plane_from(combined, 1, 1.0),
            plane_from(combined, 1, -1.0), plane_from(combined, 2, 1.0),  plane_from(combined, 2, -1.0)};
}

SixPlanes padded_planes(const ViewState& view, double slack, double tangent, double far_distance) {
    const double w = view.tan_half_width;
    const double h = view.tan_half_height;
    const double corner_cosine = 1.0 / std::sqrt(1.0 + w * w + h * h);
    const double corner_sine = std::sqrt(w * w + h * h) * corner_cosine;
    const double turn_cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
    const double turn_sine = tangent * turn_cosine;
    const double padded_cosine = corner_cosine * turn_cosine - corner_sine * turn_sine;
    if (padded_cosine < least_corner_cosine) return {};

    // With q = p - camera, n and f the plane's normal and the direction of view, n' and f' the turned ones: n'q >= 0 and
    // |n - n'| is a turn by at most delta, so nq >= -sin(delta) |q|; and |q| <= fq / cos(corner + delta). Hence
    // (n + tilt f) q >= 0 holds for every view within the turn, and moving the camera by slack moves the plane by it.
    const Vec3 f = forward_of(view);
    const double tilt = turn_sine / padded_cosine;
    SixPlanes planes = planes_of(view, near_plane, far_distance);
    for (size_t side = 0; side < 4; ++side) {
        Vec3& n = planes[side].normal;
        n = {n.x + tilt * f.x, n.y + tilt * f.y, n.z + tilt * f.z};
        planes[side].offset = std::sqrt(dot(n, n)) * slack;
    }
    // Turned views still look forwards (padded_cosine > 0); their far corners reach |f - f'| * far / cos(corner) further.
    planes[4].offset = slack;
    planes[5].offset = far_distance * (1.0 + tangent / corner_cosine) + slack;
    return planes;
}

bool outside(const SixPlanes& planes, const SurfaceBounds& b) {
    for (const Plane& plane : planes) {
        const Vec3& n = plane.normal;
        const double reach =
            magnitude(n.x) * b.half.x + magnitude(n.y) * b.half.y + magnitude(n.z) * b.half.z;
        if (dot(n, b.middle) + reach + plane.offset < 0.0) return true;
    }
    return false;
}

}  // namespace trochoid
