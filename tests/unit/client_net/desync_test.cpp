// A wrong train between a real session and a real client: found, told, counted on both sides, healed.
#include <gtest/gtest.h>

#include "client/app/ocean_session.hpp"
#include "tests/unit/client_net/lying_server.hpp"

namespace trochoid {
namespace {

TEST(BothSides, FindAndHealAWrongTrain) {
    LyingServer server;
    SessionOptions options;
    options.server = {"127.0.0.1", server.port()};
    options.software = "test 1";
    OceanSession session(options);
    const auto healed = [&] {
        return session.statistics().store.desyncs == 1 &&
               hash_of(*session.snapshot()->interest) == server.right_hash();
    };
    EXPECT_TRUE(session.wait_until(healed, std::chrono::milliseconds(8000)));
    EXPECT_EQ(server.desyncs_of_trains(), 1U);
    EXPECT_EQ(server.resyncs(), 0U) << "hashes agreed all the time";
    const SessionStatistics s = session.statistics();
    EXPECT_EQ(s.store.resyncs, 0U);
    EXPECT_EQ(s.connections, 1U) << "in the same session";
    EXPECT_EQ(s.store.probed, 4U);
}

}  // namespace
}  // namespace trochoid
