#include "server/net/session_admission.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <thread>

#include "tests/unit/server_net/server_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;
using Verdict = SessionAdmission::Verdict;

constexpr int64_t second = 1'000'000;

PeerAddress address(uint64_t n) { return {false, false, n}; }

TEST(Admission, ABurstGoesInAtOnceSomeWaitTheRestMayNot) {
    SessionAdmission admission(10);
    uint64_t id = 0;
    for (int i = 0; i < 40; ++i) EXPECT_EQ(admission.ask(address(1), ++id, 5 * second), Verdict::at_once);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(admission.ask(address(1), ++id, 5 * second), Verdict::later);
    EXPECT_EQ(admission.ask(address(1), ++id, 5 * second), Verdict::never);
    EXPECT_EQ(admission.ask(address(2), ++id, 5 * second), Verdict::at_once) << "another address";
    EXPECT_TRUE(admission.due(5 * second).empty());
    EXPECT_EQ(admission.due(5 * second + second / 2), (std::vector<uint64_t>{41, 42, 43, 44, 45}));
    // Whoever comes now does not overtake those who wait.
    EXPECT_EQ(admission.ask(address(1), ++id, 6 * second), Verdict::later);
    EXPECT_EQ(admission.due(60 * second).size(), 16U);
    EXPECT_TRUE(admission.due(61 * second).empty());
}

TEST(Admission, OverAMinuteTheRateHolds) {
    SessionAdmission admission(3);
    uint64_t in = 0;
    uint64_t id = 0;
    for (int64_t ms = 0; ms < 60'000; ms += 10) {
        in += admission.ask(address(7), ++id, ms * 1000) == Verdict::at_once ? 1U : 0U;
        if (ms % 100 == 0) in += admission.due(ms * 1000).size();
    }
    EXPECT_GE(in, 3U * 60U);
    EXPECT_LE(in, 3U * 60U + 12U);
}

TEST(Admission, WithoutARateNothingIsKept) {
    SessionAdmission admission(0);
    for (uint64_t id = 1; id < 1000; ++id) EXPECT_EQ(admission.ask(address(1), id, second), Verdict::at_once);
    EXPECT_EQ(admission.addresses(), 0U);
}

TEST(Admission, AddressesAreForgottenAndTheirNumberIsBounded) {
    SessionAdmission admission(2);
    const auto crowd = static_cast<uint64_t>(SessionAdmission::most_addresses) + 1000;
    uint64_t in = 0;
    for (uint64_t n = 0; n < crowd; ++n)
        in += admission.ask(address(n), n + 1, second) == Verdict::at_once ? 1U : 0U;
    EXPECT_LE(admission.addresses(), SessionAdmission::most_addresses + 1);
    EXPECT_LT(in, crowd) << "those beyond share one place";
    EXPECT_GE(in, SessionAdmission::most_addresses);
    admission.due(4 * second);
    EXPECT_GT(admission.addresses(), 0U);
    admission.due(30 * second);
    admission.due(40 * second);
    EXPECT_EQ(admission.addresses(), 0U);
}

class HeldBack : public ServerFixture {
protected:
    HeldBack() { logins_per_second = 1; }
    // Four are in.
    void use_up_the_burst() {
        for (int i = 0; i < 4; ++i) {
            in_.push_back(std::make_unique<RawClient>(port()));
            ASSERT_TRUE(in_.back()->log_in()) << i;
        }
    }
    std::vector<std::unique_ptr<RawClient>> in_;
};

TEST_F(HeldBack, WhoComesTooOftenWaitsAndOthersDoNot) {
    start();
    use_up_the_burst();
    const auto begun = std::chrono::steady_clock::now();
    RawClient late(port());
    late.send_magic();
    late.send(RawClient::usual_hello());
    RawClient other(port(), 0, "::1");
    EXPECT_TRUE(other.log_in());
    EXPECT_FALSE(late.receive(milliseconds(100))) << "its turn has not come";
    EXPECT_TRUE(late.wait_for<ServerHello>());
    const auto waited = std::chrono::steady_clock::now() - begun;
    EXPECT_GE(waited, milliseconds(250));
    EXPECT_LT(waited, milliseconds(2500));
    EXPECT_EQ(stats().held_back, 1U);
}

