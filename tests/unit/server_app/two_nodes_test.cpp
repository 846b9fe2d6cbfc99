// Two nodes of one world on one log: whoever appends first is first, and both come to the same world.
#include <gtest/gtest.h>

#include <set>

#include "protocol/codec/codec.hpp"
#include "protocol/units/hash.hpp"
#include "server/app/replay.hpp"
#include "server/interest/cull.hpp"
#include "server/interest/cull_key.hpp"
#include "tests/unit/server_app/real_server.hpp"

namespace trochoid {
namespace {

/// One for all nodes of the world.
TicketKey ticket_key() { return TicketKey::from_hex(std::string(2 * TicketKey::bytes, '7')).value(); }
SigningKey signing_key() { return SigningKey::from_seed(std::array<uint8_t, SigningKey::bytes>{3}); }

struct Node {
    Node(IoLoop& loop, EventLog& log, const std::shared_ptr<const TerrainGrid>& terrain,
         const SeaClock& clock, uint32_t number)
        : world("test", terrain, clock),
          worker(loop, terrain, land_settings_of({})),
          authority(loop, world, log, worker, lead_ms, number),
          sea(authority, WorldInstance{}, door) {}
    World world;
    LandWorker worker;
    SeaAuthority authority;
    TokenDoor door{TokenKeys({signing_key().public_key()}), ticket_key(), ViewerTokens::off_loopback};
    SeaService sea;
};

SeaClock clock_from_now() {
    SeaClock clock;
    clock.monotonic_start_us = monotonic_us();
    return clock;
}

Scene one_wind() {
    Scene scene;
    scene.name = "test";
    SceneWind wind{"old wind", wind_over_the_origin(), {-3600 * microseconds_per_second}, {}};
    wind.wind.seed = 5;
    wind.wind.trains = 4;
    scene.winds.push_back(wind);
    return scene;
}

ViewState a_view() {
    ViewState view;
    view.position = {to_lattice(-1000), to_lattice(-300)};
    view.altitude = static_cast<int32_t>(to_lattice(30));
    return view;
}

uint64_t culled(const SeaAuthority& authority, const CullKey& key) {
    return hash_of(cull(*authority.index(), key).state);
}

class Dice {
public:
    explicit Dice(uint64_t seed) : state_(seed) {}
    uint64_t below(uint64_t n) { return (state_ = splitmix64(state_)) % n; }

private:
    uint64_t state_;
};

decltype(Command::action) some_action(Dice& dice, uint32_t boxes) {
    const BoxId box{static_cast<uint32_t>(1 + dice.below(boxes))};
    switch (dice.below(8)) {
        case 0: {
            StartWind wind = wind_over_the_origin();
            wind.trains = 3;
            wind.seed = 1 + dice.below(1000);
            wind.vx = dice.below(2) == 0 ? 0.0F : 8.0F;
            return wind;
        }
        case 1: return StopWind{box};
        case 2:
        case 3: {
            StartShip ship;
            ship.at = {to_lattice(-1500), to_lattice(static_cast<double>(dice.below(3000)))};
            ship.speed = 8.0F;
            return ship;
        }
        case 4: return SetRate{static_cast<uint32_t>(dice.below(4)) << 15};
        case 5: return SkipTime{static_cast<int64_t>(1 + dice.below(60'000'000))};
        default: return Steer{box, static_cast<float>(dice.below(360)), static_cast<float>(dice.below(9))};
    }
}

/// A watermark, and how much of the log the node had read when it gave it.
struct Promise {
    LogPosition position;
    SeaTime watermark;
};

// The heart of it: no order of commands, reads and promises on two nodes parts their worlds or breaks a promise of either.
TEST(TwoNodes, AnyInterleavingComesToOneWorld) {
    size_t conflicts = 0;
    size_t events_in_all = 0;
    for (uint64_t seed = 1; seed <= 200; ++seed) {
        IoLoop loop;
        InMemoryEventLog log;
        const SeaClock clock = clock_from_now();
        Node a(loop, log, nullptr, clock, 1);
        Node b(loop, log, nullptr, clock, 2);
        a.authority.open(one_wind());
        b.authority.follow();
        std::vector<Promise> promises;
        Dice dice(seed);
        for (int step = 0; step < 30; ++step) {
            SeaAuthority& node = (dice.below(2) == 0 ? a : b).authority;
            const uint64_t what = dice.below(4);
            if (what == 0) node.follow();
            if (what == 1) promises.push_back({node.state()->log_position, node.watermark()});
            if (what < 2) continue;
            Command command;
            command.sequence = static_cast<uint32_t>(step + 1);
            command.action = some_action(dice, node.state()->next_box);
            const bool behind = !log.read(node.state()->log_position, 1).empty();
            std::optional<CommandReply> reply;
            node.command(command, [&](CommandReply r) { reply = std::move(r); });
            ASSERT_TRUE(reply) << "open water is traced at once";
            if (reply->code == ErrorCode::none) {
                conflicts += behind ? 1U : 0U;
                EXPECT_EQ(reply->log_position, node.state()->log_position);
            }
        }
        a.authority.follow();
        b.authority.follow();
        const auto events = log.read({0}, 1000);
        events_in_all += events.size();
        ASSERT_EQ(a.authority.state()->log_position.value, events.size());
        ASSERT_EQ(a.authority.state()->log_hash, b.authority.state()->log_hash) << "seed " << seed;
        ASSERT_EQ(hash_of(*a.authority.state()), hash_of(*b.authority.state())) << "seed " << seed;
        const CullKey key = choose_key(*a.authority.index(), a_view(), {}, nullptr, a.authority.now());
        ASSERT_EQ(culled(a.authority, key), culled(b.authority, key)) << "seed " << seed;
        World third("test", nullptr, clock);
        ASSERT_TRUE(replay(third, events, land_settings_of({})));
        ASSERT_EQ(hash_of(*third.state()), hash_of(*a.authority.state())) << "seed " << seed;
        std::set<uint64_t> ids;
        for (const StoredEvent& stored : events) {
            EXPECT_TRUE(ids.insert(stored.event_id).second);
            const auto event = decode_event(stored.bytes);
            ASSERT_TRUE(event);
            if (std::holds_alternative<ClockChanged>(event->what)) continue;
            for (const Promise& promise : promises) {
                if (promise.position > stored.position) continue;
                ASSERT_LE(promise.watermark, event->effective)
                    << "seed " << seed << ": event " << stored.position.value
                    << " takes effect before what was promised at position " << promise.position.value;
            }
        }
    }
    EXPECT_GT(conflicts, 500U);
    EXPECT_GT(events_in_all, 2000U);
}

/// Two nodes with sessions over one log, on one io thread; each looks at the log every 20 ms.
class TwoServers : public testing::Test {
protected:
    void start(const std::shared_ptr<const TerrainGrid>& terrain) {
        const SeaClock clock = clock_from_now();
        a = std::make_unique<Node>(loop, log, terrain, clock, 1);
        b = std::make_unique<Node>(loop, log, terrain, clock, 2);
        a->authority.open(one_wind());
        b->authority.follow();
        sessions_a = std::make_unique<SessionServer>(loop, a->sea, Limits{});
        sessions_b = std::make_unique<SessionServer>(loop, b->sea, Limits{});
        a->authority.on_change([this] { sessions_a->sea_changed(); });
        b->authority.on_change([this] { sessions_b->sea_changed(); });
        listener_a = listen(*sessions_a);
        listener_b = listen(*sessions_b);
        look();
        thread = std::thread([this] { loop.run(); });
    }
    std::unique_ptr<Listener> listen(SessionServer& sessions) {
        return std::make_unique<Listener>(loop, ListenAddresses{}, [&sessions](std::unique_ptr<Transport> t) {
            sessions.accept(std::move(t));
        });
    }
    void look() {
        timer.start(std::chrono::milliseconds(20), [this] {
            if (following) {
                a->authority.follow();
                b->authority.follow();
            }
            look();
        });
    }
    void TearDown() override {
        if (!thread.joinable()) return;
        loop.post([this] { loop.stop(); });
        thread.join();
    }
    template <class F>
    auto on_loop(F f) {
        std::promise<decltype(f())> promise;
        loop.post([&] { promise.set_value(f()); });
        return promise.get_future().get();
    }
    std::future<CommandReply> command(Node& node, decltype(Command::action) action) {
        auto promise = std::make_shared<std::promise<CommandReply>>();
        const Command asked{++sequence, {}, false, std::move(action)};
        loop.post([&node, asked, promise] {
            node.authority.command(asked, [promise](CommandReply r) { promise->set_value(std::move(r)); });
        });
        return promise->get_future();
    }

