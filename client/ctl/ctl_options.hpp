#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "client/ctl/ctl_token.hpp"
#include "client/net/endpoint.hpp"
#include "client/net/token_source.hpp"
#include "protocol/codec/messages.hpp"

namespace trochoid {

/// When a command shall take hold.
struct AskedTime {
    std::optional<double> at_s;  ///< sea time, seconds
    std::optional<double> in_s;  ///< seconds of sea time from now
    bool or_refuse = false;      ///< refuse rather than defer what cannot be met
    bool operator==(const AskedTime&) const = default;
};

using CommandAction = decltype(Command::action);

/// A change of the sea, in the world's units.
struct CtlCommand {
    CommandAction action;
    AskedTime when;
    bool operator==(const CtlCommand&) const = default;
};
struct CtlList {
    bool operator==(const CtlList&) const = default;
};
/// The clock is read, not set.
struct CtlTime {
    bool operator==(const CtlTime&) const = default;
};
using CtlAction = std::variant<CtlCommand, CtlList, CtlTime, CtlToken>;

/// The least role that may ask for it.
Role role_for(const CtlAction& action);

struct CtlOptions {
    Endpoint server;
    TokenSource login;
    bool json = false;
    std::chrono::milliseconds patience{30000};
    CtlAction action;
};

/// The command line as options. Nothing where --help or --version has been answered on standard output; OperatorError for
/// everything that does not fit, with what would.
std::optional<CtlOptions> read_ctl_options(int argc, const char* const* argv);

/// The sea time that is asked for, at a present sea time; the far past ("as soon as possible") where none is.
SeaTime asked_time(const AskedTime& when, SeaTime now);

}  // namespace trochoid
