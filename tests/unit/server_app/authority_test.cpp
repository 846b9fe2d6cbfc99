#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "protocol/units/operator_error.hpp"
#include "server/app/opening.hpp"
#include "server/app/sea_authority.hpp"
#include "server/app/sea_service.hpp"
#include "server/net/listener.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/session_server.hpp"
#include "tests/support/net/raw_client.hpp"

namespace trochoid {
namespace {

constexpr uint32_t lead_ms = 200;

// A shoal rising out of 20 m of water around an island, 4 km across.
std::shared_ptr<const TerrainGrid> island() {
    TerrainGrid grid;
    grid.columns = grid.rows = 129;
    grid.origin_x = grid.origin_z = -64 * 32768;
    for (int64_t z = -64; z <= 64; ++z)
        for (int64_t x = -64; x <= 64; ++x) {
            const int64_t metres = std::max<int64_t>(-20, 10 - (x * x + z * z) / 40);
            grid.heights.push_back(static_cast<int16_t>(metres * 32));
        }
    grid.open_sea_depth = -20 * 1024;
    return std::make_shared<const TerrainGrid>(grid);
}

StartWind wind_over_the_origin() {
    StartWind wind;
    wind.speed = 12.0F;
    wind.towards_degrees = 90.0F;
    wind.origin = {to_lattice(-3000), 0};
    wind.fetch = to_lattice(6000);
    wind.width = to_lattice(4000);
    return wind;
}

// The real server without its process: world, authority, service, sessions on a loopback port.
class RealServer : public testing::Test {
protected:
    void start(const std::shared_ptr<const TerrainGrid>& terrain, const Scene& scene) {
        SeaClock clock;
        clock.monotonic_start_us = monotonic_us();
        world = std::make_unique<World>(scene.name, terrain, clock);
        worker = std::make_unique<LandWorker>(loop, terrain, land_settings_of(scene.land));
        authority = std::make_unique<SeaAuthority>(loop, *world, log, *worker, lead_ms);
        authority->open(scene);
        sea = std::make_unique<SeaService>(*authority, WorldInstance{}, DirectorToken());
        sessions = std::make_unique<SessionServer>(loop, *sea, Limits{});
        authority->on_change([this] { sessions->sea_changed(); });
        listener = std::make_unique<Listener>(loop, ListenAddresses{}, [this](std::unique_ptr<Transport> t) {
            sessions->accept(std::move(t));
        });
        thread = std::thread([this] { loop.run(); });
    }
    void TearDown() override {
        if (!thread.joinable()) return;
        loop.post([this] { loop.stop(); });
        thread.join();
    }
    static Scene scene_with_wind() {
        Scene scene;
        scene.name = "test";
        SceneWind wind{"old wind", wind_over_the_origin(), {-3600 * microseconds_per_second}};
        wind.wind.seed = 5;
        scene.winds.push_back(wind);
        return scene;
    }
    template <class F>
    auto on_loop(F f) {
        std::promise<decltype(f())> promise;
        loop.post([&] { promise.set_value(f()); });
        return promise.get_future().get();
    }
    // Hands over a command and gives its reply's future.
    std::future<CommandReply> command(const Command& c) {
        auto promise = std::make_shared<std::promise<CommandReply>>();
        loop.post([this, c, promise] {
            authority->command(c, [promise](CommandReply reply) { promise->set_value(std::move(reply)); });
        });
        return promise->get_future();
    }
    SeaTime watermark() {
        return on_loop([this] { return authority->watermark(); });
    }

