#include "client/net/connection.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"
#include "tests/support/net/raw_server.hpp"
#include "tests/unit/client_net/dialler.hpp"

namespace trochoid {
namespace {

/// Both hellos exchanged.
struct ConnectionTest : testing::Test {
    RawServer server;
    std::optional<Dialler> client;
    void log_in() {
        client.emplace(Endpoint{"127.0.0.1", server.port()});
        client->send(usual_client_hello());
        ASSERT_TRUE(server.log_in());
        ASSERT_TRUE(client->gets(1));
    }
};

TEST_F(ConnectionTest, what_is_sent_before_it_stands_arrives_after_the_magic) {
    client.emplace(Endpoint{"127.0.0.1", server.port()});
    client->send(usual_client_hello());
    client->send(ClockRequest{1, 77});
    ASSERT_TRUE(server.log_in());
    const auto request = server.wait_for<ClockRequest>();
    ASSERT_TRUE(request);
    EXPECT_EQ(request->client_sent_us, 77);
    EXPECT_TRUE(client->wait([this] { return client->connected; }));
}

TEST_F(ConnectionTest, messages_arrive_however_the_stream_is_cut) {
    log_in();
    ClockReply reply;
    Bytes stream;
    for (uint32_t i = 1; i <= 20; ++i) {
        reply.sequence = i;
        const Bytes framed = frame(encode(ServerMessage(reply)));
        stream.insert(stream.end(), framed.begin(), framed.end());
    }
    size_t at = 0;
    for (size_t step = 1; at < stream.size(); step = step * 5 % 97 + 1) {
        const size_t count = std::min(step, stream.size() - at);
        ASSERT_TRUE(server.send_bytes(std::span(stream).subspan(at, count)));
        at += count;
    }
    ASSERT_TRUE(client->gets(21));
    for (uint32_t i = 1; i <= 20; ++i) EXPECT_EQ(std::get<ClockReply>(client->messages[i]).sequence, i);
}

TEST_F(ConnectionTest, traffic_counts_all_bytes_of_both_directions) {
    log_in();
    const Traffic traffic = client->connection->traffic();
    ServerHello answered = RawServer::usual_hello();
    EXPECT_EQ(traffic.bytes_received, frame(encode(ServerMessage(answered))).size());
    EXPECT_EQ(traffic.bytes_sent,
              stream_magic.size() + frame(encode(ClientMessage(usual_client_hello()))).size());
    EXPECT_EQ(traffic.frames_received, 1U);
    EXPECT_EQ(traffic.frames_sent, 1U);
}

TEST_F(ConnectionTest, the_servers_goodbye_is_handed_on) {
    log_in();
    Goodbye goodbye;
    goodbye.code = ErrorCode::shutting_down;
    goodbye.message = "back soon";
    goodbye.retry = true;
    goodbye.retry_after_ms = 1234;
    server.send(goodbye);
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::server_goodbye);
    EXPECT_EQ(client->goodbye, goodbye);
}

TEST_F(ConnectionTest, our_goodbye_reaches_a_server_that_is_still_talking) {
    log_in();
    client->loop.post([this] {
        Goodbye bye;
        bye.message = "done";
        client->connection->close(bye);
        client->connection->send(ClockRequest{9, 9});  // nothing follows a goodbye
    });
    for (uint32_t i = 1; i < 50; ++i) server.send(ClockReply{i, 0, 0, 0, {}, {}, {}, 0});
    const auto bye = server.receive();
    ASSERT_TRUE(bye);
    ASSERT_TRUE(std::holds_alternative<Goodbye>(*bye));
    EXPECT_EQ(std::get<Goodbye>(*bye).message, "done");
    EXPECT_TRUE(server.ends());
    server.hang_up();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::closed_here);
}

TEST_F(ConnectionTest, a_server_that_never_closes_does_not_hold_us) {
    log_in();
    const auto begin = std::chrono::steady_clock::now();
    client->loop.post([this] { client->connection->close({}); });
    ASSERT_TRUE(client->ends());
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
}

