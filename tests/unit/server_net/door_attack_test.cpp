#include <array>
#include <atomic>
#include <csignal>
#include <set>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/units/hash.hpp"
#include "server/net/address_crowd.hpp"
#include "server/net/handshake_turns.hpp"
#include "tests/support/net/raw_client.hpp"
#include "tests/unit/server_net/door_fixture.hpp"
#include "tests/unit/server_net/tls_by_hand.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;
constexpr Form all_forms[] = {Form::raw, Form::tls, Form::web, Form::web_tls};
constexpr int attackers = 16;

PeerAddress address(uint64_t network) { return {false, false, network}; }

// Against lists that are searched from end to end.
TEST(AddressCrowds, TheOldestOfWhoeverHasMostGoesFirst) {
    AddressCrowd crowd;
    std::vector<std::pair<uint64_t, uint64_t>> there;  // network, id
    uint64_t seed = 7;
    uint64_t next = 1;
    const auto draw = [&seed](uint64_t below) { return splitmix64(seed++) % below; };
    for (int i = 0; i < 1200; ++i) {
        if (there.empty() || draw(100) < 60) {
            there.emplace_back(draw(6), next);
            crowd.enter(address(there.back().first), next++);
        } else {
            const size_t at = draw(there.size());
            crowd.leave(address(there[at].first), there[at].second);
            crowd.leave(address(there[at].first), there[at].second);  // a second time: nothing
            there.erase(there.begin() + static_cast<std::ptrdiff_t>(at));
        }
        ASSERT_EQ(crowd.size(), there.size());
        uint64_t expected = 0;
        size_t most = 0;
        for (const auto& [network, id] : there) {  // ascends with id
            size_t count = 0;
            for (const auto& other : there) count += other.first == network ? 1 : 0;
            if (count > most) expected = id, most = count;
        }
        ASSERT_EQ(crowd.first_to_go().value_or(0), expected);
    }
}

TEST(HandshakeTurnsTest, ANewcomerPassesAFlood) {
    HandshakeTurns turns;
    uint64_t id = 0;
    for (int i = 0; i < 100; ++i) turns.wait(address(1), ++id);
    EXPECT_EQ(turns.next(), 1U);
    EXPECT_EQ(turns.next(), 2U);
    turns.wait(address(2), ++id);
    turns.wait(address(3), ++id);
    turns.wait(address(2), ++id);
    EXPECT_EQ(turns.next(), 101U);
    EXPECT_EQ(turns.next(), 102U);
    EXPECT_EQ(turns.next(), 103U);
    turns.forget(address(1), 3);
    turns.forget(address(1), 3);
    turns.forget(address(9), 4);
    EXPECT_EQ(turns.next(), 4U);
    turns.wait(address(2), ++id);
    turns.forget_begun();  // now by who has waited longest
    EXPECT_EQ(turns.next(), 5U);
    EXPECT_EQ(turns.next(), 104U);
    for (uint64_t i = 6; i <= 100; ++i) EXPECT_EQ(turns.next(), i);
    EXPECT_TRUE(turns.empty());
    EXPECT_FALSE(turns.next());
}

TEST(PeerAddresses, RoomIsMadeByLines) {
    // A /64 is the least that a customer has, and what limits go by; a /56 is what one line may have.
    EXPECT_EQ(line_of(peer_address("[2001:db8:1:200::1]:5")), line_of(peer_address("[2001:db8:1:2ff::1]:5")));
    EXPECT_NE(line_of(peer_address("[2001:db8:1:200::1]:5")), line_of(peer_address("[2001:db8:1:300::1]:5")));
    EXPECT_NE(line_of(peer_address("10.0.0.1:5")), line_of(peer_address("10.0.0.2:5")));
}

