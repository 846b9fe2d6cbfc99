#include <fmt/format.h>

#include <algorithm>

#include "protocol/model/probe_sum.hpp"
#include "tests/conformance/server/refusals.hpp"

// probes of what both ends hold, and reports of differences.
namespace trochoid::conformance::server {

namespace {

ServerPeer& probing(ServerTrial& trial, const std::vector<SyncRegion>& regions = {}) {
    ClientHello hello = ServerPeer::usual_hello();
    hello.view = view_of_water(trial.target());
    hello.regions = regions;
    hello.capabilities = capability_probes;
    ServerPeer& peer = trial.log_in(hello);
    if ((peer.hello().capabilities & capability_probes) == 0 || peer.hello().protocol < 3)
        throw Skipped{"the server's hello does not offer probes"};
    peer.await_result(0);
    peer.settle();
    return peer;
}

ProbeReply ask(ServerPeer& peer, uint32_t result, SeaTime time, std::vector<LatticePoint> points) {
    Probe probe;
    probe.sequence = peer.next_sequence();
    probe.result = result;
    probe.time = time;
    probe.points = std::move(points);
    peer.send(probe);
    return peer.await<ProbeReply>("probe reply",
                                  [&](const ProbeReply& r) { return r.sequence == probe.sequence; });
}

/// The reply's points against what our state comes to.
void compare(const InterestState& state, const ProbeReply& reply, const std::vector<LatticePoint>& points) {
    if (reply.points.empty() || reply.points.size() > points.size())
        throw Failed{fmt::format("{} points were answered of {}", reply.points.size(), points.size())};
    for (size_t i = 0; i < reply.points.size(); ++i) {
        const PointSum ours = probe_sum(state, reply.time, points[i]);
        const ProbedPoint& theirs = reply.points[i];
        if (theirs.sample != ours.sample)
            throw Failed{
                fmt::format("at ({}, {}) the sample's hash is {:016x}, but the state comes to {:016x}",
                            points[i].x, points[i].z, theirs.sample, ours.sample)};
        if (theirs.parts.size() > ours.parts.size())
            throw Failed{fmt::format("{} parts where there are {}", theirs.parts.size(), ours.parts.size())};
        for (size_t p = 0; p < theirs.parts.size(); ++p) {
            const ProbePart& part = theirs.parts[p];
            if (part.box != ours.parts[p].box || part.part != ours.parts[p].part ||
                part.sum != ours.parts[p].sum)
                throw Failed{fmt::format("at ({}, {}) part {} of box {} differs", points[i].x, points[i].z,
                                         part.part, part.box.value)};
        }
    }
}

void compare_here(ServerTrial& trial, ServerPeer& peer, const std::vector<LatticePoint>& points) {
    for (int i = 0; i < 5; ++i) {
        const InterestState state = peer.held().state();
        const uint32_t result = peer.held().result();
        const CullKey key = peer.held().last()->key;
        const ProbeReply reply = ask(peer, result, {key.from.us + (key.until.us - key.from.us) / 2}, points);
        if (reply.result != result) throw Failed{"the reply names another result"};
        if (reply.stale) {
            if (!reply.points.empty()) throw Failed{"a stale reply has points"};
            peer.settle();
            continue;
        }
        compare(state, reply, points);
        size_t parts = 0;
        for (const ProbedPoint& point : reply.points) parts += point.parts.size();
        trial.note(fmt::format("{} points, {} parts", reply.points.size(), parts));
        return;
    }
    throw Skipped{"the sea changes too fast to be probed"};
}

void add_sums(Catalogue& all) {
    all.push_back(server_case(
        "R-161/in-view", "Sums in view, part by part, are those of the state held", [](ServerTrial& trial) {
            ServerPeer& peer = probing(trial);
            std::vector<LatticePoint> points;
            for (const auto& [key, patch] : peer.held().state().patches) {
                const LatticeRect rect = rect_of(key);
                points.push_back({(rect.min.x + rect.max.x) / 2, (rect.min.z + rect.max.z) / 2});
                if (points.size() == 8) break;
            }
            if (points.empty()) throw Skipped{"no water is in view at the scene's middle"};
            compare_here(trial, peer, points);
        }));
    all.push_back(server_case(
        "R-161/in-region", "Sums where no patch lies, but a region, are those of the whole boxes",
        [](ServerTrial& trial) {
            const LatticePoint place = trial.target().place;
            ServerPeer& peer = probing(trial, {{place, 500 * 1024}});
            compare_here(trial, peer, {place, {place.x + 1, place.z}, {place.x - 30000, place.z + 50000}});
        }));
    all.push_back(
        server_case("R-161/sixteen-points", "As many points as a probe may have", [](ServerTrial& trial) {
            const LatticePoint place = trial.target().place;
            ServerPeer& peer = probing(trial, {{place, 500 * 1024}});
            std::vector<LatticePoint> points;
            for (int64_t i = 0; i < static_cast<int64_t>(most_probe_points); ++i)
                points.push_back({place.x + 7919 * i, place.z - 6007 * i});
            compare_here(trial, peer, points);
        }));
    all.push_back(server_case(
        "R-163/as-many-as-fit", "A reply holds all points whose parts fit, and no more",
        [](ServerTrial& trial) {
            const LatticePoint place = trial.target().place;
            ServerPeer& peer = probing(trial, {{place, 500 * 1024}});
            const std::vector<LatticePoint> points(most_probe_points, place);
            const InterestState state = peer.held().state();
            const ProbeReply reply = ask(peer, peer.held().result(), peer.held().last()->key.from, points);
            if (reply.stale) throw Skipped{"the sea changes too fast to be probed"};
            const size_t each = probe_sum(state, reply.time, place).parts.size();
            const size_t fit =
                each == 0 ? points.size() : std::clamp<size_t>(most_probe_parts / each, 1, points.size());
            trial.note(fmt::format("{} of {} points of {} parts", reply.points.size(), points.size(), each));
            if (reply.points.size() != fit)
                throw Failed{fmt::format("{} points of {} parts each were answered, not {}",
                                         reply.points.size(), each, fit)};
        }));
}

void add_limits(Catalogue& all) {
    all.push_back(server_case(
        "R-164/rate",
        "Of twelve probes in one write six are answered, and those that time frees; the others are refused",
        [](ServerTrial& trial) {
            ServerPeer& peer = probing(trial);
            Bytes together;
            constexpr uint32_t count = 12;
            for (uint32_t i = 0; i < count; ++i) {
                Probe probe;
                probe.sequence = peer.next_sequence();
                probe.result = peer.held().result();
                probe.time = peer.held().last()->key.from;
                probe.points = {trial.target().place};
                const Bytes framed = frame(encode(ClientMessage{probe}));
                together.insert(together.end(), framed.begin(), framed.end());
            }
            peer.send_bytes(together);
            uint32_t answered = 0;
            uint32_t refused = 0;
            const Deadline deadline(trial.target().patience);
            while (answered + refused < count) {
                const auto message = peer.receive(deadline.left());
                if (!message)
                    throw Failed{fmt::format("{} probes were answered and {} refused, of {}", answered,
                                             refused, count)};
                answered += std::holds_alternative<ProbeReply>(*message);
                const auto* reply = std::get_if<CommandReply>(&*message);
                refused += reply != nullptr && reply->code == ErrorCode::rate_limited;
            }
            trial.note(fmt::format("{} answered, {} refused", answered, refused));
            // Two a second come to be free while they are read.
            if (answered < 6 || answered > 8) throw Failed{fmt::format("{} were answered at once", answered)};
            peer.expect_service();
        }));
    all.push_back(server_case("R-162/stale", "A probe of another result than the last is answered as stale",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = probing(trial);
                                  ViewState view = view_of_water(trial.target());
                                  view.position.x += 8192 * lattice_per_metre;
                                  const uint32_t old = peer.held().result();
                                  peer.send(ViewUpdate{peer.next_sequence(), view});
                                  peer.await_result(old);
                                  const ProbeReply reply =
                                      ask(peer, old, peer.held().last()->key.from, {trial.target().place});
                                  if (!reply.stale || !reply.points.empty())
                                      throw Failed{"the reply is not stale"};
                              }));
    all.push_back(server_case(
        "R-166/desync", "After a report of a difference a snapshot follows", [](ServerTrial& trial) {
            ServerPeer& peer = probing(trial);
            Desync found;
            found.sequence = peer.next_sequence();
            found.result = peer.held().result();
            found.time = peer.held().last()->key.from;
            found.at = trial.target().place;
            found.box =
                peer.held().state().boxes.empty() ? BoxId{1} : peer.held().state().boxes.begin()->first;
            found.expected = 1;
            found.actual = 2;
            peer.held().await_snapshot();
            peer.send(found);
            const Deadline deadline(trial.target().patience);
            while (peer.held().snapshots() < 2 && !deadline.passed()) peer.receive(deadline.left());
            if (peer.held().snapshots() < 2) throw Failed{"no snapshot came"};
            peer.expect_service();
        }));
    all.push_back(
        server_case("R-166/desync-flood",
                    "Reports of differences one after the other end the session: each costs a snapshot",
                    [](ServerTrial& trial) {
                        ServerPeer& peer = probing(trial);
                        peer.held().await_snapshot();
                        for (int i = 0; i < 20; ++i) {
                            Desync found;
                            found.sequence = peer.next_sequence();
                            found.result = peer.held().result();
                            found.at = trial.target().place;
                            peer.send(found);
                        }
                        peer.expect_goodbye(ErrorCode::rate_limited, any_requirement);
                    }));
}

void add_earlier_version(Catalogue& all) {
    const auto version_2 = [&](const char* id, const char* title,
                               std::function<ClientMessage(uint32_t)> message) {
        all.push_back(server_case(id, title, [message = std::move(message)](ServerTrial& trial) {
            ClientHello hello = ServerPeer::usual_hello();
            hello.protocol_min = hello.protocol_max = 2;
            ServerPeer& peer = trial.log_in(hello);
            peer.send(message(1));
            peer.expect_goodbye(ErrorCode::unexpected_message, any_requirement);
        }));
    };
    version_2("R-166/version-2-probe", "In version 2 there are no probes", [](uint32_t n) {
        Probe probe;
        probe.sequence = n;
        probe.result = 1;
        probe.points = {{}};
        return probe;
    });
    version_2("R-166/version-2-desync", "In version 2 there are no reports of differences", [](uint32_t n) {
        Desync found;
        found.sequence = n;
        found.result = 1;
        return found;
    });
}

}  // namespace

void add_probe_cases(Catalogue& all) {
    add_sums(all);
    add_limits(all);
    add_earlier_version(all);
}

}  // namespace trochoid::conformance::server
