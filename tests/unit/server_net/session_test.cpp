#include <chrono>
#include <map>
#include <vector>

#include "protocol/model/self_check.hpp"
#include "protocol/units/operator_error.hpp"
#include "tests/unit/server_net/server_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;
using Sessions = ServerFixture;

TEST_F(Sessions, HelloIsAnsweredAndTheFirstResultFollowsAtOnce) {
    start();
    RawClient client(port());
    ClientHello mine = RawClient::usual_hello();
    mine.clock_stamp_us = 1234;
    const auto hello = client.log_in(mine);
    ASSERT_TRUE(hello);
    EXPECT_EQ(hello->world, "fake");
    EXPECT_EQ(hello->client_stamp_us, 1234);
    EXPECT_EQ(hello->limits, limits);
    EXPECT_EQ(hello->challenge_count, 64U);
    EXPECT_EQ(hello->role, Role::viewer);
    const auto result = client.next_result();
    ASSERT_TRUE(result);
    EXPECT_EQ(result->result, 1U);
    EXPECT_EQ(result->base, 0U);
    EXPECT_EQ(result->state_hash, hash_of(client.state()));
    EXPECT_EQ(hash_of(client.state()), hash_of(sea.state_for(mine.view)));
}

TEST_F(Sessions, SessionsDifferInIdAndChallenge) {
    start();
    RawClient a(port());
    RawClient b(port());
    const auto hello_a = a.log_in();
    const auto hello_b = b.log_in();
    ASSERT_TRUE(hello_a && hello_b);
    EXPECT_NE(hello_a->session, hello_b->session);
    EXPECT_NE(hello_a->challenge_seed, hello_b->challenge_seed);
}

TEST_F(Sessions, StillCameraCostsNothing) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.enter());
    const uint64_t before = client.bytes_received();
    EXPECT_FALSE(client.receive(milliseconds(500)));
    EXPECT_EQ(client.bytes_received(), before);
    EXPECT_FALSE(client.closed());
}

TEST_F(Sessions, ChangedSeaReachesAClientAsADeltaOnItsBase) {
    start();
    RawClient client(port());
    const auto first = client.enter();
    ASSERT_TRUE(first);
    sea.patches = 20;
    change_sea();
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->result, 2U);
    EXPECT_EQ(second->base, 1U);
    EXPECT_EQ(second->base_hash, first->state_hash);
    EXPECT_TRUE(second->change.boxes.empty()) << "the box had been sent";
    EXPECT_EQ(hash_of(client.state()), hash_of(sea.state_for(RawClient::usual_hello().view)));
}

TEST_F(Sessions, SpanThatRunsOutIsRenewed) {
    sea.refresh_after_us = 150'000;
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    for (int i = 0; i < 3; ++i) {
        const auto result = client.next_result(milliseconds(1000));
        ASSERT_TRUE(result) << "renewal " << i;
        client.acknowledge(*result);
    }
}

TEST_F(Sessions, ClockRequestsAreAnsweredWithTheirStamps) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    client.send(ClockRequest{1, 777});
    const auto reply = client.wait_for<ClockReply>();
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->sequence, 1U);
    EXPECT_EQ(reply->client_sent_us, 777);
    EXPECT_LE(reply->server_received_us, reply->server_sent_us);
    EXPECT_LT(reply->server_sent_us - reply->server_received_us, 100'000);
    EXPECT_EQ(reply->watermark, SeaTime{1000});
    EXPECT_EQ(reply->log_hash, 99U);
}

TEST_F(Sessions, KnownAnswerTellsExactFromApproximate) {
    start();
    RawClient exact(port());
    RawClient approximate(port());
    const auto hello = exact.log_in();
    ASSERT_TRUE(hello && approximate.log_in());
    const auto result = exact.next_result();
    const auto other = approximate.next_result();
    ASSERT_TRUE(result && other);
    exact.acknowledge(*result, reference_hash(hello->challenge_seed, hello->challenge_count));
    approximate.acknowledge(*other, 1);
    // Both stay connected and are told.
    for (const auto& [client, verdict] :
         {std::pair{&exact, Verdict::exact}, std::pair{&approximate, Verdict::approximate}}) {
        client->send(ClockRequest{1, 0});
        const auto reply = client->wait_for<ClockReply>();
        ASSERT_TRUE(reply);
        EXPECT_EQ(reply->verdict, verdict);
    }
    EXPECT_EQ(stats().exact_viewers, 1U);
    EXPECT_EQ(stats().approximate_viewers, 1U);
}