    IoLoop loop;
    InMemoryEventLog log;
    std::unique_ptr<World> world;
    std::unique_ptr<LandWorker> worker;
    std::unique_ptr<SeaAuthority> authority;
    std::unique_ptr<SeaService> sea;
    std::unique_ptr<SessionServer> sessions;
    std::unique_ptr<Listener> listener;
    std::thread thread;
};

TEST_F(RealServer, WindTakesHoldNoEarlierThanAnyWatermarkGivenBefore) {
    start(nullptr, scene_with_wind());
    for (uint32_t i = 1; i <= 5; ++i) {
        const SeaTime promised = watermark();
        const CommandReply reply = command({i, {}, false, wind_over_the_origin()}).get();
        ASSERT_EQ(reply.code, ErrorCode::none) << reply.message;
        EXPECT_GE(reply.effective, promised);
        EXPECT_LT(reply.effective - promised, 2 * microseconds_per_second);
        EXPECT_EQ(reply.log_position, LogPosition{1 + i});
        EXPECT_EQ(reply.box, BoxId{1 + i});
        EXPECT_EQ(log.read({i}, 10).size(), 1U);
    }
}

TEST_F(RealServer, WatermarkNeverFallsWhenTheRateDoes) {
    start(nullptr, scene_with_wind());
    SeaTime last = watermark();
    for (const uint32_t rate : {16U, 0U, 4U, 1U, 0U, 1U}) {
        const CommandReply changed = command({1, {}, false, SetRate{rate << 16}}).get();
        ASSERT_EQ(changed.code, ErrorCode::none) << changed.message;
        const SeaTime promised = watermark();
        EXPECT_GE(promised, last);
        const CommandReply wind = command({2, {}, false, wind_over_the_origin()}).get();
        ASSERT_EQ(wind.code, ErrorCode::none);
        EXPECT_GE(wind.effective, promised) << "rate " << rate;
        last = watermark();
    }
}

TEST_F(RealServer, AskedTimesAreMetOrRefused) {
    start(nullptr, scene_with_wind());
    const SeaTime later = watermark() + 60 * microseconds_per_second;
    EXPECT_EQ(command({1, later, true, wind_over_the_origin()}).get().effective, later);
    EXPECT_EQ(command({2, {}, true, wind_over_the_origin()}).get().code, ErrorCode::too_late);
    EXPECT_EQ(command({3, {}, false, StopWind{{77}}}).get().code, ErrorCode::unknown_box);
    EXPECT_EQ(command({4, {}, false, StopWind{{1}}}).get().code, ErrorCode::none);
    EXPECT_EQ(command({5, {}, false, StopWind{{1}}}).get().code, ErrorCode::already_ending);
    StartWind calm = wind_over_the_origin();
    calm.speed = 0.0F;
    EXPECT_EQ(command({6, {}, false, calm}).get().code, ErrorCode::value_out_of_range);
}

TEST_F(RealServer, CommandsThatWaitForATraceKeepTheirOrder) {
    start(island(), scene_with_wind());
    auto started = command({1, {}, false, wind_over_the_origin()});
    auto again = command({2, {}, false, wind_over_the_origin()});
    auto stopped = command({3, {}, false, StopWind{{2}}});  // the first one's box, not known yet
    EXPECT_EQ(started.get().box, BoxId{2});
    EXPECT_EQ(again.get().box, BoxId{3});
    EXPECT_EQ(stopped.get().code, ErrorCode::none);
    const auto state = on_loop([this] { return authority->state(); });
    EXPECT_FALSE(state->boxes.at(BoxId{3})->sea->fields.empty()) << "the island acts on it";
    EXPECT_LT(state->boxes.at(BoxId{2})->sea->record.end, end_of_time);
}

TEST_F(RealServer, TooManyWaitingCommandsAreRefused) {
    start(island(), scene_with_wind());
    std::vector<std::future<CommandReply>> replies;
    std::promise<void> posted;
    loop.post([&] {  // in one go, so that none is done in between
        for (uint32_t i = 1; i <= SeaAuthority::most_waiting + 3; ++i) {
            auto promise = std::make_shared<std::promise<CommandReply>>();
            replies.push_back(promise->get_future());
            const Command c{
                i,
                {},
                false,
                i == 1 ? std::variant<StartWind, StopWind, ListBoxes, SetRate>{wind_over_the_origin()}
                       : std::variant<StartWind, StopWind, ListBoxes, SetRate>{StopWind{{99}}}};
            authority->command(c, [promise](CommandReply reply) { promise->set_value(std::move(reply)); });
        }
        posted.set_value();
    });
    posted.get_future().get();
    EXPECT_EQ(replies[0].get().code, ErrorCode::none);
    EXPECT_EQ(replies[1].get().code, ErrorCode::unknown_box);
    EXPECT_EQ(replies.back().get().code, ErrorCode::rate_limited);
}

// What a client evaluates from what it was told equals, bit by bit, what the server says of points in its region:
// before, while and after a wind is growing and decaying, over land fields.
TEST_F(RealServer, ClientAndServerComputeTheSameSeaInASyncRegion) {
    start(island(), scene_with_wind());
    RawClient client(listener->port());
    ClientHello hello = RawClient::usual_hello();
    hello.view.position = {to_lattice(-200), to_lattice(100)};
    hello.regions = {{hello.view.position, static_cast<uint32_t>(to_lattice(400))}};
    ASSERT_TRUE(client.log_in(hello));
    const CommandReply wind = command({1, {}, false, wind_over_the_origin()}).get();
    const CommandReply stop =
        command({2, wind.effective + 20 * microseconds_per_second, false, StopWind{wind.box}}).get();
    ASSERT_EQ(stop.code, ErrorCode::none);

    LogPosition known;
    while (known < stop.log_position) {
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
    const std::vector<std::shared_ptr<const LandField>> known_fields = [&] {
        std::vector<std::shared_ptr<const LandField>> all;
        all.reserve(fields.size());
        for (const auto& [id, field] : fields) all.push_back(field);
        return all;
    }();
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, box] : client.state().boxes) boxes.push_back(prepare(*box, known_fields));
    ASSERT_EQ(boxes.size(), 2U);
    const Sea local(boxes);

