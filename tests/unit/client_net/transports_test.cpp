#include <gtest/gtest.h>

#include "protocol/codec/codec.hpp"
#include "tests/support/net/chaos_proxy.hpp"
#include "tests/support/net/form_server.hpp"
#include "tests/support/net/raw_server.hpp"
#include "tests/support/net/test_certificate.hpp"
#include "tests/unit/client_net/dialler.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

/// The same connection over each transport.
struct TransportTest : testing::TestWithParam<Transport> {
    TestAuthority authority;
    PemFile ca{authority.certificate()};
    std::optional<FormServer> server;
    std::optional<Dialler> client;

    void SetUp() override {
        ServerForm form;
        form.tls = is_encrypted(GetParam());
        form.web = is_web(GetParam());
        const CertificateAndKey own = authority.issue();
        form.certificate = own.certificate;
        form.key = own.key;
        form.protocol = form.web ? "http/1.1" : "trochoid";
        server.emplace(form);
    }
    Endpoint endpoint(uint16_t port, const char* host = "localhost") const {
        return {host, port, GetParam(), is_encrypted(GetParam()) ? ca.path() : std::string()};
    }
    void log_in(const char* host = "localhost") {
        client.emplace(endpoint(server->port(), host));
        client->send(usual_client_hello());
        ASSERT_TRUE(server->log_in(RawServer::usual_hello()));
        ASSERT_TRUE(client->gets(1)) << client->goodbye.message;
    }
};

TEST_P(TransportTest, messages_pass_both_ways_in_order) {
    log_in();
    for (uint32_t i = 1; i <= 50; ++i) client->send(ClockRequest{i, i * 7});
    for (uint32_t i = 1; i <= 50; ++i) {
        const auto request = server->wait_for<ClockRequest>();
        ASSERT_TRUE(request);
        EXPECT_EQ(request->sequence, i);
        ClockReply reply;
        reply.sequence = i;
        ASSERT_TRUE(server->send(reply));
    }
    ASSERT_TRUE(client->gets(51));
    for (uint32_t i = 1; i <= 50; ++i) EXPECT_EQ(std::get<ClockReply>(client->messages[i]).sequence, i);
    const Traffic traffic = client->connection->traffic();
    EXPECT_EQ(traffic.frames_sent, 51U);
    EXPECT_EQ(traffic.frames_received, 51U);
}

TEST_P(TransportTest, the_handshakes_say_who_is_wanted) {
    log_in();
    if (is_encrypted(GetParam())) {
        EXPECT_EQ(server->asked_name(), "localhost");
        EXPECT_EQ(server->chosen_protocol(), is_web(GetParam()) ? "http/1.1" : "trochoid");
    }
    if (is_web(GetParam())) {
        const std::string head = server->request();
        for (const std::string& line :
             {std::string("GET / HTTP/1.1"), "Host: localhost:" + std::to_string(server->port()),
              std::string("Sec-WebSocket-Protocol: trochoid\r"), std::string("Sec-WebSocket-Version: 13")})
            EXPECT_NE(head.find(line), std::string::npos) << line << " is not in\n" << head;
        EXPECT_EQ(head.find("Extensions"), std::string::npos) << "compression was offered:\n" << head;
        EXPECT_EQ(head.find("Origin"), std::string::npos);
    }
}

TEST_P(TransportTest, an_address_in_place_of_a_name) {
    log_in("127.0.0.1");
    if (!is_encrypted(GetParam())) return;
    EXPECT_EQ(server->asked_name(), "") << "SNI is for names";
}

TEST_P(TransportTest, our_goodbye_arrives_and_the_stream_ends_properly) {
    log_in();
    client->leave();
    const auto bye = server->wait_for<Goodbye>();
    ASSERT_TRUE(bye);
    EXPECT_EQ(bye->message, "done");
    EXPECT_TRUE(server->ends_properly());
    server->hang_up();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::closed_here);
}

TEST_P(TransportTest, our_goodbye_reaches_a_server_that_is_still_talking) {
    log_in();
    client->leave();
    for (uint32_t i = 1; i < 500; ++i)
        ASSERT_TRUE(server->send(ClockReply{i, 0, 0, 0, {}, {}, {}, 0}))
            << "our goodbye was overtaken by a reset";
    const auto bye = server->wait_for<Goodbye>();
    ASSERT_TRUE(bye);
    EXPECT_EQ(bye->message, "done");
}

