#include "server/world/world.hpp"

#include <gtest/gtest.h>

#include "server/event/event_log.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/effective_time.hpp"
#include "server/world/steepness.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

StartWind gale() {
    StartWind wind;
    wind.speed = 16.0F;
    wind.towards_degrees = 75.0F;
    wind.origin = {to_lattice(-3000.0), 0};
    wind.fetch = to_lattice(6000.0);
    wind.width = to_lattice(4000.0);
    wind.trains = 8;
    wind.seed = 21;
    return wind;
}

/// Bytes that stand for an event where its content does not matter to the test.
Bytes some_bytes(uint64_t id) { return {static_cast<uint8_t>(id), static_cast<uint8_t>(id >> 8), 7}; }

LogEvent start(World& world, const StartWind& wind, SeaTime begin, TracedLand land = {}) {
    auto planned = world.plan(wind, begin);
    EXPECT_TRUE(planned) << planned.error().message;
    const uint64_t id = world.state()->log_position.value + 1;
    LogEvent event{id, begin, std::move(planned).value()};
    world.apply(event, some_bytes(id), std::move(land));
    return event;
}

LogEvent stop(World& world, BoxId box, SeaTime effective) {
    auto planned = world.plan(StopWind{box}, effective);
    EXPECT_TRUE(planned) << planned.error().message;
    const uint64_t id = world.state()->log_position.value + 1;
    LogEvent event{id, planned->end, *planned};
    world.apply(event, some_bytes(id));
    return event;
}

/// The surface on a grid over the gale at one time.
uint64_t sea_hash(const WorldState& state, SeaTime t) {
    const SeaInstant instant(state.sea, t);
    std::vector<SurfaceSample> samples;
    for (int64_t x = -20; x <= 20; ++x)
        for (int64_t z = -10; z <= 10; ++z)
            samples.push_back(instant.evaluate({x * 151 * 1024 + 17, z * 203 * 1024 - 5}));
    return hash_of(samples);
}

const uint64_t still_water = sea_hash(WorldState{}, {0});

TEST(World, AWindTakesHoldAtItsTimeAndNotBefore) {
    World world("test", nullptr, {});
    const auto before = world.state();
    start(world, gale(), {100 * second});
    EXPECT_TRUE(before->boxes.empty()) << "states handed out are immutable";
    const auto after = world.state();
    ASSERT_EQ(after->boxes.size(), 1U);
    EXPECT_EQ(after->boxes.begin()->second->name, "wind 1");
    EXPECT_EQ(after->log_position, LogPosition{1});
    EXPECT_EQ(after->next_box, 2U);
    EXPECT_EQ(after->next_train, 9U);
    EXPECT_EQ(sea_hash(*after, {100 * second}), still_water);
    EXPECT_NE(sea_hash(*after, {400 * second}), still_water);
}

TEST(World, IdsAscendOverBoxes) {
    World world("test", nullptr, {});
    start(world, gale(), {0});
    start(world, gale(), {0});
    start(world, gale(), {0});
    uint32_t next_train = 1;
    uint32_t next_box = 1;
    for (const auto& [id, box] : world.state()->boxes) {
        EXPECT_EQ(id.value, next_box++);
        EXPECT_EQ(box->sea->record.first_train.value, next_train);
        next_train += 8;
    }
    EXPECT_EQ(world.state()->sea.boxes().size(), 3U);
}

TEST(World, AStopChangesNothingBeforeItAndLeavesStillWaterAfterTheDecay) {
    World world("test", nullptr, {});
    start(world, gale(), {0});
    const auto blowing = world.state();
    const SeaTime end{1500 * second};
    stop(world, {1}, end);
    const auto stopped = world.state();
    const WaveTrainBox& record = stopped->boxes.at({1})->sea->record;
    EXPECT_EQ(record.end, end);
    for (int64_t s : {1, 50, 333, 700, 1499})
        EXPECT_EQ(sea_hash(*blowing, {s * second}), sea_hash(*stopped, {s * second})) << s << " s";
    EXPECT_EQ(sea_hash(*blowing, end - 1), sea_hash(*stopped, end - 1));
    EXPECT_NE(sea_hash(*blowing, end + record.decay_us / 2), sea_hash(*stopped, end + record.decay_us / 2));
    EXPECT_NE(sea_hash(*stopped, end + record.decay_us / 2), still_water);
    EXPECT_EQ(sea_hash(*stopped, end + record.decay_us), still_water);
    EXPECT_EQ(sea_hash(*stopped, end + 10 * record.decay_us), still_water);
}

