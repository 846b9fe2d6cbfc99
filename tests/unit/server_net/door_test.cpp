#include <array>

#include "protocol/codec/codec.hpp"
#include "protocol/units/hash.hpp"
#include "tests/support/net/raw_client.hpp"
#include "tests/unit/server_net/door_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;
constexpr Form all_forms[] = {Form::raw, Form::tls, Form::web, Form::web_tls};

StreamForm form_of_text(const std::string& text) {
    return form_of(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

TEST(FirstBytes, TellFormsApart) {
    EXPECT_EQ(form_of_text(""), StreamForm::undecided);
    EXPECT_EQ(form_of_text("\x16"), StreamForm::tls);
    EXPECT_EQ(form_of_text("T"), StreamForm::undecided);
    EXPECT_EQ(form_of_text("TR"), StreamForm::undecided);
    EXPECT_EQ(form_of_text("TRO"), StreamForm::raw);
    EXPECT_EQ(form_of_text("TRACE / HTTP/1.1"), StreamForm::http);
    EXPECT_EQ(form_of_text("TX"), StreamForm::http);
    EXPECT_EQ(form_of_text("G"), StreamForm::http);
    EXPECT_EQ(form_of_text("get"), StreamForm::raw);
    EXPECT_EQ(form_of_text(std::string(1, '\0')), StreamForm::raw);
    EXPECT_EQ(form_of_text("\xff"), StreamForm::raw);
}

TEST(PeerAddresses, LoopbackAndNetworks) {
    EXPECT_TRUE(peer_address("127.0.0.1:5").loopback);
    EXPECT_TRUE(peer_address("[::1]:5").loopback);
    EXPECT_FALSE(peer_address("10.0.0.1:5").loopback);
    EXPECT_FALSE(peer_address("nonsense").loopback);
    EXPECT_EQ(peer_address("10.0.0.1:5"), peer_address("10.0.0.1:6"));
    EXPECT_NE(peer_address("10.0.0.1:5"), peer_address("10.0.0.2:5"));
    // One /64 is one customer.
    EXPECT_EQ(peer_address("[2001:db8:1:2::1]:5"), peer_address("[2001:db8:1:2:ffff::9]:5"));
    EXPECT_NE(peer_address("[2001:db8:1:2::1]:5"), peer_address("[2001:db8:1:3::1]:5"));
    EXPECT_TRUE(peer_address("[::ffff:127.0.0.1]:5").loopback);
}

TEST(PeerAddresses, CountsEndWithTheConnection) {
    AddressCounts counts;
    const PeerAddress a = peer_address("10.0.0.1:1");
    auto first = counts.enter(a);
    auto second = counts.enter(a);
    EXPECT_EQ(counts.count(a), 2U);
    first.reset();
    EXPECT_EQ(counts.count(a), 1U);
    second.reset();
    EXPECT_EQ(counts.count(a), 0U);
}

TEST(DoorPolicies, OriginsAndHosts) {
    DoorPolicy policy;
    policy.addresses = {"127.0.0.1", "192.0.2.7"};
    EXPECT_TRUE(policy.origin_allowed(""));
    for (const char* origin :
         {"http://localhost", "https://LOCALHOST:8080", "http://127.0.0.1:3000", "http://[::1]:9"})
        EXPECT_TRUE(policy.origin_allowed(origin)) << origin;
    for (const char* origin :
         {"https://evil.example", "http://localhost.evil.example", "null", "file://localhost",
          "http://127.0.0.1.evil.example", "http://evil.example#http://localhost"})
        EXPECT_FALSE(policy.origin_allowed(origin)) << origin;
    policy.origins = {"https://Sea.example"};
    EXPECT_TRUE(policy.origin_allowed("https://sea.example"));
    EXPECT_FALSE(policy.origin_allowed("https://sea.example:444"));
    EXPECT_FALSE(policy.origin_allowed("http://sea.example"));

    for (const char* host : {"localhost", "localhost:7421", "127.0.0.1:1", "[::1]:1", "192.0.2.7:7421"})
        EXPECT_TRUE(policy.host_allowed(host)) << host;
    for (const char* host : {"", "evil.example", "192.0.2.8", "localhost.evil.example", "[::2]"})
        EXPECT_FALSE(policy.host_allowed(host)) << host;
    policy.hosts = {"sea.example"};
    EXPECT_TRUE(policy.host_allowed("SEA.example:443"));
    policy.addresses = {"0.0.0.0"};
    EXPECT_TRUE(policy.host_allowed("192.0.2.8:1"));
    EXPECT_FALSE(policy.host_allowed("evil.example"));
    policy.hosts = policy.origins = {"*"};
    EXPECT_TRUE(policy.host_allowed("evil.example"));
    EXPECT_TRUE(policy.origin_allowed("https://evil.example"));
}

class Door : public DoorFixture {};

TEST_F(Door, FourFormsOnOnePortCarryTheSameSession) {
    start();
    std::vector<std::vector<Bytes>> results;
    for (const Form form : all_forms) {
        FormClient client(form, port());
        ASSERT_TRUE(client.log_in()) << name_of(form);
        std::vector<Bytes>& pieces = results.emplace_back();
        for (bool last = false; !last;) {
            const auto piece = client.wait_for<Delta>();
            ASSERT_TRUE(piece) << name_of(form);
            last = piece->last;
            pieces.push_back(encode(*piece));
        }
        EXPECT_FALSE(client.odd_frames());
    }
    for (size_t i = 1; i < results.size(); ++i) EXPECT_EQ(results[i], results[0]) << name_of(all_forms[i]);
    const DoorStats seen = door();
    EXPECT_EQ(seen.raw, 1U);
    EXPECT_EQ(seen.raw_over_tls, 1U);
    EXPECT_EQ(seen.websocket, 1U);
    EXPECT_EQ(seen.websocket_over_tls, 1U);
    EXPECT_EQ(seen.handshakes, 2U);
    EXPECT_EQ(seen.handshakes_now, 0U);
    EXPECT_EQ(stats().sessions_started, 4U);
}

TEST_F(Door, ByteByByteInEveryForm) {
    start();
    const auto drip = [](BytePipe& pipe, const Bytes& bytes) {
        for (const uint8_t byte : bytes) ASSERT_TRUE(pipe.write(std::span(&byte, 1)));
    };
    const Bytes hello = encode(RawClient::usual_hello());
    Bytes raw(stream_magic.begin(), stream_magic.end());
    const Bytes framed = frame(hello);
    raw.insert(raw.end(), framed.begin(), framed.end());
    const std::string upgrade = UpgradeWish{}.text();
    WebFrame binary;
    binary.payload = hello;
    for (const bool tls : {false, true}) {
        const auto connect = [&] {
            if (!tls) return connect_tcp(port());
            TlsWish slowly;
            slowly.drip = true;
            return connect_tls(port(), slowly);
        };
        FormClient plain(tls ? Form::tls : Form::raw, connect());
        drip(plain.pipe(), raw);
        EXPECT_TRUE(plain.wait_for<ServerHello>());
        FormClient web(tls ? Form::web_tls : Form::web, connect());
        drip(web.pipe(), Bytes(upgrade.begin(), upgrade.end()));
        drip(web.pipe(), binary.bytes());
        // The head of the answer is taken for frames here: look for the hello behind it.
        EXPECT_TRUE(eventually([&] { return stats().sessions_started == (tls ? 4U : 2U); }));
    }
}

TEST_F(Door, GarbageIsAnsweredAsWrongMagicInAndOutsideTls) {
    start();
    for (const Form form : {Form::raw, Form::tls}) {
        for (const std::string& garbage : {std::string("\0\0\0\0", 4), std::string("hello"),
                                           std::string("\xff\xfe"), std::string("TROCHOIX")}) {
            FormClient client(form, port());
            client.pipe().write(garbage);
            if (garbage.size() < 8) client.pipe().write(std::string(8 - garbage.size(), 'x'));
            EXPECT_EQ(goodbye_to(client), ErrorCode::wrong_magic) << name_of(form) << garbage;
            EXPECT_TRUE(client.ends());
        }
    }
    EXPECT_TRUE(ended_with(ErrorCode::wrong_magic, 8));
}

TEST_F(Door, TlsInsideTlsIsNoMagic) {
    start();
    FormClient client(Form::tls, port());
    client.pipe().write(std::string("\x16\x03\x01\x02\x00\x01\x00\x01", 8));
    EXPECT_EQ(goodbye_to(client), ErrorCode::wrong_magic);
}

TEST_F(Door, WithoutACertificateTlsGetsAnAlert) {
    with_tls = false;
    start();
    const auto pipe = connect_tcp(port());
    pipe->write(std::string("\x16\x03\x01\x02\x00", 5));
    EXPECT_EQ(pipe->read_all(), std::string("\x15\x03\x03\x00\x02\x02\x28", 7));
    EXPECT_TRUE(pipe->ended_properly());
    EXPECT_EQ(connect_tls(port()), nullptr);
    EXPECT_TRUE(ended_with(ErrorCode::wrong_magic, 2));
}

TEST_F(Door, SilenceMeetsTheDeadlineInAndOutsideTls) {
    limits.hello_deadline_ms = 300;
    start();
    for (const Form form : {Form::raw, Form::tls}) {
        FormClient client(form, port());
        EXPECT_EQ(goodbye_to(client), ErrorCode::hello_deadline) << name_of(form);
        EXPECT_TRUE(client.ends()) << name_of(form);
    }
    EXPECT_TRUE(ended_with(ErrorCode::hello_deadline, 2));
}

TEST_F(Door, OneDeadlineCoversFirstBytesHandshakeUpgradeAndHello) {
    limits.hello_deadline_ms = 1200;
    start();
    const auto begun = std::chrono::steady_clock::now();
    std::vector<std::unique_ptr<FormClient>> clients;
    for (const Form form : all_forms) clients.push_back(std::make_unique<FormClient>(form, port()));
    std::this_thread::sleep_for(milliseconds(900));
    for (const auto& client : clients) ASSERT_TRUE(client->open());
    for (const auto& client : clients) {
        EXPECT_EQ(goodbye_to(*client), ErrorCode::hello_deadline);
        EXPECT_GE(std::chrono::steady_clock::now() - begun, milliseconds(1190));
        EXPECT_TRUE(client->ends());
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begun, milliseconds(2050));  // not 900 + 1200
    EXPECT_EQ(clients[2]->close_code(), 4000U + 111U);
    EXPECT_EQ(clients[3]->close_code(), 4000U + 111U);
    EXPECT_TRUE(ended_with(ErrorCode::hello_deadline, 4));
}

TEST_F(Door, HalfATlsHelloMeetsTheDeadlineWithoutAWord) {
    limits.hello_deadline_ms = 200;
    start();
    const auto pipe = connect_tcp(port());
    pipe->write(std::string("\x16\x03\x01\x02\x00\x01", 6));
    EXPECT_EQ(pipe->read_all(), "");
    EXPECT_TRUE(pipe->ended());
    EXPECT_TRUE(ended_with(ErrorCode::hello_deadline));
    EXPECT_EQ(door().handshakes_failed, 0U);  // none was begun
}

TEST_F(Door, GoodbyeBeforeTheCloseInAllForms) {
    start();
    uint64_t count = 0;
    for (const Form form : all_forms) {
        FormClient client(form, port());
        ASSERT_TRUE(client.log_in()) << name_of(form);
        client.send(RawClient::usual_hello());
        const auto goodbye = client.wait_for<Goodbye>();
        ASSERT_TRUE(goodbye) << name_of(form);
        EXPECT_EQ(goodbye->code, ErrorCode::unexpected_message);
        EXPECT_TRUE(client.ends()) << name_of(form);
        if (form == Form::web || form == Form::web_tls) {
            EXPECT_EQ(client.close_code(), 4000U + 110U);
            EXPECT_EQ(client.close_reason(), "trochoid 110 protocol");
        }
        EXPECT_TRUE(ended_with(ErrorCode::unexpected_message, ++count)) << name_of(form);
    }
}

TEST_F(Door, DrainingSaysSoFirstAndThenGoodbyeInAllForms) {
    start();
    std::vector<std::unique_ptr<FormClient>> clients;
    for (const Form form : all_forms) {
        clients.push_back(std::make_unique<FormClient>(form, port()));
        ASSERT_TRUE(clients.back()->log_in()) << name_of(form);
    }
    EXPECT_EQ(status_of(get("/readyz")), 200U);
    on_loop([this] {
        front->begin_draining();
        return 0;
    });
    EXPECT_EQ(status_of(get("/readyz")), 503U);
    EXPECT_EQ(status_of(get("/livez")), 200U);
    const auto waiting = connect_tcp(port());
    ASSERT_TRUE(eventually([&] { return door().guests_now == 1; }));
    std::promise<void> drained;
    loop.post([&] {
        listener->close();
        front->close();
        sessions->drain([&] { drained.set_value(); });
    });
    for (const auto& client : clients) {
        const auto goodbye = client->wait_for<Goodbye>();
        ASSERT_TRUE(goodbye);
        EXPECT_EQ(goodbye->code, ErrorCode::shutting_down);
        EXPECT_TRUE(goodbye->retry);
        EXPECT_TRUE(client->ends());
    }
    EXPECT_EQ(clients.back()->close_code(), 1001U);
    EXPECT_EQ(drained.get_future().wait_for(std::chrono::seconds(4)), std::future_status::ready);
    EXPECT_EQ(waiting->read_all(), "");
    EXPECT_TRUE(waiting->ended());
    EXPECT_EQ(stats().ended[ErrorCode::shutting_down], 5U);
}

TEST_F(Door, ConnectionsOfOneAddressAreLimited) {
    policy.connections_per_loopback_address = 2;
    start();
    auto first = std::make_unique<FormClient>(Form::raw, port());
    FormClient second(Form::web_tls, port());
    ASSERT_TRUE(first->log_in());
    ASSERT_TRUE(second.log_in());
    FormClient third(Form::raw, port());
    third.open();
    const auto goodbye = third.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::too_many_connections);
    EXPECT_TRUE(goodbye->retry);
    EXPECT_GE(goodbye->retry_after_ms, 1000U);
    EXPECT_TRUE(third.ends());
    EXPECT_EQ(status_of(get("/livez")), 429U);
    EXPECT_EQ(connect_tls(port()), nullptr);
    const auto silent = connect_tcp(port());
    EXPECT_EQ(silent->read_all(), "");
    EXPECT_TRUE(silent->ended());
    EXPECT_TRUE(ended_with(ErrorCode::too_many_connections, 4));

    first.reset();
    ASSERT_TRUE(eventually([&] { return stats().sessions_now == 1; }));
    FormClient fourth(Form::tls, port());
    EXPECT_TRUE(fourth.log_in());
}

TEST_F(Door, OtherMachinesNeedTls) {
    far_peer = "203.0.113.5:4000";
    start();
    FormClient raw(Form::raw, port());
    raw.open();
    EXPECT_EQ(goodbye_to(raw), ErrorCode::encryption_required);
    EXPECT_TRUE(raw.ends());
    FormClient web(Form::web, port());
    ASSERT_TRUE(web.open());
    EXPECT_EQ(goodbye_to(web), ErrorCode::encryption_required);
    EXPECT_TRUE(web.ends());
    EXPECT_EQ(web.close_code(), 4303U);
    EXPECT_TRUE(ended_with(ErrorCode::encryption_required, 2));
    for (const Form form : {Form::tls, Form::web_tls}) {
        FormClient client(form, port());
        EXPECT_TRUE(client.log_in()) << name_of(form);
    }
    EXPECT_EQ(status_of(get("/livez")), 200U);
    EXPECT_EQ(status_of(get("/readyz")), 200U);
    EXPECT_EQ(status_of(get("/metrics")), 403U);
    const auto tls = connect_tls(port());
    ASSERT_TRUE(tls);
    tls->write(std::string("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    EXPECT_EQ(status_of(tls->read_all()), 200U);
    EXPECT_TRUE(tls->ended_properly());
}

TEST_F(Door, UnlessTheOperatorAllowsPlaintext) {
    far_peer = "[2001:db8::1]:4000";
    policy.allow_plaintext = true;
    start();
    for (const Form form : all_forms) {
        FormClient client(form, port());
        EXPECT_TRUE(client.log_in()) << name_of(form);
    }
    EXPECT_EQ(status_of(get("/metrics")), 200U);
}

TEST_F(Door, SixteenConnectionsOfAFarAddressByDefault) {
    far_peer = "203.0.113.5:4000";
    start();
    std::vector<std::unique_ptr<BytePipe>> held;
    held.reserve(16);
    for (int i = 0; i < 16; ++i) held.push_back(connect_tcp(port()));
    ASSERT_TRUE(eventually([&] { return door().guests_now == 16; }));
    EXPECT_EQ(status_of(get("/livez")), 429U);
    held.clear();
    ASSERT_TRUE(eventually([&] { return door().guests_now == 0; }));
    EXPECT_EQ(status_of(get("/livez")), 200U);
}

TEST_F(Door, AFloodOfConnectionsLeavesWhoIsInAlone) {
    policy.guests = 50;
    limits.hello_deadline_ms = 2000;
    start();
    FormClient good(Form::tls, port());
    ASSERT_TRUE(good.log_in());
    std::vector<std::unique_ptr<BytePipe>> flood;
    flood.reserve(80);
    for (int i = 0; i < 80; ++i) flood.push_back(connect_tcp(port()));
    EXPECT_TRUE(ended_with(ErrorCode::too_many_connections, 30));
    good.send(ClockRequest{1, 0});
    EXPECT_TRUE(good.wait_for<ClockReply>());
    FormClient next(Form::web, port());
    EXPECT_TRUE(next.log_in());
    EXPECT_TRUE(ended_with(ErrorCode::too_many_connections, 31));
    EXPECT_TRUE(ended_with(ErrorCode::hello_deadline, 49));
}

TEST_F(Door, AGoodbyeOfTheClientIsAnsweredByTheEndOfTheStream) {
    start();
    for (const Form form : all_forms) {
        FormClient client(form, port());
        ASSERT_TRUE(client.log_in()) << name_of(form);
        client.send(Goodbye{});
        EXPECT_TRUE(client.ends()) << name_of(form);  // close_notify, a close frame
        const bool web = form == Form::web || form == Form::web_tls;
        EXPECT_EQ(client.close_code(), web ? 1000U : 0U);
    }
    EXPECT_TRUE(ended_with(ErrorCode::client_closed, 4));
}

TEST_F(Door, CutAnywhereBeforeTheSession) {
    start();
    const std::string upgrade = UpgradeWish{}.text();
    for (size_t length = 0; length <= upgrade.size(); length += 7)
        connect_tcp(port())->write(upgrade.substr(0, length));
    const std::string client_hello("\x16\x03\x01\x00\x10\x01\x00\x00\x0c\x03\x03", 11);
    for (size_t length = 1; length <= client_hello.size(); ++length)
        connect_tcp(port())->write(client_hello.substr(0, length));
    EXPECT_TRUE(eventually([&] { return door().guests_now == 0 && stats().sessions_now == 0; }));
    EXPECT_EQ(door().handshakes_now, 0U);
    FormClient good(Form::web_tls, port());
    EXPECT_TRUE(good.log_in());
}

// Streams that begin well and go wrong anywhere: each ends with a code or an answer, and nothing of them stays.
TEST_F(Door, NoiseLeavesNothingBehind) {
    start();
    const Bytes hello = encode(RawClient::usual_hello());
    WebFrame binary;
    binary.payload = hello;
    const Bytes web_hello = binary.bytes();
    const Bytes framed = frame(hello);
    const std::string upgrade = UpgradeWish{}.text();
    std::vector<std::string> streams{
        std::string("TROCHOID") + std::string(framed.begin(), framed.end()),
        upgrade + std::string(web_hello.begin(), web_hello.end()),
        "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n",
        std::string("\x16\x03\x01\x00\x2c\x01\x00\x00\x28\x03\x03", 11) + std::string(38, '\x5a')};
    uint64_t seed = 1;
    const auto draw = [&seed](size_t below) { return splitmix64(seed++) % below; };
    for (int i = 0; i < 400; ++i) {
        std::string noisy = streams[draw(streams.size())];
        for (uint64_t flips = draw(4); flips > 0; --flips)
            noisy[draw(noisy.size())] = static_cast<char>(draw(256));
        if (draw(3) == 0) noisy.resize(draw(noisy.size()));
        const auto pipe = connect_tcp(port());
        pipe->write(noisy);
        if (draw(2) == 0) {
            std::array<uint8_t, 256> some{};
            pipe->read(some, milliseconds(2));
        }
    }
    EXPECT_TRUE(eventually([&] { return door().guests_now == 0 && stats().sessions_now == 0; }));
    EXPECT_EQ(door().handshakes_now, 0U);
    FormClient good(Form::web_tls, port());
    EXPECT_TRUE(good.log_in());
}

// Who stops reading while much is to come gets all of it, whole, once reading again.
TEST_F(Door, StalledReadersCatchUpInAllForms) {
    sea.patches = 600;
    start();
    for (const Form form : all_forms) {
        FormClient client(form, port());
        ASSERT_TRUE(client.log_in()) << name_of(form);
        for (uint32_t i = 1; i <= 100; ++i) client.send(SampleRequest{i, {}, std::vector<LatticePoint>(100)});
        std::this_thread::sleep_for(milliseconds(100));
        uint32_t answered = 0;
        while (answered < 100) {
            auto message = client.receive();
            ASSERT_TRUE(message) << name_of(form) << " after " << answered;
            if (const auto* reply = std::get_if<SampleReply>(&*message)) {
                EXPECT_EQ(reply->sequence, ++answered);
            } else if (const auto* refusal = std::get_if<CommandReply>(&*message)) {
                EXPECT_EQ(refusal->sequence, ++answered) << refusal->message;
            }
        }
        client.send(ClockRequest{1, 0});
        EXPECT_TRUE(client.wait_for<ClockReply>()) << name_of(form);
    }
}

}  // namespace
}  // namespace trochoid