TEST(FirstBytes, AClientHelloIsWholeInItsFirstRecord) {
    const auto bytes = [](std::array<uint8_t, tls_hello_begin> first) { return tls_hello_bytes(first); };
    EXPECT_EQ(bytes({0x16, 3, 1, 2, 0, 1, 0, 1, 0xfc}), 517U);
    EXPECT_EQ(bytes({0x16, 3, 1, 0x0f, 0xfb, 1, 0, 0x0f, 0xf7}), longest_tls_hello);
    EXPECT_EQ(bytes({0x16, 3, 1, 0x0f, 0xfc, 1, 0, 0x0f, 0xf8}), 0U);  // too long
    EXPECT_EQ(bytes({0x16, 3, 1, 2, 0, 1, 0, 1, 0xfd}), 0U);           // goes on in another record
    EXPECT_EQ(bytes({0x16, 3, 1, 0, 4, 1, 2, 0, 0}), 0U);              // announces 128 KiB
    EXPECT_EQ(bytes({0x16, 3, 1, 2, 0, 2, 0, 1, 0xfc}), 0U);           // a ServerHello
    EXPECT_EQ(bytes({0x16, 2, 1, 2, 0, 1, 0, 1, 0xfc}), 0U);
    EXPECT_EQ(bytes({0x16, 3, 1, 0, 0, 1, 0, 0, 0}), 0U);
}

class DoorAttack : public DoorFixture {
protected:
    static std::string attacker(int i) { return "127.0.0." + std::to_string(2 + i % attackers); }
    void expect_good_clients_in() {
        for (const Form form : all_forms) {
            FormClient good(form, port());
            EXPECT_TRUE(good.log_in()) << name_of(form);
        }
    }
    /// Handshakes begun from `count` addresses of attackers, each with its whole hello and nothing after it.
    std::vector<std::unique_ptr<TlsByHand>> begun_handshakes(int count) {
        std::vector<std::unique_ptr<TlsByHand>> begun;
        begun.reserve(static_cast<size_t>(count));
        for (int i = 0; i < count; ++i) {
            begun.push_back(std::make_unique<TlsByHand>(port(), attacker(i)));
            begun.back()->pipe().write(std::span<const uint8_t>(begun.back()->hello()));
        }
        return begun;
    }
    // What `begin` does, again and again from all addresses, with at most `held` connections open, until the object is gone.
    class Attack {
    public:
        template <class Begin>
        Attack(uint16_t port, size_t held, Begin begin)
            : thread_([this, port, held, begin] {
                  std::deque<std::unique_ptr<BytePipe>> pipes;
                  for (int i = 0; !over_; ++i) {
                      pipes.push_back(connect_tcp(port, "127.0.0.1", attacker(i)));
                      begin(*pipes.back());
                      if (pipes.size() > held) pipes.pop_front();
                  }
              }) {}
        Attack(const Attack&) = delete;
        Attack& operator=(const Attack&) = delete;
        ~Attack() {
            over_ = true;
            thread_.join();
        }

    private:
        std::atomic<bool> over_ = false;
        std::thread thread_;
    };

    ReadCounts read;  // lasts longer than the server's thread
};

TEST_F(DoorAttack, OneByteOfTlsTakesNoHandshake) {
    policy.handshakes = 8;
    start();
    std::vector<std::unique_ptr<BytePipe>> held;
    for (int i = 0; i < 256; ++i) {
        held.push_back(connect_tcp(port(), "127.0.0.1", attacker(i)));
        held.back()->write(std::string("\x16"));
    }
    ASSERT_TRUE(eventually([&] { return door().guests_now == 256; }));
    for (size_t i = 0; i < held.size(); i += 2)
        held[i]->write(std::string("\x03\x01\x02\x00\x01\x00\x01\xfc", 8));
    std::this_thread::sleep_for(milliseconds(50));
    EXPECT_EQ(door().handshakes_now, 0U);
    expect_good_clients_in();
    EXPECT_EQ(door().made_room, 0U);
    EXPECT_EQ(door().guests_now, 256U);
}

TEST_F(DoorAttack, WhollyBegunHandshakesMakeRoomForOthers) {
    policy.handshakes = 8;
    start();
    const auto held = begun_handshakes(64);
    ASSERT_TRUE(eventually([&] { return door().made_room == 56; }));
    EXPECT_EQ(door().handshakes_now, 8U);
    // The oldest have gone, the newest are still there.
    for (size_t i = 0; i < 56; ++i) held[i]->pipe().read_all();
    for (size_t i = 0; i < held.size(); ++i) EXPECT_EQ(held[i]->pipe().ended(), i < 56) << i;
    EXPECT_TRUE(ended_with(ErrorCode::too_many_connections, 56));
    expect_good_clients_in();
    EXPECT_EQ(door().made_room, 57U);
    EXPECT_EQ(door().handshakes_failed, 57U);
}

