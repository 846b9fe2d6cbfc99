// R6: seeded lives of a client and its servers under virtual time; exit 0 all well, 1 one failed, 2 options.
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/simulation/sim_node.hpp"
#include "tests/simulation/story.hpp"

namespace {

using namespace trochoid;

// What runs, for the message of an assertion that ends the process.
std::string at_hand;

void name_what_ran(int) {
    std::fputs(("simulation: an assertion failed in " + at_hand + "\n").c_str(), stderr);
    std::_Exit(1);
}

int failed(const std::string& what) {
    fmt::print(stderr, "simulation: {}: {}\n", at_hand, what);
    return 1;
}

/// Stories from one seed on.
int tell(uint64_t first, uint64_t count, int most_failures) {
    StoryEnd sum;
    int failures = 0;
    for (uint64_t seed = first; seed < first + count && failures < most_failures; ++seed) {
        at_hand = fmt::format("--seed {}", seed);
        const StoryEnd end = seeded_story(seed, false);
        if (!end.failure.empty()) failures += failed(end.failure);
        sum.connections += end.connections;
        sum.sessions += end.sessions;
        sum.resumed += end.resumed;
        sum.results += end.results;
        sum.pieces += end.pieces;
        sum.events += end.events;
        sum.restarts += end.restarts;
        sum.cuts += end.cuts;
        sum.troubles += end.troubles;
        for (const auto& [verdict, times] : end.resumes) sum.resumes[verdict] += times;
    }
    fmt::print(
        "{} seeds from {}: {} connections, {} cut, {} sessions, {} of them resumed, {} results of {} pieces, {} events, {} restarts, {} new "
        "beginnings after bits that turned over\n",
        count, first, sum.connections, sum.cuts, sum.sessions, sum.resumed, sum.results, sum.pieces,
        sum.events, sum.restarts, sum.troubles);
    std::string resumes;
    for (const auto& [verdict, times] : sum.resumes)
        resumes += fmt::format("{}{} {}", resumes.empty() ? "" : ", ", verdict, times);
    fmt::print("wishes to go on with what was held: {}\n", resumes.empty() ? "none" : resumes);
    if (count >= 100 && (sum.resumed == 0 || sum.cuts == 0 || sum.restarts == 0))
        return failed("nothing went wrong: the faults do not act");
    return failures == 0 ? 0 : 1;
}

/// Login and first result, cut after each of their bytes, up and down.
int cut_everywhere(uint64_t step) {
    at_hand = "an undisturbed login";
    const StoryEnd whole = cut_story(true, UINT64_MAX, CutKind::reset);
    if (!whole.failure.empty()) return failed(whole.failure);
    uint64_t stories = 0;
    int failures = 0;
    for (const bool up : {true, false})
        for (const CutKind kind : {CutKind::reset, CutKind::finish, CutKind::silence})
            for (uint64_t at = 0; at <= (up ? whole.first_up : whole.first_down) && failures < 10;
                 at += step) {
                at_hand = fmt::format("--cut {} {} {}", up ? "up" : "down", at, static_cast<int>(kind));
                const StoryEnd end = cut_story(up, at, kind);
                if (!end.failure.empty()) failures += failed(end.failure);
                ++stories;
            }
    fmt::print("login and first result, {} bytes up and {} down, cut in {} ways\n", whole.first_up,
               whole.first_down, stories);
    return failures == 0 ? 0 : 1;
}

constexpr const char* usage =
    "trochoid-simulation: --seeds N [--from SEED | --first] | --seed SEED (one, with a trace) | --cuts [STEP] | --cut up|down BYTE KIND\n";

int run(int argc, char** argv) {
    const auto word = [&](int i) { return i < argc ? std::string_view(argv[i]) : std::string_view(); };
    const auto number = [&](int i, uint64_t otherwise) {
        return i < argc ? std::strtoull(argv[i], nullptr, 10) : otherwise;
    };
    if (word(1) == "--seeds")
        return tell(word(3) == "--from" ? number(4, 1) : 1, number(2, 2000), word(3) == "--first" ? 1 : 10);
    if (word(1) == "--seed") {
        at_hand = fmt::format("--seed {}", number(2, 1));
        const StoryEnd end = seeded_story(number(2, 1), true);
        return end.failure.empty() ? 0 : failed(end.failure);
    }
    if (word(1) == "--cuts") return cut_everywhere(number(2, 1));
    if (word(1) == "--cut" && argc == 5) {
        at_hand = "that cut";
        const StoryEnd end = cut_story(word(2) == "up", number(3, 0), static_cast<CutKind>(number(4, 0) % 3));
        return end.failure.empty() ? 0 : failed(end.failure);
    }
    std::fputs(usage, stderr);
    return 2;
}

}  // namespace

int main(int argc, char** argv) {
    keep_quiet();
    std::signal(SIGABRT, name_what_ran);
    const auto began = std::chrono::steady_clock::now();
    const int status = run(argc, argv);
    fmt::print("{:.1f} s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    return status;
}
