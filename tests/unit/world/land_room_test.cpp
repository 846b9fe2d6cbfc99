// What bounds the land that a world holds, with fields made up.
#include "server/world/land_room.hpp"

#include <gtest/gtest.h>

#include "server/event/event_log.hpp"
#include "server/land/land_memory.hpp"
#include "server/world/terrain_edit.hpp"
#include "server/world/world.hpp"
#include "tests/unit/world/shoal.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

/// One new field of so many blocks for all trains, over `base` where there is one.
TracedLand land(uint32_t id, int32_t blocks, const std::shared_ptr<const LandField>& base = nullptr) {
    TracedLand traced;
    auto field = std::make_shared<LandField>(FieldId{id}, uint8_t{15});
    for (int32_t x = 0; x < blocks; ++x) {
        auto block = std::make_shared<LandBlock>();
        block->key = {x, 0};
        block->gain.fill(unit_node_gain / 2);
        field->set(block);
    }
    if (base) {
        traced.overlays = {{{id}, base->id()}};
        field->set_base(base);
    }
    traced.fields = {field};
    traced.field_of_train.assign(4, FieldId{id});
    traced.memory = std::make_shared<const LandMemory>();
    return traced;
}

struct LandRoomTest : testing::Test {
    explicit LandRoomTest() : world("test", shoal(), {}, 10) {}

    void start(SeaTime begin, int64_t life_us, TracedLand traced) {
        const auto planned = world.plan(breeze(life_us), begin);
        ASSERT_TRUE(planned) << planned.error().message;
        world.apply({world.state()->log_position.value + 1, begin, *planned, world.present()}, Bytes{1},
                    std::move(traced));
    }
    ChangeLand wall() {
        ChangeLand change;
        change.line = {{to_lattice(-300.0), 0}, {to_lattice(300.0), 0}};
        change.crest = 3.0F + static_cast<float>(walls_++);
        return change;
    }
    Result<LandChanged> change(SeaTime effective, std::vector<Retraced> touched) {
        auto planned = world.plan(wall(), effective, touched);
        if (!planned) return planned;
        Derived derived;
        for (Retraced& next : touched) derived.lands.push_back(std::move(next.land));
        world.apply({world.state()->log_position.value + 1, effective, *planned, world.present()}, Bytes{2},
                    std::move(derived));
        return planned;
    }
    const WorldBox& box(uint32_t id) const { return *world.state()->boxes.at({id}); }
    bool has(uint32_t id) const { return world.state()->boxes.contains({id}); }

    World world;

private:
    int walls_ = 0;
};

