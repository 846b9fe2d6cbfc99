#include "tests/conformance/verdict.hpp"

namespace trochoid::conformance {

std::string_view name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::passed: return "passed";
        case Verdict::failed: return "failed";
        case Verdict::skipped: return "skipped";
        case Verdict::expected_failure: return "expected failure";
        case Verdict::unexpected_pass: return "unexpected pass";
    }
    return "";
}

std::string_view name_of(CloseVerdict verdict) {
    switch (verdict) {
        case CloseVerdict::none: return "not closed";
        case CloseVerdict::clean: return "clean";
        case CloseVerdict::no_goodbye: return "no goodbye";
        case CloseVerdict::reset: return "reset";
        case CloseVerdict::left_open: return "left open";
    }
    return "";
}

std::string_view requirement_of_case(std::string_view id) { return id.substr(0, id.find('/')); }

}  // namespace trochoid::conformance