TEST(World, AWindStoppedBeforeItBlowsNeverBlows) {
    World world("test", nullptr, {});
    start(world, gale(), {100 * second});
    stop(world, {1}, {50 * second});
    for (int64_t s : {99, 100, 101, 130, 200, 500})
        EXPECT_EQ(sea_hash(*world.state(), {s * second}), still_water) << s;
}

TEST(World, StopsThatCannotBeAreRefused) {
    World world("test", nullptr, {});
    StartWind wind = gale();
    wind.life_us = 600 * second;
    start(world, wind, {0});
    EXPECT_EQ(world.plan(StopWind{{9}}, {0}).error().code, ErrorCode::unknown_box);
    EXPECT_EQ(world.plan(StopWind{{1}}, {600 * second}).error().code, ErrorCode::already_ending);
    EXPECT_TRUE(world.plan(StopWind{{1}}, {599 * second}));
    stop(world, {1}, {300 * second});
    EXPECT_EQ(world.plan(StopWind{{1}}, {400 * second}).error().code, ErrorCode::already_ending);
    EXPECT_TRUE(world.plan(StopWind{{1}}, {200 * second})) << "an earlier end is still an end";
}

TEST(World, RefusedWindsCarryTheirCode) {
    World world("test", nullptr, {});
    StartWind wind = gale();
    wind.speed = 100.0F;
    EXPECT_EQ(world.plan(wind, {0}).error().code, ErrorCode::value_out_of_range);
    wind = gale();
    wind.trains = 257;
    EXPECT_EQ(world.plan(wind, {0}).error().code, ErrorCode::too_many_trains);
    EXPECT_EQ(world.state()->log_position, LogPosition{0});
}

TEST(World, AFullWorldTakesNewWindsOnlyForThoseThatFellStill) {
    World world("test", nullptr, {});
    StartWind small = gale();
    small.fetch = small.width = to_lattice(64.0);
    small.trains = 1;
    for (uint32_t i = 0; i < most_boxes; ++i) {
        small.life_us = i == 500 ? 60 * second : 0;
        small.origin.z = to_lattice(500.0) * int64_t{i};
        start(world, small, {0});
    }
    small.life_us = 0;
    const WaveTrainBox& mortal = world.state()->boxes.at({501})->sea->record;
    const SeaTime still = mortal.end + mortal.decay_us;
    EXPECT_EQ(world.plan(small, still - 1).error().code, ErrorCode::too_many_boxes);
    start(world, small, still);
    EXPECT_EQ(world.state()->boxes.size(), most_boxes);
    EXPECT_FALSE(world.state()->boxes.contains({501}));
    EXPECT_TRUE(world.state()->boxes.contains({most_boxes + 1}));
    EXPECT_EQ(world.plan(small, still + 1000 * second).error().code, ErrorCode::too_many_boxes);
}

TEST(World, TracedLandEntersTheRecord) {
    auto grid = std::make_shared<TerrainGrid>();
    World world("test", grid, {});
    const auto planned = world.plan(gale(), {0});
    ASSERT_TRUE(planned);
    TracedLand land;
    land.fields = {std::make_shared<LandField>(FieldId{1}, uint8_t{15}),
                   std::make_shared<LandField>(FieldId{2}, uint8_t{15})};
    land.field_of_train = {{1}, {1}, {2}, {2}, {2}, {0}, {0}, {0}};
    land.gain_max = 40000;
    land.rays.resize(3);
    world.apply({1, {0}, *planned}, some_bytes(1), land);
    const auto state = world.state();
    const WorldBox& box = *state->boxes.at({1});
    EXPECT_EQ(box.sea->record.gain_max, 40000);
    EXPECT_EQ(box.sea->record.trains[2].field, FieldId{2});
    EXPECT_EQ(box.sea->record.trains[7].field, FieldId{0});
    EXPECT_EQ(box.sea->fields.size(), 2U);
    EXPECT_EQ(box.rays.size(), 3U);
    EXPECT_EQ(state->next_field, 3U);
    stop(world, {1}, {900 * second});
    const WorldBox& stopped = *world.state()->boxes.at({1});
    EXPECT_EQ(stopped.sea->fields.size(), 2U) << "the land stays with a stopped wind";
    EXPECT_EQ(stopped.sea->record.gain_max, 40000);
    EXPECT_EQ(stopped.rays.size(), 3U);
}

