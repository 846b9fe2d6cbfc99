#pragma once
#include <map>
#include <string>
#include <vector>

#include "tests/conformance/case.hpp"

namespace trochoid::conformance {

/// All that a run has found.
struct Report {
    Side side = Side::server;
    std::string target;    ///< "127.0.0.1:7421"
    std::string software;  ///< as the program under test calls itself
    std::string world;     ///< "harbour, protocol 3, model 2"
    std::string kit;       ///< version of the kit
    std::string started;   ///< UTC, "2026-11-22T18:00:00Z"
    int64_t took_us = 0;
    bool forgiving = false;  ///< unexpected passes are no failures
    std::vector<std::string> remarks;
    std::vector<Outcome> outcomes;
};

struct Tally {
    std::map<Verdict, int> verdicts;
    std::map<CloseVerdict, int> closes;
    int of(Verdict verdict) const {
        const auto found = verdicts.find(verdict);
        return found == verdicts.end() ? 0 : found->second;
    }
};
Tally tally_of(const std::vector<Outcome>& outcomes);
/// The same by requirement ("R-117"), in the order of the requirements.
std::map<std::string, Tally> tally_by_requirement(const std::vector<Outcome>& outcomes);

/// True where no outcome counts as a failure.
bool conforms(const Report& report);
bool counts_as_failure(const Outcome& outcome, bool forgiving);

/// The last lines of a run on a terminal: failures, then the sums.
std::string text_of(const Report& report);
/// JUnit XML (one testsuite a requirement), as CI systems read it.
std::string junit_of(const Report& report);
/// JSON: the layout is in this folder's README.
std::string json_of(const Report& report);
/// One page that needs no other file.
std::string html_of(const Report& report);

/// `<`, `>`, `&`, quotes and control characters as XML and HTML want them.
std::string escaped(std::string_view text);
/// "clean, code 106 R-117 after 0.4 ms, ended after 0.5 ms".
std::string sentence_of(const CloseReport& close);

}  // namespace trochoid::conformance
