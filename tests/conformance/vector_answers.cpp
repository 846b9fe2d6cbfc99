#include "tests/conformance/vector_answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <istream>
#include <map>
#include <sstream>

#include "protocol/units/operator_error.hpp"
#include "tests/conformance/golden_vectors.hpp"

namespace trochoid::conformance {

namespace {

struct Kind {
    const char* kind;
    const char* requirement;
    const char* title;
};
constexpr Kind kinds[] = {
    {"constants", "R-201", "What each train is made of: every operation rounded on its own"},
    {"phase", "R-202", "Phases anywhere in the world, at any time"},
    {"sincos", "R-203", "Sines and cosines"},
    {"sample", "R-204", "The surface at rest points"},
    {"layers", "R-204", "The surface with some layers left out"},
    {"land", "R-205", "Land fields between their nodes"},
    {"wakenode", "R-205", "Nodes of the wake table"},
    {"wakeroot", "R-205", "Roots of the wake table"},
    {"water", "R-205", "The surface at fixed places"},
    {"hash", "R-205", "Known answers"},
    {"seatime", "R-142", "Sea time by the server's clock"},
    {"hello", "R-142", "What the stamps of a hello say"},
    {"exchange", "R-142", "The exchange that counts"},
    {"reading", "R-142", "Shown sea time, and the bound of its error"},
};

const VectorSet* set_called(std::string_view name) {
    const auto sets = vector_sets();
    const auto found =
        std::find_if(sets.begin(), sets.end(), [&](const VectorSet& s) { return s.name == name; });
    return found == sets.end() ? nullptr : &*found;
}

/// The bytes that our encoder writes for what a message says; nothing where it cannot be read.
std::optional<Bytes> written_again(std::string_view direction, const Bytes& bytes) {
    const auto again = [](const auto& decoded) -> std::optional<Bytes> {
        if (!decoded) return std::nullopt;
        return encode(*decoded);
    };
    if (direction == "client") return again(decode_client(bytes));
    if (direction == "server") return again(decode_server(bytes));
    return again(decode_event(bytes));
}

bool agrees(const VectorSet& set, const VectorLine& expected, const std::string& answer) {
    if (set.name != "messages") return answer == expected.answer;
    // Another encoder may lay a buffer out otherwise: what it says has to be the same.
    const auto wanted = from_hex(expected.answer);
    const auto given = from_hex(answer);
    return given && written_again(expected.kind, *given) == wanted;
}

/// The questions of a case, and how they were answered.
struct Tally {
    /// Of equal questions (a clock's) the earlier one first.
    std::map<std::string, std::deque<VectorLine>> open;
    size_t asked = 0;
    size_t wrong = 0;
    std::string first_wrong;

