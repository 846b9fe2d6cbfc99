#include "tests/conformance/expected_failures.hpp"

#include <fmt/format.h>

#include <fstream>

#include "protocol/units/operator_error.hpp"

namespace trochoid::conformance {

ExpectedFailures ExpectedFailures::read(const std::string& path) {
    std::ifstream file(path);
    if (!file)
        throw OperatorError(
            fmt::format("cannot read the list of expected failures {}: check --expect-failures", path));
    ExpectedFailures list;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        const size_t begin = line.find_first_not_of(" \t\r");
        if (begin == std::string::npos || line[begin] == '#') continue;
        const size_t end = line.find_first_of(" \t", begin);
        const size_t reason = end == std::string::npos ? end : line.find_first_not_of(" \t\r", end);
        if (reason == std::string::npos)
            throw OperatorError(fmt::format(
                "{}:{}: say why after the case: 'R-117/view-vx-high known since 1.2'", path, number));
        list.add(line.substr(begin, end - begin), line.substr(reason));
    }
    return list;
}

void ExpectedFailures::judge(Outcome& outcome) const {
    for (const auto& [pattern, reason] : reasons_) {
        if (!glob_fits(pattern, outcome.id)) continue;
        if (outcome.verdict == Verdict::failed) {
            outcome.verdict = Verdict::expected_failure;
            outcome.reason += " (expected: " + reason + ")";
        } else if (outcome.verdict == Verdict::passed) {
            outcome.verdict = Verdict::unexpected_pass;
            outcome.reason = "passed, but is listed as failing: " + reason;
        }
        return;
    }
}

bool glob_fits(std::string_view pattern, std::string_view text) {
    size_t p = 0;
    size_t t = 0;
    size_t star = std::string_view::npos;
    size_t star_text = 0;
    while (t < text.size()) {
        if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t]) && pattern[p] != '*') {
            ++p;
            ++t;
        } else if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            star_text = t;
        } else if (star != std::string_view::npos) {
            p = star + 1;
            t = ++star_text;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

}  // namespace trochoid::conformance
