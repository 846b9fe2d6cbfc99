#pragma once
#include <string>
#include <vector>

#include "protocol/codec/codec.hpp"

namespace trochoid::conformance {

/// A line of `tests/golden/wire_messages.txt`, which is compiled in.
struct GoldenMessage {
    std::string direction;  ///< client, server or event
    std::string name;
    Bytes bytes;
};
const std::vector<GoldenMessage>& golden_messages();

}  // namespace trochoid::conformance
