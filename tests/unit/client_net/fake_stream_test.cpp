#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <variant>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"
#include "protocol/wire/session_rules.hpp"
#include "tests/support/net/raw_server.hpp"
#include "tests/unit/client_net/dialler.hpp"

namespace trochoid {
namespace {

/// A stream without a socket: a test plays the server. The real Connection drives it, on a loop.
class FakeStream final : public ClientStream {
public:
    FakeStream(bool messages, size_t write_limit = SIZE_MAX)
        : messages_(messages), write_limit_(write_limit) {}

    void dial(Dialled done) override { dialled_ = std::move(done); }
    const char* awaits() const override { return "the fake slept"; }
    void read(Arrived done) override {
        arrived_ = std::move(done);
        later([this] { deliver(); });
    }
    void write(std::span<const uint8_t> bytes, Written done) override {
        const size_t count = std::min(bytes.size(), write_limit_ - std::min(write_limit_, written_bytes()));
        written.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
        if (hold_writes)
            held = [done = std::move(done), count] { done(count); };
        else
            later([done = std::move(done), count] { done(count); });
    }
    void shut() override { shut_ = true; }
    void close() override {
        closed = true;
        dialled_ = nullptr;
        arrived_ = nullptr;
        held = nullptr;
    }
    bool keeps_messages() const override { return messages_; }
    void set_longest(uint32_t bytes) override { longest = bytes; }

    void stand(const Result<Done>& outcome = Done{}) { std::exchange(dialled_, nullptr)(outcome); }
    /// What the server says, as one piece each.
    void say(Bytes bytes) {
        inbox_.emplace_back(std::move(bytes));
        deliver();
    }
    void breaks(Error error) {
        inbox_.emplace_back(std::move(error));
        deliver();
    }

    NetLoop* loop = nullptr;
    std::vector<Bytes> written;
    bool hold_writes = false;
    std::function<void()> held;
    bool shut_ = false;
    bool closed = false;
    uint32_t longest = 0;

private:
    void later(std::function<void()> task) {
        loop->post([this, task = std::move(task)] {
            if (!closed) task();
        });
    }
    size_t written_bytes() const {
        size_t sum = 0;
        for (const Bytes& piece : written) sum += piece.size();
        return sum;
    }
    void deliver() {
        if (!arrived_ || inbox_.empty()) return;
        const std::variant<Bytes, Error> next = std::move(inbox_.front());
        inbox_.pop_front();
        const Arrived done = std::exchange(arrived_, nullptr);
        if (const auto* bytes = std::get_if<Bytes>(&next))
            done(std::span<const uint8_t>(*bytes));
        else
            done(std::get<Error>(next));
    }

    bool messages_;
    size_t write_limit_;
    Dialled dialled_;
    Arrived arrived_;
    std::deque<std::variant<Bytes, Error>> inbox_;
};

/// All that happens to the fake happens on the loop.
struct FakeTest : testing::Test {
    std::shared_ptr<FakeStream> fake;
    std::unique_ptr<Dialler> client;

    void TearDown() override { end(); }
    /// The fake keeps callbacks that keep the connection.
    void end() {
        if (client) on_loop([this] { fake->close(); });
        client.reset();
    }
    void begin(bool messages, size_t write_limit = SIZE_MAX) {
        fake = std::make_shared<FakeStream>(messages, write_limit);
        // The loop is the dialler's own: the fake has it before its first task can run.
        client = std::make_unique<Dialler>(Endpoint{"fake", 1}, fake);
        on_loop([this] { fake->loop = &client->loop; });
    }
    void on_loop(const std::function<void()>& task) const {
        bool done = false;
        client->loop.post([&] {
            task();
            const std::lock_guard lock(client->mutex);
            done = true;
            client->news.notify_all();
        });
        ASSERT_TRUE(client->wait([&] { return done; }));
    }
    /// Callbacks take turns of the loop of their own.
    bool eventually(const std::function<bool()>& holds) const {
        bool held = false;
        for (int turns = 0; turns < 1000 && !held; ++turns) on_loop([&] { held = holds(); });
        return held;
    }
    void say(const ServerMessage& message) {
        on_loop([&] { fake->say(fake->keeps_messages() ? encode(message) : frame(encode(message))); });
    }
    /// What the client has written, one piece a write.
    std::vector<Bytes> written() {
        std::vector<Bytes> out;
        on_loop([&] { out = fake->written; });
        return out;
    }
};

TEST_F(FakeTest, magic_and_hello_are_one_write) {
    begin(false);
    client->send(usual_client_hello());
    client->send(ClockRequest{1, 77});
    on_loop([this] { EXPECT_TRUE(fake->written.empty()) << "written before it stands"; });
    on_loop([this] { fake->stand(); });
    Bytes wanted(stream_magic.begin(), stream_magic.end());
    for (const ClientMessage& message :
         {ClientMessage(usual_client_hello()), ClientMessage(ClockRequest{1, 77})}) {
        const Bytes framed = frame(encode(message));
        wanted.insert(wanted.end(), framed.begin(), framed.end());
    }
    EXPECT_EQ(written(), std::vector<Bytes>{wanted});
}

TEST_F(FakeTest, where_messages_are_kept_apart_each_is_a_write_without_header) {
    begin(true);
    client->send(usual_client_hello());
    client->send(ClockRequest{1, 77});
    on_loop([this] { fake->stand(); });
    ASSERT_TRUE(eventually([this] { return fake->written.size() == 2; }));
    EXPECT_EQ(written(), (std::vector<Bytes>{encode(ClientMessage(usual_client_hello())),
                                             encode(ClientMessage(ClockRequest{1, 77}))}));
    ServerHello hello = RawServer::usual_hello();
    hello.limits.frame_to_client = 5000;
    say(hello);
    ASSERT_TRUE(client->gets(1));
    on_loop([this] { EXPECT_EQ(fake->longest, 5000U) << "the limit in force"; });
    EXPECT_EQ(client->connection->traffic(), (Traffic{encode(ServerMessage(hello)).size(),
                                                      encode(ClientMessage(usual_client_hello())).size() +
                                                          encode(ClientMessage(ClockRequest{1, 77})).size(),
                                                      1, 2}));
}

TEST_F(FakeTest, a_stream_may_be_cut_at_every_byte) {
    begin(false);
    on_loop([this] { fake->stand(); });
    Bytes stream = frame(encode(ServerMessage(RawServer::usual_hello())));
    const Bytes reply = frame(encode(ServerMessage(ClockReply{})));
    stream.insert(stream.end(), reply.begin(), reply.end());
    on_loop([&] {
        for (const uint8_t byte : stream) fake->say({byte});
    });
    ASSERT_TRUE(client->gets(2));
    EXPECT_EQ(client->connection->traffic().bytes_received, stream.size());
}

TEST_F(FakeTest, a_breach_that_the_stream_finds_is_refused_with_its_code) {
    begin(true);
    on_loop([this] { fake->stand(); });
    say(RawServer::usual_hello());
    on_loop([this] { fake->breaks({ErrorCode::frame_too_long, "too long"}); });
    ASSERT_TRUE(eventually([this] { return fake->shut_; }));
    const auto told = decode_client(written().at(0));
    ASSERT_TRUE(told);
    EXPECT_EQ(std::get<Goodbye>(*told).code, ErrorCode::frame_too_long);
    on_loop([this] { fake->breaks({ErrorCode::malformed_frame, "and once more"}); });
    EXPECT_EQ(client->closed_count, 0) << "reads on until the end";
    on_loop([this] { fake->breaks({ErrorCode::none, "gone"}); });
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::refused_server);
    EXPECT_EQ(client->goodbye.code, ErrorCode::frame_too_long);
    EXPECT_TRUE(eventually([this] { return fake->closed; }));
}

TEST_F(FakeTest, a_failed_write_leaves_the_last_word_to_the_read) {
    begin(false, 20);
    client->send(usual_client_hello());
    on_loop([this] { fake->stand(); });
    EXPECT_TRUE(eventually([this] { return client->connection->traffic().bytes_sent == 20; }));
    EXPECT_EQ(client->closed_count, 0);
    Goodbye goodbye;
    goodbye.code = ErrorCode::shutting_down;
    goodbye.message = "for today";
    say(goodbye);
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::server_goodbye);
    EXPECT_EQ(client->goodbye, goodbye);
}

