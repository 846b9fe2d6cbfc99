#include "client/net/endpoint.hpp"

#include <gtest/gtest.h>

#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

TEST(Endpoint, hosts_and_ports) {
    EXPECT_EQ(parse_endpoint("127.0.0.1:7421"), (Endpoint{"127.0.0.1", 7421}));
    EXPECT_EQ(parse_endpoint("localhost:1"), (Endpoint{"localhost", 1}));
    EXPECT_EQ(parse_endpoint("[::1]:65535"), (Endpoint{"::1", 65535}));
}

TEST(Endpoint, text_reads_back) {
    for (const Endpoint& e : {Endpoint{"127.0.0.1", 7421}, {"::1", 80}, {"sea.example", 9}})
        EXPECT_EQ(parse_endpoint(to_text(e)), e);
}

TEST(Endpoint, anything_else_names_an_example) {
    for (const char* text : {"", "7421", "127.0.0.1", "127.0.0.1:", ":7421", "a:0", "a:65536", "a:-1", "a:+1",
                             "a:7x", "a: 7", "::1:7421", "[::1]", "[]:7", "[::1:7", "a:1:2"}) {
        try {
            parse_endpoint(text);
            ADD_FAILURE() << "took '" << text << "'";
        } catch (const OperatorError& error) {
            EXPECT_NE(std::string(error.what()).find("127.0.0.1:7421"), std::string::npos) << error.what();
        }
    }
}

TEST(Endpoint, the_default_is_one) { EXPECT_EQ(parse_endpoint(default_server).host, "127.0.0.1"); }

}  // namespace
}  // namespace trochoid
