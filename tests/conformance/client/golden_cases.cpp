#include <fmt/format.h>

#include "protocol/model/probe_sum.hpp"
#include "protocol/model/self_check.hpp"
#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/golden_vectors.hpp"
#include "tests/conformance/kit_sea.hpp"

// known answers and golden messages; R-165: probes; and a session in which all is right.
namespace trochoid::conformance::client {

namespace {

void add_answers(Catalogue& all) {
    struct Challenge {
        uint64_t seed;
        uint32_t count;
    };
    for (const Challenge& it :
         {Challenge{1, 1}, Challenge{0x0123456789abcdef, 48}, Challenge{UINT64_MAX, 100}, Challenge{42, 0}})
        all.push_back(client_case(
            fmt::format("R-205/known-answer-{}", it.count),
            fmt::format("The first acknowledgement answers a challenge of {} samples exactly", it.count),
            [it](ClientTrial& trial) {
                ClientPeer& peer = trial.welcome([&](ServerHello& hello) {
                    hello.challenge_seed = it.seed;
                    hello.challenge_count = it.count;
                });
                peer.expect_service();
                const Ack& first = peer.acks().front();
                if (!first.known_answer) throw Failed{"the first acknowledgement holds no answer"};
                const uint64_t right = reference_hash(it.seed, it.count);
                if (*first.known_answer != right)
                    throw Failed{fmt::format("R-205: the answer is {:016x}, not {:016x}: another sea",
                                             *first.known_answer, right)};
            }));
    all.push_back(client_case("R-205/approximate",
                              "We say that the client's sea is approximate: the session goes on",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  peer.set_verdict(trochoid::Verdict::approximate);
                                  peer.expect_service();
                                  peer.listen(Milliseconds(400));
                                  peer.expect_service();
                              }));
}

/// A grid to which the message's tiles belong.
void fit_terrain(const ServerMessage& message, ServerHello& hello) {
    const auto* tiles = std::get_if<TerrainTiles>(&message);
    if (tiles == nullptr || tiles->tiles.empty()) return;
    const TerrainTile& tile = tiles->tiles.front();
    TerrainInfo& grid = hello.terrain;
    grid.spacing_log2 = tile.spacing_log2 - tile.key.level;
    grid.origin_x = tile.origin_x - (int64_t{tile.key.x} * 64 << tile.spacing_log2);
    grid.origin_z = tile.origin_z - (int64_t{tile.key.z} * 64 << tile.spacing_log2);
    grid.columns = (static_cast<uint32_t>(tile.key.x + 1) * 64 << tile.key.level) + 1;
    grid.rows = (static_cast<uint32_t>(tile.key.z + 1) * 64 << tile.key.level) + 1;
    grid.height_step_log2 = tile.height_step_log2;
    grid.open_sea_depth = -1024;
}

void add_messages(Catalogue& all) {
    // They belong to other sessions, so they may come at a wrong moment, but they are none that a decoder may refuse.
    const std::vector<Due> at_a_wrong_moment{{ErrorCode::unexpected_message, any_due_requirement},
                                             {ErrorCode::sequence_not_monotone, any_due_requirement},
                                             {ErrorCode::base_mismatch, any_due_requirement}};
    for (const GoldenMessage& golden : golden_messages()) {
        if (golden.direction != "server" || golden.name.starts_with("hello")) continue;
        all.push_back(client_case(
            "R-119/golden-" + golden.name, "A golden message is read",
            [golden, at_a_wrong_moment](ClientTrial& trial) {
                const auto message = decode_server(golden.bytes);
                if (!message)
                    throw Failed{"the kit cannot read the golden message itself: " + message.error().message};
                ClientPeer& peer = trial.welcome([&](ServerHello& hello) { fit_terrain(*message, hello); });
                peer.send_payload(golden.bytes);
                if (std::holds_alternative<Goodbye>(*message)) {
                    peer.expect_end();
                    if (peer.goodbye() && peer.goodbye()->code != ErrorCode::none)
                        throw Failed{"the client complains about a goodbye"};
                    return;
                }
                peer.expect_goodbye_or_service(at_a_wrong_moment);
            }));
    }
}

void add_probes(Catalogue& all) {
    const auto offer = [](ServerHello& hello) { hello.capabilities = capability_probes; };
    const auto probing = [offer](ClientTrial& trial) -> ClientPeer& {
        ClientPeer& peer = trial.welcome(offer);
        if ((peer.hello().capabilities & capability_probes) == 0 || peer.ours().protocol < 3)
            throw Skipped{"the client's hello does not offer probes"};
        return peer;
    };
    all.push_back(
        client_case("R-165/agrees", "A probe whose answer is right is followed by no report of a difference",
                    [probing](ClientTrial& trial) {
                        ClientPeer& peer = probing(trial);
                        peer.expect_service();
                        const auto probe = peer.await<Probe>("probe");
                        trial.note(fmt::format("{} points", probe.points.size()));
                        if (probe.points.empty() || probe.result != 1)
                            throw Failed{fmt::format("the probe names result {}, 1 is held", probe.result)};
                        peer.listen(Milliseconds(500));
                        if (peer.reported())
                            throw Failed{"R-165: a difference is reported though there is none"};
                        peer.expect_service();
                    }));
    all.push_back(client_case(
        "R-165/reports", "A probe's answer differs in one part: the client reports it and takes the snapshot",
        [probing](ClientTrial& trial) {
            ClientPeer& peer = probing(trial);
            ProbePart spoilt;
            peer.bend_probe([&](ProbeReply& reply) {
                if (reply.points.empty() || reply.points[0].parts.size() < 2 || spoilt.sum != 0) return;
                for (size_t i = 1; i < reply.points[0].parts.size(); ++i) reply.points[0].parts[i].sum ^= 1;
                reply.points[0].sample ^= 1;
                spoilt = reply.points[0].parts[1];
            });
            peer.expect_service();
            const auto report = peer.await<Desync>("report of a difference");
            if (report.box != spoilt.box || report.part != spoilt.part || report.expected != spoilt.sum)
                throw Failed{fmt::format(
                    "R-165: the report names part {} of box {}, the first that differs is part {} of box {}",
                    report.part, report.box.value, spoilt.part, spoilt.box.value)};
            if (report.actual != (spoilt.sum ^ 1))
                throw Failed{"R-165: the report's own hash is not that of the state held"};
            peer.expect_service();
        }));
    all.push_back(client_case("R-162/stale", "A probe is answered as stale: the session goes on",
                              [probing](ClientTrial& trial) {
                                  ClientPeer& peer = probing(trial);
                                  peer.bend_probe([](ProbeReply& reply) {
                                      reply.stale = true;
                                      reply.points.clear();
                                  });
                                  peer.expect_service();
                                  peer.await<Probe>("probe");
                                  peer.expect_service();
                              }));
    all.push_back(
        client_case("R-165/not-offered", "We do not offer probes: none comes", [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            peer.expect_service();
            constexpr Milliseconds span{600};
            const Deadline deadline(span);
            while (const auto message = peer.receive(deadline.left()))
                if (std::holds_alternative<Probe>(*message))
                    throw Failed{"a probe came that we have not offered"};
        }));
}

}  // namespace

