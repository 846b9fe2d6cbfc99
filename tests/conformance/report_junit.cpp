#include <fmt/format.h>

#include "tests/conformance/report.hpp"

namespace trochoid::conformance {

namespace {

double seconds(int64_t us) { return static_cast<double>(us) * 1e-6; }

std::string test_case(const Outcome& outcome, bool forgiving) {
    const size_t slash = outcome.id.find('/');
    std::string text = fmt::format(
        R"(    <testcase classname="{}" name="{}" time="{:.6f}">)", escaped(requirement_of_case(outcome.id)),
        escaped(slash == std::string::npos ? outcome.id : outcome.id.substr(slash + 1)),
        seconds(outcome.took_us));
    text += '\n';
    if (counts_as_failure(outcome, forgiving))
        text += fmt::format("      <failure message=\"{}\">{}</failure>\n", escaped(outcome.reason),
                            escaped(outcome.title));
    else if (outcome.verdict == Verdict::skipped || outcome.verdict == Verdict::expected_failure)
        text += fmt::format("      <skipped message=\"{}\"/>\n", escaped(outcome.reason));
    std::string said = outcome.title + "\nclose: " + sentence_of(outcome.close);
    for (const std::string& note : outcome.notes) said += "\n" + note;
    std::string lines;
    for (const char c : said) lines += c == '\n' ? std::string("\n") : escaped(std::string_view(&c, 1));
    text += fmt::format("      <system-out>{}</system-out>\n", lines);
    return text + "    </testcase>\n";
}

}  // namespace

std::string junit_of(const Report& report) {
    std::map<std::string, std::vector<const Outcome*>> suites;
    for (const Outcome& outcome : report.outcomes)
        suites[std::string(requirement_of_case(outcome.id))].push_back(&outcome);
    int failures = 0;
    int skipped = 0;
    std::string body;
    for (const auto& [name, outcomes] : suites) {
        int suite_failures = 0;
        int suite_skipped = 0;
        int64_t took_us = 0;
        std::string cases;
        for (const Outcome* outcome : outcomes) {
            const bool failed = counts_as_failure(*outcome, report.forgiving);
            suite_failures += failed;
            suite_skipped += !failed && (outcome->verdict == Verdict::skipped ||
                                         outcome->verdict == Verdict::expected_failure);
            took_us += outcome->took_us;
            cases += test_case(*outcome, report.forgiving);
        }
        body += fmt::format(
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\" time=\"{:.6f}\" "
            "timestamp=\"{}\">\n{}  </testsuite>\n",
            escaped(name), outcomes.size(), suite_failures, suite_skipped, seconds(took_us),
            escaped(report.started), cases);
        failures += suite_failures;
        skipped += suite_skipped;
    }
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"trochoid-conformance {}\" tests=\"{}\" "
        "failures=\"{}\" errors=\"0\" skipped=\"{}\" time=\"{:.6f}\">\n{}</testsuites>\n",
        name_of(report.side), report.outcomes.size(), failures, skipped, seconds(report.took_us), body);
}

}  // namespace trochoid::conformance