TEST_F(DoorAttack, GoodClientsGetInWhileHandshakesAreFlooded) {
    policy.handshakes = 16;
    start();
    const Bytes hello = TlsByHand(port()).hello();
    const Attack attack(port(), 200, [&](BytePipe& pipe) { pipe.write(std::span<const uint8_t>(hello)); });
    ASSERT_TRUE(eventually([&] { return door().made_room > 0; }));
    for (int i = 0; i < 3; ++i) expect_good_clients_in();
}

TEST_F(DoorAttack, GoodClientsGetInWhileTheDoorIsFlooded) {
    policy.guests = 64;
    start();
    size_t number = 0;
    const std::array<std::string, 4> begins{"", "\x16", "TROCHO", "GET / HTTP/1.1\r\nHost: a\r\n"};
    const Attack attack(port(), 300, [&](BytePipe& pipe) { pipe.write(begins[number++ % begins.size()]); });
    ASSERT_TRUE(eventually([&] { return door().made_room > 0; }));
    for (int i = 0; i < 3; ++i) expect_good_clients_in();
    EXPECT_LE(door().guests_now, 64U);
    EXPECT_EQ(status_of(get("/livez")), 200U);
}

// The one who holds most makes room, not whoever came first.
TEST_F(DoorAttack, AModestGuestIsNotTheOneToGo) {
    policy.guests = 32;
    start();
    FormClient patient(Form::tls, port());  // oldest of all, and not in yet
    std::vector<std::unique_ptr<BytePipe>> held;
    held.reserve(200);
    for (int i = 0; i < 200; ++i) held.push_back(connect_tcp(port(), "127.0.0.1", attacker(i)));
    ASSERT_TRUE(eventually([&] { return door().made_room == 200 - 31; }));
    EXPECT_TRUE(patient.log_in());
}

TEST_F(DoorAttack, WhoeverIsNotInTakesNoSession) {
    limits.sessions = 4;
    start();
    const Bytes hello = frame(encode(RawClient::usual_hello()));
    const std::string most = "TROCHOID" + std::string(hello.begin(), hello.end() - 1);
    std::vector<std::unique_ptr<BytePipe>> held;
    for (const std::string& begin :
         {std::string("TRO"), std::string("TROCHOID"), most, std::string("nonsense"), UpgradeWish{}.text()})
        for (int i = 0; i < 20; ++i) {
            held.push_back(connect_tcp(port(), "127.0.0.1", attacker(i)));
            held.back()->write(begin);
        }
    ASSERT_TRUE(ended_with(ErrorCode::wrong_magic, 20));
    EXPECT_EQ(stats().connections, 0U);
    EXPECT_EQ(stats().sessions_now, 0U);
    expect_good_clients_in();
    // The last byte is all that one of those lacked.
    held[40]->write(std::string(1, static_cast<char>(hello.back())));
    EXPECT_TRUE(eventually([&] { return stats().sessions_started == 5; }));
}

TEST_F(DoorAttack, HandshakesBeginAFewATurn) {
    start();
    std::vector<std::unique_ptr<TlsByHand>> flood;
    std::vector<Bytes> hellos;
    for (int i = 0; i < 60; ++i) {
        flood.push_back(std::make_unique<TlsByHand>(port()));
        hellos.push_back(flood.back()->hello());
    }
    for (size_t i = 0; i < flood.size(); ++i) flood[i]->pipe().write(std::span<const uint8_t>(hellos[i]));
    ASSERT_TRUE(eventually([&] { return door().handshakes_now == 60; }));
    EXPECT_GE(door().handshake_turns, 15U);
}

