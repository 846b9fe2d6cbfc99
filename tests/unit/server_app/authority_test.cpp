#include <gtest/gtest.h>

#include "protocol/units/operator_error.hpp"
#include "tests/unit/server_app/real_server.hpp"

namespace trochoid {
namespace {

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
        for (uint32_t i = 1; i <= LandQueue::most_waiting + 3; ++i) {
            auto promise = std::make_shared<std::promise<CommandReply>>();
            replies.push_back(promise->get_future());
            const Command c{i,
                            {},
                            false,
                            i == 1 ? decltype(Command::action){wind_over_the_origin()}
                                   : decltype(Command::action){StopWind{{99}}}};
            authority->command(c, [promise](CommandReply reply) { promise->set_value(std::move(reply)); });
        }
        posted.set_value();
    });
    posted.get_future().get();
    EXPECT_EQ(replies[0].get().code, ErrorCode::none);
    EXPECT_EQ(replies[1].get().code, ErrorCode::unknown_box);
    EXPECT_EQ(replies.back().get().code, ErrorCode::queue_overflow);
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
    EXPECT_NE(refused->message.find("--token-key"), std::string::npos);
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
