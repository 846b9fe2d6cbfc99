#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "protocol/model/self_check.hpp"
#include "tests/conformance/server/refusals.hpp"

// what the hello and the clock tell, and the known answer.
namespace trochoid::conformance::server {

namespace {

/// One exchange: the server's clock less ours, and by how much that may be off, microseconds.
struct Offset {
    int64_t offset_us = 0;
    int64_t bound_us = 0;
};

Offset offset_of(int64_t t0, int64_t t1, int64_t t2, int64_t t3) {
    return {((t1 - t0) + (t2 - t3)) / 2, ((t3 - t0) - (t2 - t1)) / 2};
}

ClockReply timed(ServerPeer& peer, Offset& offset) {
    const ClockReply reply = peer.ask_clock();
    offset = offset_of(reply.client_sent_us, reply.server_received_us, reply.server_sent_us, monotonic_us());
    return reply;
}

void agree(const Offset& a, const Offset& b) {
    constexpr int64_t rounding_us = 2;
    if (std::abs(a.offset_us - b.offset_us) > a.bound_us + b.bound_us + rounding_us)
        throw Failed{fmt::format(
            "two exchanges put the server's clock {} us apart, more than their round trips allow ({} us)",
            std::abs(a.offset_us - b.offset_us), a.bound_us + b.bound_us)};
}

void add_exchange(Catalogue& all) {
    all.push_back(server_case("R-142/hello-counts",
                              "The hello is a first exchange: it agrees with the next one",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  ClientHello hello = ServerPeer::usual_hello();
                                  hello.clock_stamp_us = monotonic_us();
                                  peer.log_in(hello);
                                  const int64_t now_us = monotonic_us();
                                  const int64_t told_us = peer.hello().server_now_us;
                                  Offset next;
                                  timed(peer, next);
                                  agree(offset_of(hello.clock_stamp_us, told_us, told_us, now_us), next);
                              }));
    all.push_back(
        server_case("R-142/eight-at-50-ms", "Eight exchanges 50 ms apart agree", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            Offset first;
            timed(peer, first);
            int64_t least = first.bound_us;
            for (int i = 1; i < 8; ++i) {
                std::this_thread::sleep_for(Milliseconds(50));
                Offset next;
                timed(peer, next);
                agree(first, next);
                least = std::min(least, next.bound_us);
            }
            trial.note(fmt::format("the least error bound is {} us", least));
        }));
    all.push_back(server_case("R-142/received-before-sent",
                              "Requests in one write: each is received after the last, none answered before",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.log_in();
                                  for (int i = 0; i < 10; ++i)
                                      peer.send(ClockRequest{peer.next_sequence(), monotonic_us()});
                                  int64_t before = INT64_MIN;
                                  for (int i = 0; i < 10; ++i) {
                                      const auto reply = peer.await<ClockReply>("clock reply");
                                      if (reply.server_received_us < before)
                                          throw Failed{"t1 went back between two replies"};
                                      before = reply.server_received_us;
                                  }
                              }));
    for (const int64_t stamp : {int64_t{0}, int64_t{-1}, int64_t{1} << 56, -(int64_t{1} << 56)})
        all.push_back(server_case(
            fmt::format("R-142/echoes-{}", stamp), "Any stamp within the bounds comes back as it is",
            [stamp](ServerTrial& trial) {
                ServerPeer& peer = trial.log_in();
                peer.send(ClockRequest{1, stamp});
                const auto reply = peer.await<ClockReply>("clock reply");
                if (reply.client_sent_us != stamp || reply.sequence != 1)
                    throw Failed{fmt::format("the reply echoes {}, not {}", reply.client_sent_us, stamp)};
            }));
    for (const int64_t stamp : {int64_t{0}, int64_t{1} << 56, -(int64_t{1} << 56)})
        all.push_back(server_case(fmt::format("R-142/hello-echoes-{}", stamp),
                                  "Any stamp of a hello comes back as it is", [stamp](ServerTrial& trial) {
                                      ClientHello hello = ServerPeer::usual_hello();
                                      hello.clock_stamp_us = stamp;
                                      trial.log_in(hello);
                                  }));
    all.push_back(server_case(
        "R-142/sea-time", "The sea time that a list tells is that of the clock told", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const ClockReply before = peer.ask_clock();
            const SeaTime now = peer.ask_boxes().now;
            const ClockReply after = peer.ask_clock();
            if (before.clock != after.clock) throw Skipped{"the clock was changed meanwhile"};
            const SeaTime least = sea_time_at(before.clock, before.server_received_us);
            const SeaTime most = sea_time_at(after.clock, after.server_sent_us);
            if (now < least || now > most)
                throw Failed{fmt::format("a list says that it is {} us, but the clock gives {} to {} us",
                                         now.us, least.us, most.us)};
        }));
    all.push_back(
        server_case("R-142/hello-clock", "Hello and replies tell one clock", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const ClockReply reply = peer.ask_clock();
            if (reply.clock.epoch == peer.hello().clock.epoch && reply.clock != peer.hello().clock)
                throw Failed{"the hello tells another clock than a reply of the same epoch"};
            if (reply.server_received_us < peer.hello().server_now_us)
                throw Failed{"the server's monotonic clock stepped back after its hello"};
            if (reply.log_position < peer.hello().log_position)
                throw Failed{"the log position fell after the hello"};
        }));
}

