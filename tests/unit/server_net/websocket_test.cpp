#include "protocol/codec/codec.hpp"
#include "protocol/wire/requirements.hpp"
#include "tests/support/net/raw_client.hpp"
#include "tests/unit/server_net/door_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

class WebSockets : public DoorFixture {
protected:
    unsigned refused_with(const UpgradeWish& wish) {
        FormClient client(Form::web, port());
        EXPECT_FALSE(client.open(wish));
        return status_of(client.answer());
    }
    static bool send(FormClient& client, const WebFrame& frame) {
        return client.pipe().write(std::span<const uint8_t>(frame.bytes()));
    }
    // A goodbye, then the close frame, then the end of the stream; and the server has counted it.
    void expect_end(FormClient& client, ErrorCode code, unsigned close_code) {
        const auto goodbye = client.wait_for<Goodbye>();
        ASSERT_TRUE(goodbye) << "close code " << client.close_code();
        EXPECT_EQ(goodbye->code, code) << goodbye->message;
        EXPECT_TRUE(client.ends());
        EXPECT_EQ(client.close_code(), close_code);
        EXPECT_TRUE(ended_with(code));
    }
};

TEST_F(WebSockets, UpgradesThatAreRefusedSayWhy) {
    start();
    UpgradeWish wish;
    wish.origin = "https://evil.example";
    EXPECT_EQ(refused_with(wish), 403U);
    wish.origin = "null";
    EXPECT_EQ(refused_with(wish), 403U);
    wish = {};
    wish.host = "evil.example";
    EXPECT_EQ(refused_with(wish), 403U);
    wish.host = "";
    EXPECT_EQ(refused_with(wish), 400U);
    wish = {};
    wish.subprotocol = "";
    EXPECT_EQ(refused_with(wish), 400U);
    wish.subprotocol = "chat, trochoid2";
    EXPECT_EQ(refused_with(wish), 400U);
    wish = {};
    wish.version = "8";
    EXPECT_EQ(refused_with(wish), 426U);
    wish.version = "";
    EXPECT_EQ(refused_with(wish), 426U);
    wish = {};
    wish.key = "short";
    EXPECT_EQ(refused_with(wish), 400U);
    wish = {};
    wish.target = "/livez/ws";
    EXPECT_EQ(refused_with(wish), 404U);
    EXPECT_EQ(door().websocket, 0U);
    EXPECT_TRUE(stats().ended.empty());
}

TEST_F(WebSockets, UpgradesThatAreTaken) {
    policy.origins = {"https://sea.example"};
    policy.hosts = {"sea.example"};
    start();
    UpgradeWish wish;
    wish.subprotocol = "chat, trochoid";
    wish.further = "Sec-WebSocket-Extensions: permessage-deflate\r\n";
    for (const char* origin : {"", "http://localhost:8000", "https://sea.example"}) {
        wish.origin = origin;
        wish.host = *origin == 'h' && wish.host == "localhost" ? "sea.example:443" : "localhost";
        FormClient client(Form::web, port());
        ASSERT_TRUE(client.open(wish)) << client.answer();
        EXPECT_NE(client.answer().find("Sec-WebSocket-Protocol: trochoid\r\n"), std::string::npos);
        EXPECT_NE(client.answer().find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"),
                  std::string::npos);
        EXPECT_EQ(client.answer().find("deflate"), std::string::npos);
        client.send(RawClient::usual_hello());
        EXPECT_TRUE(client.wait_for<ServerHello>());
    }
}

TEST_F(WebSockets, FirstMessageRightBehindTheUpgrade) {
    start();
    WebFrame hello;
    hello.payload = encode(RawClient::usual_hello());
    const Bytes bytes = hello.bytes();
    UpgradeWish wish;
    FormClient client(Form::web, port());
    const std::string both = wish.text() + std::string(bytes.begin(), bytes.end());
    client.pipe().write(both.substr(0, both.size() - 5));
    std::this_thread::sleep_for(milliseconds(20));
    client.pipe().write(both.substr(both.size() - 5));
    EXPECT_TRUE(eventually([&] { return stats().sessions_started == 1; }));
}

TEST_F(WebSockets, FragmentsAndPingsBetweenThem) {
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.open());
    const Bytes hello = encode(RawClient::usual_hello());
    WebFrame piece;
    piece.last = false;
    piece.payload.assign(hello.begin(), hello.begin() + 10);
    send(client, piece);
    WebFrame ping;
    ping.opcode = 9;
    ping.payload = {1, 2, 3};
    send(client, ping);
    piece.opcode = 0;
    piece.payload.clear();
    send(client, piece);  // an empty fragment
    piece.last = true;
    piece.payload.assign(hello.begin() + 10, hello.end());
    send(client, piece);
    EXPECT_TRUE(client.wait_for<ServerHello>());
    ASSERT_EQ(client.pongs().size(), 1U);
    EXPECT_EQ(client.pongs()[0], ping.payload);
}

