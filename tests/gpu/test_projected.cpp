// The projected grid's filter: each wave by the spacing of vertices along its own direction, against the CPU's sea.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/gpu/offscreen_context.hpp"
#include "client/scene/edge_level.hpp"
#include "client/scene/projected_grid.hpp"
#include "tests/gpu/mesher_cases.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {
namespace {

constexpr SeaTime now{1'000'000};

class Projected : public testing::Test {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> Projected::context_;

WaveTrainBox box_of(std::vector<WaveTrain> trains) {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    box.begin = {-sea_time_bound};
    box.trains = std::move(trains);
    return box;
}

/// A sea without patches, so that everything acts everywhere.
InterestState state_of(const WaveTrainBox& box) {
    InterestState state;
    state.boxes[box.id] = std::make_shared<const WaveTrainBox>(box);
    return state;
}

WaveBounds bounds_of_waves(const InterestState& state) {
    LandTable land;
    land.rebuild(state, 1U << 20, 1U << 20);
    SeaTable table;
    table.rebuild(state, land);
    return table.bounds_of_list(0);
}

/// The CPU's twin of what projected.vert shows: each train on its own, by its weight.
class Twin {
public:
    Twin(const WaveTrainBox& box, const Camera& camera, const DrawOptions& options)
        : frame_(frame_of(camera, DepthRange::classic)),
          view_(projected_view(frame_)),
          eye_(mesh_eye(frame_, display_filter(view_of(camera, glm::dvec3(0)), options.error_px))),
          grid_(make_projected_grid(view_, bounds_of_waves(state_of(box)),
                                    projected_shape(options, view_, eye_.filter.angle_per_vertex),
                                    options.attention)) {
        for (const WaveTrain& train : box.trains) {
            const WaveTrainBox alone = box_of({train});
            constants_.push_back(derive_constants(train));
            seas_.emplace_back(Sea({prepare(alone, {})}), now, displayed_layers);
        }
    }

