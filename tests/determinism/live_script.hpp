#pragma once
#include <string_view>
#include <vector>

#include "tests/determinism/still_server.hpp"

namespace trochoid {

/// What directors ask for while the named scene runs: ships that set out and turn, storms that start, are steered and stopped,
/// a breakwater and a channel through it. Empty for most scenes. Times count from `opens`.
std::vector<LiveCommand> live_script(std::string_view scene, SeaTime opens);

}  // namespace trochoid
