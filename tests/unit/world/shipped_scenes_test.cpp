#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "protocol/model/interest_state.hpp"
#include "server/event/scene.hpp"
#include "server/world/train_spectrum.hpp"
#include "server/world/world.hpp"

namespace trochoid {
namespace {

std::shared_ptr<const WorldState> opened(const char* name) {
    const Scene scene =
        load_scene(std::filesystem::path(TROCHOID_SOURCE_DIR) / "server" / "scenes" / name / "scene.toml");
    World world(scene.name, scene.terrain.empty() ? nullptr : std::make_shared<TerrainGrid>(),
                {1, scene.clock_start, 0, scene.rate_q16});
    uint64_t id = 0;
    for (const SceneWind& wind : scene.winds) {
        auto planned = world.plan(wind.wind, wind.begin, wind.name);
        EXPECT_TRUE(planned) << planned.error().message;
        ++id;
        world.apply({id, wind.begin, *planned}, {});
    }
    return world.state();
}

uint32_t gain_at(const WorldState& state, BoxId box, LatticePoint p) {
    const WaveTrainBox& record = state.boxes.at(box)->sea->record;
    return envelope_at(record, instant_of(record, {0}), p).gain;
}

TEST(ShippedScenes, ScillyOpensInAGrownSwellThatCoversTheMap) {
    const auto state = opened("scilly");
    ASSERT_EQ(state->boxes.size(), 2U);
    size_t trains = 0;
    for (const auto& [id, box] : state->boxes) trains += box->sea->record.trains.size();
    EXPECT_GE(trains, 28U);
    EXPECT_LE(trains, 36U);
    EXPECT_NEAR(significant_height(state->boxes.at({1})->sea->record.trains), 4.18, 0.02);
    constexpr int64_t side = 10240 * lattice_per_metre;
    for (int64_t x = -4; x <= 4; ++x)
        for (int64_t z = -4; z <= 4; ++z)
            EXPECT_EQ(gain_at(*state, {1}, {x * side / 4, z * side / 4}), full_gain) << x << ", " << z;
    // The local wind has grown too, and its edge crosses the map.
    EXPECT_EQ(gain_at(*state, {2}, {to_lattice(-3500.0), to_lattice(-4200.0)}), full_gain);
    EXPECT_EQ(gain_at(*state, {2}, {to_lattice(6000.0), to_lattice(6000.0)}), 0U);
}

TEST(ShippedScenes, OpenSeaOpensGrownAndShowsAnEdge) {
    const auto state = opened("open-sea");
    ASSERT_EQ(state->boxes.size(), 2U);
    EXPECT_EQ(gain_at(*state, {1}, {0, 0}), full_gain);
    EXPECT_EQ(gain_at(*state, {2}, {to_lattice(1271.0), to_lattice(1602.0)}), full_gain);
    EXPECT_EQ(gain_at(*state, {2}, {to_lattice(-4000.0), to_lattice(-4000.0)}), 0U);
}

TEST(ShippedScenes, SeasLookLikeTheirHeight) {
    // Four times the standard deviation of the surface over space is the significant height.
    const auto state = opened("open-sea");
    const SeaInstant instant(state->sea, {0});
    double sum = 0.0;
    double squares = 0.0;
    constexpr int side = 60;
    for (int64_t i = 0; i < side; ++i)
        for (int64_t j = 0; j < side; ++j) {
            // West of the squall, inside the trade wind alone.
            const auto y =
                static_cast<double>(instant.evaluate({-(9000 + i * 97) * 1024, (3000 - j * 103) * 1024}).ay);
            sum += y;
            squares += y * y;
        }
    constexpr double count = side * side;
    const double deviation = std::sqrt(squares / count - (sum / count) * (sum / count));
    const double expected = significant_height(state->boxes.at({1})->sea->record.trains);
    EXPECT_NEAR(4.0 * deviation, expected, 0.15 * expected);
}

}  // namespace
}  // namespace trochoid
