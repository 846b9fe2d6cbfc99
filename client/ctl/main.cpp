#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "client/ctl/ctl_options.hpp"
#include "client/ctl/ctl_report.hpp"
#include "client/net/blocking_link.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace {

using namespace trochoid;

/// Sends the command and prints what came of it; the exit code.
int carry_out(BlockingLink& link, const CtlOptions& options, const CtlCommand& asked) {
    const ClockReply clock = link.clock();
    Command command;
    command.action = asked.action;
    command.at = asked_time(asked.when, sea_time_at(clock.clock, clock.server_sent_us));
    command.refuse_if_late = asked.when.or_refuse;
    const CommandReply reply = link.command(command);
    if (reply.code != ErrorCode::none) {
        fmt::print(stderr, "trochoid-ctl: {}\n", refusal(reply));
        return 1;
    }
    fmt::print("{}", report(reply, asked.action, command.at, options.json));
    return 0;
}

LinkOptions link_options(const CtlOptions& options, std::string token) {
    return {options.server, fmt::format("trochoid-ctl {}", software_version()), std::move(token),
            options.patience};
}

/// The world that a token has to name: as it was given, or as the server tells a viewer.
std::string world_of(const CtlOptions& options) {
    if (!options.login.signs() || !options.login.world().empty()) return options.login.world();
    try {
        return BlockingLink(link_options(options, "")).hello().world;
    } catch (const LinkError& error) {
        if (error.code() != ErrorCode::token_required) throw;
        throw OperatorError(
            "this server names its world only to who logs in: say --world NAME with --sign-with");
    }
}

void warn(const std::string& warning) {
    if (!warning.empty()) fmt::print(stderr, "trochoid-ctl: warning: {}\n", warning);
}

int run(const CtlOptions& options) {
    if (const auto* token = std::get_if<CtlToken>(&options.action)) {
        const TokenReport report = carry_out(*token, options.json);
        warn(report.warning);
        fmt::print("{}", report.text);
        return report.status;
    }
    warn(options.login.warning());
    BlockingLink link(
        link_options(options, options.login.token(role_for(options.action), world_of(options))));
    if (const auto* command = std::get_if<CtlCommand>(&options.action))
        return carry_out(link, options, *command);
    const bool time = std::holds_alternative<CtlTime>(options.action);
    fmt::print("{}", time ? report(link.clock(), options.json) : report(link.list(), options.json));
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