TEST_F(Sessions, OnlyTheTokenMakesADirector) {
    start();
    RawClient director(port());
    ClientHello hello = RawClient::usual_hello();
    hello.token = "secret";
    const auto answer = director.log_in(hello);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->role, Role::director);
    director.send(Command{1, {}, false, SetRate{}});
    const auto done = director.wait_for<CommandReply>();
    ASSERT_TRUE(done);
    EXPECT_EQ(done->code, ErrorCode::none);
    EXPECT_EQ(done->sequence, 1U);

    RawClient viewer(port());
    ASSERT_TRUE(viewer.log_in());
    viewer.send(Command{1, {}, false, SetRate{}});
    const auto refused = viewer.wait_for<CommandReply>();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->code, ErrorCode::token_required);

    RawClient liar(port());
    hello.token = "guess";
    EXPECT_FALSE(liar.log_in(hello));
    EXPECT_TRUE(liar.ends());
    liar.disconnect();
    EXPECT_TRUE(ended_with(ErrorCode::token_refused, 1));
}

TEST_F(Sessions, LargeAnswersComeInPieces) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    client.send(Command{1, {}, false, ListBoxes{}});
    size_t boxes = 0;
    size_t pieces = 0;
    while (const auto list = client.wait_for<BoxList>()) {
        ++pieces;
        boxes += list->boxes.size();
        if (list->last) break;
    }
    EXPECT_EQ(boxes, 1024U);
    EXPECT_GT(pieces, 4U);
    client.send(RaysRequest{1, {1}});
    size_t rays = 0;
    while (const auto reply = client.wait_for<RaysReply>()) {
        rays += reply->rays.size();
        if (reply->last) break;
    }
    EXPECT_EQ(rays, 128U);
    client.send(RaysRequest{2, {5}});
    const auto refused = client.wait_for<CommandReply>();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->code, ErrorCode::unknown_box);
}

TEST_F(Sessions, QuestionsBeyondWhatWaitsAreAnsweredInOrder) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    constexpr uint32_t questions = 40;  // ten times what a session keeps
    for (uint32_t i = 1; i <= questions; ++i)
        client.send(SampleRequest{i, {}, std::vector<LatticePoint>(limits.sample_points)});
    for (uint32_t i = 1; i <= questions; ++i) {
        const auto reply = client.wait_for<SampleReply>();
        ASSERT_TRUE(reply) << i;
        EXPECT_EQ(reply->sequence, i);
        EXPECT_EQ(reply->samples.size(), limits.sample_points);
    }
}

TEST_F(Sessions, TerrainComesAfterTheFirstResultEachTileOnce) {
    sea.tiles = 100;  // 800 KiB of noise: far more than the credit of 64 KiB
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    const auto first = client.receive();
    ASSERT_TRUE(first && std::holds_alternative<Delta>(*first));
    client.acknowledge(std::get<Delta>(*first));
    std::set<std::pair<int32_t, int32_t>> tiles;
    while (tiles.size() < 100) {
        const auto message = client.receive();
        ASSERT_TRUE(message) << tiles.size();
        if (const auto* delta = std::get_if<Delta>(&*message)) client.acknowledge(*delta);
        if (const auto* tile = std::get_if<TerrainTiles>(&*message)) {
            ASSERT_EQ(tile->tiles.size(), 1U);
            const auto& got = tile->tiles.front();
            EXPECT_EQ(got, sea.tile(got.key));
            EXPECT_TRUE(tiles.emplace(got.key.x, got.key.z).second) << "sent twice";
        }
    }
    EXPECT_EQ(stats().terrain_tiles, 100U);
}

