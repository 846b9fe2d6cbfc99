// Storms, ships and changes of the land through the whole server: commands in, log, states and tiles out.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "protocol/units/operator_error.hpp"
#include "server/app/replay.hpp"
#include "server/event/scene.hpp"
#include "server/world/ship_box.hpp"
#include "tests/unit/server_app/real_server.hpp"

namespace trochoid {
namespace {

ChangeLand breakwater() {
    ChangeLand change;
    change.line = {{to_lattice(-1200), to_lattice(-600)}, {to_lattice(-900), to_lattice(700)}};
    change.width = 40.0F;
    change.crest = 4.0F;
    return change;
}

StartWind storm() {
    StartWind wind = wind_over_the_origin();
    wind.fetch = to_lattice(3000);
    wind.vx = 10.0F;
    wind.trains = 6;
    return wind;
}

StartShip ferry() {
    StartShip ship;
    ship.at = {to_lattice(-1500), to_lattice(-1700)};
    ship.towards_degrees = 90.0F;
    ship.speed = 9.0F;
    ship.name = "ferry";
    return ship;
}

class LiveSea : public RealServer {
protected:
    CommandReply done(decltype(Command::action) action) {
        const CommandReply reply = command({++sequence_, {}, false, std::move(action)}).get();
        EXPECT_EQ(reply.code, ErrorCode::none) << reply.message;
        return reply;
    }
    CommandReply refused(decltype(Command::action) action) {
        const uint64_t before = state()->log_position.value;
        const CommandReply reply = command({++sequence_, {}, false, std::move(action)}).get();
        EXPECT_NE(reply.code, ErrorCode::none);
        EXPECT_EQ(state()->log_position.value, before) << "a refusal leaves no trace";
        return reply;
    }
    std::shared_ptr<const WorldState> state() {
        return on_loop([this] { return authority->state(); });
    }

private:
    uint32_t sequence_ = 0;
};

// A second world that hears of nothing but the log's bytes, and traces all land by itself, is the same to the last bit.
TEST_F(LiveSea, TheLogAloneRebuildsTheWorldWithItsLand) {
    Scene scene = scene_with_wind();
    scene.breakwaters.push_back(
        {{{to_lattice(500), to_lattice(-900)}, {to_lattice(900), to_lattice(-900)}}, 30.0F, 2.0F, false});
    SceneShip ship{
        ferry(), {-100 * microseconds_per_second}, {{{-50 * microseconds_per_second}, 120.0, 7.0}}};
    ship.ship.name = "pilot";
    scene.ships.push_back(ship);
    const auto terrain = island();
    start(terrain, scene);
    const auto opening_clock = state()->clock;
    const CommandReply squall = done(storm());
    const CommandReply vessel = done(ferry());
    done(Steer{squall.box, 40.0F, 15.0F});
    const CommandReply second_leg = done(Steer{vessel.box, 180.0F, 6.0F});
    EXPECT_NE(second_leg.box, vessel.box);
    done(SetRate{8U << 16});
    done(breakwater());
    ChangeLand channel = breakwater();
    channel.line = {{to_lattice(-300), to_lattice(-1500)}, {to_lattice(-300), to_lattice(1500)}};
    channel.crest = -12.0F;
    channel.dig = true;
    done(channel);
    done(wind_over_the_origin());
    done(StopWind{second_leg.box});
    done(SetRate{1U << 16});

    const auto live = state();
    size_t succeeded = 0;
    size_t overlays = 0;
    for (const auto& [id, box] : live->boxes) {
        succeeded += box->predecessor.value != 0 ? 1U : 0U;
        overlays += box->sea->record.overlays.size();
    }
    EXPECT_GE(succeeded, 3U) << "old wind and storm, twice";
    EXPECT_GE(overlays, 1U);
    LandSettings settings = land_settings_of(scene.land);
    settings.threads = 1;
    World follower(scene.name, terrain, opening_clock);
    const auto events = on_loop([this] { return log.read({0}, 1000); });
    EXPECT_EQ(events.size(), live->log_position.value);
    const auto followed = replay(follower, events, settings);
    ASSERT_TRUE(followed) << followed.error().message;
    EXPECT_EQ(hash_of(*follower.state()), hash_of(*live));

    World half(scene.name, terrain, opening_clock);
    ASSERT_TRUE(replay(half, std::span(events).first(events.size() / 2), settings));
    EXPECT_NE(hash_of(*half.state()), hash_of(*live));
    EXPECT_EQ(replay(half, events, settings).error().code, ErrorCode::base_mismatch)
        << "not from its position";
    ASSERT_TRUE(replay(half, std::span(events).subspan(events.size() / 2), settings));
    EXPECT_EQ(hash_of(*half.state()), hash_of(*live));
}

TEST_F(LiveSea, AShipsNewCourseIsSeenAtOnceOrNotAtAll) {
    start(nullptr, scene_with_wind());
    const CommandReply ship = done(ferry());
    int changes = 0;
    std::promise<void> set;
    loop.post([&] {
        authority->on_change([&] {
            ++changes;
            const auto now = authority->state();
            size_t sailing = 0;
            for (const auto& [id, box] : now->boxes)
                if (has_wake(box->sea->record.wake) &&
                    box->sea->record.end - box->sea->record.begin > 86400 * microseconds_per_second)
                    ++sailing;
            EXPECT_EQ(sailing, 1U) << "the old course has ended, the new one begun";
        });
        set.set_value();
    });
    set.get_future().get();
    const CommandReply turned = done(Steer{ship.box, 10.0F, 5.0F});
    EXPECT_EQ(changes, 1);
    EXPECT_EQ(turned.log_position.value, ship.log_position.value + 2) << "two events";
    const auto now = state();
    const auto& old_leg = now->boxes.at(ship.box)->sea->record;
    const auto& new_leg = now->boxes.at(turned.box)->sea->record;
    EXPECT_EQ(old_leg.end, turned.effective);
    EXPECT_EQ(new_leg.begin, turned.effective);
    EXPECT_NEAR(to_metres(ship_place(old_leg, turned.effective).x - ship_place(new_leg, turned.effective).x),
                0.0, 0.01);
    EXPECT_EQ(now->boxes.at(turned.box)->name, "ferry");
    on_loop([this] {
        authority->on_change({});
        return 0;
    });
    done(Steer{turned.box, 0.0F, 0.0F});
    EXPECT_EQ(refused(Steer{turned.box, 0.0F, 3.0F}).code, ErrorCode::already_ending);
}

TEST_F(LiveSea, CommandsThatCannotBeAreRefusedAndLeaveNothing) {
    start(nullptr, scene_with_wind());
    EXPECT_EQ(refused(breakwater()).code, ErrorCode::no_terrain);
    EXPECT_EQ(refused(Steer{{1}, 0.0F, 5.0F}).code, ErrorCode::not_moving);
    EXPECT_EQ(refused(Steer{{7}, 0.0F, 5.0F}).code, ErrorCode::unknown_box);
    StartShip slow = ferry();
    slow.speed = 0.0F;
    EXPECT_EQ(refused(slow).code, ErrorCode::value_out_of_range);
    StartWind gale = wind_over_the_origin();
    gale.speed = 100.0F;
    EXPECT_EQ(refused(gale).code, ErrorCode::value_out_of_range);
    gale = wind_over_the_origin();
    gale.fetch = 0;
    EXPECT_EQ(refused(gale).code, ErrorCode::value_out_of_range);
}

TEST_F(LiveSea, ABreakwaterShelters) {
    start(island(), scene_with_wind());
    const LatticePoint lee{to_lattice(-850), 0};
    const auto before = state();
    const CommandReply reply = done(breakwater());
    const auto after = state();
    EXPECT_EQ(after->boxes.size(), 2U);
    // An hour later the cross-fade is long over: behind the wall the sea is far lower.
    const auto energy = [&](const WorldState& at) {
        double sum = 0.0;
        for (int64_t s = 0; s < 60; ++s) {
            const SeaInstant instant(at.sea, reply.effective + (3600 + s) * microseconds_per_second);
            const auto y = static_cast<double>(instant.evaluate(lee).ay);
            sum += y * y;
        }
        return sum;
    };
    EXPECT_GT(energy(*before), 0.01);
    EXPECT_LT(energy(*after), 0.3 * energy(*before));
    EXPECT_EQ(height_at(*after->terrain, to_lattice(-1050), to_lattice(50)) > 0, true);
    // While it fades the next one waits.
    ChangeLand higher = breakwater();
    higher.crest = 6.0F;
    Command impatient{90, watermark() + 2 * microseconds_per_second, true, higher};
    const CommandReply late = command(impatient).get();
    EXPECT_EQ(late.code, ErrorCode::too_late);
    EXPECT_NE(late.message.find("the land changes until"), std::string::npos) << late.message;
    const CommandReply next = done(higher);
    EXPECT_GE(next.effective, reply.effective + land_fade_us);
    EXPECT_EQ(refused(higher).code, ErrorCode::value_out_of_range) << "nothing changes";
    // Changes do not pile up: no wind could be stopped before the last of them.
    CommandReply last;
    uint32_t waiting = 0;
    for (; waiting < 20 && last.code == ErrorCode::none; ++waiting) {
        higher.crest += 1.0F;
        last = command({100 + waiting, {}, false, higher}).get();
    }
    EXPECT_EQ(last.code, ErrorCode::too_late);
    EXPECT_LE(waiting, 8U);
}

// What no land can change goes on under its own name: nothing is sent again for it.
TEST_F(LiveSea, AChangeFarBehindTheWavesTouchesNoBox) {
    Scene scene;
    scene.name = "test";
    StartWind wind = wind_over_the_origin();
    wind.origin = {to_lattice(-2000), to_lattice(1200)};
    wind.fetch = to_lattice(800);
    wind.width = to_lattice(600);
    wind.seed = 9;
    scene.winds.push_back({"small", wind, {-3600 * microseconds_per_second}, {}});
    start(island(), scene);
    ChangeLand change = breakwater();
    change.line = {{to_lattice(1500), to_lattice(-1500)}, {to_lattice(1700), to_lattice(-1500)}};
    done(change);
    EXPECT_EQ(state()->boxes.size(), 1U);
    EXPECT_EQ(state()->boxes.at({1})->sea->record.end, end_of_time);
}

TEST_F(LiveSea, ClientsHaveTheTilesThatChangedAgain) {
    const auto terrain = island();
    start(terrain, scene_with_wind());
    RawClient client(listener->port());
    ClientHello hello = RawClient::usual_hello();
    hello.view.position = {to_lattice(-1000), 0};
    hello.view.altitude = static_cast<int32_t>(to_lattice(30));
    ASSERT_TRUE(client.log_in(hello));
    std::map<std::tuple<uint8_t, int32_t, int32_t>, TerrainTile> tiles;
    const auto receive_until_quiet = [&] {
        while (const auto message = client.receive(std::chrono::milliseconds(600))) {
            if (const auto* delta = std::get_if<Delta>(&*message); delta != nullptr && delta->last)
                client.acknowledge(*delta);
            if (const auto* sent = std::get_if<TerrainTiles>(&*message))
                for (const TerrainTile& tile : sent->tiles)
                    tiles[{tile.key.level, tile.key.x, tile.key.z}] = tile;
        }
    };
    receive_until_quiet();
    ASSERT_GE(tiles.size(), 3U);
    const auto before = tiles;
    done(breakwater());
    receive_until_quiet();
    const auto now = state();
    size_t changed = 0;
    for (const auto& [place, tile] : tiles) {
        EXPECT_EQ(tile, make_tile(*now->terrain, tile.key)) << "a tile is out of date";
        const auto had = before.find(place);
        changed += had != before.end() && had->second != tile ? 1U : 0U;
    }
    EXPECT_GE(changed, 2U);
    EXPECT_FALSE(client.closed());
}

// What a client evaluates from what it was told equals, bit by bit, what the server says: a storm, a ship on her second course, and
// boxes whose land has changed, before, while and after they take the others' places.
TEST_F(LiveSea, ClientAndServerComputeTheSameMovingSea) {
    start(island(), scene_with_wind());
    RawClient client(listener->port());
    ClientHello hello = RawClient::usual_hello();
    hello.view.position = {to_lattice(-1000), to_lattice(-300)};
    hello.regions = {{hello.view.position, static_cast<uint32_t>(to_lattice(500))}};
    ASSERT_TRUE(client.log_in(hello));
    done(storm());
    const CommandReply ship =
        done(StartShip{{to_lattice(-1300), to_lattice(-300)}, 90.0F, 8.0F, 100.0F, 0.0F, "ferry"});
    const CommandReply turned = done(Steer{ship.box, 140.0F, 6.0F});
    const CommandReply changed = done(breakwater());
    EXPECT_NE(turned.box, ship.box);
    LogPosition known;
    while (known < changed.log_position) {
        const auto result = client.next_result();
        ASSERT_TRUE(result);
        ASSERT_EQ(result->state_hash, hash_of(client.state()));
        client.acknowledge(*result);
        known = result->key.log_position;
    }
    std::map<FieldId, std::shared_ptr<LandField>> fields;
    for (const auto& [key, block] : client.state().blocks) {
        auto& field = fields[key.field];
        if (!field) field = std::make_shared<LandField>(key.field, block.step_log2);
        field->set(block.block);
    }
    std::vector<std::shared_ptr<const LandField>> known_fields;
    for (const auto& [id, field] : fields) known_fields.push_back(field);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    size_t overlays = 0;
    for (const auto& [id, box] : client.state().boxes) {
        boxes.push_back(prepare(*box, known_fields));
        overlays += box->overlays.size();
    }
    EXPECT_GE(overlays, 1U);
    EXPECT_GE(boxes.size(), 6U) << "two winds and their successors, two courses";
    const Sea local(boxes);
    std::vector<LatticePoint> points;
    for (int64_t i = 0; i < 100; ++i)
        points.push_back({hello.view.position.x + (i % 10 - 5) * 61 * 1024,
                          hello.view.position.z + (i / 10 - 5) * 61 * 1024});
    uint32_t sequence = 0;
    for (const int64_t ms : {-100, 0, 3000, 9000, 11000, 60000}) {
        const SeaTime time = changed.effective + ms * 1000;
        client.send(SampleRequest{++sequence, time, points});
        const auto reply = client.wait_for<SampleReply>();
        ASSERT_TRUE(reply);
        const SeaInstant instant(local, time);
        for (size_t i = 0; i < points.size(); ++i)
            ASSERT_EQ(instant.evaluate(points[i]), reply->samples[i]) << ms << " ms, point " << i;
    }
}

// Land that covers everything: the waves end at once, and nothing else happens.
TEST_F(LiveSea, LandThatCoversEverythingIsACalm) {
    TerrainGrid grid = *island();
    for (int16_t& height : grid.heights) height = 320;
    start(std::make_shared<const TerrainGrid>(grid), scene_with_wind());
    done(storm());
    const auto now = state();
    for (const int64_t s : {0, 100, 4000}) {
        const SeaInstant instant(now->sea, SeaTime{s * microseconds_per_second});
        for (int64_t x = -1500; x <= 1500; x += 250) {
            const SurfaceSample sample = instant.evaluate({to_lattice(static_cast<double>(x)), 0});
            EXPECT_EQ(sample.ay, 0.0F) << x;
            EXPECT_EQ(sample.ny, 1.0F);
        }
    }
    EXPECT_EQ(refused(breakwater()).code, ErrorCode::value_out_of_range) << "it is higher already";
}

TEST_F(LiveSea, ASceneWhoseBreakwaterIsBesideTheTerrainIsRefused) {
    Scene scene = scene_with_wind();
    ChangeLand far = breakwater();
    for (LatticePoint& p : far.line) p.x += to_lattice(100000);
    scene.breakwaters.push_back(far);
    try {
        start(island(), scene);
        ADD_FAILURE() << "it opened";
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("the scene's breakwater 1 cannot be"), std::string::npos)
            << error.what();
    }
}

/// Opens one of the shipped scenes that show a single feature; all are alive a minute later.
class ShippedScene : public LiveSea, public testing::WithParamInterface<const char*> {};

TEST_P(ShippedScene, OpensAndLives) {
    const std::string name = GetParam();
    const Scene scene =
        load_scene(std::filesystem::path(TROCHOID_SOURCE_DIR) / "server" / "scenes" / name / "scene.toml");
    start(load_terrain(scene.terrain), scene);
    const auto now = state();
    EXPECT_FALSE(now->boxes.empty());
    size_t moving = 0;
    for (const auto& [id, box] : now->boxes) moving += box->sea->record.course.empty() ? 0U : 1U;
    EXPECT_EQ(moving > 0, name != "breakwater");
    if (name == "breakwater") {
        EXPECT_NE(*now->terrain, *load_terrain(scene.terrain)) << "its mole is there from the beginning";
    }
    const SeaInstant instant(now->sea, scene.clock_start + 60 * microseconds_per_second);
    EXPECT_FALSE(instant.live().empty());
}

INSTANTIATE_TEST_SUITE_P(Features, ShippedScene, testing::Values("storm-cell", "ship-wakes", "breakwater"));

}  // namespace
}  // namespace trochoid
