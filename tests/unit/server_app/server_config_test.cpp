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

    const auto full =
        parse({"--scene",      "a.toml", "--port",          "0",          "--bind",      "127.0.0.1",
               "--port-file",  "p",      "--token-key",     "a.pub",      "--token-key", "b.pub",
               "--ticket-key", "k",      "--viewer-tokens", "always",     "--log-level", "debug",
               "--lead-ms",    "250",    "--paused",        "--land-mib", "64"});
    ASSERT_TRUE(full);
    EXPECT_EQ(*full, (ServerConfig{"a.toml",
                                   0,
                                   {"127.0.0.1"},
                                   "p",
                                   {"a.pub", "b.pub"},
                                   "k",
                                   ViewerTokens::always,
                                   "debug",
                                   250,
                                   true,
                                   64,
                                   {}}));
    EXPECT_EQ(land_blocks_of(*full), (size_t{64} << 20) / land_block_bytes);
    EXPECT_EQ(land_blocks_of(*plain), usual_land_blocks);
    EXPECT_EQ(limits_of(*full).command_lead_ms, 250U);
    for (const char* part : {"a.toml", "127.0.0.1", "debug", "250 ms", "64 MiB", "paused", "a.pub b.pub",
                             "viewer tokens always"})
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
    EXPECT_THROW(parse({"--scene", "a", "--viewer-tokens", "sometimes"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--token-key", ""}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--unknown"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "stray"}), OperatorError);
}

TEST(ServerConfigs, TheDoor) {
    const auto plain = parse({"--scene", "a"});
    ASSERT_TRUE(plain);
    const DoorPolicy usual = policy_of(plain->door, plain->bind);
    EXPECT_EQ(usual.connections_per_address, 16U);
    EXPECT_EQ(usual.connections_per_loopback_address, 0U);
    EXPECT_EQ(usual.addresses, plain->bind);
    EXPECT_FALSE(usual.allow_plaintext);
    EXPECT_FALSE(plain->door.tls());
    EXPECT_EQ(plain->door.logins_per_address, 10U);

    const auto full =
        parse({"--scene", "a", "--tls-cert", "c", "--tls-key", "k", "--allow-plaintext", "--allow-origin",
               "https://a", "--allow-origin", "https://b", "--allow-host", "h", "--connections-per-address",
               "5", "--logins-per-address", "3", "--drain-ms", "700"});
    ASSERT_TRUE(full);
    EXPECT_EQ(full->door, (DoorOptions{"c", "k", true, {"https://a", "https://b"}, {"h"}, 5, 3, 700}));
    const DoorPolicy policy = policy_of(full->door, full->bind);
    EXPECT_EQ(policy.connections_per_address, 5U);
    EXPECT_EQ(policy.connections_per_loopback_address, 5U);
    EXPECT_TRUE(policy.origin_allowed("https://b"));
    EXPECT_TRUE(policy.host_allowed("h:1"));
    for (const char* part : {"TLS c k", "plaintext for all", "https://a https://b",
                             "connections per address 5", "logins per address 3 a second", "drain 700 ms"})
        EXPECT_NE(text_of(*full).find(part), std::string::npos) << part;

    EXPECT_THROW(parse({"--scene", "a", "--tls-cert", "c"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--tls-key", "k"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--tls-cert", "", "--tls-key", "k"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--connections-per-address", "-1"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--logins-per-address", "-1"}), OperatorError);
    EXPECT_THROW(parse({"--scene", "a", "--drain-ms", "600001"}), OperatorError);
}

TEST(ServerConfigs, HelpAndVersionAreAnswered) {
    EXPECT_FALSE(parse({"--help"}));
    EXPECT_FALSE(parse({"--version"}));
}

}  // namespace
}  // namespace trochoid
