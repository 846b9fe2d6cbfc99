#include "tests/conformance/report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid::conformance {

Tally tally_of(const std::vector<Outcome>& outcomes) {
    Tally tally;
    for (const Outcome& outcome : outcomes) {
        ++tally.verdicts[outcome.verdict];
        ++tally.closes[outcome.close.verdict];
    }
    return tally;
}

std::map<std::string, Tally> tally_by_requirement(const std::vector<Outcome>& outcomes) {
    std::map<std::string, Tally> tallies;
    for (const Outcome& outcome : outcomes) {
        Tally& tally = tallies[std::string(requirement_of_case(outcome.id))];
        ++tally.verdicts[outcome.verdict];
        ++tally.closes[outcome.close.verdict];
    }
    return tallies;
}

bool counts_as_failure(const Outcome& outcome, bool forgiving) {
    return outcome.verdict == Verdict::failed || (outcome.verdict == Verdict::unexpected_pass && !forgiving);
}

bool conforms(const Report& report) {
    return std::none_of(report.outcomes.begin(), report.outcomes.end(),
                        [&](const Outcome& outcome) { return counts_as_failure(outcome, report.forgiving); });
}

std::string escaped(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '&': out += "&amp;"; break;
            case '"': out += "&quot;"; break;
            case '\'': out += "&#39;"; break;
            default: out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return out;
}

std::string sentence_of(const CloseReport& close) {
    std::string text(name_of(close.verdict));
    const auto milliseconds = [](int64_t us) { return static_cast<double>(us) * 1e-3; };
    if (close.goodbye_us >= 0)
        text += fmt::format(", code {}{} after {:.1f} ms", static_cast<unsigned>(close.code),
                            close.requirement == 0 ? "" : fmt::format(" R-{}", close.requirement),
                            milliseconds(close.goodbye_us));
    if (close.end_us >= 0) text += fmt::format(", ended after {:.1f} ms", milliseconds(close.end_us));
    return text;
}

std::string text_of(const Report& report) {
    std::string text;
    for (const Outcome& outcome : report.outcomes)
        if (counts_as_failure(outcome, report.forgiving))
            text += fmt::format("\n{}  {}\n    {}\n    {}\n", outcome.id, name_of(outcome.verdict),
                                outcome.title, outcome.reason);
    std::map<std::string, int> reasons;
    for (const Outcome& outcome : report.outcomes)
        if (outcome.verdict == Verdict::skipped) ++reasons[outcome.reason];
    for (const auto& [reason, count] : reasons) text += fmt::format("\n{} skipped: {}", count, reason);
    for (const std::string& remark : report.remarks) text += "\n" + remark;
    const Tally tally = tally_of(report.outcomes);
    text += fmt::format("\n{} cases of {} requirements: {} passed, {} failed, {} skipped",
                        report.outcomes.size(), tally_by_requirement(report.outcomes).size(),
                        tally.of(Verdict::passed), tally.of(Verdict::failed), tally.of(Verdict::skipped));
    if (const int expected = tally.of(Verdict::expected_failure); expected > 0)
        text += fmt::format(", {} expected failures", expected);
    if (const int passes = tally.of(Verdict::unexpected_pass); passes > 0)
        text += fmt::format(", {} unexpected passes", passes);
    text += fmt::format("; {:.1f} s\n", static_cast<double>(report.took_us) * 1e-6);
    text += fmt::format("{} {} {}\n", report.software, conforms(report) ? "conforms" : "does not conform",
                        report.target.empty() ? "" : "(" + report.target + ")");
    return text;
}

}  // namespace trochoid::conformance