TEST_F(Sessions, TilesThatChangeAreSentAgainAndNoOthers) {
    sea.tiles = 20;
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    std::map<std::pair<int32_t, int32_t>, TerrainTile> tiles;
    const auto receive_tiles = [&](size_t count) {
        for (size_t got = 0; got < count;) {
            const auto message = client.receive();
            ASSERT_TRUE(message) << got;
            if (const auto* delta = std::get_if<Delta>(&*message)) client.acknowledge(*delta);
            if (const auto* tile = std::get_if<TerrainTiles>(&*message)) {
                for (const TerrainTile& one : tile->tiles) tiles[{one.key.x, one.key.z}] = one;
                ++got;
            }
        }
    };
    receive_tiles(20);
    const auto before = tiles;
    sea.changed_tiles = 3;
    change_sea();
    receive_tiles(3);
    for (const auto& [place, tile] : tiles) {
        EXPECT_EQ(tile, sea.tile(tile.key));
        EXPECT_EQ(tile == before.at(place), place.second > 0 || place.first >= 3);
    }
    // A tile that changes while the view does not call for it comes too: the client would go on showing it.
    sea.tiles = 1;
    sea.changed_tiles = 5;
    change_sea();
    receive_tiles(2);
    EXPECT_EQ(stats().terrain_tiles, 25U);
    change_sea();
    EXPECT_FALSE(client.wait_for<TerrainTiles>(milliseconds(300))) << "nothing else is out of date";
}

TEST_F(Sessions, EveryNewCommandIsADirectorsAndCountsForTheLimit) {
    limits.commands_per_second = 3;
    start();
    const std::vector<decltype(Command::action)> actions{StartShip{}, Steer{{1}, 0.0F, 1.0F},
                                                         ChangeLand{{{0, 0}, {1024, 0}}, 20.0F, 3.0F, false}};
    RawClient viewer(port());
    ASSERT_TRUE(viewer.log_in());
    RawClient director(port());
    ClientHello hello = RawClient::usual_hello();
    hello.token = "secret";
    ASSERT_TRUE(director.log_in(hello));
    uint32_t sequence = 0;
    for (const auto& action : actions) {
        ++sequence;
        viewer.send(Command{sequence, {}, false, action});
        const auto refused = viewer.wait_for<CommandReply>();
        ASSERT_TRUE(refused);
        EXPECT_EQ(refused->code, ErrorCode::token_required) << sequence;
        director.send(Command{sequence, {}, false, action});
        const auto done = director.wait_for<CommandReply>();
        ASSERT_TRUE(done);
        EXPECT_EQ(done->code, ErrorCode::none) << sequence;
        EXPECT_EQ(done->sequence, sequence);
    }
    director.send(Command{++sequence, {}, false, Steer{{1}, 0.0F, 1.0F}});
    const auto limited = director.wait_for<CommandReply>();
    ASSERT_TRUE(limited);
    EXPECT_EQ(limited->code, ErrorCode::rate_limited);
}

TEST_F(Sessions, ShutdownSaysGoodbyeWithARetryTimeToEveryone) {
    start();
    RawClient a(port());
    RawClient b(port());
    RawClient silent(port());
    ASSERT_TRUE(a.log_in() && b.log_in());
    std::promise<void> drained;
    loop.post([&] {
        listener->close();
        sessions->drain([&] { drained.set_value(); });
    });
    for (RawClient* client : {&a, &b, &silent}) {
        const auto goodbye = client->wait_for<Goodbye>();
        ASSERT_TRUE(goodbye);
        EXPECT_EQ(goodbye->code, ErrorCode::shutting_down);
        EXPECT_TRUE(goodbye->retry);
        EXPECT_GE(goodbye->retry_after_ms, 1000U);
        client->disconnect();
    }
    EXPECT_EQ(drained.get_future().wait_for(milliseconds(1500)), std::future_status::ready);
    EXPECT_THROW(RawClient{port()}, std::exception);
}

TEST_F(Sessions, ListensOnBothLoopbacks) {
    start();
    if (listener->text().find("::1") == std::string::npos) GTEST_SKIP() << "no IPv6 here";
    RawClient client(port(), 0, "::1");
    EXPECT_TRUE(client.log_in());
}

TEST(ListenerRules, RefusesWhatIsNotLoopback) {
    IoLoop loop;
    for (const char* address : {"0.0.0.0", "::", "192.168.1.1", "8.8.8.8", "example"}) {
        EXPECT_THROW(Listener(loop, {{address}, 0}, [](auto) {}), OperatorError) << address;
    }
    EXPECT_NO_THROW(Listener(loop, {{"127.0.0.2"}, 0}, [](auto) {}));
}

TEST(ListenerRules, RefusesAPortThatIsTaken) {
    IoLoop loop;
    const Listener first(loop, {}, [](auto) {});
    EXPECT_THROW(Listener(loop, {{"127.0.0.1"}, first.port()}, [](auto) {}), OperatorError);
}

}  // namespace
}  // namespace trochoid
