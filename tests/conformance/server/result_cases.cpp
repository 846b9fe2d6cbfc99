#include <fmt/format.h>

#include <algorithm>

#include "protocol/wire/requirements.hpp"
#include "tests/conformance/server/refusals.hpp"

// results, their order, their bases, and acknowledgements.
namespace trochoid::conformance::server {

namespace {

// What a server may have unacknowledged (chapter 8), and a frame that was begun before.
constexpr uint64_t window_bytes = 64 * 1024;
constexpr uint32_t window_results = 32;

ClientHello watching(const Target& target, double altitude_m = 20.0) {
    ClientHello hello = ServerPeer::usual_hello();
    hello.view = view_of_water(target, altitude_m);
    return hello;
}

/// Moves far enough that another result has to follow.
void move_on(ServerPeer& peer, ViewState& view) {
    view.position.x += 8192 * lattice_per_metre;
    peer.send(ViewUpdate{peer.next_sequence(), view});
}

/// Moves on and on without an acknowledgement, until results stop coming.
void fill_window(ServerTrial& trial) {
    ServerPeer& peer = trial.connect();
    peer.acknowledge_by_itself(false);
    ClientHello hello = watching(trial.target(), 100.0);
    hello.view.patch_budget = 1024;
    hello.view.accepted_error_px = 0.1F;
    uint64_t bytes = 0;
    uint32_t begun = 0;
    peer.watch([&](const ServerMessage& message, int64_t) {
        const auto* piece = std::get_if<Delta>(&message);
        if (piece == nullptr && !std::holds_alternative<TerrainTiles>(message)) return;
        if (piece != nullptr && piece->piece == 0) {
            if (bytes >= window_bytes)
                throw Failed{fmt::format("R-133: a result begins after {} bytes unacknowledged", bytes)};
            if (++begun > window_results)
                throw Failed{fmt::format("R-133: {} results came unacknowledged", begun)};
        }
        bytes += encode(message).size() + frame_header_bytes;
    });
    peer.log_in(hello);
    peer.await_result(0);
    // Slower than views may come, and than most servers decide results.
    const Milliseconds pause(std::max(150U, 1200 / std::max(peer.hello().limits.views_per_second, 1U)));
    for (uint32_t i = 0; i < window_results + 4; ++i) {
        const uint32_t before = peer.held().result();
        move_on(peer, hello.view);
        const Deadline deadline(pause);
        while (!deadline.passed() && peer.receive(deadline.left())) {
        }
        if (peer.held().result() == before && bytes >= window_bytes) break;
    }
    trial.note(fmt::format("{} results, {} bytes", begun, bytes));
    if (bytes < window_bytes && begun < window_results)
        throw Skipped{"the results in the scene's middle do not fill the window"};
    peer.watch({});
    peer.acknowledge();
    peer.expect_service();
}

void add_order(Catalogue& all) {
    all.push_back(server_case(
        "R-134/first-result", "The first result is number 1, a snapshot, right after the hello",
        [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in(watching(trial.target()));
            const int64_t begin_us = monotonic_us();
            const Delta& first = peer.await_result(0);
            trial.note(fmt::format(
                "whole {:.1f} ms after the hello: {} boxes, {} patches, {} blocks in {} pieces",
                static_cast<double>(monotonic_us() - begin_us) * 1e-3, peer.held().state().boxes.size(),
                peer.held().state().patches.size(), peer.held().state().blocks.size(), peer.held().pieces()));
            if (first.result != 1 || first.base != 0)
                throw Failed{fmt::format("the first result is {} on {}", first.result, first.base)};
        }));
    all.push_back(server_case(
        "R-134/ascending", "Twelve results ascend by 1, each on the last", [](ServerTrial& trial) {
            ClientHello hello = watching(trial.target());
            ServerPeer& peer = trial.log_in(hello);
            for (uint32_t i = 0; i < 12; ++i) {
                peer.await_result(peer.held().result());
                move_on(peer, hello.view);
            }
            if (peer.held().snapshots() != 1)
                throw Failed{fmt::format("{} snapshots came without a reason", peer.held().snapshots() - 1)};
        }));
    all.push_back(server_case("R-134/turning", "A camera that turns round: each result is whole and right",
                              [](ServerTrial& trial) {
                                  ClientHello hello = watching(trial.target(), 60.0);
                                  ServerPeer& peer = trial.log_in(hello);
                                  constexpr float half[] = {0.38268343F, 0.70710678F, 0.92387953F,
                                                            1.0F};  // sines of 22.5, 45, 67.5, 90 degrees
                                  constexpr float other[] = {0.92387953F, 0.70710678F, 0.38268343F, 0.0F};
                                  for (size_t i = 0; i < 4; ++i) {
                                      hello.view.qx = hello.view.qz = 0.0F;
                                      hello.view.qy = half[i];
                                      hello.view.qw = other[i];
                                      peer.await_result(peer.held().result());
                                      peer.send(ViewUpdate{peer.next_sequence(), hello.view});
                                  }
                                  peer.await_result(4);
                              }));
    all.push_back(server_case("R-134/key", "A result's key holds what was asked for", [](ServerTrial& trial) {
        ClientHello hello = watching(trial.target());
        hello.view.patch_budget = 64;
        hello.view.accepted_error_px = 2.0F;
        hello.regions = {{trial.target().place, 200 * 1024}};
        ServerPeer& peer = trial.log_in(hello);
        const CullKey key = peer.await_result(0).key;
        const ClockReply clock = peer.ask_clock();
        if (key.regions != hello.regions) throw Failed{"R-131: the key has other regions than the hello"};
        if (key.patch_limit > hello.view.patch_budget)
            throw Failed{fmt::format("the key allows {} patches, the view {}", key.patch_limit,
                                     hello.view.patch_budget)};
        if (key.error_in_force_px < hello.view.accepted_error_px)
            throw Failed{"the error in force is below the accepted one"};
        if (key.from > key.until) throw Failed{"the key's span ends before it begins"};
        if (clock.clock.rate_q16 > 0 &&
            key.until <= sea_time_at(peer.hello().clock, peer.hello().server_now_us))
            throw Failed{"the key's span lies in the past"};
        if (key.log_position > clock.log_position) throw Failed{"the key's log position is ahead of the log"};
    }));
}

void add_budgets(Catalogue& all) {
    all.push_back(
        server_case("R-134/budget-1", "A budget of one patch is kept; the error in force rises instead",
                    [](ServerTrial& trial) {
                        ClientHello hello = watching(trial.target());
                        hello.view.patch_budget = 1;
                        ServerPeer& peer = trial.log_in(hello);
                        const Delta& first = peer.await_result(0);
                        if (peer.held().state().patches.size() > 1)
                            throw Failed{fmt::format("{} patches came", peer.held().state().patches.size())};
                        trial.note(fmt::format("error in force {} px", first.key.error_in_force_px));
                    }));
    all.push_back(server_case(
        "R-134/budget-1024", "The largest budget: every piece within the frame limit, the whole state right",
        [](ServerTrial& trial) {
            ClientHello hello = watching(trial.target(), 300.0);
            hello.view.patch_budget = 1024;
            hello.view.accepted_error_px = 0.1F;
            ServerPeer& peer = trial.log_in(hello);
            peer.await_result(0);
            trial.note(fmt::format("{} patches, {} pieces", peer.held().state().patches.size(),
                                   peer.held().pieces()));
        }));
    all.push_back(
        server_case("R-134/nothing-new", "Nothing is sent while nothing changes", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            peer.await_result(0);
            peer.settle(Milliseconds(200));
            int changes = 0;  // empty results carry a new span, or ask for an acknowledgement of terrain
            peer.watch([&](const ServerMessage& message, int64_t) {
                const auto* piece = std::get_if<Delta>(&message);
                changes += piece != nullptr && !piece->change.empty();
            });
            for (int i = 0; i < 5; ++i) peer.send(ViewUpdate{peer.next_sequence(), view_of_sky()});
            peer.settle(Milliseconds(400));
            if (changes > 0)
                throw Failed{
                    fmt::format("{} pieces with changes came for a view that did not change", changes)};
        }));
    all.push_back(
        server_case("R-134/latest-view", "Of many views the last one counts", [](ServerTrial& trial) {
            ClientHello hello = watching(trial.target());
            ServerPeer& peer = trial.log_in(hello);
            const uint32_t count = std::min(peer.hello().limits.views_per_second, 20U);
            for (uint32_t i = 0; i < count; ++i) move_on(peer, hello.view);
            const Deadline deadline(trial.target().patience);
            const auto near = [&] {
                if (!peer.held().last()) return false;
                const int64_t off = peer.held().last()->key.anchor.position.x - hello.view.position.x;
                return std::abs(off) <= 2048 * lattice_per_metre;
            };
            while (!near() && !deadline.passed()) peer.receive(deadline.left());
            if (!near()) throw Failed{"no result for the last of the views came"};
            trial.note(fmt::format("{} results for {} views", peer.held().result(), count));
        }));
}

void add_regions(Catalogue& all) {
    all.push_back(server_case("R-131/unseen", "A region counts for a client that looks at no water",
                              [](ServerTrial& trial) {
                                  ClientHello hello = ServerPeer::usual_hello();
                                  hello.regions = {{trial.target().place, 100 * 1024}};
                                  ServerPeer& peer = trial.log_in(hello);
                                  const Delta& first = peer.await_result(0);
                                  if (first.key.regions != hello.regions)
                                      throw Failed{"the key has other regions than the hello"};
                                  if (peer.held().state().boxes.empty() && !trial.target().boxes.empty())
                                      trial.note("no box reaches the region");
                              }));
    all.push_back(server_case(
        "R-131/changed", "Regions sent later take the place of the hello's", [](ServerTrial& trial) {
            ClientHello hello = ServerPeer::usual_hello();
            hello.regions = {{trial.target().place, 100 * 1024}};
            ServerPeer& peer = trial.log_in(hello);
            peer.await_result(0);
            const std::vector<SyncRegion> moved{{trial.target().place, 300 * 1024},
                                                {{trial.target().place.x + 1024 * 1024, 0}, 5 * 1024}};
            peer.send(SyncRegions{1, moved});
            const Deadline deadline(trial.target().patience);
            while (peer.held().last()->key.regions != moved && !deadline.passed())
                peer.receive(deadline.left());
            if (peer.held().last()->key.regions != moved)
                throw Failed{"no result has the new regions in its key"};
            peer.send(SyncRegions{2, {}});
            while (!peer.held().last()->key.regions.empty() && !deadline.passed())
                peer.receive(deadline.left());
            if (!peer.held().last()->key.regions.empty()) throw Failed{"no result without regions came"};
        }));
    all.push_back(server_case(
        "R-131/most-and-largest", "32 regions of 2 km: every piece within the frame limit",
        [](ServerTrial& trial) {
            ClientHello hello = ServerPeer::usual_hello();
            const LatticePoint place = trial.target().place;
            for (int64_t i = 0; i < 32; ++i)
                hello.regions.push_back(
                    {{place.x + (i % 8 - 4) * 1024 * 1024, place.z + (i / 8 - 2) * 1024 * 1024},
                     Limits{}.sync_radius});
            ServerPeer& peer = trial.log_in(hello);
            peer.await_result(0);
            trial.note(fmt::format("{} boxes, {} blocks in {} pieces", peer.held().state().boxes.size(),
                                   peer.held().state().blocks.size(), peer.held().pieces()));
        }));
}

void add_acks(Catalogue& all) {
    all.push_back(server_case("R-133/wrong-hash",
                              "After an acknowledgement with another hash a snapshot follows",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.acknowledge_by_itself(false);
                                  peer.log_in(watching(trial.target()));
                                  peer.await_result(0);
                                  const uint32_t before = peer.held().result();
                                  peer.held().await_snapshot();
                                  peer.acknowledge(peer.held().hash() ^ 1);
                                  const Deadline deadline(trial.target().patience);
                                  while (peer.held().snapshots() < 2 && !deadline.passed())
                                      peer.receive(deadline.left());
                                  if (peer.held().snapshots() < 2) throw Failed{"no snapshot came"};
                                  peer.await_result(before);
                                  peer.acknowledge();
                                  peer.expect_service();
                              }));
    all.push_back(server_case(
        "R-133/never-in-step", "A client that never comes into step is let go", [](ServerTrial& trial) {
            ServerPeer& peer = trial.connect();
            peer.acknowledge_by_itself(false);
            peer.log_in();
            uint32_t snapshots = 0;
            const Deadline deadline(trial.target().patience);
            while (!peer.goodbye() && !deadline.passed()) {
                if (peer.held().snapshots() > snapshots && peer.held().last() &&
                    peer.held().last()->result == peer.held().result()) {
                    snapshots = peer.held().snapshots();
                    if (snapshots > 40) throw Failed{"40 snapshots came, and no end"};
                    peer.held().await_snapshot();
                    peer.acknowledge(1);
                }
                if (!peer.receive(deadline.left())) break;
            }
            trial.note(fmt::format("{} snapshots came", snapshots));
            const Goodbye goodbye = peer.expect_goodbye(ErrorCode::base_mismatch);
            if (!goodbye.retry)
                throw Failed{"the goodbye does not say that trying again can help (chapter 12)"};
        }));
}