TEST_F(ConnectionTest, every_breach_is_answered_with_its_code) {
    const Bytes reply = encode(ServerMessage(ClockReply{}));
    Bytes too_long{0, 0, 0, 1, 0, 0, 0, 0};
    Bytes malformed{8, 0, 0, 0, 1, 0, 0, 0};
    Bytes noise(64, 0x5a);
    Bytes named_noise = noise;
    std::copy_n(reply.begin() + 4, 4, named_noise.begin() + 4);  // the file identifier
    Bytes trailing = reply;
    trailing.insert(trailing.end(), 8, 0);
    const std::pair<Bytes, ErrorCode> breaches[] = {
        {too_long, ErrorCode::frame_too_long},
        {malformed, ErrorCode::malformed_frame},
        {frame(noise), ErrorCode::unknown_message},
        {frame(named_noise), ErrorCode::verification_failed},
        {frame(trailing), ErrorCode::trailing_bytes},
        {frame(encode(ServerMessage(RawServer::usual_hello()))), ErrorCode::unexpected_message},
    };
    for (const auto& [bytes, code] : breaches) {
        log_in();
        ASSERT_TRUE(server.send_bytes(bytes));
        const auto goodbye = server.wait_for<Goodbye>();
        ASSERT_TRUE(goodbye) << static_cast<unsigned>(code);
        EXPECT_EQ(goodbye->code, code) << goodbye->message;
        EXPECT_NE(goodbye->requirement, 0U);
        server.hang_up();
        ASSERT_TRUE(client->ends());
        EXPECT_EQ(client->cause, CloseCause::refused_server);
        EXPECT_EQ(client->closed_count, 1);
        client.reset();
    }
}

TEST_F(ConnectionTest, another_program_on_the_port_is_named_as_such) {
    client.emplace(Endpoint{"127.0.0.1", server.port()});
    client->send(usual_client_hello());
    ASSERT_TRUE(server.accept());
    const std::string http = "HTTP/1.1 400 Bad Request\r\n\r\n";
    server.send_bytes({reinterpret_cast<const uint8_t*>(http.data()), http.size()});
    server.receive();
    server.hang_up();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::refused_server);
    EXPECT_TRUE(client->says("does not speak Trochoid's protocol")) << client->goodbye.message;
}

TEST_F(ConnectionTest, a_lost_server_is_lost_once) {
    log_in();
    server.hang_up();
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::lost);
    EXPECT_TRUE(client->goodbye.retry);
    EXPECT_EQ(client->closed_count, 1);
}

TEST(Connection, nobody_listens) {
    RawServer server;
    const uint16_t port = server.port();
    server.stop_listening();
    Dialler client(Endpoint{"127.0.0.1", port});
    ASSERT_TRUE(client.ends());
    EXPECT_EQ(client.cause, CloseCause::lost);
    EXPECT_EQ(client.goodbye.message, "nothing listens at 127.0.0.1:" + std::to_string(port) +
                                          ": start trochoid-server or check --connect");
}

TEST(Connection, no_such_host) {
    Dialler client(Endpoint{"999.1.1.1.invalid", 7421});
    ASSERT_TRUE(client.ends());
    EXPECT_EQ(client.cause, CloseCause::lost);
    EXPECT_TRUE(client.says("check --connect")) << client.goodbye.message;
}

TEST(Connection, a_silent_listener_is_given_up) {
    RawServer server;
    Dialler client(Endpoint{"127.0.0.1", server.port()});
    ASSERT_TRUE(server.accept());
    ASSERT_TRUE(client.ends());
    EXPECT_TRUE(client.says("within 5 s")) << client.goodbye.message;
}

TEST(Connection, closed_before_it_stands) {
    RawServer server;
    Dialler client(Endpoint{"127.0.0.1", server.port()});
    client.loop.post([&client] { client.connection->close({}); });
    ASSERT_TRUE(client.ends());
    EXPECT_EQ(client.cause, CloseCause::closed_here);
}

TEST(NetLoop, runs_in_order_and_forgets_after_stop) {
    std::vector<int> order;
    std::mutex mutex;
    std::condition_variable news;
    NetLoop loop;
    for (int i = 0; i < 100; ++i)
        loop.post([&, i] {
            loop.assert_here();
            const std::lock_guard lock(mutex);
            order.push_back(i);
            news.notify_all();
        });
    {
        std::unique_lock lock(mutex);
        ASSERT_TRUE(news.wait_for(lock, std::chrono::seconds(5), [&] { return order.size() == 100; }));
    }
    for (int i = 0; i < 100; ++i) EXPECT_EQ(order[static_cast<size_t>(i)], i);
    loop.after(std::chrono::milliseconds(20), [&] { order.push_back(-1); });
    loop.stop();
    loop.post([&] { order.push_back(-2); });
    EXPECT_EQ(order.back(), 99);
}

}  // namespace
}  // namespace trochoid