// Some that dribble keep the io thread a little busy in every millisecond: others begin all the same.
TEST_F(DoorAttack, DribbledHandshakesHoldUpNoOther) {
    start();
    const auto slow = begun_handshakes(8);
    ASSERT_TRUE(eventually([&] { return door().handshakes_now == slow.size(); }));
    std::atomic<bool> over = false;
    std::thread dribble([&] {
        for (const auto& one : slow)
            one->pipe().write(std::string("\x17\x03\x03\x40\x00", 5));  // a record of 16 KiB
        for (size_t i = 0; !over; ++i) {
            slow[i % slow.size()]->pipe().write(std::string("a"));
            std::this_thread::sleep_for(std::chrono::microseconds(50));
        }
    });
    std::this_thread::sleep_for(milliseconds(20));
    expect_good_clients_in();
    EXPECT_EQ(door().handshakes_now, slow.size()) << "they got in only when those had gone";
    over = true;
    dribble.join();
}

TEST_F(DoorAttack, OnlyCheapKeyExchanges) {
    start();
    TlsWish wish;
    for (const char* group : {"ffdhe2048", "ffdhe8192", "P-384", "P-521"}) {
        wish.groups = group;
        EXPECT_EQ(connect_tls(port(), wish), nullptr) << group;
    }
    for (const char* group : {"X25519", "P-256"}) {
        wish.groups = group;
        EXPECT_NE(connect_tls(port(), wish), nullptr) << group;
    }
}

// Thousands of records that carry nothing: each is one turn of the loop, not all of them one.
TEST_F(DoorAttack, KeyUpdatesAreReadOneByOne) {
    counts = &read;
    start();
    TlsByHand client(port());
    ASSERT_TRUE(client.shake_hands());
    Bytes hello(stream_magic.begin(), stream_magic.end());
    const Bytes framed = frame(encode(RawClient::usual_hello()));
    hello.insert(hello.end(), framed.begin(), framed.end());
    ASSERT_TRUE(client.write(hello));
    ASSERT_TRUE(eventually([&] { return stats().sessions_started == 1; }));
    const uint64_t before = read.reads;
    read.most_reads = 0;
    constexpr uint64_t updates = 3000;
    const Bytes flood = client.key_updates(static_cast<int>(updates));
    ASSERT_TRUE(client.pipe().write(std::span<const uint8_t>(flood)));
    EXPECT_TRUE(eventually([&] { return read.reads - before >= 2 * updates; }));
    EXPECT_LE(read.most_reads, 3U);  // a record's header, its content, and that there is no more
    EXPECT_EQ(stats().sessions_now, 1U);
}

/// A ClientHello made so long by a padding extension (RFC 7685).
Bytes padded(Bytes hello, size_t length) {
    constexpr size_t extension_header = 4;
    const size_t more = length - hello.size();
    const auto grow = [&](size_t at) {
        const size_t grown = (size_t{hello[at]} << 8 | hello[at + 1]) + more;
        hello[at] = static_cast<uint8_t>(grown >> 8);
        hello[at + 1] = static_cast<uint8_t>(grown);
    };
    grow(3);  // the record
    grow(7);  // the message, the lower two bytes of its length
    size_t at = 5 + 4 + 2 + 32;
    at += 1 + size_t{hello[at]};                                 // the session
    at += 2 + (size_t{hello[at]} << 8 | size_t{hello[at + 1]});  // cipher suites
    at += 1 + size_t{hello[at]};                                 // compression
    grow(at);                                                    // the extensions
    const size_t zeros = more - extension_header;
    hello.insert(hello.end(), {0, 21, static_cast<uint8_t>(zeros >> 8), static_cast<uint8_t>(zeros)});
    hello.resize(length);
    return hello;
}