TEST(World, LandThatSteepensWavesLowersTheirChoppiness) {
    World world("test", std::make_shared<TerrainGrid>(), {});
    const BoxStarted planned = *world.plan(gale(), {0});
    EXPECT_LE(steepness_of(planned.box) * 1.5, 0.48);
    EXPECT_EQ(world.fit_to_land(planned, {}), planned);
    TracedLand steep;
    steep.steepness_growth = 3.0F;
    const BoxStarted fitted = world.fit_to_land(planned, steep);
    EXPECT_LE(steepness_of(fitted.box) * 3.0, 0.48);
    EXPECT_GT(steepness_of(fitted.box) * 3.0, 0.479);
    // The next wind over the same water finds the steeper one counted.
    world.apply({1, {0}, fitted}, some_bytes(1), steep);
    const BoxStarted next = *world.plan(gale(), {0});
    EXPECT_LE(steepness_of(next.box) * 1.5 + steepness_of(fitted.box) * 3.0, 0.8);
}

TEST(World, SeedZeroDrawsOneAndKeepsItInTheEvent) {
    World world("test", nullptr, {});
    StartWind wind = gale();
    wind.seed = 0;
    const BoxStarted a = *world.plan(wind, {0});
    const BoxStarted b = *world.plan(wind, {1});
    EXPECT_NE(a.wind.seed, 0U);
    EXPECT_NE(a.box.trains, b.box.trains);
    wind.seed = a.wind.seed;
    EXPECT_EQ(world.plan(wind, {0})->box, a.box);
}

TEST(World, RateChangesKeepSeaTimeContinuous) {
    SeaClock clock;
    clock.start = {5 * second};
    clock.monotonic_start_us = 1000;
    World world("test", nullptr, clock);
    int64_t now = 1000;
    uint64_t id = 1;
    for (uint32_t rate : {1U << 15, 0U, 16U << 16, 3U << 16}) {
        now += 7'654'321;
        const SeaTime before = sea_time_at(world.state()->clock, now);
        const auto changed = world.plan(SetRate{rate}, now);
        ASSERT_TRUE(changed);
        world.apply({id, before, *changed}, some_bytes(id));
        ++id;
        const SeaClock& after = world.state()->clock;
        EXPECT_EQ(sea_time_at(after, now), before);
        const double passed = static_cast<double>(sea_time_at(after, now + 2'000'000) - before);
        EXPECT_NEAR(passed, 2e6 * rate / 65536.0, 1.0);
        EXPECT_EQ(after.epoch, id);
    }
    EXPECT_EQ(world.plan(SetRate{(16U << 16) + 1}, now).error().code, ErrorCode::value_out_of_range);
}

TEST(World, TimeIsSkippedForwardAtTheSameRate) {
    SeaClock clock;
    clock.start = {5 * second};
    clock.monotonic_start_us = 1000;
    clock.rate_q16 = 2U << 16;
    World world("test", nullptr, clock);
    const int64_t now = 1000 + 7'654'321;
    const SeaTime before = sea_time_at(clock, now);
    const auto skipped = world.plan(SkipTime{600 * second}, now);
    ASSERT_TRUE(skipped);
    world.apply({1, skipped->clock.start, *skipped}, some_bytes(1));
    const SeaClock& after = world.state()->clock;
    EXPECT_EQ(sea_time_at(after, now), before + 600 * second);
    EXPECT_EQ(sea_time_at(after, now + second), before + 602 * second);
    EXPECT_EQ(after.epoch, clock.epoch + 1);
    for (const int64_t wrong : {int64_t{0}, int64_t{-1}, longest_skip_us + 1, INT64_MAX, INT64_MIN})
        EXPECT_EQ(world.plan(SkipTime{wrong}, now).error().code, ErrorCode::value_out_of_range) << wrong;
    clock.start = {sea_time_bound / 2 - second};
    World old("test", nullptr, clock);
    EXPECT_EQ(old.plan(SkipTime{second}, now).error().code, ErrorCode::value_out_of_range);
}