void add_golden_cases(Catalogue& all) {
    all.push_back(client_case(
        "R-121/golden-way", "A session in which all is right, to our goodbye", [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome([](ServerHello& hello) {
                hello.challenge_count = 16;
                hello.ticket.assign(64, 3);
                hello.ticket_life_ms = 600'000;
            });
            peer.set_verdict(trochoid::Verdict::exact);
            peer.follow_interest(true);
            constexpr size_t small_pieces = 1500;
            peer.send_result(small_sea(), true, small_pieces);
            peer.await_ack(1);
            for (int i = 0; i < 6; ++i) {
                peer.send_result(i % 2 == 0 ? grown_sea() : small_sea(), false, small_pieces);
                peer.await_ack(peer.result());
                peer.listen(Milliseconds(100));
            }
            if (peer.clock_requests().size() < 2) throw Failed{"R-142: fewer than two clock requests came"};
            Goodbye goodbye;
            goodbye.code = ErrorCode::shutting_down;
            goodbye.message = "the golden way ends here";
            peer.send(goodbye);
            peer.expect_end();
            if (peer.goodbye() && peer.goodbye()->code != ErrorCode::none)
                throw Failed{"the client complains about a goodbye"};
        }));
    add_answers(all);
    add_messages(all);
    add_probes(all);
}

}  // namespace trochoid::conformance::client
