// What the world makes of a changed land, with fields made up: server/land has its own tests, and tests/unit/server_app joins the two.
#include <gtest/gtest.h>

#include <cmath>

#include "server/event/event_log.hpp"
#include "server/land/land_memory.hpp"
#include "server/world/steepness.hpp"
#include "server/world/terrain_edit.hpp"
#include "server/world/world.hpp"
#include "tests/unit/world/shoal.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

ChangeLand wall() {
    ChangeLand change;
    change.line = {{to_lattice(-300.0), 0}, {to_lattice(300.0), 0}};
    return change;
}

/// A field whose single block around the origin halves the heights, or shifts them.
std::shared_ptr<LandField> field(uint32_t id, uint16_t gain, int32_t x = 0) {
    auto made = std::make_shared<LandField>(FieldId{id}, uint8_t{15});
    auto block = std::make_shared<LandBlock>();
    block->key = {x, 0};
    block->gain.fill(gain);
    made->set(block);
    return made;
}

/// All four trains read one new field, over `base` where there is one.
TracedLand land(uint32_t id, uint16_t gain, const std::shared_ptr<const LandField>& base = nullptr,
                int32_t x = 0) {
    TracedLand traced;
    auto top = field(id, gain, x);
    if (base) {
        traced.overlays = {{{id}, base->id()}};
        top->set_base(base);
    }
    traced.fields = {top};
    traced.field_of_train.assign(4, FieldId{id});
    return traced;
}

class LandChange : public testing::Test {
protected:
    LandChange() : world("test", shoal(), {}) {}

    void start(const StartWind& wind, SeaTime begin, TracedLand traced) {
        const auto planned = world.plan(wind, begin);
        ASSERT_TRUE(planned) << planned.error().message;
        world.apply(event(begin, *planned), Bytes{1}, std::move(traced));
    }
    LandChanged change(SeaTime effective, std::vector<Retraced> touched) {
        // Each change raises the wall by a metre more, so that something changes.
        ChangeLand higher = wall();
        higher.crest = 3.0F + static_cast<float>(walls_++);
        auto planned = world.plan(higher, effective, touched);
        EXPECT_TRUE(planned) << planned.error().message;
        Derived derived;
        for (Retraced& next : touched) derived.lands.push_back(std::move(next.land));
        world.apply(event(effective, *planned), Bytes{2}, std::move(derived));
        return *planned;
    }
    LogEvent event(SeaTime effective, decltype(LogEvent::what) what) const {
        return {world.state()->log_position.value + 1, effective, std::move(what)};
    }
    const WaveTrainBox& record(uint32_t box) const { return world.state()->boxes.at({box})->sea->record; }
    uint16_t gain_read(uint32_t box) const {
        return static_cast<uint16_t>(
            world.state()->boxes.at({box})->sea->fields.at(0)->sample({4096, 4096}).gain >> 9);
    }
    double height(SeaTime t, LatticePoint p) const {
        return static_cast<double>(SeaInstant(world.state()->sea, t).evaluate(p).ay);
    }

    World world;

private:
    int walls_ = 0;
};

TEST_F(LandChange, TheTerrainOfTheNextStateIsTheChangedOne) {
    const auto before = world.state()->terrain;
    const LandChanged changed = change({0}, {});
    EXPECT_TRUE(changed.boxes.empty());
    const auto after = world.state()->terrain;
    EXPECT_NE(before, after);
    EXPECT_LT(height_at(*before, 0, 0), 0);
    EXPECT_EQ(height_at(*after, 0, 0), 3 * 1024);
    EXPECT_EQ(*after, *edited(*before, wall())->terrain);
}

