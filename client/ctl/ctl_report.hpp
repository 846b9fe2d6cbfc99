#pragma once
#include <string>

#include "client/ctl/ctl_options.hpp"
#include "protocol/codec/messages.hpp"

namespace trochoid {

/// "98745.678 s (1 d 03:25:45.678)"; "never" at the end of time.
std::string sea_time_text(SeaTime time);

/// waiting, growing, grown, decaying or over.
const char* stage_of(const BoxSummary& box, SeaTime now);

/// What a program prints on standard output, as a table or as JSON, ended by a newline.
std::string report(const BoxList& list, bool json);
/// Of a command that the server took; `asked` is when it was asked to take hold.
std::string report(const CommandReply& reply, const CommandAction& action, SeaTime asked, bool json);
std::string report(const ClockReply& clock, bool json);

/// What the server refused and what to do.
std::string refusal(const CommandReply& reply);

}  // namespace trochoid