// A message in crumbs, fragments of nothing, pings: all within the length that is allowed.
TEST_F(WebSockets, FloodsOfFragmentsAndPingsEndIt) {
    start();
    for (const bool logged_in : {false, true}) {
        for (const int kind : {0, 1, 2}) {
            FormClient client(Form::web, port());
            ASSERT_TRUE(logged_in ? client.log_in().has_value() : client.open());
            Bytes flood;
            for (int i = 0; i < 1000; ++i) {
                WebFrame piece;
                piece.opcode = kind == 2 ? 9 : i == 0 ? 2 : 0;
                piece.last = kind == 2;
                if (kind == 0) piece.payload = {1};
                const Bytes bytes = piece.bytes();
                flood.insert(flood.end(), bytes.begin(), bytes.end());
            }
            client.pipe().write(std::span<const uint8_t>(flood));
            const auto goodbye = client.wait_for<Goodbye>();
            ASSERT_TRUE(goodbye) << kind << " close code " << client.close_code();
            EXPECT_EQ(goodbye->code, ErrorCode::rate_limited);
            EXPECT_EQ(goodbye->requirement, requirement::websocket);
            EXPECT_EQ(client.close_code() == 0 ? (client.ends(), client.close_code()) : client.close_code(),
                      4402U);
            EXPECT_EQ(client.close_reason(), "trochoid 402 resource");
        }
    }
    EXPECT_TRUE(ended_with(ErrorCode::rate_limited, 6));
}

TEST_F(WebSockets, AMessageInOrdinaryFragmentsIsWhole) {
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.open());
    const Bytes hello = encode(RawClient::usual_hello());
    for (size_t i = 0; i < hello.size(); ++i) {
        WebFrame piece;
        piece.opcode = i == 0 ? 2 : 0;
        piece.last = i + 1 == hello.size() || i == 200;
        piece.payload = {hello[i]};
        if (i == 200) piece.payload.assign(hello.begin() + 200, hello.end());
        send(client, piece);
        if (i == 200) break;
    }
    EXPECT_TRUE(client.wait_for<ServerHello>());
}

TEST_F(WebSockets, ATextMessageEndsIt) {
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.log_in());
    WebFrame text;
    text.opcode = 1;
    text.payload = {'h', 'i'};
    send(client, text);
    const auto goodbye = client.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::malformed_frame);
    EXPECT_EQ(goodbye->requirement, requirement::websocket);
    EXPECT_TRUE(client.ends());
    EXPECT_EQ(client.close_code(), 1003U);
    EXPECT_TRUE(ended_with(ErrorCode::malformed_frame));
}

TEST_F(WebSockets, AnEmptyMessageEndsIt) {
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.open());
    send(client, {});
    expect_end(client, ErrorCode::malformed_frame, 4102);
}

TEST_F(WebSockets, TheLimitBeforeLoginHoldsForOneFrameAndForMany) {
    start();
    {
        FormClient client(Form::web, port());
        ASSERT_TRUE(client.open());
        WebFrame large;
        large.payload.assign(limits.frame_before_login + 1, 7);
        send(client, large);
        expect_end(client, ErrorCode::frame_too_long, 1009);
    }
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.open());
    WebFrame piece;
    piece.last = false;
    piece.payload.assign(1000, 7);
    for (int i = 0; i < 4; ++i) {
        send(client, piece);
        piece.opcode = 0;
    }
    EXPECT_FALSE(client.receive(milliseconds(100)));
    EXPECT_EQ(client.close_code(), 0U);
    send(client, piece);
    EXPECT_EQ(goodbye_to(client), ErrorCode::frame_too_long);
    EXPECT_TRUE(client.ends());
    EXPECT_EQ(client.close_code(), 1009U);
}

TEST_F(WebSockets, AnAnnouncedLengthAllocatesNothing) {
    limits.hello_deadline_ms = 400;
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.open());
    WebFrame huge;
    Bytes begin{0x82, 0xff, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6};  // 4 GiB announced, 2 bytes sent
    client.pipe().write(std::span<const uint8_t>(begin));
    EXPECT_EQ(goodbye_to(client), ErrorCode::hello_deadline);
    EXPECT_TRUE(client.ends());
}