    struct Shown {
        float height = 0;
        uint32_t trains = 0;     // with a weight
        uint32_t isotropic = 0;  // that would have one by the longest spacing
    };
    Shown at(const ProbedVertex& v) const {
        const glm::vec2 metres = from_mesh_eye(eye_, {v.x, v.z});
        const float ahead = glm::dot(metres, view_.forward);
        const auto behind = std::lower_bound(grid_.rows.begin(), grid_.rows.end(), ahead,
                                             [](const ProjectedRow& r, float a) { return r.forward < a; });
        auto row = static_cast<size_t>(behind - grid_.rows.begin());
        if (row == grid_.rows.size() ||
            (row > 0 && ahead - grid_.rows[row - 1].forward < grid_.rows[row].forward - ahead))
            --row;
        const float half_width = grid_.rows[row].half_width;
        const float side = glm::dot(metres, view_.right) / half_width;
        const auto column =
            static_cast<uint32_t>(std::lround((side + 1.0F) * 0.5F * static_cast<float>(grid_.columns)));
        const VertexSteps steps = steps_at(view_, grid_, row, column);
        const float cell = std::max(grid_.rows[row].along, glm::length(steps.across));
        const float wanted = spacing_at(eye_, {v.x, v.z});
        const float longest = std::max(wanted, cell);
        const float least = std::max(wanted, cell * least_spacing_share);
        Shown shown;
        for (size_t i = 0; i < seas_.size(); ++i) {
            const TrainConstants& c = constants_[i];
            const float weight =
                displayed_weight(c.wavelength, wave_spacing(steps, {c.kx, c.kz}, c.wavelength, least));
            if (displayed_weight(c.wavelength, longest) > 0.0F) ++shown.isotropic;
            if (weight <= 0.0F) continue;
            ++shown.trains;
            const LatticePoint p{frame_.anchor.x + v.x, frame_.anchor.z + v.z};
            shown.height += weight * seas_[i].evaluate(p).ay;
        }
        return shown;
    }

private:
    CameraFrame frame_;
    ProjectedView view_;
    MeshEye eye_;
    ProjectedGrid grid_;
    std::vector<TrainConstants> constants_;
    std::vector<SeaInstant> seas_;
};

/// Whatever the direction of the view, the shader shows what the CPU's twin of the filter shows.
TEST_F(Projected, shows_each_train_by_the_spacing_along_its_own_direction) {
    const WaveTrainBox box = box_of(wind_sea(60.0, 0.4, 1.5, 24, 5));
    const InterestState state = state_of(box);
    DrawOptions options;
    options.mesher = MesherKind::projected;
    options.projected_rows = 100;
    options.projected_columns = 200;
    options.error_px = 2.0F;
    size_t more = 0;
    size_t fewer = 0;
    size_t compared = 0;
    for (const double yaw : {0.0, 0.37, 0.785398, 1.9, 3.3, 5.5})
        for (const double altitude : {4.0, 30.0}) {
            const Camera camera = standing_at(-777.7, 1'234.5, altitude, yaw, -0.06);
            const Twin twin(box, camera, options);
            const Probe probe = probe_view(state, now, camera, options);
            ASSERT_GT(probe.vertices.size(), 10'000U);
            float worst = 0;
            for (size_t i = 0; i < probe.vertices.size(); i += 61) {
                const ProbedVertex& v = probe.vertices[i];
                const Twin::Shown shown = twin.at(v);
                worst = std::max(worst, std::abs(shown.height - v.shift[1]));
                ++compared;
                more += shown.trains > shown.isotropic ? 1 : 0;
                fewer += shown.trains < shown.isotropic ? 1 : 0;
                ASSERT_NEAR(v.trains_evaluated, shown.trains, 1);
            }
            EXPECT_LT(worst, 2e-3F) << "m, yaw " << yaw << " from " << altitude << " m";
        }
    // Towards the picture's sides cells are skew, their diagonals longer than their sides.
    fmt::print("of {} vertices {} show more trains than by the longest spacing, {} fewer\n", compared, more,
               fewer);
    EXPECT_GT(more, compared / 10) << "what changes nothing proves nothing";
    EXPECT_LT(fewer, more / 2);
}

/// Root mean square height, m, of the vertices at some distance near the picture's middle, the camera looking north.
double height_between(const Probe& probe, const Camera& camera, double from, double to) {
    double squares = 0;
    double count = 0;
    for (const ProbedVertex& v : probe.vertices) {
        const double away = std::hypot(to_metres(probe.anchor.x + v.x - camera.position.x),
                                       to_metres(probe.anchor.z + v.z - camera.position.z));
        const double aside = to_metres(probe.anchor.x + v.x - camera.position.x);
        if (away < from || away > to || std::abs(aside) > 0.05 * away) continue;
        squares += static_cast<double>(v.shift[1]) * static_cast<double>(v.shift[1]);
        ++count;
    }
    EXPECT_GT(count, 50);
    return std::sqrt(squares / count);
}

/// Far away cells are many times longer than wide; a swell that runs across them is sampled finely all the same.
TEST_F(Projected, a_far_swell_across_the_view_stays) {
    const Camera camera = probing(standing_at(10.3, 7.1, 20, 0.0, -0.05));
    DrawOptions options;
    options.mesher = MesherKind::projected;
    options.projected_rows = 300;
    const auto height_of = [&](double heading) {
        const InterestState state = state_of(box_of({deep_train(100.0, heading, 0.5F, 0.8F, 7)}));
        return height_between(probe_view(state, now, camera, options), camera, 900, 1'100);
    };
    // Trains head clockwise from east; the camera looks north.
    EXPECT_GT(height_of(0.0), 0.9 * 0.5 / std::sqrt(2.0));
    EXPECT_LT(height_of(-1.5707963), 0.02) << "along the view it would only be noise";
}

}  // namespace
}  // namespace trochoid