TEST_F(HeldBack, TheHelloDeadlineStandsStill) {
    logins_per_second = 1;
    limits.hello_deadline_ms = 300;
    start();
    for (int i = 0; i < 4; ++i) {
        in_.push_back(std::make_unique<RawClient>(port()));
        ASSERT_TRUE(in_.back()->log_in()) << i;
    }
    RawClient late(port());
    late.send_magic();
    late.send(RawClient::usual_hello());
    EXPECT_TRUE(late.wait_for<ServerHello>()) << "after about a second";
    // One that then says nothing is not let off.
    RawClient silent(port());
    const auto goodbye = silent.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::hello_deadline);
}

TEST_F(HeldBack, BeyondThoseWhoWaitTheCodeSaysWhenToComeAgain) {
    start();
    use_up_the_burst();
    std::vector<std::unique_ptr<RawClient>> waiting;
    waiting.reserve(2);
    for (int i = 0; i < 2; ++i) waiting.push_back(std::make_unique<RawClient>(port()));
    RawClient beyond(port());
    const auto goodbye = beyond.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::too_many_connections);
    EXPECT_TRUE(goodbye->retry);
    EXPECT_GE(goodbye->retry_after_ms, 1000U);
    EXPECT_LE(goodbye->retry_after_ms, 3000U);
    beyond.disconnect();
    EXPECT_TRUE(ended_with(ErrorCode::too_many_connections, 1));
}

TEST_F(HeldBack, WhoWaitsIsToldWhenTheServerShutsDown) {
    start();
    use_up_the_burst();
    RawClient late(port());
    for (int i = 0; i < 100 && stats().held_back < 1; ++i) std::this_thread::sleep_for(milliseconds(10));
    std::promise<void> drained;
    loop.post([&] { sessions->drain([&] { drained.set_value(); }); });
    const auto goodbye = late.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::shutting_down);
    EXPECT_EQ(drained.get_future().wait_for(std::chrono::seconds(10)), std::future_status::ready);
}

TEST_F(HeldBack, WhoLeavesWhileItWaitsIsForgotten) {
    start();
    use_up_the_burst();
    {
        RawClient gone(port());
        for (int i = 0; i < 100 && stats().held_back < 1; ++i) std::this_thread::sleep_for(milliseconds(10));
    }
    RawClient next(port());
    EXPECT_TRUE(next.log_in());
    EXPECT_TRUE(ended_with(ErrorCode::client_closed, 1));
}

/// Ends as soon as something is written.
class DeadTransport final : public Transport {
public:
    const std::string& peer() const override { return peer_; }
    void when_readable(std::function<void()>) override {}
    void when_writable(std::function<void()>) override {}
    Moved read(std::span<uint8_t>) override { return {0, true}; }
    Moved write(std::span<const uint8_t>) override { return {0, true}; }
    void finish(ErrorCode) override {}
    void close() override {}

private:
    std::string peer_ = "127.0.0.1:1";
};

// What ended last is remembered longest, however low its number.
using Ends = ServerFixture;
TEST_F(Ends, TheOldestEndIsForgottenFirst) {
    limits.sessions = 1;
    start();
    auto first = std::make_unique<RawClient>(port());
    const auto hello = first->log_in();
    ASSERT_TRUE(hello);
    spdlog::set_level(spdlog::level::warn);
    on_loop([this] {
        for (int i = 0; i < 4096; ++i) sessions->accept(std::make_unique<DeadTransport>());
        return 0;
    });
    spdlog::set_level(spdlog::level::info);
    ASSERT_TRUE(ended_with(ErrorCode::too_many_sessions, 4096));
    first.reset();
    ASSERT_TRUE(ended_with(ErrorCode::client_closed, 1));
    RawClient again(port());
    ClientHello back = RawClient::usual_hello();
    back.ticket = hello->ticket;
    const auto welcome = again.log_in(back);
    ASSERT_TRUE(welcome);
    EXPECT_EQ(welcome->last_session, hello->session);
    EXPECT_EQ(welcome->last_code, ErrorCode::client_closed);
}

}  // namespace
}  // namespace trochoid