void add_windows(Catalogue& all) {
    const auto never_written = [&](const char* id, const char* title,
                                   std::function<uint32_t(uint32_t)> number) {
        all.push_back(server_case(id, title, [number = std::move(number)](ServerTrial& trial) {
            ServerPeer& peer = trial.connect();
            peer.acknowledge_by_itself(false);
            peer.log_in();
            peer.await_result(0);
            peer.send(Ack{number(peer.held().result()), peer.held().hash(), 0, {}});
            peer.expect_goodbye(ErrorCode::value_out_of_range, requirement::whole_results);
        }));
    };
    never_written("R-135/next", "A result is acknowledged that is not written yet",
                  [](uint32_t result) { return result + 20; });
    never_written("R-135/last-number", "The result 2³² - 1 is acknowledged",
                  [](uint32_t) { return UINT32_MAX; });
    all.push_back(
        server_case("R-135/before-the-first", "A result is acknowledged in the same write as the hello",
                    [](ServerTrial& trial) {
                        ServerPeer& peer = trial.connect();
                        peer.acknowledge_by_itself(false);
                        Bytes together(stream_magic.begin(), stream_magic.end());
                        for (const ClientMessage& message :
                             {ClientMessage{ServerPeer::usual_hello()}, ClientMessage{Ack{1000, 0, 0, {}}}}) {
                            const Bytes framed = frame(encode(message));
                            together.insert(together.end(), framed.begin(), framed.end());
                        }
                        peer.send_bytes(together);
                        peer.expect_goodbye(ErrorCode::value_out_of_range, requirement::whole_results);
                    }));
    all.push_back(server_case("R-125/ack-back", "An acknowledgement goes back to an earlier result",
                              [](ServerTrial& trial) {
                                  ClientHello hello = watching(trial.target());
                                  ServerPeer& peer = trial.log_in(hello);
                                  peer.await_result(0);
                                  move_on(peer, hello.view);
                                  peer.await_result(1);
                                  peer.send(Ack{1, 0, 0, {}});
                                  peer.expect_goodbye(ErrorCode::sequence_not_monotone);
                              }));
    all.push_back(
        server_case("R-125/ack-again", "The same result may be acknowledged again", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            peer.await_result(0);
            peer.acknowledge();
            peer.acknowledge();
            peer.expect_service();
        }));
    all.push_back(server_case("R-133/window",
                              "Without acknowledgements no result is begun after 64 KiB, or 32 results",
                              [](ServerTrial& trial) { fill_window(trial); }));
    all.push_back(server_case("R-133/late-ack",
                              "After a window that was full an acknowledgement lets results go on",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.acknowledge_by_itself(false);
                                  ClientHello hello = watching(trial.target());
                                  peer.log_in(hello);
                                  peer.await_result(0);
                                  for (int i = 0; i < 10; ++i) move_on(peer, hello.view);
                                  peer.settle(Milliseconds(300));
                                  const uint32_t before = peer.held().result();
                                  peer.acknowledge();
                                  peer.acknowledge_by_itself(true);
                                  move_on(peer, hello.view);
                                  peer.await_result(before);
                              }));
}

}  // namespace

void add_result_cases(Catalogue& all) {
    add_order(all);
    add_budgets(all);
    add_regions(all);
    add_acks(all);
    add_windows(all);
}

}  // namespace trochoid::conformance::server
