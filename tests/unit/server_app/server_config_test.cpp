#include "server/app/server_config.hpp"

#include <gtest/gtest.h>

#include "protocol/units/operator_error.hpp"
#include "server/world/world_state.hpp"

namespace trochoid {
namespace {

std::optional<ServerConfig> parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "trochoid-server");
    return parse_command_line(static_cast<int>(arguments.size()), arguments.data());
}

TEST(ServerConfigs, DefaultsAndEveryOption) {
    const auto plain = parse({"--scene", "a.toml"});
    ASSERT_TRUE(plain);
    ServerConfig expected;
    expected.scene = "a.toml";
    EXPECT_EQ(*plain, expected);

    const auto full = parse({"--scene", "a.toml", "--port", "0", "--bind", "127.0.0.1", "--port-file", "p",
                             "--director-token-file", "t", "--log-level", "debug", "--lead-ms", "250",
                             "--paused", "--land-mib", "64"});
    ASSERT_TRUE(full);
    EXPECT_EQ(*full, (ServerConfig{"a.toml", 0, {"127.0.0.1"}, "p", "t", "debug", 250, true, 64}));
    EXPECT_EQ(land_blocks_of(*full), (size_t{64} << 20) / land_block_bytes);
    EXPECT_EQ(land_blocks_of(*plain), usual_land_blocks);
    EXPECT_EQ(limits_of(*full).command_lead_ms, 250U);
    for (const char* part : {"a.toml", "127.0.0.1", "debug", "250 ms", "64 MiB", "paused"})
        EXPECT_NE(text_of(*full).find(part), std::string::npos) << part;
}

TEST(ServerConfigs, MistakesAreTheOperators) {
    EXPECT_THROW(parse({}), OperatorError);
    EXPECT_THROW(parse({"--scene"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--port", "70000"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--port", "-1"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--lead-ms", "10001"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--land-mib", "15"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--land-mib", "0"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--log-level", "loud"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--unknown"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "stray"}), OperatorError);
}

TEST(ServerConfigs, HelpAndVersionAreAnswered) {
    EXPECT_FALSE(parse({"--help"}));
    EXPECT_FALSE(parse({"--version"}));
}

}  // namespace
}  // namespace trochoid