// Nothing follows a hello until it is answered: it is whole when its last byte has been read, in whatever steps.
TEST_F(DoorAttack, HellosOfAnyLengthAreAnswered) {
    start();
    for (const size_t length : {400U, 1033U, 1034U, 2057U, 2058U, 2600U, 3081U, 3082U, 4000U, 4096U})
        for (const size_t first : {0U, 1U, 5U, 9U, 1500U}) {
            if (first >= length) continue;
            TlsByHand client(port());
            const Bytes hello = padded(client.hello(), length);
            client.pipe().write(std::span(hello).first(first));
            if (first > 0) std::this_thread::sleep_for(milliseconds(5));
            client.pipe().write(std::span(hello).subspan(first));
            std::array<uint8_t, 1> answer{};
            ASSERT_EQ(client.pipe().read(answer, milliseconds(2000)), 1U) << length << " after " << first;
            EXPECT_EQ(answer[0], 0x16) << length << " after " << first;
        }
}

// A ClientHello in crumbs, each a record of its own, would be a thousand reads of the socket in one call of OpenSSL's.
TEST_F(DoorAttack, AHelloInManyRecordsIsRefused) {
    counts = &read;
    start();
    TlsByHand client(port());
    const Bytes hello = client.hello();
    Bytes crumbs;
    for (size_t i = 5; i < hello.size(); ++i) {
        crumbs.insert(crumbs.end(), {0x16, 3, 1, 0, 1});
        crumbs.push_back(hello[i]);
    }
    client.pipe().write(std::span<const uint8_t>(crumbs));
    EXPECT_EQ(client.pipe().read_all(), std::string("\x15\x03\x03\x00\x02\x02\x32", 7));
    EXPECT_TRUE(ended_with(ErrorCode::malformed_frame));
    EXPECT_LE(read.most_reads, 16U);
    EXPECT_EQ(door().handshakes_failed, 0U);
}

// Half a KeyUpdate, with the rest in the next record: what the server has to say meanwhile waits, and the session lives.
TEST_F(DoorAttack, InTheMiddleOfAKeyUpdateNothingBreaks) {
    start();
    TlsByHand client(port());
    ASSERT_TRUE(client.shake_hands());
    Bytes hello(stream_magic.begin(), stream_magic.end());
    const Bytes framed = frame(encode(RawClient::usual_hello()));
    hello.insert(hello.end(), framed.begin(), framed.end());
    ASSERT_TRUE(client.write(hello));
    ASSERT_TRUE(eventually([&] { return stats().results == 1; }));
    while (!client.read(milliseconds(200)).empty()) {
    }
    const std::array<uint8_t, 5> update{24, 0, 0, 1, 0};
    const Bytes half = client.record(22, std::span(update).first(4));  // the message's header
    const Bytes rest = client.record(22, std::span(update).subspan(4));
    ASSERT_TRUE(client.pipe().write(std::span<const uint8_t>(half)));
    std::this_thread::sleep_for(milliseconds(50));
    sea.revision = 2;
    on_loop([this] {
        sessions->sea_changed();
        return 0;
    });
    EXPECT_TRUE(client.read(milliseconds(150)).empty());
    EXPECT_FALSE(client.pipe().ended());
    EXPECT_EQ(stats().sessions_now, 1U);
    ASSERT_TRUE(client.pipe().write(std::span<const uint8_t>(rest)));
    EXPECT_FALSE(client.read().empty());
    EXPECT_EQ(stats().sessions_now, 1U);
}

