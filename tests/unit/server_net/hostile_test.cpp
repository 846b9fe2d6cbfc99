#include <chrono>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"
#include "protocol/wire/requirements.hpp"
#include "tests/unit/server_net/server_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

class HostilePeers : public ServerFixture {
protected:
    // The goodbye comes with its code, the stream ends, and the server has counted it.
    void expect_goodbye(RawClient& client, ErrorCode code, uint16_t broken) {
        const auto goodbye = client.wait_for<Goodbye>();
        ASSERT_TRUE(goodbye) << (client.closed() ? "closed without a word" : "still connected");
        EXPECT_EQ(goodbye->code, code) << goodbye->message;
        EXPECT_EQ(goodbye->requirement, broken);
        EXPECT_FALSE(goodbye->message.empty());
        EXPECT_TRUE(client.ends());
        client.disconnect();
        for (int i = 0; i < 50 && stats().sessions_now > 0; ++i)
            std::this_thread::sleep_for(milliseconds(10));
        EXPECT_EQ(stats().ended[code], 1U);
        RawClient other(port());  // and others are served on
        EXPECT_TRUE(other.log_in());
    }
};

TEST_F(HostilePeers, NothingSentMeetsTheHelloDeadline) {
    limits.hello_deadline_ms = 200;
    start();
    RawClient client(port());
    const auto begun = std::chrono::steady_clock::now();
    expect_goodbye(client, ErrorCode::hello_deadline, requirement::hello_deadline);
    EXPECT_GE(std::chrono::steady_clock::now() - begun, milliseconds(190));
}

TEST_F(HostilePeers, DrippingBytesDoNotMoveTheHelloDeadline) {
    limits.hello_deadline_ms = 300;
    start();
    RawClient client(port());
    client.send_magic();
    const auto until = std::chrono::steady_clock::now() + milliseconds(3000);
    const Bytes hello = frame(encode(RawClient::usual_hello()));
    size_t sent = 0;
    while (!client.closed() && std::chrono::steady_clock::now() < until && sent + 1 < hello.size()) {
        client.send_bytes(std::span(hello).subspan(sent++, 1));
        if (client.receive(milliseconds(50))) break;
    }
    EXPECT_LT(std::chrono::steady_clock::now(), until);
    EXPECT_EQ(stats().ended.size() + stats().sessions_now, 1U);
    EXPECT_EQ(stats().sessions_started, 0U);
}

TEST_F(HostilePeers, WrongMagic) {
    start();
    RawClient client(port());
    const std::string request = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
    client.send_bytes({reinterpret_cast<const uint8_t*>(request.data()), request.size()});
    expect_goodbye(client, ErrorCode::wrong_magic, requirement::magic);
}

TEST_F(HostilePeers, FrameBeyondTheLimitBeforeLogin) {
    start();
    RawClient client(port());
    client.send_magic();
    client.send_bytes(frame_header(limits.frame_before_login + 1));
    expect_goodbye(client, ErrorCode::frame_too_long, requirement::frame_length);
}

TEST_F(HostilePeers, FrameBeyondTheLimitAfterLogin) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    client.send_bytes(frame_header(limits.frame_after_login + 1));
    expect_goodbye(client, ErrorCode::frame_too_long, requirement::frame_length);
}

TEST_F(HostilePeers, RandomBytesInAFrame) {
    start();
    RawClient client(port());
    client.send_magic();
    client.send_bytes(frame(Bytes(100, 0xa5)));
    expect_goodbye(client, ErrorCode::unknown_message, requirement::file_identifier);
}

TEST_F(HostilePeers, TrailingBytes) {
    start();
    RawClient client(port());
    client.send_magic();
    Bytes hello = encode(RawClient::usual_hello());
    hello.insert(hello.end(), 8, 0);
    client.send_bytes(frame(hello));
    expect_goodbye(client, ErrorCode::trailing_bytes, requirement::size_field);
}

TEST_F(HostilePeers, SecondHello) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    client.send(RawClient::usual_hello());
    expect_goodbye(client, ErrorCode::unexpected_message, requirement::hello_first);
}

TEST_F(HostilePeers, MessageBeforeTheHello) {
    start();
    RawClient client(port());
    client.send_magic();
    client.send(ClockRequest{1, 0});
    expect_goodbye(client, ErrorCode::unexpected_message, requirement::hello_first);
}