    std::vector<LatticePoint> points;
    points.reserve(100);
    for (int i = 0; i < 100; ++i)
        points.push_back({hello.view.position.x + (i % 10 - 5) * 31 * 1024,
                          hello.view.position.z + (i / 10 - 5) * 31 * 1024});
    uint32_t sequence = 0;
    for (const int64_t seconds : {-5, 0, 5, 30, 600}) {
        const SeaTime time = wind.effective + seconds * microseconds_per_second;
        client.send(SampleRequest{++sequence, time, points});
        const auto reply = client.wait_for<SampleReply>();
        ASSERT_TRUE(reply);
        const SeaInstant instant(local, time);
        for (size_t i = 0; i < points.size(); ++i)
            ASSERT_EQ(instant.evaluate(points[i]), reply->samples[i]) << seconds << " s, point " << i;
    }
}

TEST_F(RealServer, ViewersMayListButNotCommand) {
    start(nullptr, scene_with_wind());
    RawClient viewer(listener->port());
    ASSERT_TRUE(viewer.log_in());
    viewer.send(Command{1, {}, false, wind_over_the_origin()});
    const auto refused = viewer.wait_for<CommandReply>();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->code, ErrorCode::token_required);
    EXPECT_NE(refused->message.find("--director-token-file"), std::string::npos);
    viewer.send(Command{2, {}, false, ListBoxes{}});
    const auto list = viewer.wait_for<BoxList>();
    ASSERT_TRUE(list);
    ASSERT_EQ(list->boxes.size(), 1U);
    EXPECT_EQ(list->boxes[0].name, "old wind");
}

TEST(Opening, TerrainThatIsNone) {
    EXPECT_EQ(load_terrain({}), nullptr);
    EXPECT_THROW(load_terrain("/does/not/exist"), OperatorError);
    EXPECT_THROW(load_terrain("/tmp"), OperatorError);
    EXPECT_THROW(load_terrain(TROCHOID_SOURCE_DIR "/LICENSE"), OperatorError);
    const auto scilly = load_terrain(TROCHOID_SOURCE_DIR "/server/scenes/scilly/scilly.terrain");
    ASSERT_TRUE(scilly);
    EXPECT_GT(scilly->columns, 100U);
}

}  // namespace
}  // namespace trochoid
