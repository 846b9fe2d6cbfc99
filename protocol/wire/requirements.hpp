#pragma once
#include <cstdint>

#include "protocol/units/error_code.hpp"

namespace trochoid {

/// Numbers of the requirements in protocol/README.md (R-101, …). They travel in Goodbye::requirement and never change
/// meaning; a number that falls out of use stays unused.
namespace requirement {
// Frames and stream
inline constexpr uint16_t magic = 101;
inline constexpr uint16_t frame_header = 102;
inline constexpr uint16_t frame_length = 103;
inline constexpr uint16_t one_port = 104;
inline constexpr uint16_t websocket = 105;
inline constexpr uint16_t encryption = 106;
// Buffers
inline constexpr uint16_t file_identifier = 111;
inline constexpr uint16_t verified_buffer = 112;
inline constexpr uint16_t size_field = 113;
inline constexpr uint16_t known_union_tag = 114;
inline constexpr uint16_t fields_present = 115;
inline constexpr uint16_t finite_numbers = 116;
inline constexpr uint16_t ranges = 117;
inline constexpr uint16_t unit_quaternion = 118;
// Session
inline constexpr uint16_t hello_first = 121;
inline constexpr uint16_t hello_deadline = 122;
inline constexpr uint16_t version_range = 123;
inline constexpr uint16_t world_name = 124;
inline constexpr uint16_t ascending_sequence = 125;
inline constexpr uint16_t message_rates = 126;
inline constexpr uint16_t director_role = 127;
inline constexpr uint16_t progress = 128;
// Interest
inline constexpr uint16_t region_count = 131;
inline constexpr uint16_t region_radius = 132;
inline constexpr uint16_t acknowledged_state = 133;
inline constexpr uint16_t result_order = 134;
inline constexpr uint16_t whole_results = 135;
inline constexpr uint16_t tiles_of_grid = 136;
// World
inline constexpr uint16_t model_version = 141;
// Login
inline constexpr uint16_t good_token = 153;
inline constexpr uint16_t viewer_token = 156;
inline constexpr uint16_t resumed_state = 158;
// Probes
inline constexpr uint16_t desync_answered = 166;
}  // namespace requirement

/// The requirement that a peer breaks when it is refused with this code; 0 where no requirement is broken.
constexpr uint16_t requirement_of(ErrorCode code) {
    switch (code) {
        case ErrorCode::frame_too_long: return requirement::frame_length;
        case ErrorCode::malformed_frame: return requirement::frame_header;
        case ErrorCode::verification_failed: return requirement::verified_buffer;
        case ErrorCode::trailing_bytes: return requirement::size_field;
        case ErrorCode::unknown_message: return requirement::known_union_tag;
        case ErrorCode::value_out_of_range: return requirement::ranges;
        case ErrorCode::not_finite: return requirement::finite_numbers;
        case ErrorCode::not_a_unit_quaternion: return requirement::unit_quaternion;
        case ErrorCode::sequence_not_monotone: return requirement::ascending_sequence;
        case ErrorCode::unexpected_message: return requirement::hello_first;
        case ErrorCode::hello_deadline: return requirement::hello_deadline;
        case ErrorCode::missing_field: return requirement::fields_present;
        case ErrorCode::wrong_magic: return requirement::magic;
        case ErrorCode::base_mismatch: return requirement::acknowledged_state;
        case ErrorCode::protocol_version: return requirement::version_range;
        case ErrorCode::model_version: return requirement::model_version;
        case ErrorCode::token_required: return requirement::viewer_token;
        case ErrorCode::token_refused: return requirement::good_token;
        case ErrorCode::rate_limited: return requirement::message_rates;
        case ErrorCode::too_many_regions: return requirement::region_count;
        case ErrorCode::region_too_large: return requirement::region_radius;
        case ErrorCode::no_progress: return requirement::progress;
        case ErrorCode::wrong_world: return requirement::world_name;
        case ErrorCode::encryption_required: return requirement::encryption;
        case ErrorCode::too_many_boxes:
        case ErrorCode::too_many_trains:
        case ErrorCode::too_many_legs: return requirement::ranges;
        default: return 0;
    }
}

}  // namespace trochoid