// A server whose land changes all day keeps one memory a wind, not one a change.
TEST_F(LandChange, ASucceededBoxForgetsItsTrace) {
    TracedLand first = land(1, unit_node_gain / 2);
    first.memory = std::make_shared<const LandMemory>();
    const std::weak_ptr<const LandMemory> old = first.memory;
    start(breeze(), {-5000 * second}, std::move(first));
    ASSERT_FALSE(old.expired());
    TracedLand next = land(2, unit_node_gain / 4, world.state()->boxes.at({1})->sea->fields[0]);
    next.memory = std::make_shared<const LandMemory>();
    const auto kept = next.memory;
    change({100 * second}, {{{1}, std::move(next)}});
    EXPECT_TRUE(old.expired());
    EXPECT_EQ(world.state()->boxes.at({2})->land_memory, kept);
}

TEST_F(LandChange, ASuccessorGoesOnWithTheSameWaves) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain / 2));
    const WaveTrainBox old = record(1);
    const SeaTime now{100 * second};
    change(now, {{{1}, land(2, unit_node_gain / 4, world.state()->boxes.at({1})->sea->fields[0])}});
    const WaveTrainBox& next = record(2);
    EXPECT_EQ(record(1).end, now);
    EXPECT_EQ(record(1).decay_us, next.fade_us);
    EXPECT_EQ(next.fade_us, land_fade_us);
    EXPECT_EQ(next.begin, now);
    EXPECT_EQ(next.begin - next.raised_us, old.begin);
    EXPECT_EQ(next.end, old.end);
    ASSERT_EQ(next.trains.size(), old.trains.size());
    for (size_t i = 0; i < old.trains.size(); ++i) {
        WaveTrain same = next.trains[i];
        EXPECT_EQ(same.field, FieldId{2});
        same.field = old.trains[i].field;
        EXPECT_EQ(same, old.trains[i]);
    }
    EXPECT_EQ(next.overlays, (std::vector<FieldOverlay>{{{2}, {1}}}));
    EXPECT_EQ(world.state()->boxes.at({2})->predecessor, BoxId{1});
    EXPECT_EQ(world.state()->boxes.at({2})->name, "wind 1");
    EXPECT_EQ(gain_read(1), unit_node_gain / 2);
    EXPECT_EQ(gain_read(2), unit_node_gain / 4);
}

// At full height and over equal land, one box fading out and its successor fading in are one sea.
TEST_F(LandChange, TheCrossFadeIsCoherent) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain));
    World still("twin", shoal(), {});
    still.apply({1, {-5000 * second}, *still.plan(breeze(), {-5000 * second})}, Bytes{1},
                land(1, unit_node_gain));
    const SeaTime now{100 * second};
    change(now, {{{1}, land(2, unit_node_gain)}});
    double highest = 0.0;
    for (int64_t ms = -2000; ms <= 12000; ms += 250)
        for (int64_t x = -3; x <= 3; ++x) {
            const SeaTime t = now + ms * 1000;
            const LatticePoint p{x * 70'000, x * 31'000};
            const double expected = static_cast<double>(SeaInstant(still.state()->sea, t).evaluate(p).ay);
            EXPECT_NEAR(height(t, p), expected, 1e-5) << ms << " ms";
            highest = std::max(highest, std::abs(expected));
        }
    EXPECT_GT(highest, 0.05);
}

TEST_F(LandChange, AGrowingWindGoesOnGrowing) {
    const SeaTime begin{0};
    start(breeze(), begin, land(1, unit_node_gain));
    const SeaTime now{20 * second};
    ASSERT_GT(record(1).build_up_us, 60 * second);
    const WaveTrainBox old = record(1);
    change(now, {{{1}, land(2, unit_node_gain)}});
    const SeaTime later{40 * second};
    EXPECT_EQ(instant_of(record(2), later).time_gain, instant_of(old, later).time_gain);
    EXPECT_EQ(instant_of(record(2), later).front, instant_of(old, later).front);
}

