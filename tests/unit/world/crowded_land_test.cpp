// What a change of the land costs where the world is full, and that it comes out as for one box at a time.
#include <gtest/gtest.h>

#include <chrono>

#include "server/event/event_log.hpp"
#include "server/world/steepness.hpp"
#include "server/world/world.hpp"
#include "tests/unit/world/shoal.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;
constexpr SeaTime long_ago{-5000 * second};

/// So many winds of 256 trains that all overlap each other, and that share the steepness there is.
World& crowd(World& world, uint32_t winds) {
    StartWind wind;
    wind.speed = 12.0F;
    wind.towards_degrees = 75.0F;
    wind.fetch = to_lattice(3000.0);
    wind.width = to_lattice(3000.0);
    wind.trains = 256;
    wind.seed = 5;
    const Result<BoxStarted> first = world.plan(wind, long_ago);
    EXPECT_TRUE(first) << first.error().message;
    for (uint32_t i = 0; i < winds; ++i) {
        BoxStarted next = *first;
        next.box.id = {i + 1};
        next.box.first_train = {1 + 256 * i};
        next.box.origin.x += (i % 25) * to_lattice(20.0);
        next.box.origin.z += (i / 25) * to_lattice(20.0);
        for (WaveTrain& train : next.box.trains) train.choppiness *= 1.2F / static_cast<float>(winds);
        world.apply({i + 1, long_ago, next}, Bytes{1});
    }
    return world;
}

ChangeLand wall(float crest) {
    ChangeLand change;
    change.line = {{to_lattice(-300.0), 0}, {to_lattice(300.0), 0}};
    change.crest = crest;
    return change;
}

/// Every box's land, a little steeper for some.
std::vector<Retraced> retraced(const std::vector<BoxId>& boxes) {
    std::vector<Retraced> touched;
    for (const BoxId box : boxes) {
        touched.push_back({box, {}});
        touched.back().land.steepness_growth = 1.0F + 0.1F * static_cast<float>(box.value % 7);
    }
    return touched;
}

LandChanged planned(const World& world, const ChangeLand& change, SeaTime effective) {
    const std::vector<Retraced> touched = retraced(world.on_land_at(effective));
    const auto begun = std::chrono::steady_clock::now();
    Result<LandChanged> plan = world.plan(change, effective, touched);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begun;
    EXPECT_TRUE(plan) << plan.error().message;
    std::printf("a change of the land under %zu winds of %zu boxes is planned in %.1f ms\n", touched.size(),
                world.state()->boxes.size(), ms.count());
    return std::move(plan).value();
}

void apply(World& world, const LandChanged& change, SeaTime effective) {
    Derived derived;
    derived.lands.resize(change.boxes.size());
    world.apply({world.state()->log_position.value + 1, effective, change}, Bytes{2}, std::move(derived));
}

class CrowdedLand : public testing::TestWithParam<uint32_t> {};

TEST_P(CrowdedLand, IsPlannedAsForOneBoxAtATime) {
    World world("test", shoal(), {});
    crowd(world, GetParam());
    // Twice, so that predecessors that still decay stand beside their successors.
    const SeaTime first{0};
    apply(world, planned(world, wall(3.0F), first), first);
    const SeaTime next = first + land_fade_us;
    const LandChanged change = planned(world, wall(4.0F), next);
    ASSERT_EQ(change.boxes.size(), GetParam());
    const auto state = world.state();
    for (size_t i = 0; i < change.boxes.size(); i += 1 + change.boxes.size() / 20) {
        std::vector<SteepBox> others;
        for (const auto& [id, box] : state->boxes) {
            const bool goes_on = id.value > GetParam();
            const double growth =
                goes_on ? static_cast<double>(1.0F + 0.1F * static_cast<float>(id.value % 7)) : 0.0;
            others.push_back({&box->sea->record, std::max(box->land_growth, growth), box->predecessor});
        }
        WaveTrainBox twin = change.boxes[i].box;
        const BoxId before = change.boxes[i].predecessor;
        for (size_t t = 0; t < twin.trains.size(); ++t)
            twin.trains[t].choppiness = state->boxes.at(before)->sea->record.trains[t].choppiness;
        limit_successor(twin, before, static_cast<double>(1.0F + 0.1F * static_cast<float>(before.value % 7)),
                        SteepCrowd(others));
        EXPECT_EQ(twin, change.boxes[i].box) << "box " << before.value;
    }
}

INSTANTIATE_TEST_SUITE_P(Winds, CrowdedLand, testing::Values(100U, 500U));

}  // namespace
}  // namespace trochoid
