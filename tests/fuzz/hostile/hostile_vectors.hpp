#pragma once
#include <string>
#include <vector>

#include "protocol/codec/codec.hpp"

namespace trochoid {

/// A buffer that the FlatBuffers verifier takes and the standard does not.
struct HostileVector {
    enum class Direction : uint8_t { client, server, event };
    Direction direction = Direction::client;
    std::string what;  ///< message, field and what is wrong with it
    std::string kind;  ///< of wrong: "number", "missing", …
    ErrorCode code{};  ///< that the standard demands
    Bytes bytes;
};

/// Every message type × field × hostile value, and contradictions between fields: the same on every machine and in every run.
std::vector<HostileVector> hostile_vectors();

/// Contradictions between fields, which no rule of a single field covers (hostile_pairs.cpp).
void add_contradictions(std::vector<HostileVector>& out);

std::string name_of(HostileVector::Direction direction);
/// By flatc's code of today's schema, with FlatBuffers' own limits.
bool verifies(const HostileVector& vector);
/// What today's decoder says.
Error refusal(const HostileVector& vector);

}  // namespace trochoid
