#include "server/app/token_door.hpp"

#include "tests/unit/server_app/real_server.hpp"

namespace trochoid {
namespace {

constexpr UnixSeconds noon{1'795'370'400};

class TokenDoors : public testing::Test {
protected:
    void open(ViewerTokens viewers, bool with_key = true) {
        TokenKeys keys;
        if (with_key) keys = TokenKeys({key.public_key()});
        door = std::make_unique<TokenDoor>(std::move(keys), ticket_key(), viewers, [this] { return now; });
    }
    static TicketKey ticket_key() { return *TicketKey::from_hex(std::string(64, 'a')); }
    std::string token(Role role, const std::string& world = "scilly") const {
        return sign_token({role, now, {now.value + 60}, random_nonce(), world}, key);
    }
    Result<LoginDecision> login(const std::string& text, const std::vector<uint8_t>& ticket = {},
                                bool loopback = true) {
        ClientHello hello;
        hello.token = text;
        hello.ticket = ticket;
        return door->login(hello, loopback, "scilly", instance);
    }
    std::vector<uint8_t> ticket(Role role, uint64_t session) {
        return door->new_ticket(session, role, instance).ticket;
    }
    static ErrorCode code_of(const Result<LoginDecision>& decision) {
        return decision ? ErrorCode::none : decision.error().code;
    }

    const SigningKey key = SigningKey::generate();
    const WorldInstance instance{{1, 2, 3}};
    UnixSeconds now = noon;
    std::unique_ptr<TokenDoor> door;
};

TEST_F(TokenDoors, EveryRoleHasItsToken) {
    open(ViewerTokens::always);
    for (const Role role : {Role::viewer, Role::director, Role::admin}) {
        const auto decision = login(token(role));
        ASSERT_TRUE(decision) << decision.error().message;
        EXPECT_EQ(*decision, (LoginDecision{role, 0}));
    }
}

TEST_F(TokenDoors, ATokenIsGoodOnceWhateverTheClockDoes) {
    open(ViewerTokens::off_loopback);
    const std::string once = token(Role::director);
    ASSERT_TRUE(login(once));
    for (const uint64_t seconds : {0U, 60U, 30U, 1U, 2000U, 0U}) {
        now = {noon.value + seconds};
        ASSERT_EQ(code_of(login(once)), ErrorCode::token_refused) << seconds;
    }
    now = {noon.value + 2000};
    ASSERT_TRUE(login(token(Role::director)));
    now = noon;
    EXPECT_NE(login(once).error().message.find("clock"), std::string::npos)
        << "forgotten, and refused for its age though the clock was set back";
}

TEST_F(TokenDoors, WhoComesWithABadTokenIsNoViewerEither) {
    open(ViewerTokens::never);
    EXPECT_EQ(code_of(login("secret")), ErrorCode::token_refused);
    EXPECT_EQ(code_of(login(token(Role::viewer, "azores"))), ErrorCode::token_refused);
}

TEST_F(TokenDoors, ARestartTakesNoOlderTokens) {
    open(ViewerTokens::off_loopback);
    const std::string once = token(Role::director);
    ASSERT_TRUE(login(once));
    now = {noon.value + 1};
    open(ViewerTokens::off_loopback);
    EXPECT_EQ(code_of(login(once)), ErrorCode::token_refused);
    EXPECT_TRUE(login(token(Role::director)));
}

TEST_F(TokenDoors, ViewersNeedTokensWhereTheOperatorSaysSo) {
    const auto comes_in = [&](ViewerTokens when, bool loopback) {
        open(when);
        const auto decision = login("", {}, loopback);
        if (decision) return decision->role == Role::viewer;
        EXPECT_EQ(decision.error().code, ErrorCode::token_required);
        return false;
    };
    EXPECT_TRUE(comes_in(ViewerTokens::off_loopback, true));
    EXPECT_FALSE(comes_in(ViewerTokens::off_loopback, false));
    EXPECT_FALSE(comes_in(ViewerTokens::always, true));
    EXPECT_FALSE(comes_in(ViewerTokens::always, false));
    EXPECT_TRUE(comes_in(ViewerTokens::never, true));
    EXPECT_TRUE(comes_in(ViewerTokens::never, false));
}

TEST_F(TokenDoors, ATicketStandsForTheTokenOnce) {
    open(ViewerTokens::always);
    const auto held = ticket(Role::director, 42);
    const auto back = login("", held);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, (LoginDecision{Role::director, 42}));
    EXPECT_EQ(code_of(login("", held)), ErrorCode::token_refused);
    EXPECT_EQ(login(token(Role::admin), held)->role, Role::admin) << "the ticket is passed over";
}

TEST_F(TokenDoors, AGoodTicketLeavesTheTokenUnused) {
    open(ViewerTokens::always);
    const std::string kept = token(Role::admin);
    EXPECT_EQ(login(kept, ticket(Role::viewer, 5))->role, Role::viewer);
    EXPECT_EQ(login(kept)->role, Role::admin);
}

TEST_F(TokenDoors, AnotherNodeOpensTheTicket) {
    open(ViewerTokens::always);
    const auto held = ticket(Role::director, 42);
    open(ViewerTokens::always, false);
    EXPECT_EQ(login("", held)->last_session, 42U);
}

TEST_F(TokenDoors, ABadTicketCountsForNothing) {
    open(ViewerTokens::off_loopback);
    const std::vector<uint8_t> bad(93, 7);
    EXPECT_EQ(*login("", bad), LoginDecision{}) << "a viewer needs none here";
    EXPECT_EQ(*login(token(Role::director), bad), (LoginDecision{Role::director, 0}));
    EXPECT_EQ(code_of(login("", bad, false)), ErrorCode::token_refused);
    const auto old = ticket(Role::director, 1);
    now = {noon.value + 601};
    EXPECT_EQ(code_of(login("", old, false)), ErrorCode::token_refused);
    now = noon;
    EXPECT_TRUE(login("", old, false));
}

TEST_F(TokenDoors, TicketsAreGoodForTenMinutesInOneLifeOfTheWorld) {
    open(ViewerTokens::always);
    const IssuedTicket issued = door->new_ticket(9, Role::director, instance);
    EXPECT_EQ(issued.life_ms, 600'000U);
    ClientHello hello;
    hello.ticket = issued.ticket;
    EXPECT_FALSE(door->login(hello, true, "scilly", WorldInstance{}));
    now = {noon.value + 600};
    EXPECT_TRUE(door->login(hello, true, "scilly", instance));
}

// Anybody may come in as viewer here, and come back: as often as it takes to fill what tickets are remembered in.
TEST_F(TokenDoors, ViewersTicketsDoNotShutOutDirectors) {
    open(ViewerTokens::off_loopback);
    ErrorCode last = ErrorCode::none;
    for (uint64_t i = 0; i <= 65'536; ++i) last = code_of(login("", ticket(Role::viewer, i), false));
    EXPECT_EQ(last, ErrorCode::token_refused) << "full";
    EXPECT_NE(login("", ticket(Role::viewer, 1), false).error().message.find("in a minute"),
              std::string::npos);
    EXPECT_TRUE(login(token(Role::director)));
    EXPECT_TRUE(login("", ticket(Role::director, 1)));
    now = {noon.value + 601};
    EXPECT_TRUE(login("", ticket(Role::viewer, 2), false)) << "the first have made room";
}

// The same by the wire: roles, tickets and who may what.
TEST_F(RealServer, DirectorsChangeTheSeaAndAdminsTime) {
    start(nullptr, scene_with_wind());
    const std::pair<Role, std::pair<bool, bool>> rights[] = {
        {Role::viewer, {false, false}}, {Role::director, {true, false}}, {Role::admin, {true, true}}};
    for (const auto& [role, may] : rights) {
        RawClient client(listener->port());
        const auto hello = client.log_in(hello_as(role));
        ASSERT_TRUE(hello);
        EXPECT_EQ(hello->role, role);
        client.send(Command{1, {}, false, wind_over_the_origin()});
        const auto wind = client.wait_for<CommandReply>(RawClient::Milliseconds(20'000));
        ASSERT_TRUE(wind);
        EXPECT_EQ(wind->code, may.first ? ErrorCode::none : ErrorCode::token_required) << wind->message;
        client.send(Command{2, {}, false, SetRate{1U << 16}});
        const auto rate = client.wait_for<CommandReply>();
        ASSERT_TRUE(rate);
        EXPECT_EQ(rate->code, may.second ? ErrorCode::none : ErrorCode::token_required) << rate->message;
    }
}

TEST_F(RealServer, WhoComesBackWithTheTicketIsWhoLeft) {
    start(nullptr, scene_with_wind());
    auto first = std::make_unique<RawClient>(listener->port());
    const auto hello = first->log_in(hello_as(Role::director));
    ASSERT_TRUE(hello);
    EXPECT_EQ(hello->last_session, 0U);
    EXPECT_GT(hello->ticket_life_ms, 0U);
    first->disconnect();
    while (on_loop([this] { return sessions->stats().sessions_now; }) > 0) std::this_thread::yield();
    ClientHello again = RawClient::usual_hello();
    again.ticket = hello->ticket;
    RawClient back(listener->port());
    const auto answer = back.log_in(again);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->role, Role::director);
    EXPECT_EQ(answer->last_session, hello->session);
    EXPECT_EQ(answer->last_code, ErrorCode::client_closed);
    EXPECT_NE(answer->ticket, hello->ticket) << "rotated";
    RawClient thief(listener->port());
    const auto late = thief.log_in(again);
    ASSERT_TRUE(late) << "a viewer needs no ticket on this machine";
    EXPECT_EQ(late->role, Role::viewer);
    EXPECT_EQ(late->last_session, 0U);
}

}  // namespace
}  // namespace trochoid