    std::string verdict() const {
        size_t missing = 0;
        for (const auto& [question, lines] : open) missing += lines.size();
        std::string text;
        if (wrong > 0) text = fmt::format("{} of {} lines differ, the first: {}", wrong, asked, first_wrong);
        if (missing > 0)
            text +=
                fmt::format("{}{} of {} lines are not answered", text.empty() ? "" : "; ", missing, asked);
        return text;
    }
};

/// What a line belongs to: a message's own question, else set and kind.
std::string subject_of(const VectorSet& set, const VectorLine& line) {
    return set.name == "messages" ? line.question : set.name + " " + line.kind;
}

/// Whether such lines of the set are no questions, but what its questions are about.
bool is_record(const VectorSet& set, const std::string& kind) {
    return set.text.find(fmt::format("\n{} ", kind)) != std::string::npos;
}

bool asks_of(const std::vector<VectorCase>& cases, const VectorSet& set) {
    return std::any_of(cases.begin(), cases.end(), [&](const VectorCase& it) { return it.set == set.name; });
}

std::map<std::string, Tally> questions_of(const std::vector<VectorCase>& cases) {
    std::map<std::string, Tally> tallies;
    for (const VectorCase& it : cases) tallies[it.subject];
    for (const VectorSet& set : vector_sets()) {
        std::istringstream lines(set.text);
        for (std::string line; std::getline(lines, line);) {
            auto apart = line.starts_with('#') ? std::nullopt : vector_line(set, line);
            if (!apart || apart->answer.empty()) continue;
            const auto found = tallies.find(subject_of(set, *apart));
            if (found == tallies.end()) continue;
            ++found->second.asked;
            found->second.open[apart->question].push_back(std::move(*apart));
        }
    }
    return tallies;
}

void take(const VectorSet& set, const VectorLine& line, Tally& tally, const std::string& where) {
    const auto found = tally.open.find(line.question);
    if (found == tally.open.end())
        throw OperatorError(fmt::format("{}: '{}' is no question of `vectors {}`, or was answered before",
                                        where, line.question, set.group));
    const VectorLine expected = std::move(found->second.front());
    found->second.pop_front();
    if (found->second.empty()) tally.open.erase(found);
    if (agrees(set, expected, line.answer)) return;
    constexpr size_t most = 160;
    const auto shortened = [](const std::string& text) {
        return text.size() > most ? text.substr(0, most) + "…" : text;
    };
    if (tally.wrong++ == 0)
        tally.first_wrong = set.name == "messages"
                                ? fmt::format("{}: the message says something else, or cannot be read", where)
                                : fmt::format("{}: '{}' is {}, not {}", where, line.question,
                                              shortened(expected.answer), shortened(line.answer));
}

}  // namespace

std::vector<VectorCase> vector_cases(const std::vector<std::string>& groups) {
    std::vector<VectorCase> cases;
    const auto wanted = [&](const VectorSet& set) {
        return groups.empty() || std::find(groups.begin(), groups.end(), set.group) != groups.end();
    };
    for (const VectorSet& set : vector_sets()) {
        if (!wanted(set)) continue;
        if (set.name == "messages")
            for (const GoldenMessage& message : golden_messages())
                cases.push_back(
                    {fmt::format("R-119/{}-{}", message.direction, message.name),
                     fmt::format("The golden message '{}' is read and written again", message.name), set.name,
                     message.direction, message.direction + " " + message.name});
        for (const Kind& kind : kinds)
            if (set.text.find(fmt::format("\n{} ", kind.kind)) != std::string::npos)
                cases.push_back({fmt::format("{}/{}-{}", kind.requirement, set.name, kind.kind), kind.title,
                                 set.name, kind.kind, fmt::format("{} {}", set.name, kind.kind)});
    }
    std::map<std::string_view, std::vector<VectorCase>> by_requirement;
    for (const VectorCase& it : cases) by_requirement[requirement_of_case(it.id)].push_back(it);
    std::vector<VectorCase> ordered;
    for (const auto& [requirement, its] : by_requirement)
        ordered.insert(ordered.end(), its.begin(), its.end());
    return ordered;
}

std::vector<Outcome> judge_answers(std::istream& answers, const std::string& name,
                                   const std::vector<VectorCase>& cases) {
    std::map<std::string, Tally> tallies = questions_of(cases);
    const VectorSet* set = nullptr;
    size_t number = 0;
    for (std::string line; std::getline(answers, line);) {
        const std::string where = fmt::format("{}:{}", name, ++number);
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
        if (line.empty() || line[0] == '#') continue;
        constexpr std::string_view begins = "vectors ";
        if (line.starts_with(begins)) {
            set = set_called(line.substr(begins.size()));
            if (set == nullptr)
                throw OperatorError(
                    fmt::format("{}: '{}' is no set of golden vectors: see `vectors`", where, line));
            continue;
        }
        if (set == nullptr)
            throw OperatorError(where + ": a line 'vectors NAME' has to come before the answers");
        const auto apart = vector_line(*set, line);
        if (!apart) throw OperatorError(fmt::format("{}: '{}' has too few words", where, line));
        if (apart->answer.empty() && is_record(*set, apart->kind)) continue;
        const auto found = tallies.find(subject_of(*set, *apart));
        if (found != tallies.end())
            take(*set, *apart, found->second, where);
        else if (asks_of(cases, *set))
            throw OperatorError(
                fmt::format("{}: '{}' is no question of `vectors {}`", where, apart->question, set->group));
    }
    std::vector<Outcome> outcomes;
    for (const VectorCase& it : cases) {
        const Tally& tally = tallies.at(it.subject);
        Outcome outcome;
        outcome.id = it.id;
        outcome.title = it.title;
        outcome.reason = tally.verdict();
        outcome.verdict = outcome.reason.empty() ? Verdict::passed : Verdict::failed;
        outcome.notes.push_back(fmt::format("{} lines", tally.asked));
        outcomes.push_back(std::move(outcome));
    }
    return outcomes;
}

}  // namespace trochoid::conformance