TEST_F(LandChange, AWindThatIsStillToComeIsSimplyReplaced) {
    start(breeze(), {500 * second}, land(1, unit_node_gain));
    change({100 * second}, {{{1}, land(2, unit_node_gain / 2)}});
    EXPECT_EQ(record(1).end, record(1).begin);
    EXPECT_EQ(record(1).decay_us, 0);
    EXPECT_EQ(record(2).begin, SeaTime{500 * second});
    EXPECT_EQ(record(2).fade_us, 0);
    EXPECT_EQ(record(2).raised_us, 0);
    for (const int64_t s : {0, 499, 501, 700}) EXPECT_EQ(instant_of(record(1), {s * second}).time_gain, 0U);
    EXPECT_GT(instant_of(record(2), {700 * second}).time_gain, 0U);
}

TEST_F(LandChange, OverlaysPileUpAndUnusedOnesFallAway) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain));
    const auto top = [&](uint32_t box) { return world.state()->boxes.at({box})->sea->fields.at(0); };
    change({0}, {{{1}, land(2, unit_node_gain / 2, top(1))}});
    change({100 * second}, {{{2}, land(3, unit_node_gain / 4, top(2), 1)}});
    EXPECT_EQ(record(3).overlays, (std::vector<FieldOverlay>{{{2}, {1}}, {{3}, {2}}}));
    EXPECT_EQ(gain_read(3), unit_node_gain / 2) << "the middle field's block shows through";
    // A stop keeps all of it.
    const auto ending = world.plan(StopWind{{3}}, {300 * second});
    ASSERT_TRUE(ending);
    world.apply(event(ending->end, *ending), Bytes{3});
    EXPECT_EQ(gain_read(3), unit_node_gain / 2);
    // A whole trace starts anew.
    start(breeze(), {-5000 * second}, land(4, unit_node_gain));
    change({400 * second}, {{{4}, land(5, unit_node_gain / 3)}});
    EXPECT_TRUE(record(5).overlays.empty());
}

TEST_F(LandChange, BandsThatStayKeepTheirFields) {
    TracedLand two;
    two.fields = {field(1, unit_node_gain), field(2, unit_node_gain)};
    two.field_of_train = {{1}, {1}, {2}, {2}};
    start(breeze(), {-5000 * second}, two);
    TracedLand next;
    next.fields = {field(3, unit_node_gain / 2)};
    next.overlays = {{{3}, {2}}};
    next.field_of_train = {{1}, {1}, {3}, {3}};
    change({0}, {{{1}, next}});
    EXPECT_EQ(record(2).trains[0].field, FieldId{1});
    EXPECT_EQ(record(2).trains[3].field, FieldId{3});
    EXPECT_EQ(world.state()->boxes.at({2})->sea->fields.size(), 2U);
    EXPECT_EQ(record(2).overlays, (std::vector<FieldOverlay>{{{3}, {2}}}));
    EXPECT_EQ(world.state()->next_field, 4U);
}

TEST_F(LandChange, WhoHasGoneOnIsNamed) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain));
    change({0}, {{{1}, land(2, unit_node_gain)}});
    const auto refused = world.plan(StopWind{{1}}, {50 * second});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::already_ending);
    EXPECT_NE(refused.error().message.find("box 2"), std::string::npos) << refused.error().message;
    // Also before the change takes hold: a stop of the old one would leave the new one to begin.
    change({1000 * second}, {{{2}, land(3, unit_node_gain)}});
    EXPECT_EQ(world.plan(StopWind{{2}}, {500 * second}).error().code, ErrorCode::already_ending);
    const auto stop = world.plan(StopWind{{3}}, {500 * second});
    ASSERT_TRUE(stop);
    EXPECT_EQ(stop->end, SeaTime{1000 * second});
}

TEST_F(LandChange, OnlyWavesThatLastAreTracedAgainAndOneChangeWaitsForTheOther) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain));
    StartWind brief = breeze();
    brief.life_us = 50 * second;
    start(brief, {0}, land(2, unit_node_gain));
    StartShip ship;
    world.apply(event({0}, *world.plan(ship, {0})), Bytes{1});
    EXPECT_EQ(world.on_land_at({0}), (std::vector<BoxId>{{1}, {2}}));
    EXPECT_EQ(world.on_land_at({45 * second}), (std::vector<BoxId>{{1}}))
        << "its decay begins while it would fade";
    EXPECT_EQ(world.land_settled(), SeaTime{-sea_time_bound});
    change({20 * second}, {{{1}, land(3, unit_node_gain)}});
    EXPECT_EQ(world.land_settled(), SeaTime{20 * second} + land_fade_us);
}