TEST_F(WebSockets, TheLimitAfterLoginIsTheOneOfTheHello) {
    start();
    {
        FormClient client(Form::web_tls, port());
        ASSERT_TRUE(client.log_in());
        WebFrame fitting;
        fitting.payload.assign(limits.frame_after_login, 0xa5);
        send(client, fitting);
        expect_end(client, ErrorCode::unknown_message, 4105);
    }
    FormClient client(Form::web_tls, port());
    ASSERT_TRUE(client.log_in());
    WebFrame large;
    large.payload.assign(limits.frame_after_login + 1, 0xa5);
    send(client, large);
    expect_end(client, ErrorCode::frame_too_long, 1009);
}

// What breaks WebSocket itself is answered by its close frame at once: no goodbye, but a code in the books.
TEST_F(WebSockets, BrokenFramesEndWithAProtocolError) {
    start();
    std::vector<WebFrame> broken(5);
    broken[0].masked = false;
    broken[1].reserved = 4;
    broken[2].opcode = 3;
    broken[3].opcode = 0;  // goes on with nothing
    broken[4].opcode = 9;
    broken[4].last = false;  // a ping in pieces
    uint64_t count = 0;
    for (WebFrame& frame : broken) {
        frame.payload = {1, 2, 3, 4};
        FormClient client(Form::web, port());
        ASSERT_TRUE(client.log_in());
        send(client, frame);
        EXPECT_FALSE(client.wait_for<Goodbye>());
        EXPECT_EQ(client.close_code(), 1002U);
        EXPECT_TRUE(client.ends());
        EXPECT_TRUE(ended_with(ErrorCode::malformed_frame, ++count));
    }
}

TEST_F(WebSockets, TheClientsCloseIsAnswered) {
    start();
    FormClient client(Form::web_tls, port());
    ASSERT_TRUE(client.log_in());
    WebFrame close;
    close.opcode = 8;
    close.payload = {0x03, 0xe8};
    send(client, close);
    EXPECT_TRUE(client.ends());
    EXPECT_EQ(client.close_code(), 1000U);
    EXPECT_TRUE(ended_with(ErrorCode::client_closed));
}

TEST_F(WebSockets, AGoodbyeOfTheClientEndsIt) {
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.log_in());
    client.send(Goodbye{});
    EXPECT_TRUE(ended_with(ErrorCode::client_closed));
    EXPECT_TRUE(eventually([&] { return stats().sessions_now == 0; }));
}

TEST_F(WebSockets, CutInTheMiddleOfAMessage) {
    start();
    {
        FormClient client(Form::web, port());
        ASSERT_TRUE(client.log_in());
        WebFrame binary;
        binary.payload.assign(100, 1);
        Bytes bytes = binary.bytes();
        bytes.resize(50);
        client.pipe().write(std::span<const uint8_t>(bytes));
    }
    EXPECT_TRUE(ended_with(ErrorCode::client_closed));
    EXPECT_TRUE(eventually([&] { return stats().sessions_now == 0; }));
}

TEST_F(WebSockets, PingsAloneDoNotKeepASessionAlive) {
    limits.no_progress_ms = 400;
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.log_in());
    const auto until = std::chrono::steady_clock::now() + milliseconds(3000);
    std::optional<Goodbye> goodbye;
    while (!goodbye && std::chrono::steady_clock::now() < until) {
        WebFrame ping;
        ping.opcode = 9;
        send(client, ping);
        goodbye = client.wait_for<Goodbye>(milliseconds(30));
    }
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::no_progress);
}

// A close frame that is never answered, a write that waits for ever: the place of its address is free again all the same.
TEST_F(WebSockets, WhoSaysNoMoreLeavesItsPlace) {
    policy.connections_per_loopback_address = 3;
    limits.hello_deadline_ms = 300;
    start();
    const auto all_gone = [&] {
        return eventually([&] { return door().guests_now == 0 && stats().sessions_now == 0; });
    };
    for (const bool in : {false, true}) {
        std::vector<std::unique_ptr<FormClient>> silent;
        for (int i = 0; i < 3; ++i) {
            silent.push_back(std::make_unique<FormClient>(Form::web, port()));
            if (in) {
                ASSERT_TRUE(silent.back()->log_in()) << "the places of those before are not free";
                silent.back()->send(RawClient::usual_hello());
            } else {
                ASSERT_TRUE(silent.back()->open());
            }
        }
        ASSERT_TRUE(all_gone());
    }
    FormClient good(Form::web, port());
    EXPECT_TRUE(good.log_in());
}

}  // namespace
}  // namespace trochoid
