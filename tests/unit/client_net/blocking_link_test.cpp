#include "client/net/blocking_link.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "tests/support/net/raw_server.hpp"

namespace trochoid {
namespace {

/// A server's script on a thread of its own.
struct Script {
    RawServer server;
    std::thread thread;
    explicit Script(std::function<void(RawServer&)> play) {
        thread = std::thread([this, play = std::move(play)] { play(server); });
    }
    ~Script() { thread.join(); }
    LinkOptions options() const {
        LinkOptions o;
        o.server = {"127.0.0.1", server.port()};
        o.software = "test 1";
        o.token = "secret";
        o.patience = std::chrono::milliseconds(1500);
        return o;
    }
};

TEST(BlockingLink, hello_says_who_we_are_and_looks_at_no_water) {
    std::optional<ClientHello> theirs;
    Script script([&](RawServer& s) {
        theirs = s.log_in();
        s.wait_for<Goodbye>();
        s.hang_up();
    });
    {
        BlockingLink link(script.options());
        EXPECT_EQ(link.hello().software, "raw server");
    }
    script.thread.join();
    script.thread = std::thread([] {});
    ASSERT_TRUE(theirs);
    EXPECT_EQ(theirs->software, "test 1");
    EXPECT_EQ(theirs->token, "secret");
    EXPECT_EQ(theirs->view.patch_budget, 1U);
    EXPECT_TRUE(theirs->regions.empty());
}

TEST(BlockingLink, answers_are_found_by_their_sequence) {
    Script script([](RawServer& s) {
        ASSERT_TRUE(s.log_in());
        const auto command = s.wait_for<Command>();
        ASSERT_TRUE(command);
        s.send(CommandReply{command->sequence + 7, ErrorCode::internal_error, "another's", {}, {}, {}});
        s.send(CommandReply{command->sequence, ErrorCode::none, "", {42}, {3}, {5}});
        const auto list = s.wait_for<Command>();
        ASSERT_TRUE(list);
        EXPECT_TRUE(std::holds_alternative<ListBoxes>(list->action));
        EXPECT_GT(list->sequence, command->sequence);
        BoxSummary one;
        one.box = {1};
        BoxSummary two;
        two.box = {2};
        s.send(BoxList{list->sequence, {9}, {one}, false});
        s.send(BoxList{list->sequence, {9}, {two}, true});
        const auto clock = s.wait_for<ClockRequest>();
        ASSERT_TRUE(clock);
        ClockReply reply;
        reply.sequence = clock->sequence;
        reply.watermark = {77};
        s.send(reply);
        s.wait_for<Goodbye>();
        s.hang_up();
    });
    BlockingLink link(script.options());
    Command stop;
    stop.action = StopWind{{5}};
    EXPECT_EQ(link.command(stop).effective.us, 42);
    const BoxList list = link.list();
    ASSERT_EQ(list.boxes.size(), 2U);
    EXPECT_EQ(list.boxes[1].box.value, 2U);
    EXPECT_EQ(link.clock().watermark.us, 77);
}

TEST(BlockingLink, a_refusal_is_an_answer) {
    Script script([](RawServer& s) {
        ASSERT_TRUE(s.log_in());
        const auto command = s.wait_for<Command>();
        ASSERT_TRUE(command);
        s.send(CommandReply{command->sequence, ErrorCode::unknown_box, "there is no box 9", {}, {}, {}});
        s.wait_for<Goodbye>();
        s.hang_up();
    });
    BlockingLink link(script.options());
    Command stop;
    stop.action = StopWind{{9}};
    EXPECT_EQ(link.command(stop).code, ErrorCode::unknown_box);
}

/// What connecting, or asking for the list after it, throws.
LinkError failure_of(const LinkOptions& options) {
    try {
        BlockingLink link(options);
        link.list();
    } catch (const LinkError& error) {
        return error;
    }
    ADD_FAILURE() << "nothing was thrown";
    return LinkError("", ErrorCode::none, false);
}

TEST(BlockingLink, a_goodbye_is_quoted) {
    Script script([](RawServer& s) {
        ASSERT_TRUE(s.accept());
        s.receive();
        Goodbye goodbye;
        goodbye.code = ErrorCode::token_refused;
        goodbye.message = "wrong token";
        s.send(goodbye);
        s.ends();
    });
    const LinkError error = failure_of(script.options());
    EXPECT_EQ(error.code(), ErrorCode::token_refused);
    EXPECT_FALSE(error.unreachable());
    EXPECT_NE(std::string(error.what()).find("says: wrong token"), std::string::npos) << error.what();
}

TEST(BlockingLink, silence_ends_at_the_deadline) {
    Script script([](RawServer& s) {
        ASSERT_TRUE(s.log_in());
        s.wait_for<Goodbye>();
        s.hang_up();
    });
    const auto begin = std::chrono::steady_clock::now();
    const LinkError error = failure_of(script.options());
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
    EXPECT_NE(std::string(error.what()).find("gave no list"), std::string::npos) << error.what();
}

TEST(BlockingLink, a_server_that_hangs_up_in_mid_question) {
    Script script([](RawServer& s) {
        ASSERT_TRUE(s.log_in());
        s.wait_for<Command>();
        s.hang_up();
    });
    EXPECT_FALSE(failure_of(script.options()).unreachable());
}

TEST(BlockingLink, nobody_there) {
    LinkOptions options;
    {
        RawServer server;
        options.server = {"127.0.0.1", server.port()};
    }
    const LinkError error = failure_of(options);
    EXPECT_TRUE(error.unreachable());
    EXPECT_NE(std::string(error.what()).find("start trochoid-server"), std::string::npos);
}

}  // namespace
}  // namespace trochoid