TEST_F(LandRoomTest, SharedFieldsCountOnceAndStillBoxesMayGo) {
    start({-90'000 * second}, 1000 * second, land(1, 3));
    start({-80'000 * second}, 0, land(2, 2));
    EXPECT_EQ(world.room_for_land({0}), (LandRoom{5, 2, 10, 2}));
    EXPECT_EQ(world.room_for_land({-89'500 * second}), (LandRoom{5, 5, 10, 5})) << "it still blows";
    ASSERT_TRUE(change({0}, {{{2}, land(3, 1, box(2).sea->fields[0])}}));
    // The successor reads both fields; the predecessor has given its place away.
    EXPECT_EQ(land_room(*world.state(), {0}).kept, 3U);
    // So does one over another that is to come.
    const TracedLand next = land(4, 4, box(3).sea->fields[0]);
    const Retraced again{{3}, next};
    EXPECT_EQ(room_after(*world.state(), {&again, 1}, {0}).kept, 7U);
    const Retraced flat{{3}, land(4, 4)};
    EXPECT_EQ(room_after(*world.state(), {&flat, 1}, {0}).kept, 4U);
}

TEST_F(LandRoomTest, TheFirstToFallStillMakesRoomFirst) {
    start({-95'000 * second}, 10'000 * second, land(1, 3));
    start({-90'000 * second}, 1000 * second, land(2, 3));
    start({-80'000 * second}, 0, land(3, 3));
    start({0}, 0, land(4, 4));
    EXPECT_TRUE(has(1)) << "it fell still later";
    EXPECT_FALSE(has(2));
    start({10 * second}, 0, land(5, 0));
    EXPECT_TRUE(has(1)) << "nothing has come";
    start({20 * second}, 0, land(6, 3));
    EXPECT_FALSE(has(1));
    EXPECT_EQ(land_room(*world.state(), {0}), (LandRoom{10, 10, 10, 10}));
}

TEST_F(LandRoomTest, AChangeThatDoesNotFitIsRefused) {
    start({-80'000 * second}, 0, land(1, 6));
    const auto over = change({0}, {{{1}, land(2, 5, box(1).sea->fields[0])}});
    ASSERT_FALSE(over);
    EXPECT_EQ(over.error().code, ErrorCode::too_much_land);
    EXPECT_EQ(world.state()->log_position.value, 1U);
    EXPECT_TRUE(change({0}, {{{1}, land(2, 4, box(1).sea->fields[0])}}));
}

// When the land changes, what fell still long ago goes, and traces that no change can reach any more are forgotten.
TEST_F(LandRoomTest, OldLandAndUselessTracesGo) {
    start({-95'000 * second}, 10'000 * second, land(1, 1));
    start({-10'000 * second}, 10'020 * second, land(2, 1));
    start({-80'000 * second}, 0, land(3, 1));
    const std::weak_ptr<const LandMemory> ending = box(2).land_memory;
    ASSERT_TRUE(change({0}, {}));
    EXPECT_FALSE(has(1));
    EXPECT_FALSE(ending.expired()) << "twenty seconds are enough for another change";
    ASSERT_TRUE(change({12 * second}, {}));
    EXPECT_TRUE(ending.expired());
    EXPECT_TRUE(has(2));
    EXPECT_NE(box(3).land_memory, nullptr);
}

/// Height at a place where waves of all boxes act.
float height_at(const World& world, SeaTime when) {
    return SeaInstant(world.state()->sea, when).evaluate({0, 0}).ay;
}

// What takes hold only later is logged now: until then nothing goes that still moves the sea.
TEST_F(LandRoomTest, AChangeAheadOfTimeLeavesTheWindThatStillBlows) {
    start({-80'000 * second}, 0, land(1, 3));
    start({-10'000 * second}, 9'847 * second, land(2, 2));
    world.set_present({0});
    ASSERT_GT((box(2).sea->record.end + box(2).sea->record.decay_us).us, 5 * second);
    const float before = height_at(world, {5 * second});
    ASSERT_TRUE(change({50 * second}, {{{1}, land(3, 6)}}));
    EXPECT_TRUE(has(2));
    EXPECT_EQ(height_at(world, {5 * second}), before);
}

TEST_F(LandRoomTest, AWindToComeCutsNoCrossFade) {
    start({-80'000 * second}, 0, land(1, 3));
    start({-70'000 * second}, 0, land(2, 2));
    world.set_present({0});
    ASSERT_TRUE(change({500'000}, {{{1}, land(3, 3)}}));
    world.set_present({1 * second});
    const float before = height_at(world, {2 * second});
    ASSERT_LE(4U, world.room_for_land({3600 * second}).left());
    start({3600 * second}, 0, land(4, 4));
    EXPECT_TRUE(has(1));
    EXPECT_EQ(height_at(world, {2 * second}), before);
}

// As the server defers it: to the end of the cross-fade under way.
TEST_F(LandRoomTest, TheNextChangeCutsNoCrossFade) {
    start({-80'000 * second}, 0, land(1, 3));
    world.set_present({0});
    ASSERT_TRUE(change({500'000}, {{{1}, land(2, 3)}}));
    world.set_present({1 * second});
    const float before = height_at(world, {2 * second});
    ASSERT_TRUE(change(world.land_settled(), {{{2}, land(3, 5)}}));
    EXPECT_EQ(height_at(world, {2 * second}), before);
}

}  // namespace
}  // namespace trochoid
