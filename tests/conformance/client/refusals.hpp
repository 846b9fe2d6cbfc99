#pragma once
#include <functional>
#include <string>
#include <vector>

#include "protocol/wire/requirements.hpp"
#include "server_generated.h"
#include "tests/conformance/client_trial.hpp"

// The most common kind of case: a valid session, one thing wrong, the right goodbye.
namespace trochoid::conformance::client {

inline constexpr Due out_of_range{ErrorCode::value_out_of_range, requirement::ranges};
inline constexpr Due infinite_or_nan{ErrorCode::not_finite, requirement::finite_numbers};
inline constexpr Due not_unit{ErrorCode::not_a_unit_quaternion, requirement::unit_quaternion};
inline constexpr Due absent{ErrorCode::missing_field, requirement::fields_present};
inline constexpr Due unexpected{ErrorCode::unexpected_message, any_due_requirement};

/// Skips the case where the session's version, the highest that the client offers, is an earlier one.
void need_version(const ClientPeer& peer, uint16_t version);
/// After both hellos this payload comes: the goodbye has to be that one. `since`: the protocol version that knows what is wrong in it.
Case refused(std::string id, std::string title, Bytes payload, Due due, uint16_t since = 2);
/// The same in the place of our hello.
Case refused_first(std::string id, std::string title, Bytes payload, Due due);
/// After both hellos this payload comes: the session goes on.
Case taken(std::string id, std::string title, Bytes payload);
/// Our hello, made from the client's: it has to be refused.
Case hello_refused(std::string id, std::string title, std::function<Bytes(ServerHello)> make, Due due);
/// Our hello: a session comes about.
Case hello_taken(std::string id, std::string title, std::function<void(ServerHello&)> change);

/// A legal message of a server, bent in place by FlatBuffers' mutable accessors; `Table` is the body's.
template <class Table, class Bend>
Bytes bent(const ServerMessage& message, Bend bend) {
    Bytes bytes = encode(message);
    bend(*static_cast<Table*>(wire_fb::GetMutableServerEnvelope(bytes.data())->mutable_body()));
    return bytes;
}

/// The buffer with one field of the table taken away. `field` is its place in the vtable (VT_…).
template <class Table>
void drop_field(const Table& table, uint16_t field) {
    const auto* at = reinterpret_cast<const uint8_t*>(&table);
    const auto* vtable = at - flatbuffers::ReadScalar<flatbuffers::soffset_t>(at);
    flatbuffers::WriteScalar<flatbuffers::voffset_t>(const_cast<uint8_t*>(vtable) + field, 0);
}

/// One legal message of each type that a server may send, by name; deltas are result 1 of the laden sea.
struct LegalMessage {
    const char* name;
    ServerMessage message;
};
const std::vector<LegalMessage>& legal_messages();
/// Result 1, a snapshot of the laden sea in one piece.
Delta legal_delta();

}  // namespace trochoid::conformance::client