void add_watermark(Catalogue& all) {
    all.push_back(server_case(
        "R-144/rises", "The watermark rises with the time, and never falls", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const ClockReply first = peer.ask_clock();
            if (first.clock.rate_q16 == 0) throw Skipped{"the sea's time stands still"};
            std::this_thread::sleep_for(Milliseconds(300));
            const ClockReply later = peer.ask_clock();
            if (later.watermark <= first.watermark)
                throw Failed{fmt::format("the watermark stood at {} us for 300 ms", later.watermark.us)};
        }));
    all.push_back(server_case("R-144/all-alike", "Two sessions are told one log", [](ServerTrial& trial) {
        ServerPeer& one = trial.log_in();
        ServerPeer& other = trial.log_in();
        for (int i = 0; i < 10; ++i) {
            const ClockReply a = one.ask_clock();
            const ClockReply b = other.ask_clock();
            if (b.watermark < a.watermark)
                throw Failed{"a later reply to another session has an earlier watermark"};
            if (b.log_position < a.log_position)
                throw Failed{"a later reply to another session has an earlier log position"};
            if (a.log_position == b.log_position && a.log_hash != b.log_hash)
                throw Failed{"one log position, two hashes"};
        }
    }));
    all.back().connections = 2;
    all.push_back(
        server_case("R-144/results", "The watermarks of results do not fall, nor behind those of replies",
                    [](ServerTrial& trial) {
                        ServerPeer& peer = trial.connect();
                        SeaTime highest{INT64_MIN};
                        peer.watch([&](const ServerMessage& message, int64_t) {
                            const auto* piece = std::get_if<Delta>(&message);
                            if (piece == nullptr) return;
                            if (piece->watermark < highest)
                                throw Failed{"a result has an earlier watermark than what came before"};
                            highest = piece->watermark;
                        });
                        ClientHello hello = ServerPeer::usual_hello();
                        hello.view = view_of_water(trial.target());
                        peer.log_in(hello);
                        for (int i = 0; i < 5; ++i) {
                            peer.await_result(peer.held().result());
                            hello.view.position.x += 4096 * lattice_per_metre;
                            peer.send(ViewUpdate{peer.next_sequence(), hello.view});
                        }
                    }));
    all.push_back(server_case("R-129/instance",
                              "Two sessions are told one instance of the world, and it is not zero",
                              [](ServerTrial& trial) {
                                  const WorldInstance one = trial.log_in().hello().instance;
                                  const WorldInstance other = trial.log_in().hello().instance;
                                  if (one != other)
                                      throw Failed{"two sessions beside each other are told two instances"};
                                  if (one == WorldInstance{}) throw Failed{"the instance is all zero"};
                              }));
    all.back().connections = 2;
    all.push_back(server_case("R-129/limits", "The limits told are finite, and a client can live with them",
                              [](ServerTrial& trial) {
                                  const Limits& told = trial.log_in().hello().limits;
                                  const std::pair<const char*, uint32_t> figures[] = {
                                      {"hello_deadline_ms", told.hello_deadline_ms},
                                      {"views_per_second", told.views_per_second},
                                      {"sync_regions", told.sync_regions},
                                      {"patches", told.patches},
                                      {"trains_per_box", told.trains_per_box},
                                      {"boxes", told.boxes},
                                      {"commands_per_second", told.commands_per_second},
                                      {"sample_points", told.sample_points},
                                      {"sessions", told.sessions},
                                      {"control_messages", told.control_messages},
                                      {"no_progress_ms", told.no_progress_ms}};
                                  for (const auto& [name, figure] : figures)
                                      if (figure == 0) throw Failed{fmt::format("the limit {} is 0", name)};
                                  if (told.frame_after_login < told.frame_before_login)
                                      throw Failed{"frames may be longer before the login than after it"};
                              }));
}

