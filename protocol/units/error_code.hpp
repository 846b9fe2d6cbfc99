#pragma once
#include <cstdint>
#include <string_view>

namespace trochoid {

/// Why a message was refused or a session ended. The numbers travel in Goodbye and CommandReply and never change
/// meaning; the hundreds digit is the class (protocol/README.md, "Codes").
enum class ErrorCode : uint16_t {
    none = 0,
    // 1xx protocol: the peer sent what the standard forbids
    frame_too_long = 101,
    malformed_frame = 102,
    verification_failed = 103,
    trailing_bytes = 104,
    unknown_message = 105,
    value_out_of_range = 106,
    not_finite = 107,
    not_a_unit_quaternion = 108,
    sequence_not_monotone = 109,
    unexpected_message = 110,
    hello_deadline = 111,
    missing_field = 112,
    wrong_magic = 113,
    base_mismatch = 114,
    // 2xx version
    protocol_version = 201,
    model_version = 202,
    // 3xx auth
    token_required = 301,
    token_refused = 302,
    encryption_required = 303,
    // 4xx resource
    too_many_sessions = 401,
    rate_limited = 402,
    too_many_regions = 403,
    region_too_large = 404,
    too_many_boxes = 405,
    too_many_trains = 406,
    no_progress = 407,
    queue_overflow = 408,
    too_many_legs = 409,
    too_much_land =
        410,  // more land blocks than whoever says so is set up to hold; nobody broke the standard
    too_many_connections = 411,
    // 5xx session
    client_closed = 501,
    // 6xx world
    wrong_world = 601,
    unknown_box = 602,
    already_ending = 603,
    too_late = 604,
    not_moving = 605,
    no_terrain = 606,
    // 7xx server
    shutting_down = 701,
    internal_error = 702,
};

/// Whether the number is a code of a class that the standard has: those that this version does not know count as their class.
constexpr bool is_a_code(uint16_t number) { return number == 0 || (number > 100 && number < 800); }

/// The class of a code as named in Goodbye: "protocol", "version", "auth", "resource", "session", "world", "server".
constexpr std::string_view error_class(ErrorCode code) {
    switch (static_cast<uint16_t>(code) / 100) {
        case 0: return "none";
        case 1: return "protocol";
        case 2: return "version";
        case 3: return "auth";
        case 4: return "resource";
        case 5: return "session";
        case 6: return "world";
        case 7: return "server";
        default: return "unknown";
    }
}

}  // namespace trochoid