    IoLoop loop;
    InMemoryEventLog log;
    LoopTimer timer{loop};
    std::atomic<bool> following{true};
    std::atomic<uint32_t> sequence{0};
    std::unique_ptr<Node> a;
    std::unique_ptr<Node> b;
    std::unique_ptr<SessionServer> sessions_a;
    std::unique_ptr<SessionServer> sessions_b;
    std::unique_ptr<Listener> listener_a;
    std::unique_ptr<Listener> listener_b;
    std::thread thread;
};

// A client of one node goes on at the other, where it left off; what happened on either meanwhile comes as a change.
TEST_F(TwoServers, AClientGoesOnAtTheOtherNode) {
    start(nullptr);
    ClientHello hello = RawClient::usual_hello();
    const UnixSeconds now = unix_now();
    hello.token = sign_token({Role::director, now, {now.value + 60}, random_nonce(), "test"}, signing_key());
    hello.view = a_view();
    RawClient first(listener_a->port());
    const auto there = first.log_in(hello);
    ASSERT_TRUE(there);
    ASSERT_EQ(there->role, Role::director);
    StartShip ship;
    ship.at = {to_lattice(-1500), 0};
    const CommandReply sails = command(*b, ship).get();
    ASSERT_EQ(sails.code, ErrorCode::none);
    ASSERT_EQ(command(*b, Steer{sails.box, 90.0F, 6.0F}).get().code, ErrorCode::none) << "two events at once";
    std::optional<Delta> last;
    while (!last || last->key.log_position < LogPosition{4}) {
        last = first.next_result();
        ASSERT_TRUE(last) << "events of the other node come to this one's clients";
        first.acknowledge(*last);
    }
    first.send(ClockRequest{1, 0});
    const auto clock = first.wait_for<ClockReply>();
    ASSERT_TRUE(clock);
    const InterestState held = first.state();
    first.disconnect();
    // Something happens while it is away.
    ASSERT_EQ(command(*a, StopWind{{1}}).get().code, ErrorCode::none);
    while (on_loop([&] { return b->authority.state()->log_position.value; }) < 5) {
    }

    RawClient second(listener_b->port());
    second.hold(held);
    hello.token.clear();
    hello.ticket = there->ticket;
    hello.resume = ResumeState{{}, last->key, hash_of(held), clock->log_position, clock->log_hash};
    const auto answer = second.log_in(hello);
    ASSERT_TRUE(answer);
    EXPECT_TRUE(answer->resumed);
    EXPECT_EQ(answer->role, Role::director);
    EXPECT_EQ(answer->last_session, there->session);
    EXPECT_EQ(answer->last_code, ErrorCode::none) << "this node has not seen how that session ended";
    const auto result = second.next_result();
    ASSERT_TRUE(result);
    EXPECT_EQ(result->result, 2U);
    EXPECT_EQ(result->base, 1U);
    EXPECT_EQ(result->key.log_position, LogPosition{5});
    EXPECT_EQ(result->state_hash, hash_of(second.state()));
    EXPECT_EQ(result->change.boxes.size(), 1U) << "the wind that ends";
    EXPECT_EQ(on_loop([&] { return culled(a->authority, result->key); }), result->state_hash)
        << "the other node has the same for this key";
}

// Land is traced by each node for itself, from the events alone, and traces in progress give way to what another was first with.
TEST_F(TwoServers, LandComesToTheSameOnBoth) {
    start(island());
    following = false;
    ChangeLand mole;
    mole.line = {{to_lattice(-1200), to_lattice(-600)}, {to_lattice(-900), to_lattice(700)}};
    mole.width = 40.0F;
    mole.crest = 4.0F;
    StartWind wind = wind_over_the_origin();
    wind.trains = 4;
    wind.seed = 3;
    ChangeLand higher = mole;
    higher.crest = 6.0F;
    // All at once on both; each finds the log changed under it.
    std::vector<std::future<CommandReply>> replies;
    replies.push_back(command(*a, wind));
    replies.push_back(command(*b, mole));
    replies.push_back(command(*b, wind));
    replies.push_back(command(*a, StopWind{{1}}));
    replies.push_back(command(*a, higher));
    size_t done = 0;
    for (auto& reply : replies) done += reply.get().code == ErrorCode::none ? 1U : 0U;
    EXPECT_GE(done, 4U);
    on_loop([&] {
        a->authority.follow();
        b->authority.follow();
        return 0;
    });
    const auto [of_a, of_b] = on_loop([&] { return std::pair(a->authority.state(), b->authority.state()); });
    EXPECT_GE(of_a->log_position.value, 5U);
    EXPECT_EQ(of_a->log_hash, of_b->log_hash);
    EXPECT_EQ(hash_of(*of_a), hash_of(*of_b));
    size_t fields = 0;
    for (const auto& [id, box] : of_a->boxes) fields += box->sea->fields.size();
    EXPECT_GT(fields, 2U);
    const CullKey key =
        on_loop([&] { return choose_key(*a->authority.index(), a_view(), {}, nullptr, a->authority.now()); });
    EXPECT_EQ(on_loop([&] { return culled(a->authority, key); }),
              on_loop([&] { return culled(b->authority, key); }));
}

// A node that has not looked at the log for a while promises no more than it knows.
TEST(TwoNodes, AWatermarkEndsALeadAfterTheLastLook) {
    IoLoop loop;
    InMemoryEventLog log;
    const SeaClock clock = clock_from_now();
    Node a(loop, log, nullptr, clock, 1);
    Node b(loop, log, nullptr, clock, 2);
    a.authority.open(one_wind());
    b.authority.follow();
    const SeaTime promised = b.authority.watermark();
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_EQ(b.authority.watermark(), promised);
    EXPECT_GE(b.authority.now() + int64_t{lead_ms} * 1000, promised + 30'000);
    b.authority.follow();
    EXPECT_GE(b.authority.watermark(), promised + 30'000);
}

// A node that comes back replays the log and goes on with the numbers of its events where its earlier life stopped: an event under a
// number that the log knows already would be lost.
TEST(TwoNodes, AReplayedNodeGoesOnWithItsNumbers) {
    for (const uint32_t number : {0U, 7U}) {
        IoLoop loop;
        InMemoryEventLog log;
        const SeaClock clock = clock_from_now();
        {
            Node first(loop, log, nullptr, clock, number);
            first.authority.open(one_wind());
            for (int i = 0; i < 100; ++i)
                first.authority.command({1, {}, false, SetRate{1U << 16}}, [](const CommandReply&) {});
        }
        const auto events = log.read({0}, 1000);
        ASSERT_EQ(events.size(), 101U);
        World world("test", nullptr, clock);
        ASSERT_TRUE(replay(world, events, land_settings_of({})));
        LandWorker worker(loop, nullptr, land_settings_of({}));
        SeaAuthority again(loop, world, log, worker, lead_ms, number);
        std::optional<CommandReply> reply;
        again.command({1, {}, false, StopWind{{1}}}, [&](CommandReply r) { reply = std::move(r); });
        ASSERT_TRUE(reply);
        EXPECT_EQ(reply->code, ErrorCode::none) << reply->message;
        EXPECT_EQ(reply->log_position, LogPosition{102});
        const auto all = log.read({0}, 1000);
        ASSERT_EQ(all.size(), 102U);
        EXPECT_EQ(all.back().event_id, all[100].event_id + 1);
        EXPECT_EQ(all.back().log_hash, world.state()->log_hash);
    }
}

// What was promised under a faster clock holds after it was slowed, for a node that knows of that clock by the log alone.
TEST(TwoNodes, AReplayedNodeKeepsWhatWasPromisedUnderAnEarlierClock) {
    IoLoop loop;
    InMemoryEventLog log;
    const SeaClock clock = clock_from_now();
    Node a(loop, log, nullptr, clock, 1);
    a.authority.open(one_wind());
    a.authority.command({1, {}, false, SetRate{16U << 16}}, [](const CommandReply&) {});
    a.authority.follow();
    const SeaTime promised = a.authority.watermark();
    a.authority.command({2, {}, false, SetRate{0}}, [](const CommandReply&) {});
    World world("test", nullptr, clock);
    ASSERT_TRUE(replay(world, log.read({0}, 1000), land_settings_of({})));
    LandWorker worker(loop, nullptr, land_settings_of({}));
    SeaAuthority late(loop, world, log, worker, lead_ms, 2);
    std::optional<CommandReply> reply;
    late.command({1, {}, false, StopWind{{1}}}, [&](CommandReply r) { reply = std::move(r); });
    ASSERT_TRUE(reply);
    ASSERT_EQ(reply->code, ErrorCode::none) << reply->message;
    EXPECT_GE(reply->effective, promised);
}

// Land that was traced over a terrain which another node has changed meanwhile is of no use, however often: whoever reads the event traces
// it over the terrain of then.
TEST(TwoNodes, LandThatChangesUnderEachTraceIsNotUsed) {
    IoLoop loop;
    const SeaClock clock = clock_from_now();
    // Three changes of the land, ready to be written.
    InMemoryEventLog elsewhere;
    Node other(loop, elsewhere, island(), clock, 3);
    other.authority.open(one_wind());
    const LogPosition opened = other.authority.state()->log_position;
    for (int i = 0; i < 3; ++i) {
        ChangeLand mole;
        mole.line = {{to_lattice(-1200 + 400 * i), to_lattice(-600)},
                     {to_lattice(-1100 + 400 * i), to_lattice(700)}};
        mole.width = 40.0F;
        mole.crest = 4.0F;
        // Each at its own time, so that each is an event.
        other.authority.command({1, {(1 + 15 * i) * microseconds_per_second}, true, mole},
                                [](const CommandReply&) {});
    }
    size_t changes = 0;
    other.authority.on_change([&] {
        if (++changes == 3) loop.stop();
    });
    loop.run();
    const auto written = elsewhere.read({0}, 100);
    ASSERT_EQ(written.size(), opened.value + 3);

    IoLoop second_loop;
    InMemoryEventLog log;
    size_t next = 0;
    const auto write_next = [&] {
        ASSERT_TRUE(std::holds_alternative<Appended>(
            log.append({next}, written[next].event_id, written[next].bytes)));
        ++next;
    };
    while (next < opened.value) write_next();
    Node a(second_loop, log, island(), clock, 1);
    a.authority.follow();
    // A look at the log waits for the trace in progress, whose end comes before the next turn of this.
    std::function<void()> interfere = [&] {
        if (next == written.size()) return;
        write_next();
        a.authority.follow();
        second_loop.post(interfere);
    };
    StartWind wind = wind_over_the_origin();
    wind.trains = 3;
    wind.seed = 9;
    std::optional<CommandReply> reply;
    second_loop.post([&] {
        a.authority.command({1, {}, false, wind}, [&](CommandReply r) {
            reply = std::move(r);
            second_loop.stop();
        });
        second_loop.post(interfere);
    });
    second_loop.run();
    ASSERT_TRUE(reply);
    EXPECT_EQ(next, written.size()) << "all three changes came in between";
    EXPECT_EQ(reply->code, ErrorCode::queue_overflow) << reply->message;
    EXPECT_EQ(log.read({0}, 100).size(), written.size());
}

}  // namespace
}  // namespace trochoid
