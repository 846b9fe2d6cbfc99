#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/units/error_code.hpp"

// What comes of a case: a verdict about what was asked of the program under test, and another about how it closed.
namespace trochoid::conformance {

enum class Verdict : uint8_t {
    passed,
    failed,
    skipped,           ///< the program under test, or the options given, do not allow it
    expected_failure,  ///< failed, and is on the list of expected failures
    unexpected_pass,   ///< passed, and is on the list: the list is out of date
};
std::string_view name_of(Verdict verdict);

/// How the program under test ended the connection at which the case aims.
enum class CloseVerdict : uint8_t {
    none,        ///< it was not asked to close, and did not
    clean,       ///< goodbye, then the end of the stream
    no_goodbye,  ///< the stream ended without a goodbye
    reset,       ///< the connection was reset, with or without a goodbye before
    left_open,   ///< goodbye, but the stream did not end in time; or it should have closed and did not
};
std::string_view name_of(CloseVerdict verdict);

struct CloseReport {
    CloseVerdict verdict = CloseVerdict::none;
    ErrorCode code = ErrorCode::none;  ///< of its goodbye
    uint16_t requirement = 0;          ///< of its goodbye
    std::string sentence;              ///< of its goodbye
    int64_t goodbye_us = -1;           ///< from our last byte to its goodbye; -1: none came
    int64_t end_us = -1;               ///< from our last byte to the end of the stream; -1: it did not end
    bool operator==(const CloseReport&) const = default;
};

struct Outcome {
    std::string id;
    std::string title;
    Verdict verdict = Verdict::skipped;
    std::string reason;  ///< why it failed or was skipped; on the list: the list's reason too
    CloseReport close;
    std::vector<std::string> notes;  ///< figures worth a look, in order
    int64_t took_us = 0;
    bool operator==(const Outcome&) const = default;
};

/// "R-117" of "R-117/view-vx-high"; the whole id where it has no slash.
std::string_view requirement_of_case(std::string_view id);

/// Ends a case: what is wrong, in one sentence.
struct Failed {
    std::string reason;
};
/// Ends a case that cannot be run here: why, and what would allow it.
struct Skipped {
    std::string reason;
};

}  // namespace trochoid::conformance
