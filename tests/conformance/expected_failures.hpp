#pragma once
#include <map>
#include <string>

#include "tests/conformance/verdict.hpp"

namespace trochoid::conformance {

/// Cases known to fail, with why: a line each, `ID reason`; `#` begins a comment. `ID` may hold `*` and `?`.
class ExpectedFailures {
public:
    ExpectedFailures() = default;
    /// OperatorError where a line is no such line.
    static ExpectedFailures read(const std::string& path);

    void add(const std::string& pattern, const std::string& reason) { reasons_[pattern] = reason; }
    /// An unexpected pass does not count as a failure.
    void forgive_passes() { forgiving_ = true; }
    bool forgiving() const { return forgiving_; }
    /// Turns `failed` into `expected_failure` and `passed` into `unexpected_pass` where the case is on the list.
    void judge(Outcome& outcome) const;

private:
    std::map<std::string, std::string> reasons_;
    bool forgiving_ = false;
};

/// Whether a pattern with `*` (any characters) and `?` (one) fits the whole text.
bool glob_fits(std::string_view pattern, std::string_view text);

}  // namespace trochoid::conformance