void add_known_answer(Catalogue& all) {
    const auto verdict_after = [](ServerTrial& trial,
                                  std::function<std::optional<uint64_t>(const ServerHello&)> answer) {
        ServerPeer& peer = trial.connect();
        peer.acknowledge_by_itself(false);
        const ServerHello hello = peer.log_in();
        peer.await_result(0);
        if (peer.ask_clock().verdict != trochoid::Verdict::pending)
            throw Failed{"there is a verdict before the answer"};
        peer.answer_challenge(answer(hello));
        peer.acknowledge();
        const auto verdict = peer.ask_clock().verdict;
        // The session goes on whatever the answer was, and the verdict stays.
        if (peer.ask_clock().verdict != verdict)
            throw Failed{"the verdict changed from one reply to the next"};
        return verdict;
    };
    all.push_back(
        server_case("R-205/exact", "The right known answer makes a client exact", [=](ServerTrial& trial) {
            const auto verdict = verdict_after(trial, [](const ServerHello& hello) {
                return reference_hash(hello.challenge_seed, hello.challenge_count);
            });
            if (verdict != trochoid::Verdict::exact)
                throw Failed{"the right answer is not called exact: the server computes another sea"};
        }));
    all.push_back(server_case("R-205/approximate",
                              "A wrong known answer makes a client approximate, and ends nothing",
                              [=](ServerTrial& trial) {
                                  const auto verdict = verdict_after(trial, [](const ServerHello& hello) {
                                      return reference_hash(hello.challenge_seed, hello.challenge_count) ^ 1;
                                  });
                                  if (verdict != trochoid::Verdict::approximate)
                                      throw Failed{"a wrong answer is not called approximate"};
                              }));
    all.push_back(
        server_case("R-205/pending", "Without an answer the verdict is open", [=](ServerTrial& trial) {
            const auto verdict =
                verdict_after(trial, [](const ServerHello&) { return std::optional<uint64_t>(); });
            if (verdict != trochoid::Verdict::pending) throw Failed{"there is a verdict without an answer"};
        }));
    all.push_back(
        server_case("R-205/challenges-differ", "Two sessions get two challenges, of 1 to 65,536 points",
                    [](ServerTrial& trial) {
                        const ServerHello one = trial.log_in().hello();
                        const ServerHello other = trial.log_in().hello();
                        if (one.challenge_seed == other.challenge_seed)
                            throw Failed{"two sessions have one challenge: an answer can be repeated"};
                        if (one.challenge_count == 0 || one.challenge_count > 65536)
                            throw Failed{fmt::format("a challenge of {} points", one.challenge_count)};
                    }));
    all.back().connections = 2;
}

}  // namespace

void add_clock_cases(Catalogue& all) {
    add_exchange(all);
    add_watermark(all);
    add_known_answer(all);
}

}  // namespace trochoid::conformance::server
