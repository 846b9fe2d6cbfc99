#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "client/net/endpoint.hpp"

namespace trochoid {

/// What a peer wrote that nobody has checked, fit to be shown: printable ASCII alone, at most so many characters.
std::string printable(std::string_view text, size_t most);

/// What listens there, going by the first bytes of a stream that is not Trochoid's, and what to do.
std::string who_listens(std::span<const uint8_t> first, const Endpoint& endpoint);

}  // namespace trochoid
