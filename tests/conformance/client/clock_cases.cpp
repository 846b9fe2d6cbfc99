#include <fmt/format.h>

#include <cstdlib>

#include "tests/conformance/client/refusals.hpp"

// clock requests and what replies may say.
namespace trochoid::conformance::client {

namespace {

const std::vector<Due> refusals{{ErrorCode::value_out_of_range, any_due_requirement},
                                {ErrorCode::unexpected_message, any_due_requirement}};

/// From the third reply on the replies are bent: the client may refuse that or go on.
void add_bent(Catalogue& all, const char* id, const char* title, void (*bend)(ClockReply&),
              bool has_to_be_taken = false) {
    all.push_back(client_case(id, title, [bend, has_to_be_taken](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome([](ServerHello& hello) { hello.clock.epoch = 4; });
        int replies = 0;
        peer.bend_clock([&](ClockReply& reply) {
            if (++replies >= 3) bend(reply);
        });
        const Deadline deadline(Milliseconds(3000));
        while (replies < 5 && !peer.goodbye() && !deadline.passed()) peer.listen(Milliseconds(60));
        if (replies < 3) throw Failed{"R-142: no three clock requests came in 3 s"};
        if (has_to_be_taken)
            peer.expect_service();
        else if (peer.goodbye())
            peer.expect_goodbye(refusals[0], {refusals[1]});
        else
            peer.expect_goodbye_or_service(refusals);
    }));
}

}  // namespace

void add_clock_cases(Catalogue& all) {
    Case requests =
        client_case("R-142/requests", "8 requests 50 ms apart, then one every 2 s", [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            constexpr size_t burst = 8;
            const Deadline deadline(Milliseconds(7000));
            while (peer.clock_requests().size() < burst + 2 && !deadline.passed())
                peer.listen(Milliseconds(50));
            const std::vector<ClockRequest>& asked = peer.clock_requests();
            if (asked.size() < burst + 2)
                throw Failed{
                    fmt::format("R-142: {} requests came in 7 s, {} were due", asked.size(), burst + 2)};
            // By the client's own clock. A machine that is busy sends later, never much earlier.
            const auto apart_ms = [&](size_t i) {
                return static_cast<double>(asked[i].client_sent_us - asked[i - 1].client_sent_us) * 1e-3;
            };
            const auto within = [&](size_t i, double least, double most) {
                if (apart_ms(i) < least || apart_ms(i) > most)
                    throw Failed{
                        fmt::format("R-142: requests {} and {} are {:.0f} ms apart", i, i + 1, apart_ms(i))};
            };
            for (size_t i = 1; i < burst; ++i) within(i, 25.0, 1000.0);
            for (size_t i = burst; i < burst + 2; ++i) within(i, 1500.0, 4000.0);
            trial.note(fmt::format("the first two {:.0f} ms apart, the last two {:.0f} ms", apart_ms(1),
                                   apart_ms(burst + 1)));
        });
    requests.course = Course::waiting;
    all.push_back(std::move(requests));
    all.push_back(
        client_case("R-142/stamps", "The requests' stamps run as our clock does", [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            const Deadline deadline(Milliseconds(4000));
            while (peer.clock_requests().size() < 6 && !deadline.passed()) peer.listen(Milliseconds(50));
            const auto& asked = peer.clock_requests();
            if (asked.size() < 6) throw Failed{"R-142: no six requests came in 4 s"};
            const int64_t theirs = asked.back().client_sent_us - asked.front().client_sent_us;
            const int64_t ours = peer.clock_requests_at_us().back() - peer.clock_requests_at_us().front();
            trial.note(fmt::format("{} us by its clock, {} us by ours", theirs, ours));
            constexpr int64_t slack_us = 200'000;
            if (std::abs(theirs - ours) > slack_us)
                throw Failed{fmt::format("{} us by the client's clock, {} us by ours", theirs, ours)};
        }));
    all.push_back(client_case("R-142/unanswered",
                              "Requests that are not answered do not end the session at once",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  peer.answer_by_itself(false);
                                  peer.listen(Milliseconds(1000));
                                  peer.answer_by_itself(true);
                                  peer.expect_service();
                              }));
    add_bent(all, "R-144/watermark-falls", "The watermark falls: it may be refused, or not counted",
             [](ClockReply& r) { r.watermark.us -= 60'000'000; });
    add_bent(all, "R-144/log-falls", "The log position falls: it may be refused, or not counted",
             [](ClockReply& r) { r.log_position = {1}; });
    add_bent(all, "R-142/epoch-falls",
             "The clock goes back to an earlier epoch: it may be refused, or not counted",
             [](ClockReply& r) { --r.clock.epoch; });
    add_bent(all, "R-142/sent-before-received",
             "A reply was sent before its request was received: it may be refused, or not counted",
             [](ClockReply& r) { r.server_sent_us = r.server_received_us - 1000; });
    add_bent(all, "R-142/other-sequence",
             "A reply to a request that never was: it may be refused, or not counted",
             [](ClockReply& r) { r.sequence = 60000; });
    add_bent(all, "R-142/other-stamp", "A reply that echoes another stamp: it may be refused, or not counted",
             [](ClockReply& r) { r.client_sent_us -= 777; });
    add_bent(
        all, "R-142/next-epoch", "A new epoch with four times the rate",
        [](ClockReply& r) {
            ++r.clock.epoch;
            r.clock.rate_q16 = 4U << 16;
        },
        true);
    add_bent(
        all, "R-142/paused", "A new epoch in which time stands still",
        [](ClockReply& r) {
            ++r.clock.epoch;
            r.clock.rate_q16 = 0;
        },
        true);
    add_bent(
        all, "R-142/skipped", "A new epoch a day later",
        [](ClockReply& r) {
            constexpr int64_t day_us = int64_t{86400} * microseconds_per_second;
            ++r.clock.epoch;
            r.clock.start.us += day_us;
            r.watermark.us += day_us;
        },
        true);
}

}  // namespace trochoid::conformance::client
