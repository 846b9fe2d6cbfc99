#include <gtest/gtest.h>

#include "protocol/codec/codec.hpp"
#include "server/event/event_log.hpp"
#include "server/world/world.hpp"

namespace trochoid {
namespace {

StartWind breeze() {
    StartWind wind;
    wind.speed = 7.0F;
    wind.towards_degrees = 310.0F;
    wind.fetch = to_lattice(3000.0);
    wind.width = to_lattice(1000.0);
    wind.trains = 9;
    return wind;
}

SceneBox unlimited_box() {
    SceneBox box;
    box.name = "ground swell";
    box.ramp_rear = box.ramp_front = box.ramp_side = to_lattice(50.0);
    box.trains = {{120.0, 30.0, 0.6, 0.5, 1.0}};
    return box;
}

/// Folds what the log holds, through its bytes alone.
std::shared_ptr<const WorldState> replay(const EventLog& log) {
    World world("test", nullptr, {});
    for (const StoredEvent& stored : log.read({0}, 100)) {
        const auto event = decode_event(stored.bytes);
        EXPECT_TRUE(event) << event.error().message;
        world.apply(*event, stored.bytes);
    }
    return world.state();
}

TEST(EventBytes, TheLogsBytesAloneRebuildTheWorld) {
    World world("test", nullptr, {});
    InMemoryEventLog log;
    const auto commit = [&](SeaTime effective, auto planned) {
        ASSERT_TRUE(planned) << planned.error().message;
        const LogEvent event{world.state()->log_position.value + 1, effective, std::move(planned).value()};
        const Bytes bytes = encode(event);
        const auto result = log.append(world.state()->log_position, event.event_id, bytes);
        ASSERT_TRUE(std::holds_alternative<Appended>(result));
        world.apply(event, bytes);
        EXPECT_EQ(world.state()->log_hash, std::get<Appended>(result).log_hash);
    };
    commit({5}, world.plan(breeze(), {5}));
    commit({6}, world.plan(unlimited_box()));
    commit({900'000'000}, world.plan(StopWind{{1}}, {900'000'000}));
    commit({1000}, world.plan(SetRate{2U << 16}, 1000));
    EXPECT_EQ(world.state()->log_position, LogPosition{4});
    const auto again = replay(log);
    EXPECT_EQ(hash_of(*again), hash_of(*world.state()));
    EXPECT_EQ(hash_of(*again), hash_of(*replay(log)));
}

}  // namespace
}  // namespace trochoid