TEST_F(HostilePeers, OtherProtocolOtherModelOtherWorld) {
    start();
    const auto refused_with = [this](const ClientHello& hello) {
        RawClient client(port());
        client.send_magic();
        client.send(hello);
        const auto goodbye = client.wait_for<Goodbye>(milliseconds(500));
        return goodbye ? goodbye->code : ErrorCode::none;
    };
    ClientHello hello = RawClient::usual_hello();
    hello.protocol_min = hello.protocol_max = 999;
    EXPECT_EQ(refused_with(hello), ErrorCode::protocol_version);
    hello = RawClient::usual_hello();
    hello.model = 999;
    EXPECT_EQ(refused_with(hello), ErrorCode::model_version);
    hello = RawClient::usual_hello();
    hello.world = "atlantis";
    EXPECT_EQ(refused_with(hello), ErrorCode::wrong_world);
    hello.world = "fake";
    EXPECT_EQ(refused_with(hello), ErrorCode::none);
}

TEST_F(HostilePeers, TooManyOrTooLargeRegions) {
    limits.sync_regions = 2;
    start();
    RawClient many(port());
    ASSERT_TRUE(many.log_in());
    many.send(SyncRegions{1, std::vector<SyncRegion>(3, SyncRegion{{0, 0}, 1024})});
    const auto goodbye = many.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::too_many_regions);
    EXPECT_EQ(goodbye->offending_sequence, 1U);
    RawClient large(port());
    ASSERT_TRUE(large.log_in());
    large.send(SyncRegions{9, {SyncRegion{{0, 0}, limits.sync_radius + 1}}});
    const auto second = large.wait_for<Goodbye>();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->code, ErrorCode::region_too_large);
}

TEST_F(HostilePeers, ViewFlood) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    for (uint32_t i = 1; i <= limits.views_per_second + 60; ++i)
        if (!client.send(ViewUpdate{i, RawClient::usual_hello().view})) break;
    expect_goodbye(client, ErrorCode::rate_limited, requirement::message_rates);
}

TEST_F(HostilePeers, SequenceThatStepsBack) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    client.send(ViewUpdate{5, RawClient::usual_hello().view});
    client.send(ViewUpdate{5, RawClient::usual_hello().view});
    expect_goodbye(client, ErrorCode::sequence_not_monotone, requirement::ascending_sequence);
}

TEST_F(HostilePeers, AckOfAResultNeverWritten) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    client.send(Ack{1000, 0, 0, {}});
    expect_goodbye(client, ErrorCode::value_out_of_range, requirement::whole_results);
}

TEST_F(HostilePeers, CommandFloodIsRefusedNotDisconnected) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    for (uint32_t i = 1; i <= 30; ++i) client.send(Command{i, {}, false, SetRate{}});
    size_t limited = 0;
    for (int i = 0; i < 30; ++i) {
        const auto reply = client.wait_for<CommandReply>();
        ASSERT_TRUE(reply);
        limited += reply->code == ErrorCode::rate_limited ? 1U : 0U;
    }
    EXPECT_GE(limited, 8U);
}

TEST_F(HostilePeers, SessionsBeyondTheLimit) {
    limits.sessions = 1;
    start();
    RawClient first(port());
    ASSERT_TRUE(first.log_in());
    RawClient second(port());
    const auto goodbye = second.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::too_many_sessions);
    EXPECT_TRUE(goodbye->retry);
}

TEST_F(HostilePeers, CutAtEveryByteOfAHello) {
    start();
    Bytes bytes(stream_magic.begin(), stream_magic.end());
    const Bytes hello = frame(encode(RawClient::usual_hello()));
    bytes.insert(bytes.end(), hello.begin(), hello.end());
    for (size_t length = 0; length < bytes.size(); ++length) {
        RawClient client(port());
        client.send_bytes(std::span(bytes).first(length));
    }
    RawClient good(port());
    EXPECT_TRUE(good.log_in());
    for (int i = 0; i < 100 && stats().sessions_now > 1; ++i) std::this_thread::sleep_for(milliseconds(10));
    EXPECT_EQ(stats().sessions_now, 1U);
    EXPECT_EQ(stats().sessions_started, 1U);
}

}  // namespace
}  // namespace trochoid
