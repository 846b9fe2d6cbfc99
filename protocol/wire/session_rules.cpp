#include "protocol/wire/session_rules.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"

namespace trochoid {

namespace {

Error unexpected(const char* sentence) { return {ErrorCode::unexpected_message, sentence}; }

template <class Hello, class Message>
Result<Done> expected_with(SessionPhase phase, const Message& message, const char* first) {
    switch (phase) {
        case SessionPhase::awaiting_hello:
            if (std::holds_alternative<Hello>(message) || std::holds_alternative<Goodbye>(message))
                return Done{};
            return unexpected(first);
        case SessionPhase::open:
            if (std::holds_alternative<Hello>(message))
                return unexpected("a second hello: open another connection for another session");
            return Done{};
        case SessionPhase::closed: break;
    }
    return unexpected("nothing may follow a goodbye");
}

template <class Hello, class Message>
SessionPhase phase_with(SessionPhase phase, const Message& message) {
    if (std::holds_alternative<Goodbye>(message)) return SessionPhase::closed;
    return std::holds_alternative<Hello>(message) ? SessionPhase::open : phase;
}

}  // namespace

Result<Done> expected(SessionPhase phase, const ClientMessage& message) {
    return expected_with<ClientHello>(phase, message, "the first message must be the client's hello");
}

Result<Done> expected(SessionPhase phase, const ServerMessage& message) {
    return expected_with<ServerHello>(phase, message, "the first message must be the server's hello");
}

SessionPhase phase_after(SessionPhase phase, const ClientMessage& message) {
    return phase_with<ClientHello>(phase, message);
}
SessionPhase phase_after(SessionPhase phase, const ServerMessage& message) {
    return phase_with<ServerHello>(phase, message);
}

Result<Done> permitted(Role role, const ClientMessage& message) {
    const auto* command = std::get_if<Command>(&message);
    if (command == nullptr || role == Role::admin || std::holds_alternative<ListBoxes>(command->action))
        return Done{};
    const bool moves_time =
        std::holds_alternative<SetRate>(command->action) || std::holds_alternative<SkipTime>(command->action);
    if (moves_time)
        return Error{ErrorCode::token_required, "moving time needs an admin's token in the hello"};
    if (role == Role::director) return Done{};
    return Error{ErrorCode::token_required,
                 "commands that change the world need a director's token in the hello"};
}

uint32_t sequence_of(const ClientMessage& message) {
    return std::visit(
        [](const auto& m) -> uint32_t {
            if constexpr (requires { m.sequence; })
                return m.sequence;
            else
                return 0;
        },
        message);
}

Result<uint16_t> common_version(const ClientHello& hello) {
    const uint16_t highest = std::min(hello.protocol_max, protocol_version_max);
    if (highest < std::max(hello.protocol_min, protocol_version_min))
        return Error{
            ErrorCode::protocol_version,
            fmt::format(
                "this server speaks protocol versions {} to {}, the client {} to {}: update the older one",
                protocol_version_min, protocol_version_max, hello.protocol_min, hello.protocol_max)};
    if (hello.model != model_version)
        return Error{ErrorCode::model_version,
                     fmt::format("this server computes version {} of the sea, the client version {}: "
                                 "update the older one",
                                 model_version, hello.model)};
    return highest;
}

Result<Done> acceptable(const ServerHello& hello) {
    if (hello.protocol < protocol_version_min || hello.protocol > protocol_version_max)
        return Error{ErrorCode::protocol_version,
                     fmt::format("the server has chosen protocol version {}, and {} to {} were offered",
                                 hello.protocol, protocol_version_min, protocol_version_max)};
    if (hello.model != model_version)
        return Error{
            ErrorCode::model_version,
            fmt::format(
                "the server computes version {} of the sea, this client version {}: update the older one",
                hello.model, model_version)};
    return Done{};
}

Result<Done> SequenceRule::accept(const ClientMessage& message) {
    uint32_t& last = last_[message.index()];
    if (const auto* ack = std::get_if<Ack>(&message)) {
        if (ack->result < last)
            return Error{ErrorCode::sequence_not_monotone,
                         fmt::format("result {} acknowledged after result {}", ack->result, last)};
        last = ack->result;
        return Done{};
    }
    const bool sequenced = std::visit(
        [](const auto& m) {
            return requires { m.sequence; };
        },
        message);
    if (!sequenced) return Done{};
    const uint32_t sequence = sequence_of(message);
    if (sequence <= last)
        return Error{ErrorCode::sequence_not_monotone,
                     fmt::format("sequence number {} after {} in messages of one type", sequence, last)};
    last = sequence;
    return Done{};
}

Goodbye goodbye_for_payload(const Error& error, std::span<const uint8_t> payload,
                            std::string_view identifier) {
    Goodbye goodbye = goodbye_for(error);
    const bool has_it =
        payload.size() >= 8 && std::equal(identifier.begin(), identifier.end(), payload.begin() + 4);
    if (!has_it) goodbye.requirement = requirement::file_identifier;
    return goodbye;
}

Goodbye goodbye_for(const Error& error, uint32_t offending_sequence) {
    Goodbye goodbye;
    goodbye.code = error.code;
    goodbye.message = error.message;
    goodbye.offending_sequence = offending_sequence;
    goodbye.requirement = requirement_of(error.code);
    // A peer that broke the standard would break it again; what may have passed by then is worth another try.
    constexpr uint32_t soon_ms = 1000;
    constexpr uint32_t later_ms = 10000;
    switch (error.code) {
        case ErrorCode::too_many_sessions:
        case ErrorCode::rate_limited:
        case ErrorCode::internal_error:
            goodbye.retry = true;
            goodbye.retry_after_ms = later_ms;
            break;
        case ErrorCode::shutting_down:
        case ErrorCode::no_progress:
        case ErrorCode::queue_overflow:
        case ErrorCode::hello_deadline:
        case ErrorCode::base_mismatch:
            goodbye.retry = true;
            goodbye.retry_after_ms = soon_ms;
            break;
        default: break;
    }
    return goodbye;
}

}  // namespace trochoid