TEST_P(TransportTest, the_servers_goodbye_is_handed_on) {
    log_in();
    Goodbye goodbye;
    goodbye.code = ErrorCode::shutting_down;
    goodbye.message = "back soon";
    server->send(goodbye);
    server->hang_up();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::server_goodbye);
    EXPECT_EQ(client->goodbye, goodbye);
}

TEST_P(TransportTest, a_server_that_hangs_up_is_lost) {
    log_in();
    server->hang_up();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::lost);
    EXPECT_TRUE(client->says(to_text(endpoint(server->port())))) << client->goodbye.message;
}

TEST_P(TransportTest, a_message_beyond_the_limit_is_refused) {
    log_in();
    const Bytes too_long(Limits{}.frame_to_client + 1, 0);
    const Bytes its_header{1, 0x40, 0, 0, 0, 0, 0, 0};
    ASSERT_TRUE(server->send_bytes(is_web(GetParam()) ? too_long : its_header));
    const auto told = server->wait_for<Goodbye>();
    ASSERT_TRUE(told);
    EXPECT_EQ(told->code, ErrorCode::frame_too_long);
    EXPECT_EQ(told->requirement, 103U);
    EXPECT_TRUE(server->ends_properly());
    server->hang_up();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::refused_server);
}

TEST_P(TransportTest, closed_in_mid_dial) {
    RawServer silent;
    client.emplace(endpoint(silent.port()));
    ASSERT_TRUE(silent.accept());
    client->leave();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::closed_here);
    EXPECT_TRUE(silent.ends());
}

/// From the connection on: the hello's answer after 1 (raw), 2 (TLS, WebSocket), 3 (both) round trips.
TEST_P(TransportTest, no_round_trip_is_wasted) {
    constexpr int64_t one_way_us = 80'000;
    ChaosSchedule far;
    far.always.up.delay_us = far.always.down.delay_us = one_way_us;
    ChaosProxy proxy(server->port(), far);
    client.emplace(endpoint(proxy.port()));
    client->send(usual_client_hello());
    ASSERT_TRUE(server->log_in(RawServer::usual_hello()));
    ASSERT_TRUE(client->gets(1)) << client->goodbye.message;
    const int64_t took_us = client_monotonic_us() - proxy.connections().at(0).accepted_us;
    const int round_trips = 1 + (is_encrypted(GetParam()) ? 1 : 0) + (is_web(GetParam()) ? 1 : 0);
    EXPECT_GE(took_us, round_trips * 2 * one_way_us);
    EXPECT_LT(took_us, (round_trips + 1) * 2 * one_way_us) << "a round trip more, or 160 ms of computing";
}

TEST(Transports, a_listener_that_says_nothing_is_given_up) {
    const std::pair<Transport, const char*> awaited[] = {
        {Transport::tcp, "no server's hello"},
        {Transport::tls, "no TLS handshake"},
        {Transport::ws, "no answer to the WebSocket's upgrade"},
        {Transport::wss, "no TLS handshake"}};
    RawServer silent;  // connections stand before they are accepted
    std::vector<std::unique_ptr<Dialler>> clients;
    for (const auto& each : awaited)
        clients.push_back(std::make_unique<Dialler>(Endpoint{"localhost", silent.port(), each.first}));
    for (size_t i = 0; i < clients.size(); ++i) {
        ASSERT_TRUE(clients[i]->ends());
        EXPECT_TRUE(clients[i]->says("within 5 s")) << clients[i]->goodbye.message;
        EXPECT_TRUE(clients[i]->says(awaited[i].second)) << clients[i]->goodbye.message;
    }
}

INSTANTIATE_TEST_SUITE_P(Each, TransportTest,
                         testing::Values(Transport::tcp, Transport::tls, Transport::ws, Transport::wss),
                         [](const testing::TestParamInfo<Transport>& each) {
                             const std::string text = to_text({"h", 1, each.param});
                             return each.param == Transport::tcp ? "tcp" : text.substr(0, text.find(':'));
                         });

}  // namespace
}  // namespace trochoid
