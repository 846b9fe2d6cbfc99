// Land costs memory and time: what bounds both, through the whole server.
#include <gtest/gtest.h>

#include <set>

#include "protocol/codec/codec.hpp"
#include "protocol/units/operator_error.hpp"
#include "server/app/land_change.hpp"
#include "server/app/replay.hpp"
#include "server/land/land_trace.hpp"
#include "server/world/terrain_edit.hpp"
#include "tests/unit/server_app/real_server.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

/// A long bar off the island's west side; each metre more of it changes the sea all over the terrain.
ChangeLand bar(float crest, double x = -1500.0) {
    ChangeLand change;
    change.line = {{to_lattice(x), to_lattice(-1800)}, {to_lattice(x), to_lattice(1800)}};
    change.width = 60.0F;
    change.crest = crest;
    return change;
}

class LandLimits : public RealServer {
protected:
    CommandReply done(decltype(Command::action) action) {
        CommandReply reply = command({++sequence_, {}, false, std::move(action)}).get();
        EXPECT_EQ(reply.code, ErrorCode::none) << reply.message;
        return reply;
    }
    CommandReply ask(decltype(Command::action) action) {
        return command({++sequence_, {}, false, std::move(action)}).get();
    }
    CommandReply refused(decltype(Command::action) action) {
        const uint64_t before = state()->log_position.value;
        CommandReply reply = command({++sequence_, {}, false, std::move(action)}).get();
        EXPECT_NE(reply.code, ErrorCode::none);
        EXPECT_EQ(state()->log_position.value, before) << "a refusal leaves no trace";
        return reply;
    }
    std::shared_ptr<const WorldState> state() {
        return on_loop([this] { return authority->state(); });
    }
    size_t held() { return land_room(*state(), {-sea_time_bound}).held; }
    /// Land blocks in memory that the state's boxes keep there.
    size_t blocks_in_memory() {
        std::set<const LandBlock*> blocks;
        const auto now = state();
        for (const auto& [id, box] : now->boxes)
            for (const auto& top : box->sea->fields)
                for (auto field = top; field; field = field->base())
                    for (const auto& block : field->blocks()) blocks.insert(block.get());
        return blocks.size();
    }
    std::vector<LogEvent> events() {
        std::vector<LogEvent> list;
        for (const StoredEvent& stored : on_loop([this] { return log.read({0}, 1000); }))
            list.push_back(decode_event(stored.bytes).value());
        return list;
    }
    /// A second world that hears of nothing but the log is the same to the last bit.
    void expect_a_follower_agrees(const std::shared_ptr<const TerrainGrid>& terrain, SeaClock clock) {
        World follower("test", terrain, clock, most_land_blocks);
        const auto stored = on_loop([this] { return log.read({0}, 1000); });
        const auto followed = replay(follower, stored, land_settings_of(SceneLand{}));
        ASSERT_TRUE(followed) << followed.error().message;
        EXPECT_EQ(hash_of(*follower.state()), hash_of(*state()));
    }
    /// Several commands at once, as they come in one read; the replies in the order in which they are given.
    std::vector<CommandReply> together(const std::vector<decltype(Command::action)>& actions) {
        std::promise<std::vector<CommandReply>> all;
        loop.post([&] {
            auto replies = std::make_shared<std::vector<CommandReply>>();
            for (const auto& action : actions)
                authority->command({++sequence_, {}, false, action},
                                   [&all, replies, count = actions.size()](CommandReply reply) {
                                       replies->push_back(std::move(reply));
                                       if (replies->size() == count) all.set_value(*replies);
                                   });
        });
        return all.get_future().get();
    }
    /// Land blocks of scene_with_wind's wind over the island.
    static size_t blocks_of_one_wind() {
        const World world("test", island(), {});
        const auto planned = world.plan(scene_with_wind().winds.front());
        return blocks_of(trace_land(planned->box, *island(), {1}, land_settings_of(SceneLand{})));
    }

private:
    uint32_t sequence_ = 0;
};

