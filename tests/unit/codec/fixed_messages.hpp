#pragma once
#include <string>
#include <vector>

#include "protocol/codec/codec.hpp"

namespace trochoid {

/// A message with fixed contents, as tests/golden/wire_messages.txt keeps its bytes.
struct FixedMessage {
    std::string direction;  ///< client, server or event
    std::string name;
    Bytes bytes;
};
std::vector<FixedMessage> fixed_messages();

/// Decodes and encodes again; empty where the bytes are refused.
Bytes encoded_again(const FixedMessage& message);

}  // namespace trochoid