/// Peers that have been given their last word and go on sending, each on a thread, until nothing more is taken.
class ToldOff : public DoorFixture {
protected:
    ToldOff() { std::signal(SIGPIPE, SIG_IGN); }  // OpenSSL writes to what has been closed
    struct Peer {
        std::string name;
        std::shared_ptr<BytePipe> pipe;
        std::string flood;
        std::shared_ptr<void> owner;  // of the pipe
        ReadCounts read;
        uint64_t before = 0;
    };
    /// The pipe's reads are counted apart, if it is made behind this.
    Peer& newcomer(std::string name) {
        Peer& peer = *peers_.emplace_back(std::make_unique<Peer>());
        peer.name = std::move(name);
        on_loop([&] {
            counts = &peer.read;
            return 0;
        });
        return peer;
    }
    template <class Owner>
    static void own(Peer& peer, std::shared_ptr<Owner> owner, std::string flood) {
        peer.pipe = std::shared_ptr<BytePipe>(owner, &owner->pipe());
        peer.owner = std::move(owner);
        peer.flood = std::move(flood);
        peer.before = peer.read.bytes;
    }
    void own(Peer& peer, std::shared_ptr<BytePipe> pipe) {
        // Counted from when it has been read once.
        EXPECT_TRUE(eventually([&] { return peer.read.bytes > 0; })) << peer.name;
        peer.pipe = std::move(pipe);
        peer.flood = zeros_;
        peer.before = peer.read.bytes;
    }
    void expect_all_gone_soon() {
        Peer& other = newcomer("neighbour");
        FormClient neighbour(Form::raw, port());
        ASSERT_TRUE(neighbour.log_in());
        const auto begun = std::chrono::steady_clock::now();
        std::vector<std::thread> floods;
        for (const auto& peer : peers_)
            if (peer->pipe)
                floods.emplace_back([&one = *peer, begun] {
                    while (std::chrono::steady_clock::now() - begun < milliseconds(6000) &&
                           one.pipe->write(one.flood)) {
                    }
                });
        for (uint32_t i = 1; i <= 20; ++i) {
            const auto asked = std::chrono::steady_clock::now();
            neighbour.send(ClockRequest{i, 0});
            EXPECT_TRUE(neighbour.wait_for<ClockReply>());
            EXPECT_LT(std::chrono::steady_clock::now() - asked, milliseconds(1000));
            std::this_thread::sleep_for(milliseconds(20));
        }
        EXPECT_TRUE(eventually([&] { return stats().sessions_now == 1 && door().guests_now == 0; }));
        EXPECT_LT(std::chrono::steady_clock::now() - begun, milliseconds(5000));
        for (std::thread& flood : floods) flood.join();
        for (const auto& peer : peers_) {
            if (peer->pipe) {
                EXPECT_LE(peer->read.bytes - peer->before, most_dropped_bytes + 65536) << peer->name;
            }
        }
        EXPECT_GT(other.read.bytes, 0U);
    }
    const std::string unmasked_ = "\x82\x05hello";
    const std::string zeros_ = std::string(1 << 18, '\0');

private:
    std::vector<std::unique_ptr<Peer>> peers_;
};

TEST_F(ToldOff, ASessionReadsAMebibyteMore) {
    start();
    const Bytes message = WebFrame{.payload = Bytes(60000)}.bytes();
    const std::string messages(message.begin(), message.end());
    for (const Form form : all_forms) {
        Peer& peer = newcomer(name_of(form));
        const auto client = std::make_shared<FormClient>(form, port());
        ASSERT_TRUE(client->log_in()) << peer.name;
        client->send(RawClient::usual_hello());
        EXPECT_EQ(goodbye_to(*client), ErrorCode::unexpected_message) << peer.name;
        own(peer, client, form == Form::raw || form == Form::tls ? zeros_ : messages);
    }
    Peer& torn_web = newcomer("broken WebSocket");
    const auto web = std::make_shared<FormClient>(Form::web, port());
    ASSERT_TRUE(web->log_in());
    web->pipe().write(unmasked_);
    EXPECT_FALSE(web->wait_for<Goodbye>());
    EXPECT_EQ(web->close_code(), 1002U);
    own(torn_web, web, zeros_);
    for (const bool records : {false, true}) {
        Peer& peer = newcomer(records ? "TLS records without content" : "broken TLS");
        const auto tls = std::make_shared<TlsByHand>(port());
        ASSERT_TRUE(tls->shake_hands());
        Bytes hello(stream_magic.begin(), stream_magic.end());
        const Bytes framed = frame(encode(RawClient::usual_hello()));
        for (int i = 0; i < (records ? 2 : 1); ++i) hello.insert(hello.end(), framed.begin(), framed.end());
        ASSERT_TRUE(tls->write(hello));
        ASSERT_TRUE(eventually([&] { return stats().sessions_started == (records ? 7U : 6U); }));
        const Bytes updates = records ? tls->key_updates(20000) : Bytes{};
        own(peer, tls, records ? std::string(updates.begin(), updates.end()) : zeros_);
    }
    expect_all_gone_soon();
    EXPECT_EQ(stats().ended[ErrorCode::unexpected_message] + stats().ended[ErrorCode::malformed_frame], 7U);
}