TEST_F(FakeTest, a_server_that_takes_nothing_is_given_up) {
    begin(false);
    on_loop([this] {
        fake->hold_writes = true;
        fake->stand();
    });
    say(RawServer::usual_hello());
    ClientHello large = usual_client_hello();
    large.token = std::string(1000, 't');
    for (int i = 0; i < 300; ++i) client->send(large);
    ASSERT_TRUE(client->ends());
    EXPECT_TRUE(client->says("takes nothing more")) << client->goodbye.message;
    EXPECT_EQ(client->cause, CloseCause::lost);
}

TEST_F(FakeTest, a_dial_that_fails_says_why_and_one_that_sleeps_is_given_up) {
    begin(false);
    on_loop([this] { fake->stand(Error{ErrorCode::none, "the tide is out"}); });
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->goodbye.message, "the tide is out");
    EXPECT_EQ(client->cause, CloseCause::lost);
    end();
    begin(false);
    ASSERT_TRUE(client->ends());
    EXPECT_TRUE(client->says("the fake slept at fake:1 within 5 s")) << client->goodbye.message;
}

TEST_F(FakeTest, a_call_for_encryption_names_the_address_to_use) {
    begin(false);
    on_loop([this] { fake->stand(); });
    Goodbye goodbye;
    goodbye.code = ErrorCode::encryption_required;
    goodbye.message = "no plain text here";
    say(goodbye);
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->cause, CloseCause::server_goodbye);
    EXPECT_EQ(client->goodbye.message, "no plain text here (--connect tls://fake:1)");
}

TEST_F(FakeTest, strangers_are_told_by_their_first_bytes) {
    const std::pair<std::string, std::string> strangers[] = {
        {"HTTP/1.1 400 Bad Request\r\n",
         "a web server listens at fake:1 and does not speak Trochoid's protocol"},
        {std::string("\x15\x03\x01\x00\x02\x02\x46\x00", 8), "wants TLS: use --connect tls://fake:1"},
        {"SSH-2.0-OpenSSH", "what listens at fake:1 does not speak Trochoid's protocol"},
    };
    for (const auto& stranger : strangers) {
        const std::string& words = stranger.second;
        const Bytes bytes(stranger.first.begin(), stranger.first.end());
        begin(false);
        on_loop([this] { fake->stand(); });
        on_loop([&] { fake->say(bytes); });
        on_loop([this] { fake->breaks({ErrorCode::none, "gone"}); });
        ASSERT_TRUE(client->ends()) << words;
        EXPECT_EQ(client->cause, CloseCause::refused_server);
        EXPECT_TRUE(client->says(words)) << client->goodbye.message;
        end();
    }
}

TEST_F(FakeTest, an_end_before_the_hello_says_that_tls_may_be_wanted) {
    begin(false);
    on_loop([this] { fake->stand(); });
    on_loop([this] { fake->breaks({ErrorCode::none, "it went away"}); });
    ASSERT_TRUE(client->ends());
    EXPECT_EQ(client->goodbye.message,
              "it went away before its hello: check --connect (where TLS is wanted: tls://fake:1)");
}

}  // namespace
}  // namespace trochoid