TEST(World, FoldingTheLogTwiceGivesOneStateAndTheLogsHash) {
    World live("test", nullptr, {});
    InMemoryEventLog log;
    std::vector<LogEvent> events;
    events.push_back(start(live, gale(), {0}));
    StartWind other = gale();
    other.towards_degrees = 200.0F;
    events.push_back(start(live, other, {30 * second}));
    events.push_back(stop(live, {1}, {600 * second}));
    const auto changed = live.plan(SetRate{1U << 15}, 77);
    events.push_back({4, {77}, *changed});
    live.apply(events.back(), some_bytes(4));

    World replayed("test", nullptr, {});
    for (const LogEvent& event : events) {
        const auto result =
            log.append(replayed.state()->log_position, event.event_id, some_bytes(event.event_id));
        ASSERT_TRUE(std::holds_alternative<Appended>(result));
        replayed.apply(event, some_bytes(event.event_id));
        EXPECT_EQ(replayed.state()->log_hash, std::get<Appended>(result).log_hash);
    }
    EXPECT_EQ(hash_of(*replayed.state()), hash_of(*live.state()));
    EXPECT_EQ(sea_hash(*replayed.state(), {500 * second}), sea_hash(*live.state(), {500 * second}));

    World without("test", nullptr, {});
    for (size_t i = 0; i < 2; ++i) without.apply(events[i], some_bytes(events[i].event_id));
    EXPECT_NE(hash_of(*without.state()), hash_of(*live.state()));
}

TEST(World, SummariesTellHeightAndGrowth) {
    World world("test", nullptr, {});
    start(world, gale(), {0});
    const WaveTrainBox record = world.state()->boxes.at({1})->sea->record;
    auto list = summaries(*world.state(), {record.build_up_us / 2});
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0].box, BoxId{1});
    EXPECT_EQ(list[0].trains, 8);
    EXPECT_EQ(list[0].wind_speed, 16.0F);
    EXPECT_NEAR(list[0].gain_now, 0.5F, 1e-5F);
    // 6 km under 16 m/s: JONSWAP's 0.00126 x^0.557 U10^2/g, x = g F/U10^2.
    EXPECT_NEAR(list[0].significant_height, 0.643F, 0.002F);
    EXPECT_EQ(summaries(*world.state(), {-1})[0].gain_now, 0.0F);
}

TEST(EffectiveTime, IsTheAskedOneOrAsSoonAsPossible) {
    const SeaTime now{100 * second};
    EXPECT_EQ(*effective_time({0}, now, 500'000, false), now + 500'000);
    EXPECT_EQ(*effective_time(now + 400'000, now, 500'000, false), now + 500'000);
    EXPECT_EQ(*effective_time(now + 600'000, now, 500'000, false), now + 600'000);
    EXPECT_EQ(*effective_time(now + 500'000, now, 500'000, true), now + 500'000);
    EXPECT_EQ(effective_time(now + 499'999, now, 500'000, true).error().code, ErrorCode::too_late);
    EXPECT_EQ(effective_time({sea_time_bound}, now, 500'000, false).error().code,
              ErrorCode::value_out_of_range);
}

TEST(EffectiveTime, LeadIsRealTime) {
    SeaClock clock;
    EXPECT_EQ(lead_in_sea_time(clock, 500), 500'000);
    clock.rate_q16 = 4U << 16;
    EXPECT_EQ(lead_in_sea_time(clock, 500), 2'000'000);
    clock.rate_q16 = 0;
    EXPECT_EQ(lead_in_sea_time(clock, 500), 0);
}

}  // namespace
}  // namespace trochoid
