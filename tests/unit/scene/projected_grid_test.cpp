#include "client/scene/projected_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "protocol/model/displayed.hpp"

namespace trochoid {
namespace {

constexpr WaveBounds swell{2.5F, 2.0F};
constexpr ProjectedShape shape{180, 100};

ProjectedView view_from(double altitude, double pitch) {
    ProjectedView view;
    view.altitude_m = altitude;
    view.pitch = pitch;
    return view;
}

/// Tangents right and up in the picture of a point relative to the camera: metres ahead, to the right, up.
struct Seen {
    double right;
    double up;
    bool before_camera;
};
Seen project(const ProjectedView& view, double ahead, double right, double up) {
    const double depth = ahead * std::cos(view.pitch) + up * std::sin(view.pitch);
    const double rise = up * std::cos(view.pitch) - ahead * std::sin(view.pitch);
    return {right / depth, rise / depth, depth > 0.3};
}
bool in_picture(const ProjectedView& view, const Seen& seen) {
    return seen.before_camera && std::abs(seen.right) < view.tan_half_width &&
           std::abs(seen.up) < view.tan_half_height;
}
double drop(double ahead, double right) { return (ahead * ahead + right * right) / (2 * earth_radius); }

/// Whether a place of the still water lies in the grid.
bool holds(const ProjectedGrid& grid, double ahead, double right) {
    for (size_t i = 0; i + 1 < grid.rows.size(); ++i) {
        const ProjectedRow& near = grid.rows[i];
        const ProjectedRow& far = grid.rows[i + 1];
        if (ahead < static_cast<double>(near.forward) || ahead > static_cast<double>(far.forward)) continue;
        const double share =
            (ahead - static_cast<double>(near.forward)) / static_cast<double>(far.forward - near.forward);
        const double half_width = static_cast<double>(near.half_width) +
                                  share * static_cast<double>(far.half_width - near.half_width);
        if (std::abs(right) <= half_width + 1e-3) return true;
    }
    return false;
}

/// Metres between a row's vertices.
float width_of(const ProjectedGrid& grid, size_t row) {
    return 2.0F * grid.rows[row].half_width / static_cast<float>(grid.columns);
}

/// Whatever waves do within their bounds, water that comes into view is in the grid.
TEST(ProjectedGrid, holds_all_water_that_waves_bring_into_view) {
    std::mt19937 random(5);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    size_t in_view = 0;
    for (int i = 0; i < 300; ++i) {
        const double altitude = std::exp(between(std::log(0.5), std::log(10'000.0)));
        const ProjectedView view = view_from(altitude, between(-1.5707963, 1.5707963));
        const WaveBounds waves{static_cast<float>(between(0, 30)), static_cast<float>(between(0, 25))};
        const ProjectedGrid grid = make_projected_grid(view, waves, shape, std::exp2(between(-2.0, 2.0)));
        for (int k = 0; k < 2'000; ++k) {
            // Places are dense near the camera and reach beyond the horizon.
            const double away =
                std::exp(between(std::log(0.1), std::log(3.0 * std::sqrt(2 * earth_radius * altitude))));
            const double turn = between(-3.2, 3.2);
            const double ahead = away * std::cos(turn);
            const double right = away * std::sin(turn);
            const double moved = between(0, static_cast<double>(waves.displacement));
            const double towards = between(-3.2, 3.2);
            const double x = ahead + moved * std::cos(towards);
            const double z = right + moved * std::sin(towards);
            const double rise = between(-1, 1) * static_cast<double>(waves.height);
            const double up = rise - altitude - drop(x, z);
            if (!in_picture(view, project(view, x, z, up))) continue;
            // Behind the horizon nothing is seen, however the picture is made.
            if (std::hypot(x, z) > std::sqrt(2 * earth_radius * altitude) +
                                       std::sqrt(2 * earth_radius * static_cast<double>(waves.height)))
                continue;
            ++in_view;
            ASSERT_TRUE(holds(grid, ahead, right))
                << "altitude " << altitude << " pitch " << view.pitch << " height " << waves.height
                << " displacement " << waves.displacement << " place " << ahead << ' ' << right;
        }
    }
    EXPECT_GT(in_view, 20'000U);
}

/// Row B3: at rest the rows have equal heights on the screen, up to the horizon.
TEST(ProjectedGrid, rows_cover_equal_heights_of_the_picture) {
    for (const double pitch : {-0.05, -0.3, -0.9, -1.5707963}) {
        SCOPED_TRACE(pitch);
        const ProjectedView view = view_from(400, pitch);
        const ProjectedGrid grid = make_projected_grid(view, swell, shape, 1.0);
        ASSERT_EQ(grid.rows.size(), shape.rows + 1);
        std::vector<double> heights;
        const double horizon = std::sqrt(2 * earth_radius * view.altitude_m);
        for (size_t i = 0; i + 1 < grid.rows.size(); ++i) {
            const auto near = static_cast<double>(grid.rows[i].forward);
            const auto far = static_cast<double>(grid.rows[i + 1].forward);
            if (far > 0.3 * horizon) break;  // there the horizon takes its own
            const Seen a = project(view, near, 0, -view.altitude_m - drop(near, 0));
            const Seen b = project(view, far, 0, -view.altitude_m - drop(far, 0));
            if (in_picture(view, a) && in_picture(view, b)) heights.push_back(b.up - a.up);
        }
        EXPECT_GT(heights.size(), shape.rows * 3 / 4);
        const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
        EXPECT_LT(*most, 1.1 * *least);
    }
}

TEST(ProjectedGrid, reaches_the_horizon_and_beyond_where_waves_rise) {
    for (const double altitude : {0.5, 3.0, 20.0, 200.0, 5'000.0, 10'000.0}) {
        const ProjectedGrid grid = make_projected_grid(view_from(altitude, -0.1), swell, shape, 1.0);
        const double horizon = std::sqrt(2 * earth_radius * altitude);
        EXPECT_GT(grid.rows.back().forward, horizon + 5'000);
        // Where rows are far apart the horizon's line lies below its place by the sagitta: less than half a pixel.
        const auto beyond = std::find_if(grid.rows.begin(), grid.rows.end(), [&](const ProjectedRow& row) {
            return static_cast<double>(row.forward) > horizon;
        });
        ASSERT_NE(beyond, grid.rows.begin());
        const double gap = static_cast<double>(beyond->forward - (beyond - 1)->forward);
        EXPECT_LT(gap * gap / (8 * earth_radius) / horizon, 5e-4) << "radians, from " << altitude << " m";
    }
}

TEST(ProjectedGrid, no_row_is_absurdly_near_the_next) {
    for (const double pitch : {-1.5707963, -0.8, 0.0, 0.5})
        for (const double altitude : {0.6, 2.0, 9.0}) {
            const ProjectedGrid grid = make_projected_grid(view_from(altitude, pitch), swell, shape, 1.0);
            for (size_t i = 0; i + 1 < grid.rows.size(); ++i)
                EXPECT_GT(grid.rows[i + 1].forward - grid.rows[i].forward, 0.2F);
        }
}

TEST(ProjectedGrid, attention_moves_rows_to_the_foreground) {
    size_t far_before = shape.rows;
    for (const double attention : {0.25, 0.5, 1.0, 2.0, 4.0}) {
        const ProjectedGrid grid = make_projected_grid(view_from(20, -0.2), swell, shape, attention);
        const auto far = static_cast<size_t>(std::count_if(
            grid.rows.begin(), grid.rows.end(), [](const auto& row) { return row.forward > 200; }));
        EXPECT_LT(far, far_before);
        far_before = far;
        EXPECT_EQ(grid.rows.size(), shape.rows + 1);
    }
}

TEST(ProjectedGrid, is_empty_where_no_water_can_be_in_view) {
    EXPECT_TRUE(make_projected_grid(view_from(20, 0.6), swell, shape, 1.0).rows.empty());
    EXPECT_TRUE(make_projected_grid(view_from(20, 1.5707963), swell, shape, 1.0).rows.empty());
    // Crests that are higher than the camera come into view from below.
    EXPECT_FALSE(make_projected_grid(view_from(2, 0.6), {9.0F, 7.0F}, shape, 1.0).rows.empty());
}

/// The grid slides with the camera and does not jump.
TEST(ProjectedGrid, follows_the_camera_without_jumps) {
    ProjectedGrid before = make_projected_grid(view_from(12, -0.2), swell, shape, 1.0);
    for (int i = 1; i < 200; ++i) {
        const ProjectedGrid grid =
            make_projected_grid(view_from(12 + 0.01 * i, -0.2 - 0.0005 * i), swell, shape, 1.0);
        ASSERT_EQ(grid.rows.size(), before.rows.size());
        for (size_t k = 0; k < grid.rows.size(); ++k)
            ASSERT_NEAR(grid.rows[k].forward, before.rows[k].forward,
                        0.1F * std::max(grid.rows[k].along, width_of(grid, k)));
        before = grid;
    }
}

/// Where a vertex lies on the sea, m from the camera.
glm::vec2 vertex_of(const ProjectedView& view, const ProjectedGrid& grid, size_t row, uint32_t column) {
    const float side = static_cast<float>(2 * column) / static_cast<float>(grid.columns) - 1.0F;
    return view.forward * grid.rows[row].forward + view.right * (side * grid.rows[row].half_width);
}

TEST(ProjectedGrid, steps_lead_to_the_next_vertices) {
    ProjectedView view = view_from(15, -0.15);
    view.forward = {0.6F, 0.8F};
    view.right = {-0.8F, 0.6F};
    const ProjectedGrid grid = make_projected_grid(view, swell, shape, 1.0);
    for (size_t row = 1; row + 1 < grid.rows.size(); row += 7)
        for (uint32_t column = 0; column < grid.columns; column += 11) {
            const VertexSteps steps = steps_at(view, grid, row, column);
            const glm::vec2 here = vertex_of(view, grid, row, column);
            const glm::vec2 beside = vertex_of(view, grid, row, column + 1) - here;
            const glm::vec2 on = vertex_of(view, grid, row + 1, column) - here;
            const glm::vec2 back = here - vertex_of(view, grid, row - 1, column);
            const glm::vec2 along = glm::length(on) > glm::length(back) ? on : back;
            EXPECT_NEAR(glm::length(steps.across - beside), 0, 1e-3F * glm::length(beside));
            // The farthest rows may lie where the width no longer grows evenly.
            EXPECT_NEAR(glm::length(steps.along - along), 0, 2e-2F * glm::length(along)) << row;
        }
}

TEST(ProjectedGrid, filters_a_wave_by_the_spacing_along_its_own_direction) {
    const glm::vec2 ahead{0.28F, 0.96F};
    const glm::vec2 aside{-0.96F, 0.28F};
    constexpr float wavelength = 60.0F;
    const auto spacing = [&](float along, float across, float turned, float least) {
        const glm::vec2 k = (ahead * std::cos(turned) + aside * std::sin(turned)) * (6.2831853F / wavelength);
        return wave_spacing({ahead * along, aside * across}, k, wavelength, least);
    };
    for (float turned = 0; turned < 6.3F; turned += 0.3F) {
        EXPECT_NEAR(spacing(7, 7, turned, 1), 7, 1e-4) << "square cells, whatever the direction";
        EXPECT_NEAR(spacing(300, 4, turned, 0), std::hypot(300 * std::cos(turned), 4 * std::sin(turned)),
                    1e-2);
    }
    EXPECT_NEAR(spacing(300, 4, 1.5707963F, 1), 4, 1e-3) << "across long cells";
    EXPECT_NEAR(spacing(300, 4, 0, 1), 300, 1e-2) << "along them";
    EXPECT_NEAR(spacing(300, 4, 1.5707963F, 9), 9, 1e-6) << "no finer than what the server sends";
}

/// Near the water crests hide troughs: rows go where waves stand up, and none where the sea is calm.
TEST(ProjectedGrid, waves_draw_rows_to_the_distance_where_they_stand_up) {
    const auto far_rows = [](double altitude, const WaveBounds& waves) {
        const ProjectedGrid grid = make_projected_grid(view_from(altitude, -0.1), waves, shape, 1.0);
        return std::count_if(grid.rows.begin(), grid.rows.end(), [](const ProjectedRow& row) {
            return row.forward > 300 && row.forward < 3'000;
        });
    };
    constexpr WaveBounds calm{0.05F, 0.05F};
    EXPECT_GT(2 * far_rows(3, swell), 3 * far_rows(3, calm));
    EXPECT_LT(far_rows(400, swell), far_rows(400, calm) * 11 / 10);
}

TEST(ProjectedGrid, takes_its_shape_from_the_options_or_the_wanted_angle) {
    const ProjectedView view = view_from(20, -0.2);
    DrawOptions options;
    const ProjectedShape wanted = projected_shape(options, view, 0.02F);
    EXPECT_EQ(wanted.columns, 86U);
    EXPECT_EQ(wanted.rows, 288U);
    options.projected_rows = options.projected_columns = 50;
    EXPECT_EQ(projected_shape(options, view, 0.02F), (ProjectedShape{50, 50}));
    EXPECT_EQ(make_projected_grid(view, swell, {50, 50}, 1.0).rows.size(), 51U);
    options.projected_rows = 1'000'000;
    EXPECT_EQ(projected_shape(options, view, 0.02F).rows, most_projected_quads);
}

TEST(ProjectedGrid, knows_the_view_from_the_camera) {
    Camera camera;
    camera.yaw = 0.7;
    for (const double pitch : {-1.5707963, -0.3, 0.4}) {
        camera.pitch = pitch;
        const ProjectedView view = projected_view(frame_of(camera, DepthRange::reversed_zero_to_one));
        EXPECT_NEAR(view.pitch, pitch, 1e-3);
        EXPECT_NEAR(view.tan_half_height, std::tan(0.45), 1e-5);
        EXPECT_NEAR(view.tan_half_width, std::tan(0.45) * 16 / 9, 1e-5);
        EXPECT_NEAR(view.forward.x, std::sin(0.7), 1e-5);
        EXPECT_NEAR(view.forward.y, -std::cos(0.7), 1e-5);
        EXPECT_NEAR(view.right.x, std::cos(0.7), 1e-5);
    }
}

}  // namespace
}  // namespace trochoid