TEST_F(LandChange, AWindThatIsStillToComeHoldsUpNoFurtherChange) {
    start(breeze(), {500 * second}, land(1, unit_node_gain));
    change({100 * second}, {{{1}, land(2, unit_node_gain / 2)}});
    EXPECT_EQ(world.land_settled(), SeaTime{-sea_time_bound});
    change({101 * second}, {{{2}, land(3, unit_node_gain / 4)}});
    EXPECT_EQ(record(3).begin, SeaTime{500 * second});
    EXPECT_EQ(record(3).raised_us, 0);
    EXPECT_EQ(record(3).fade_us, 0);
    for (const uint32_t gone : {1U, 2U})
        EXPECT_EQ(instant_of(record(gone), {700 * second}).time_gain, 0U) << gone;
}

// Stopped at the very moment at which the land changes: then the two boxes decay as the one would have.
TEST_F(LandChange, AStopAtTheChangeLeavesTheWindItsDecay) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain));
    const int64_t decay_us = record(1).decay_us;
    const SeaTime now{100 * second};
    change(now, {{{1}, land(2, unit_node_gain)}});
    const auto stop = world.plan(StopWind{{2}}, now);
    ASSERT_TRUE(stop) << stop.error().message;
    EXPECT_EQ(stop->end, now);
    world.apply(event(now, *stop), Bytes{3});
    EXPECT_EQ(record(2).decay_us, decay_us);
    const SeaTime half = now + decay_us / 2;
    constexpr double half_gain = full_gain / 2.0;
    EXPECT_NEAR(instant_of(record(2), half).time_gain, half_gain, 64);
}

TEST_F(LandChange, SteeperLandLowersChoppinessOnlyWhereThereIsNoRoom) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain));
    TracedLand steep = land(2, unit_node_gain);
    steep.steepness_growth = 1.2F;
    change({0}, {{{1}, steep}});
    EXPECT_EQ(record(2).trains[0].choppiness, record(1).trains[0].choppiness);
    TracedLand steeper = land(3, unit_node_gain);
    steeper.steepness_growth = 60.0F;
    change({100 * second}, {{{2}, steeper}});
    EXPECT_LT(record(3).trains[0].choppiness, record(1).trains[0].choppiness);
    EXPECT_LE(steepness_of(record(3)) * 60.0, steepness_limit);
}

TEST_F(LandChange, WithoutTerrainItIsRefused) {
    const World open("test", nullptr, {});
    const auto refused = open.plan(wall(), {0}, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::no_terrain);
    ChangeLand bad = wall();
    bad.width = 0.0F;
    EXPECT_EQ(world.plan(bad, {0}, {}).error().code, ErrorCode::value_out_of_range);
}

TEST_F(LandChange, TheHashSeesTheTerrainAndEveryField) {
    start(breeze(), {-5000 * second}, land(1, unit_node_gain / 2));
    const uint64_t before = hash_of(*world.state());
    WorldState other = *world.state();
    other.terrain = edited(*other.terrain, wall())->terrain;
    EXPECT_NE(hash_of(other), before);
    other = *world.state();
    auto box = std::make_shared<WorldBox>(*other.boxes.at({1}));
    box->wind.noise = 0.5F;
    other.boxes[{1}] = box;
    EXPECT_NE(hash_of(other), before);
    box = std::make_shared<WorldBox>(*world.state()->boxes.at({1}));
    box->sea = prepare(box->sea->record, land(1, unit_node_gain / 3).fields);
    other.boxes[{1}] = box;
    EXPECT_NE(hash_of(other), before);
}

}  // namespace
}  // namespace trochoid
