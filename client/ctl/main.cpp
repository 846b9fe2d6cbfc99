#include <fmt/format.h>

#include <cstdio>

#include "client/ctl/ctl_options.hpp"
#include "client/ctl/ctl_report.hpp"
#include "client/net/blocking_link.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace {

using namespace trochoid;

/// Sends the command and prints what came of it; the exit code.
int carry_out(BlockingLink& link, const CtlOptions& options, Command command, const AskedTime& when) {
    const ClockReply clock = link.clock();
    command.at = asked_time(when, sea_time_at(clock.clock, clock.server_sent_us));
    command.refuse_if_late = when.or_refuse;
    const CommandReply reply = link.command(command);
    if (reply.code != ErrorCode::none) {
        fmt::print(stderr, "trochoid-ctl: {}\n", refusal(reply));
        return 1;
    }
    fmt::print("{}", report(reply, options, command.at));
    return 0;
}

int run(const CtlOptions& options) {
    BlockingLink link({options.server, fmt::format("trochoid-ctl {}", software_version()), options.token,
                       options.patience});
    Command command;
    if (const auto* start = std::get_if<CtlStartWind>(&options.action)) {
        command.action = start->wind;
        return carry_out(link, options, command, start->when);
    }
    if (const auto* stop = std::get_if<CtlStopWind>(&options.action)) {
        command.action = StopWind{stop->box};
        return carry_out(link, options, command, stop->when);
    }
    if (const auto* time = std::get_if<CtlTime>(&options.action)) {
        if (!time->rate) {
            fmt::print("{}", report(link.clock(), options.json));
            return 0;
        }
        command.action = SetRate{static_cast<uint32_t>(*time->rate * 65536.0 + 0.5)};
        return carry_out(link, options, command, {});
    }
    fmt::print("{}", report(link.list(), options.json));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto options = read_ctl_options(argc, argv);
        return options ? run(*options) : 0;
    } catch (const OperatorError& error) {
        fmt::print(stderr, "trochoid-ctl: {}\n", error.what());
        return 2;
    } catch (const LinkError& error) {
        fmt::print(stderr, "trochoid-ctl: {}\n", error.what());
        return error.unreachable() ? 2 : 1;
    }
}
