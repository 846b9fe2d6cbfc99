#include "tests/conformance/client_conduct.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "protocol/wire/session_rules.hpp"
#include "tests/conformance/verdict.hpp"

namespace trochoid::conformance {

namespace {

constexpr uint32_t messages_per_second = 1000;
constexpr uint16_t first_with_probes = 3;

bool is_of_version_2(const ClientMessage& message) {
    const auto* command = std::get_if<Command>(&message);
    return !std::holds_alternative<Probe>(message) && !std::holds_alternative<Desync>(message) &&
           (command == nullptr || !std::holds_alternative<SkipTime>(command->action));
}

void judge_regions(const SyncRegions& said, const Limits& limits) {
    if (said.regions.size() > limits.sync_regions)
        throw Failed{fmt::format("R-131: {} sync regions, our hello allows {}", said.regions.size(),
                                 limits.sync_regions)};
    for (const SyncRegion& region : said.regions)
        if (region.radius > limits.sync_radius)
            throw Failed{fmt::format("R-132: a sync region's radius is {}, our hello allows {}",
                                     region.radius, limits.sync_radius)};
}

}  // namespace

bool ClientConduct::Bucket::take(uint32_t rate, int64_t now_us) {
    constexpr int64_t whole = 1'000'000;
    spent_ = std::max<int64_t>(0, spent_ - (now_us - at_us_) * rate) + whole;
    at_us_ = now_us;
    return spent_ <= whole * rate;
}

void ClientConduct::judge_rates(const ClientMessage& message, const Limits& limits, int64_t at_us) {
    const auto count = [&](Bucket& bucket, const char* of_what, uint32_t rate) {
        if (!bucket.take(rate, at_us))
            throw Failed{fmt::format("R-126: more than {} {} a second", rate, of_what)};
    };
    count(messages_, "messages", messages_per_second);
    if (std::holds_alternative<ViewUpdate>(message) || std::holds_alternative<SyncRegions>(message))
        count(views_, "views and regions", limits.views_per_second);
    if (std::holds_alternative<Command>(message)) count(commands_, "commands", limits.commands_per_second);
}

void ClientConduct::judge(const ClientMessage& message, const ServerHello& ours, int64_t at_us) {
    if (ours.protocol < first_with_probes && !is_of_version_2(message))
        throw Failed{fmt::format("R-175: a message that version {} does not know", ours.protocol)};
    if (const auto may = permitted(ours.role, message); !may)
        throw Failed{fmt::format("R-127: the session's role is {}: {}", static_cast<unsigned>(ours.role),
                                 may.error().message)};
    if (const auto* regions = std::get_if<SyncRegions>(&message)) judge_regions(*regions, ours.limits);
    judge_rates(message, ours.limits, at_us);
}

}  // namespace trochoid::conformance
