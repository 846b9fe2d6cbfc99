#include "tests/simulation/verdicts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid {

namespace {

constexpr int64_t second = 1'000'000;

std::vector<LatticePoint> points_in(const SyncRegion& region) {
    std::vector<LatticePoint> points;
    const int64_t step = region.radius * 2 / 5;
    for (int64_t i = -1; i <= 1; ++i)
        for (int64_t j = -1; j <= 1; ++j)
            points.push_back({region.centre.x + i * step, region.centre.z + j * step});
    return points;
}

// A bound is of real time; sea time may run faster.
int64_t bound_in_sea_time(const SimClient& client, const SimNode& node) {
    return client.clock_bound_us() * std::max<int64_t>(1, (node.rate_q16() + 0xffff) >> 16);
}

}  // namespace

std::string verdict(const SimClient& client, const SimNode& node, const ViewState& view,
                    const std::vector<SyncRegion>& regions) {
    if (!client.live()) return "is not connected: " + client.sentence();
    if (client.state() != node.state_of(client.key())) return "holds another state than its key stands for";
    if (!node.serves(client.key(), view))
        return "has a key that is not for its view, the time or the sea of now";
    if (client.regions() != regions) return "has other sync regions than it asked for";
    for (const SyncRegion& region : regions) {
        const auto points = points_in(region);
        for (const int64_t later : {-second, int64_t{0}, 5 * second})
            if (client.samples(node.now() + later, points) != node.samples(node.now() + later, points))
                return fmt::format("computes another sea at now {:+} us", later);
    }
    if (client.clock_error_us(node.now()) > bound_in_sea_time(client, node))
        return fmt::format("is wrong about sea time by {} us, more than the bound of {} us that it states",
                           client.clock_error_us(node.now()), bound_in_sea_time(client, node));
    // Another hash than that: nobody may go on with it.
    if (!node.resumes(client.key(), client.state())) return "could not go on with what it holds";
    if (node.resumes(client.key(), client.state() ^ 1)) return "could go on with what it does not hold";
    return {};
}

std::string untroubled(const SimClient& client) {
    const StoreCounters& counters = client.counters();
    if (counters.resyncs != 0)
        return fmt::format("had to start again {} times after a wrong hash", counters.resyncs);
    if (counters.desyncs != 0) return fmt::format("found {} differences by probes", counters.desyncs);
    return {};
}

std::string verdict(const SimCounts& counts, bool at_end) {
    if (counts.ended_without_code != 0)
        return fmt::format("{} sessions ended without a code", counts.ended_without_code);
    if (counts.started > counts.connections) return "more sessions than connections";
    if (counts.ended + counts.open < counts.connections)
        return fmt::format("{} connections, but {} ended and {} are open", counts.connections, counts.ended,
                           counts.open);
    if (at_end && counts.open != 0)
        return fmt::format("{} sessions are open after all have left", counts.open);
    return {};
}

}  // namespace trochoid
