#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "client/store/clock_estimator.hpp"
#include "protocol/units/hash.hpp"

// Clock exchanges, and what a client makes of them (chapter 7 of the standard). To write the file anew after a deliberate change:
// TROCHOID_WRITE_GOLDENS=1 store_test --gtest_filter='ClockGoldens.*'
namespace trochoid {
namespace {

constexpr const char* file_name = TROCHOID_SOURCE_DIR "/tests/golden/wire_clock.txt";
constexpr const char* head =
    R"(# Trochoid golden clock exchanges, protocol version 3 (chapter 7). All numbers are decimal integers, times in microseconds.
# Lines count in their order. Records:
# client                                          a client that knows of no server yet
# clock EPOCH START MONOTONIC_START RATE_Q16      the server's clock from here on, as hellos and replies tell it
# And what follows from them:
# seatime M SEA                        sea time at the server's monotonic time M
# hello T0 T1 T3 OFFSET DELAY          a hello's stamps: the exchanges before it count no more; then the exchange that counts
# exchange T0 T1 T2 T3 OFFSET DELAY    the same after a reply
# reading M SEA ERROR                  shown sea time at the client's monotonic time M, and the bound of its error (real time)
)";

/// What the client of this file computes, line by line.
class Reader {
public:
    /// The answer that belongs behind the words of a line; empty for records.
    std::string answer(const std::string& kind, std::istream& in) {
        if (kind == "client") {
            estimator_ = ClockEstimator();
        } else if (kind == "clock") {
            in >> clock_.epoch >> clock_.start.us >> clock_.monotonic_start_us >> clock_.rate_q16;
        } else if (kind == "seatime") {
            int64_t at = 0;
            in >> at;
            return fmt::format("{}", sea_time_at(clock_, at).us);
        } else if (kind == "reading") {
            int64_t at = 0;
            in >> at;
            const SeaTime shown = estimator_.sea_time(at);
            return fmt::format("{} {}", shown.us, estimator_.error_bound_us(at));
        } else {
            return exchange(kind == "hello", in);
        }
        return "";
    }

private:
    std::string exchange(bool is_hello, std::istream& in) {
        int64_t back = 0;
        if (is_hello) {
            ServerHello hello;
            hello.clock = clock_;
            in >> hello.client_stamp_us >> hello.server_now_us >> back;
            estimator_.begin(hello, back);
        } else {
            ClockReply reply;
            reply.clock = clock_;
            in >> reply.client_sent_us >> reply.server_received_us >> reply.server_sent_us >> back;
            estimator_.add(reply, back);
        }
        return fmt::format("{} {}", estimator_.offset_us(), estimator_.round_trip_us());
    }

    ClockEstimator estimator_;
    SeaClock clock_;
};

/// The questions of the file: clients in networks good and bad, clocks of every rate.
class Story {
public:
    std::string text() {
        // Stamps far apart, odd sums of both signs, jitter; the server is behind and ahead.
        for (const int64_t ahead : {int64_t{123'456'789}, int64_t{-9'876'543'211}, int64_t{0}}) {
            says("client\nclock {} {} {} {}", next_epoch_++, 5'000'000 - ahead, ahead + 3, 65'536);
            ahead_ = ahead;
            meet(20'001, 7'000);
            for (int i = 0; i < 10; ++i) {
                ask(way(), 10 + i, way());
                look(16'667);
                look(33'331);
            }
        }
        // All later ones are worse, but in time the drift weighs more; nobody looks in between.
        says("client");
        meet(10, 13);
        for (int i = 0; i < 12; ++i) {
            now_ += 30'000'000;
            ask(1'000 + i, 0, 1'003);
        }
        look(1);
        rates();
        falls();
        return std::move(text_);
    }

private:
    template <class... Values>
    void says(fmt::format_string<Values...> form, Values&&... values) {
        text_ += fmt::format(form, std::forward<Values>(values)...) + "\n";
    }
    int64_t way() { return 50 + static_cast<int64_t>(splitmix64(dice_++) % 40'000); }
    void meet(int64_t there, int64_t back) {
        says("hello {} {} {}", now_, now_ + there + ahead_, now_ + there + back);
        now_ += there + back;
        look(0);
    }
    void ask(int64_t there, int64_t held, int64_t back) {
        const int64_t received = now_ + there + ahead_;
        says("exchange {} {} {} {}", now_, received, received + held, now_ + there + held + back);
        now_ += there + held + back;
    }
    void look(int64_t later) {
        now_ += later;
        says("reading {}", now_);
    }
    /// New epochs: they are shown at once.
    void rates() {
        for (const uint32_t rate : {0U, 1U, 65'535U, 131'072U, 16U << 16}) {
            says("clock {} {} {} {}", next_epoch_++, -1'000'000'007, now_ + ahead_ - 77, rate);
            for (const int64_t at : {int64_t{0}, int64_t{1}, int64_t{65'535}, int64_t{65'536}, int64_t{-1},
                                     int64_t{-65'537}, int64_t{1} << 56, -(int64_t{1} << 40)})
                says("seatime {}", at);
            ask(300, 5, 301);
            look(1'000'000);
        }
    }
    /// A better exchange is slewed in, from either side; who is asked often slews too; a second behind is made up at once; the
    /// same server met again begins its exchanges anew, but shows no step.
    void falls() {
        says("client");
        says("clock {} {} {} {}", next_epoch_++, 0, 0, 65'536);
        for (const int64_t step :
             {int64_t{60'000}, int64_t{-60'000}, int64_t{1'000'001}, int64_t{-999'999}}) {
            meet(64'000, 0);
            look(100);
            ahead_ += step;
            ask(50, 0, 51);
            for (const int64_t later :
                 {int64_t{63}, int64_t{64}, int64_t{65}, int64_t{1}, int64_t{62}, int64_t{16'667},
                  int64_t{1'000'000}, int64_t{3'000'000}, int64_t{90'000'000}})
                look(later);
            // A request that was answered before it was sent, as after a clock was set: the delay counts as none.
            says("exchange {} {} {} {}", now_, now_ + ahead_, now_ + ahead_ + 900, now_ + 1);
            look(5);
        }
    }

    std::string text_;
    int64_t now_ = 1'000'000;
    int64_t ahead_ = 0;
    uint64_t dice_ = 1;
    uint32_t next_epoch_ = 1;
};

TEST(ClockGoldens, this_client_reads_the_clock_as_the_file_says) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): a test has one thread here.
    if (std::getenv("TROCHOID_WRITE_GOLDENS") != nullptr) {
        std::ofstream out(file_name);
        out << head;
        Reader reader;
        std::istringstream questions(Story().text());
        for (std::string line; std::getline(questions, line);) {
            std::istringstream words(line);
            std::string kind;
            words >> kind;
            const std::string answer = reader.answer(kind, words);
            out << line << (answer.empty() ? "" : " ") << answer << '\n';
        }
    }
    std::ifstream in(file_name);
    Reader reader;
    int checked = 0;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with('#')) continue;
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        const std::string answer = reader.answer(kind, words);
        ASSERT_FALSE(words.fail()) << line;
        std::string expected;
        std::getline(words >> std::ws, expected);
        EXPECT_EQ(answer, expected) << line;
        checked += answer.empty() ? 0 : 1;
    }
    EXPECT_GT(checked, 150) << file_name;
}

}  // namespace
}  // namespace trochoid
