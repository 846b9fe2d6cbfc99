#pragma once
#include <cstdint>
#include <span>
#include <string_view>

#include "protocol/codec/messages.hpp"
#include "protocol/units/result.hpp"

// What a well-formed message still has to keep, as pure functions and small counters: no sockets, no clocks.
namespace trochoid {

/// Protocol versions from which on there are such things.
inline constexpr uint16_t first_with_resume = 3;
inline constexpr uint16_t first_with_probes = 3;
inline constexpr uint16_t first_with_patch_planes = 3;
inline constexpr uint16_t first_with_skip_time = 3;

enum class SessionPhase : uint8_t {
    awaiting_hello,  ///< nothing but a ClientHello, or a Goodbye, may come
    open,            ///< both hellos have passed
    closed,          ///< a Goodbye has passed: nothing may follow
};

/// Whether a server in this phase may be sent the message: unexpected_message otherwise.
Result<Done> expected(SessionPhase phase, const ClientMessage& message);
/// Whether a client in this phase (it has sent its hello) may be sent the message.
Result<Done> expected(SessionPhase phase, const ServerMessage& message);
/// The phase after an expected message.
SessionPhase phase_after(SessionPhase phase, const ClientMessage& message);
SessionPhase phase_after(SessionPhase phase, const ServerMessage& message);

/// Whether the role may ask for it (token_required otherwise): commands that change the world are the director's.
Result<Done> permitted(Role role, const ClientMessage& message);

/// The sequence number that a message carries, 0 where its type carries none.
uint32_t sequence_of(const ClientMessage& message);

/// Protocol version that both speak: the highest common one. protocol_version where there is none, model_version where
/// the client computes another sea.
Result<uint16_t> common_version(const ClientHello& hello);

/// Whether a client can go on with what the server has chosen: protocol_version, model_version otherwise.
Result<Done> acceptable(const ServerHello& hello);

/// Sequence numbers ascend strictly within each type of message, from 1; gaps are allowed. An Ack's result never goes back.
class SequenceRule {
public:
    /// sequence_not_monotone where the message breaks the rule.
    Result<Done> accept(const ClientMessage& message);

private:
    uint32_t last_[std::variant_size_v<ClientMessage>] = {};
};

/// The goodbye that answers a refusal: with the requirement broken, and whether trying again can help.
Goodbye goodbye_for(const Error& error, uint32_t offending_sequence = 0);

/// What messages towards servers and towards clients carry at their bytes 4 to 7.
inline constexpr std::string_view client_identifier = "TRCC";
inline constexpr std::string_view server_identifier = "TRCS";
/// The goodbye for a payload that could not be decoded: one without the identifier of its direction breaks another requirement than one
/// whose message is unknown.
Goodbye goodbye_for_payload(const Error& error, std::span<const uint8_t> payload,
                            std::string_view identifier);

}  // namespace trochoid