TEST_F(LandLimits, AWindBeyondTheLimitIsRefusedAndOldOnesMakeRoom) {
    const size_t one = blocks_of_one_wind();
    ASSERT_GT(one, 50U);
    most_land_blocks = 2 * one + one / 2;
    Scene scene = scene_with_wind();
    SceneWind yesterday = scene.winds.front();
    yesterday.name = "yesterday's";
    yesterday.begin = {-100'000 * second};
    yesterday.wind.life_us = 10'000 * second;
    scene.winds.insert(scene.winds.begin(), yesterday);
    start(island(), scene);
    ASSERT_EQ(held(), 2 * one);
    const auto opened = state();
    EXPECT_TRUE(opened->boxes.contains({1}));
    StartWind same = wind_over_the_origin();
    same.seed = 5;
    done(same);
    EXPECT_FALSE(state()->boxes.contains({1})) << "it fell still yesterday and makes room";
    EXPECT_EQ(held(), 2 * one);
    const CommandReply full = refused(same);
    EXPECT_EQ(full.code, ErrorCode::too_much_land);
    EXPECT_NE(full.message.find("--land-mib"), std::string::npos) << full.message;
    // What needs no land goes on: a wind beside the terrain, a ship.
    StartWind far = wind_over_the_origin();
    far.origin.x += to_lattice(100'000);
    done(far);
    EXPECT_EQ(held(), 2 * one);
    expect_a_follower_agrees(island(), opened->clock);
}

TEST_F(LandLimits, AtTheLimitLandIsRefusedBeforeItIsTraced) {
    most_land_blocks = blocks_of_one_wind();
    start(island(), scene_with_wind());
    const CommandReply wind = refused(wind_over_the_origin());
    EXPECT_EQ(wind.code, ErrorCode::too_much_land);
    const CommandReply wall = refused(bar(-2.0F));
    EXPECT_EQ(wall.code, ErrorCode::too_much_land);
    EXPECT_EQ(height_at(*state()->terrain, to_lattice(-1500), 0), -20 * 1024) << "the bed stays";
}

TEST_F(LandLimits, ASceneWithMoreLandThanTheLimitIsTheOperators) {
    most_land_blocks = blocks_of_one_wind() / 2;
    try {
        start(island(), scene_with_wind());
        ADD_FAILURE() << "it opened";
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("--land-mib"), std::string::npos) << error.what();
    }
}

// A wind that still has to blow is not let go for one that begins after it: the scene is too large.
TEST_F(LandLimits, ASceneLosesNoWindThatIsStillToBlow) {
    most_land_blocks = blocks_of_one_wind() * 3 / 2;
    Scene scene = scene_with_wind();
    SceneWind tomorrow = scene.winds.front();
    tomorrow.name = "tomorrow's";
    tomorrow.begin = {100'000 * second};
    scene.winds.front().wind.life_us = 90'000 * second;
    scene.winds.push_back(tomorrow);
    EXPECT_THROW(start(island(), scene), OperatorError);
}

// A director who changes the land all day long: what the server holds stays bounded, every change is done, and the sea is that of the
// land as it is.
TEST_F(LandLimits, ChangesOfTheLandAllDayHoldNoMoreThanTheLimit) {
    const size_t one = blocks_of_one_wind();
    most_land_blocks = 5 * one;
    start(island(), scene_with_wind());
    const SeaClock clock = state()->clock;
    done(SetRate{16U << 16});
    size_t all = held();
    size_t flat = 0;
    int put_off = 0;
    SeaTime settled{};
    for (int i = 0; i < 12; ++i) {
        // No change may have to wait for more than a minute.
        while (on_loop([this] { return authority->now(); }) + 40 * second < settled)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        const auto before = state();
        // Many ahead of their time would hold too much at once: the server says so, and they come when some have passed.
        CommandReply reply = ask(bar(4.0F, -1900.0 + 60.0 * i));
        for (; reply.code == ErrorCode::too_much_land; reply = ask(bar(4.0F, -1900.0 + 60.0 * i)), ++put_off)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        ASSERT_EQ(reply.code, ErrorCode::none) << reply.message;
        settled = reply.effective + land_fade_us;
        for (const auto& [id, box] : state()->boxes) {
            if (before->boxes.contains(id)) continue;
            for (const auto& field : box->sea->fields)
                if (field->id().value >= before->next_field) all += field->block_count();
            flat += box->sea->record.overlays.empty() ? 1U : 0U;
        }
        ASSERT_LE(land_room(*state(), {-sea_time_bound}).kept, most_land_blocks) << "after change " << i;
        // What still cross-fades stays until it has fallen still: half as much again at most.
        ASSERT_LE(blocks_in_memory(), most_land_blocks * 3 / 2) << "after change " << i;
    }
    EXPECT_GT(all, most_land_blocks) << "without a limit it would hold all that ever came";
    EXPECT_GE(put_off, 1);
    EXPECT_GE(flat, 1U) << "now and then overlays are laid down in fields of their own";
    const auto now = state();
    const auto last = std::prev(now->boxes.end())->second;
    const TracedLand whole = trace_land(last->sea->record, *now->terrain, {1}, land_settings_of(SceneLand{}));
    ASSERT_EQ(whole.fields.size(), last->sea->fields.size());
    for (size_t i = 0; i < whole.fields.size(); ++i)
        for (const auto& block : whole.fields[i]->blocks()) {
            const LandBlock* const counts = last->sea->fields[i]->find(block->key);
            ASSERT_NE(counts, nullptr);
            ASSERT_EQ(*counts, *block);
        }
    expect_a_follower_agrees(island(), clock);
}

// What needs no land does not wait for land, and the change that it passes comes to the same.
TEST_F(LandLimits, CommandsWithoutLandPassChangesOfTheLand) {
    Scene scene = scene_with_wind();
    SceneWind second_wind = scene.winds.front();
    second_wind.name = "second";
    second_wind.wind.seed = 6;
    scene.winds.push_back(second_wind);
    start(island(), scene);
    const SeaClock clock = state()->clock;
    StartWind far = wind_over_the_origin();
    far.origin.x += to_lattice(100'000);
    StartShip ship;
    ship.at = {to_lattice(-1500), to_lattice(-1700)};
    ship.name = "ferry";
    const auto replies = together(
        {bar(-2.0F), SetRate{2U << 16}, ship, far, StopWind{{2}}, Steer{{3}, 40.0F, 6.0F}, StopWind{{99}}});
    for (const CommandReply& reply : replies)
        EXPECT_EQ(reply.code, reply.sequence == 7 ? ErrorCode::unknown_box : ErrorCode::none)
            << reply.message;
    // The last names a box that the change might have made: it keeps its place behind it.
    const std::vector<uint32_t> order{2, 3, 4, 5, 6, 1, 7};
    for (size_t i = 0; i < order.size(); ++i) EXPECT_EQ(replies[i].sequence, order[i]);
    const auto now = state();
    EXPECT_EQ(now->boxes.at({2})->successor.value, 0U) << "it was stopped before the land changed";
    EXPECT_NE(now->boxes.at({1})->successor.value, 0U);
    expect_a_follower_agrees(island(), clock);
}

// Twelve changes at once: the first is traced, the others together after it. The log has them in their order.
TEST_F(LandLimits, WaitingChangesOfTheLandAreTracedTogether) {
    const auto terrain = island();
    start(terrain, scene_with_wind());
    const SeaClock clock = state()->clock;
    std::vector<decltype(Command::action)> actions;
    std::vector<ChangeLand> changes;
    for (int i = 0; i < 12; ++i) {
        changes.push_back(bar(-8.0F, -1700.0 + 60.0 * i));
        changes.back().dig = i % 3 == 1;
        actions.emplace_back(changes.back());
    }
    // One of them changes nothing: it alone is refused.
    changes.erase(changes.begin() + 7);
    std::get<ChangeLand>(actions[7]).line = {{to_lattice(90'000), 0}, {to_lattice(91'000), 0}};
    // Digging in water that is deeper already changes nothing either.
    for (size_t i = changes.size(); i-- > 0;)
        if (changes[i].dig) changes.erase(changes.begin() + static_cast<std::ptrdiff_t>(i));
    const auto replies = together(actions);
    size_t done = 0;
    SeaTime last;
    for (const CommandReply& reply : replies) {
        const ChangeLand& change = std::get<ChangeLand>(actions[reply.sequence - 1]);
        const bool nothing = reply.sequence == 8 || change.dig;
        EXPECT_EQ(reply.code, nothing ? ErrorCode::value_out_of_range : ErrorCode::none)
            << reply.sequence << ": " << reply.message;
        done += nothing ? 0U : 1U;
        last = std::max(last, reply.effective);
    }
    ASSERT_EQ(done, changes.size());
    std::vector<ChangeLand> logged;
    size_t land_events = 0;
    for (const LogEvent& event : events())
        if (const auto* changed = std::get_if<LandChanged>(&event.what)) {
            ++land_events;
            for (const ChangeLand& change : changes_of(*changed)) logged.push_back(change);
        }
    EXPECT_EQ(land_events, 2U);
    EXPECT_EQ(logged, changes);
    EXPECT_EQ(*state()->terrain, *edited(*terrain, changes)->terrain);
    EXPECT_LE(last, replies.front().effective + land_fade_us) << "one cross-fade after the first";
    expect_a_follower_agrees(terrain, clock);
}

/// Land blocks that a change of the island brings up under scene_with_wind's wind.
size_t blocks_of(const ChangeLand& change, const Scene& scene) {
    const LandSettings settings = land_settings_of(SceneLand{});
    World world("test", island(), {});
    const auto planned = world.plan(scene.winds.front());
    Derived derived;
    derived.lands.push_back(trace_land(planned->box, *island(), {1}, settings));
    LogEvent event{1, planned->box.begin, world.fit_to_land(*planned, derived.lands.front())};
    const Bytes bytes = encode(event);
    world.apply(event, bytes, std::move(derived));
    const std::vector<BoxId> boxes{{1}};
    const auto outcome =
        trace_edit(world.state(), edited(*island(), change).value(), boxes, settings, SIZE_MAX, nullptr);
    size_t blocks = 0;
    for (const Retraced& next : outcome->touched) blocks += blocks_of(next.land);
    return blocks;
}

// Where the one before it finds no room after all, one that would have changed nothing after that does change something.
TEST_F(LandLimits, WhatWasRefusedBecauseOfAnotherIsTriedWithoutIt) {
    const auto short_bar = [](double x) {
        ChangeLand change = bar(-2.0F, x);
        change.line = {{to_lattice(x), to_lattice(1300)}, {to_lattice(x), to_lattice(1500)}};
        return change;
    };
    const ChangeLand beside = short_bar(1500.0);
    const ChangeLand large = bar(-2.0F);
    const ChangeLand part_of_it = short_bar(-1500.0);
    const size_t first = blocks_of(beside, scene_with_wind());
    const size_t most = blocks_of(large, scene_with_wind());
    const size_t least = blocks_of(part_of_it, scene_with_wind());
    most_land_blocks = blocks_of_one_wind() + first + least + 8;
    ASSERT_GT(most, std::max(most_land_blocks / 2, least + 8)) << first << " " << least;
    start(island(), scene_with_wind());
    const auto replies = together({beside, large, part_of_it});
    for (const CommandReply& reply : replies)
        EXPECT_EQ(reply.code, reply.sequence == 2 ? ErrorCode::too_much_land : ErrorCode::none)
            << reply.sequence << ": " << reply.message;
    EXPECT_EQ(*state()->terrain, *edited(*island(), std::vector{beside, part_of_it})->terrain);
}

class LandOfSessions : public LandLimits {
protected:
    std::unique_ptr<RawClient> director() {
        auto client = std::make_unique<RawClient>(listener->port());
        EXPECT_TRUE(client->log_in(hello_as(Role::director)));
        return client;
    }
};

TEST_F(LandOfSessions, OneSessionsCommandsDoNotFillTheQueue) {
    start(island(), scene_with_wind());
    const auto greedy = director();
    const auto modest = director();
    constexpr uint32_t asked = 18;
    for (uint32_t i = 1; i <= asked; ++i) greedy->send(Command{i, {}, false, wind_over_the_origin()});
    size_t busy = 0;
    size_t done = 0;
    for (uint32_t i = 1; i <= asked; ++i) {
        const auto reply = greedy->wait_for<CommandReply>(RawClient::Milliseconds(60'000));
        ASSERT_TRUE(reply);
        if (reply->code == ErrorCode::none) ++done;
        if (reply->code != ErrorCode::queue_overflow) continue;
        ++busy;
        EXPECT_NE(reply->message.find("try again"), std::string::npos) << reply->message;
        if (busy > 1) continue;
        modest->send(Command{1, {}, false, wind_over_the_origin()});
    }
    EXPECT_EQ(busy + done, asked);
    EXPECT_GE(busy, 3U);
    EXPECT_GE(done, LandQueue::most_of_a_session);
    const auto other = modest->wait_for<CommandReply>(RawClient::Milliseconds(60'000));
    ASSERT_TRUE(other);
    EXPECT_EQ(other->code, ErrorCode::none) << "others are served: " << other->message;
}

TEST_F(LandOfSessions, WhatASessionThatIsOverHasLeftWaitingIsDropped) {
    start(island(), scene_with_wind());
    auto gone = director();
    for (uint32_t i = 1; i <= 9; ++i) gone->send(Command{i, {}, false, wind_over_the_origin()});
    gone->disconnect();
    while (on_loop([this] { return sessions->stats().sessions_now; }) > 0) std::this_thread::yield();
    done(wind_over_the_origin());
    EXPECT_LE(state()->log_position.value, 7U) << "the scene's, this one, and what was begun before";
    EXPECT_TRUE(on_loop([this] { return authority->state(); })->boxes.contains({2}));
}

// Who steers her by the number before the last is told her number of today.
TEST_F(LandLimits, AShipsOldNumberIsAnsweredWithTheNewOne) {
    start(nullptr, scene_with_wind());
    StartShip ship;
    ship.at = {to_lattice(-1500), to_lattice(-1700)};
    ship.name = "ferry";
    const CommandReply first = done(ship);
    const CommandReply next = done(Steer{first.box, 40.0F, 6.0F});
    const CommandReply third = done(Steer{next.box, 80.0F, 6.0F});
    for (const BoxId old : {first.box, next.box}) {
        const std::string named = fmt::format("goes on as box {}", third.box.value);
        for (const decltype(Command::action)& action :
             {decltype(Command::action){Steer{old, 10.0F, 5.0F}}, decltype(Command::action){StopWind{old}}}) {
            const CommandReply reply = refused(action);
            EXPECT_EQ(reply.code, ErrorCode::already_ending);
            EXPECT_NE(reply.message.find(named), std::string::npos) << reply.message;
        }
    }
    done(StopWind{third.box});
    EXPECT_EQ(refused(Steer{third.box, 10.0F, 5.0F}).message.find("goes on as"), std::string::npos);
}

}  // namespace
}  // namespace trochoid
