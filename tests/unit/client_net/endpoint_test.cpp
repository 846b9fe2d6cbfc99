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

TEST(Endpoint, schemes_say_how_to_get_there) {
    EXPECT_EQ(parse_endpoint("tcp://127.0.0.1:7421"), (Endpoint{"127.0.0.1", 7421}));
    EXPECT_EQ(parse_endpoint("tls://sea.example:7421/"), (Endpoint{"sea.example", 7421, Transport::tls}));
    EXPECT_EQ(parse_endpoint("ws://[::1]:7421"), (Endpoint{"::1", 7421, Transport::ws}));
    EXPECT_EQ(parse_endpoint("WSS://sea.example:1/"), (Endpoint{"sea.example", 1, Transport::wss}));
    EXPECT_EQ(parse_endpoint("ws://sea.example"), (Endpoint{"sea.example", 80, Transport::ws}));
    EXPECT_EQ(parse_endpoint("wss://[fe80::1]/"), (Endpoint{"fe80::1", 443, Transport::wss}));
}

TEST(Endpoint, text_reads_back) {
    for (const Transport transport : {Transport::tcp, Transport::tls, Transport::ws, Transport::wss})
        for (const Endpoint& e : {Endpoint{"127.0.0.1", 7421, transport},
                                  {"::1", 80, transport},
                                  {"::1", 443, transport},
                                  {"sea.example", 9, transport}})
            EXPECT_EQ(parse_endpoint(to_text(e)), e) << to_text(e);
    EXPECT_EQ(to_text({"sea.example", 9, Transport::wss}), "wss://sea.example:9");
    EXPECT_EQ(to_text({"::1", 7421}), "[::1]:7421");
}

TEST(Endpoint, encryption_is_put_on_and_taken_off) {
    EXPECT_EQ(with_encryption({"a", 1}, true), (Endpoint{"a", 1, Transport::tls}));
    EXPECT_EQ(with_encryption({"a", 1, Transport::ws}, true), (Endpoint{"a", 1, Transport::wss}));
    EXPECT_EQ(with_encryption({"a", 1, Transport::wss, "ca.pem"}, false), (Endpoint{"a", 1, Transport::ws}));
}

TEST(Endpoint, anything_else_names_an_example) {
    for (const char* text :
         {"",           "7421",        "127.0.0.1",     "127.0.0.1:",   ":7421",       "a:0",
          "a:65536",    "a:-1",        "a:+1",          "a:7x",         "a: 7",        "::1:7421",
          "[::1]",      "[]:7",        "[::1:7",        "a:1:2",        "a:1/",        "[::1]x:7",
          "[::g]:7",    "[a]:7",       "b a:7",         "http://a:1",   "://a:1",      "tls://a",
          "tcp://a/",   "tls://[::1]", "ws://",         "ws:///",       "wss://:1",    "ws://a:1/sea",
          "ws://a:1//", "ws://a:0",    "ws://a:",       "wss://me@a:1", "wss://a:1?x", "tls:a:1",
          "tlsx://a:1", "t://a:1",     "ws://a\r\nb:1", "ws://a#b:1"}) {
        try {
            parse_endpoint(text);
            ADD_FAILURE() << "took '" << text << "'";
        } catch (const OperatorError& error) {
            EXPECT_NE(std::string(error.what()).find("127.0.0.1:7421"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("wss://"), std::string::npos) << error.what();
        }
    }
}

TEST(Endpoint, the_default_is_one) { EXPECT_EQ(parse_endpoint(default_server).host, "127.0.0.1"); }

TEST(Endpoints, TokensTravelEncryptedOrWithinThisMachine) {
    for (const char* safe : {"127.0.0.1:7421", "127.1.2.3:7421", "[::1]:7421", "localhost:7421",
                             "ws://localhost:7421", "tls://sea.example:7421", "wss://10.0.0.1"})
        EXPECT_TRUE(keeps_secrets(parse_endpoint(safe))) << safe;
    for (const char* open : {"sea.example:7421", "10.0.0.1:7421", "ws://10.0.0.1:7421",
                             "127.sea.example:7421", "localhost.example:7421", "[::2]:7421"}) {
        EXPECT_FALSE(keeps_secrets(parse_endpoint(open))) << open;
        EXPECT_THROW(require_secrecy(parse_endpoint(open)), OperatorError) << open;
    }
    EXPECT_NO_THROW(require_secrecy(parse_endpoint("127.0.0.1:7421")));
}

}  // namespace
}  // namespace trochoid