TEST_F(ToldOff, TheDoorReadsAMebibyteMore) {
    start();
    const std::string garbage = "\x16\x03\x01\x02" + std::string(12, '\0');
    for (const std::string& first : {std::string("nonsense"), garbage, std::string("PRI * HTTP/2.0\r\n\r\n"),
                                     std::string("GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n")}) {
        Peer& plain = newcomer(first);
        auto pipe = connect_tcp(port());
        pipe->write(first);
        own(plain, std::move(pipe));
        if (first == garbage) continue;
        Peer& encrypted = newcomer(first + " inside TLS");
        auto tls = connect_tls(port());
        ASSERT_TRUE(tls);
        tls->write(first);
        own(encrypted, std::move(tls));
    }
    Peer& torn = newcomer("broken TLS");
    const auto tls = std::make_shared<TlsByHand>(port());
    ASSERT_TRUE(tls->shake_hands());
    own(torn, tls, zeros_);
    Peer& web = newcomer("broken WebSocket");
    auto pipe = connect_tcp(port());
    pipe->write(UpgradeWish{}.text() + unmasked_);
    own(web, std::move(pipe));
    expect_all_gone_soon();
}

TEST_F(DoorAttack, WhatIsOddEndsAndHoldsNothingUp) {
    limits.hello_deadline_ms = 700;
    counts = &read;
    start();
    const std::string upgrade = UpgradeWish{}.text();
    UpgradeWish odd;
    odd.further =
        "Connection: close, Upgrade, Upgrade\r\nUpgrade: h2c, websocket\r\nSec-WebSocket-Key: x\r\n"
        "Sec-WebSocket-Extensions: permessage-deflate; server_max_window_bits=99; x=\"\\\"\r\n";
    std::string headers = "GET / HTTP/1.1\r\nHost: a\r\n";
    for (int i = 0; i < 600; ++i) headers += "a:\r\n";
    std::string pipelined;
    for (int i = 0; i < 2000; ++i) pipelined += "GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n";
    const Bytes tls_inside = TlsByHand(port()).hello();
    const std::vector<std::string> streams{odd.text(),
                                           headers + "\r\n",
                                           headers + std::string(1 << 20, 'x'),
                                           pipelined,
                                           upgrade + upgrade + pipelined,
                                           std::string(tls_inside.begin(), tls_inside.end()),
                                           "GET /" + std::string(1 << 20, '/') + " HTTP/1.1\r\n\r\n",
                                           "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
                                           "TROCHOID" + std::string(1 << 20, '\0'),
                                           "TROCHOID" + std::string("\xff\xff\xff\xff\0\0\0\0", 8)};
    for (const bool inside_tls : {false, true}) {
        for (const std::string& stream : streams) {
            auto pipe = inside_tls ? connect_tls(port()) : connect_tcp(port());
            ASSERT_TRUE(pipe);
            pipe->write(stream);
            pipe->read_all(milliseconds(20));
        }
        // Slowly: a byte, and then nothing more, at every place.
        std::vector<std::unique_ptr<BytePipe>> slow;
        for (size_t i = 0; i < upgrade.size(); i += 5) {
            slow.push_back(inside_tls ? connect_tls(port()) : connect_tcp(port()));
            ASSERT_TRUE(slow.back());
            slow.back()->write(upgrade.substr(0, i));
        }
        for (size_t i = 1; i < tls_inside.size() && !inside_tls; i += 20) {
            slow.push_back(connect_tcp(port()));
            slow.back()->write(std::span(tls_inside).first(i));
        }
        EXPECT_EQ(status_of(get("/livez")), 200U);
        EXPECT_TRUE(eventually([&] { return door().guests_now == 0; }));
        for (const auto& pipe : slow) {
            pipe->read_all();
            EXPECT_TRUE(pipe->ended());
        }
    }
    EXPECT_LE(read.most_reads, 32U);
    EXPECT_LE(read.most_bytes, 65536U);
    EXPECT_EQ(stats().connections, 0U);
    expect_good_clients_in();
}

}  // namespace
}  // namespace trochoid
