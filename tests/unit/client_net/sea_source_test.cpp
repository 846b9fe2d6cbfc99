#include "client/app/session_sea_source.hpp"

#include <gtest/gtest.h>

#include "tests/support/net/raw_server.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

WaveTrainBox box_one() {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    WaveTrain train;
    train.kx = 40018;
    train.omega = 1613943558211ULL;
    train.amplitude = 1.0F;
    train.choppiness = 0.5F;
    box.trains = {train};
    return box;
}

TEST(SessionSeaSource, the_viewer_sees_what_the_session_knows) {
    RawServer server;
    SessionOptions options;
    options.server = {"127.0.0.1", server.port()};
    SessionSeaSource source(options);
    EXPECT_EQ(source.snapshot().state, nullptr);
    TerrainGrid grid;
    grid.columns = grid.rows = 65;
    grid.heights.assign(65 * 65, 7);
    ServerHello hello = RawServer::usual_hello();
    hello.terrain = {0, 0, grid.spacing_log2, 65, 65, grid.height_step_log2, grid.open_sea_depth};
    ASSERT_TRUE(server.log_in(hello));
    Delta d;
    d.result = 1;
    d.last = true;
    d.change.boxes = {std::make_shared<const WaveTrainBox>(box_one())};
    InterestState told;
    apply(told, d.change);
    d.state_hash = hash_of(told);
    d.key.error_in_force_px = 1.5F;
    d.key.until = {1};
    server.send(d);
    server.send(TerrainTiles{{make_tile(grid, {0, 0, 0})}});
    ASSERT_TRUE(source.session().wait_until([&] { return !source.session().snapshot()->tiles->empty(); },
                                            milliseconds(5000)));
    const SceneInput first = source.snapshot();
    ASSERT_NE(first.state, nullptr);
    EXPECT_EQ(first.state->boxes.size(), 1U);
    EXPECT_EQ(first.tiles.size(), 1U);
    EXPECT_EQ(first.terrain.columns, 65U);
    EXPECT_TRUE(first.statistics.connected);
    EXPECT_EQ(first.statistics.error_in_force_px, 1.5F);
    EXPECT_EQ(first.statistics.server_version, "raw server");
    const SceneInput second = source.snapshot();
    EXPECT_EQ(first.state, second.state) << "what did not change keeps its pointer";
    EXPECT_EQ(first.tiles, second.tiles);

    source.request_rays({1});
    source.request_rays({1});
    const auto asked = server.wait_for<RaysRequest>();
    ASSERT_TRUE(asked);
    EXPECT_FALSE(server.wait_for<RaysRequest>(milliseconds(300))) << "asked twice";
    RaysReply reply;
    reply.sequence = asked->sequence;
    reply.box = {1};
    reply.rays = {{{0, 0}, {1024, 0}, {{{5, 0}, ActionKind::blocked}}}};
    server.send(reply);
    for (int i = 0; i < 200 && source.snapshot().rays.empty(); ++i)
        source.session().wait_until([] { return false; }, milliseconds(10));
    EXPECT_EQ(source.snapshot().rays, reply.rays);
    // The box goes, and its rays with it.
    Delta gone;
    gone.result = 2;
    gone.base = 1;
    gone.base_hash = d.state_hash;
    gone.last = true;
    gone.change.removed_boxes = {{1}};
    gone.state_hash = hash_of(InterestState{});
    gone.key = d.key;
    server.send(gone);
    ASSERT_TRUE(source.session().wait_until([&] { return source.session().snapshot()->result == 2; },
                                            milliseconds(5000)));
    EXPECT_TRUE(source.snapshot().rays.empty());
}

}  // namespace
}  // namespace trochoid
