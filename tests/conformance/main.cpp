#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <utility>

#include "protocol/model/self_check.hpp"
#include "protocol/units/error_code.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "tests/conformance/client_trial.hpp"
#include "tests/conformance/framed_stream.hpp"
#include "tests/conformance/golden_vectors.hpp"
#include "tests/conformance/options.hpp"
#include "tests/conformance/report.hpp"
#include "tests/conformance/runner.hpp"
#include "tests/conformance/server_trial.hpp"
#include "tests/conformance/vector_answers.hpp"
#include "tests/conformance/witness.hpp"

namespace trochoid::conformance {
namespace {

bool chosen(const Case& it, const Options& options) {
    const auto fits = [&](const std::string& pattern) { return glob_fits(pattern, it.id); };
    return it.side == options.side &&
           (options.only.empty() || std::any_of(options.only.begin(), options.only.end(), fits)) &&
           std::none_of(options.except.begin(), options.except.end(), fits);
}

Catalogue chosen_cases(const Options& options, Catalogue all) {
    Catalogue cases;
    for (Case& it : all)
        if (chosen(it, options)) cases.push_back(std::move(it));
    if (cases.empty()) throw OperatorError("no case fits --only and --except: see --list");
    return cases;
}

std::string utc_now() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

void write_file(const std::string& path, const std::string& text, const char* option) {
    if (path.empty()) return;
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw OperatorError(fmt::format("cannot write {}: check {}", path, option));
}

void write_reports(const Report& report, const Options& options) {
    write_file(options.junit, junit_of(report), "--junit");
    write_file(options.json, json_of(report), "--json");
    write_file(options.html, html_of(report), "--html");
}

void show_progress(const Outcome& outcome, size_t done, size_t total, bool quiet) {
    if (quiet && outcome.verdict != Verdict::failed) return;
    fmt::print("[{:>3}/{}] {:<16} {:<44} {:6.0f} ms  {}\n", done, total, name_of(outcome.verdict), outcome.id,
               static_cast<double>(outcome.took_us) * 1e-3,
               outcome.verdict == Verdict::passed ? sentence_of(outcome.close) : outcome.reason);
    std::fflush(stdout);
}

/// Runs the cases, and tells of them on the terminal and in the reports. `remark`: what to add once all have run.
int carry_out(RunPlan& plan, Report& report, const Options& options,
              const std::function<std::string()>& remark) {
    report.kit = fmt::format("trochoid-conformance {}", software_version());
    report.started = utc_now();
    fmt::print("{} at {}: {}; {} cases\n", report.software, report.target, report.world, plan.cases.size());
    plan.jobs = options.jobs;
    plan.connections = options.connections;
    if (!options.expected_failures.empty()) plan.expected = ExpectedFailures::read(options.expected_failures);
    if (options.forgive_passes) plan.expected.forgive_passes();
    report.forgiving = options.forgive_passes;
    plan.progress = [&](const Outcome& outcome, size_t done) {
        show_progress(outcome, done, plan.cases.size(), options.quiet);
    };
    const int64_t begin_us = monotonic_us();
    report.outcomes = run(plan);
    report.took_us = monotonic_us() - begin_us;
    report.remarks.push_back(remark());
    fmt::print("{}", text_of(report));
    write_reports(report, options);
    return conforms(report) ? 0 : 1;
}

int test_server(Options& options) {
    self_check();
    Target& target = options.target;
    RunPlan plan;
    plan.cases = chosen_cases(options, whole_catalogue());
    try {
        explore(target);
    } catch (const Failed& failed) {
        throw OperatorError(
            fmt::format("no session with a server at {}: {}", to_text(target.server), failed.reason));
    }
    Report report;
    report.side = Side::server;
    report.target = to_text(target.server);
    report.software = target.hello.software;
    report.world = fmt::format("world '{}', protocol {}, model {}", target.hello.world, target.hello.protocol,
                               target.hello.model);
    Witness witness(target);
    plan.trial = [&] { return std::make_unique<ServerTrial>(target); };
    plan.still_serves = [&] { witness.confirm(); };
    return carry_out(plan, report, options, [&] {
        return fmt::format("The witness beside the cases was answered {} times, in {:.1f} ms at most.",
                           witness.exchanges(), static_cast<double>(witness.slowest_us()) * 1e-3);
    });
}

/// Who comes, before any case. One whose first words break the standard fails case by case; where nobody speaks, OperatorError.
void look_at_client(const ClientTarget& target, Report& report) {
    constexpr Milliseconds long_enough{10'000};
    const auto nobody = [](const std::string& reason) {
        return OperatorError(fmt::format("no client says hello: {}: check --run or --listen", reason));
    };
    ClientTrial trial(target);
    std::unique_ptr<Stream> tcp;
    try {
        tcp = trial.come(Way::plain);
    } catch (const Failed& failed) {
        throw nobody(failed.reason);
    }
    try {
        ClientPeer& peer = trial.meet(trial.ascend(std::move(tcp), Way::whole));
        peer.receive(long_enough);
        if (!peer.said_hello())
            throw nobody(
                fmt::format("nothing came within {} s: {}", long_enough.count() / 1000, trial.last_words()));
        const ClientHello& hello = peer.hello();
        report.software = hello.software;
        report.world =
            fmt::format("protocol {} to {}, model {}", hello.protocol_min, hello.protocol_max, hello.model);
    } catch (const Failed& failed) {
        report.software = "a client without a valid hello";
        report.world = failed.reason;
    }
}

int test_client(Options& options) {
    self_check();
    ClientTarget& target = options.client;
    RunPlan plan;
    plan.cases = chosen_cases(options, whole_catalogue());
    if (target.command.empty()) {
        target.gate = std::make_shared<Listener>(options.listen);
        fmt::print(
            "Start the client against {}{}, again and again: each case wants a connection of its own\n",
            address_of(*target.gate, target.transport),
            target.authority ? fmt::format(" (it shall trust {})", target.authority->file()) : "");
        std::fflush(stdout);
        constexpr Milliseconds by_hand{60'000};
        target.coming = by_hand;
        options.jobs = 1;
    }
    Report report;
    report.side = Side::client;
    report.target = target.command.empty() ? address_of(*target.gate, target.transport) : target.command;
    look_at_client(target, report);
    plan.trial = [&] { return std::make_unique<ClientTrial>(target); };
    plan.still_serves = [] {};
    return carry_out(plan, report, options, [] {
        return std::string("Each case had a connection, and a run of the program, of its own.");
    });
}

/// Golden vectors as cases; with what was judged of each, where it was.
Catalogue vector_catalogue(const std::vector<VectorCase>& cases, const std::vector<Outcome>& judged = {}) {
    Catalogue all;
    for (const VectorCase& it : cases) {
        const size_t i = all.size();
        Case& made = all.emplace_back();
        made.id = it.id;
        made.title = it.title;
        made.side = Side::vectors;
        if (judged.empty()) continue;
        made.body = [outcome = judged[i]](Trial& trial) {
            for (const std::string& note : outcome.notes) trial.note(note);
            if (outcome.verdict == Verdict::failed) throw Failed{outcome.reason};
        };
    }
    return all;
}

int check_vectors(Options& options) {
    const bool piped = options.answers == "-";
    const std::vector<VectorCase> cases = vector_cases(options.groups);
    std::ifstream file;
    if (!piped) file.open(options.answers, std::ios::binary);
    if (!piped && !file) throw OperatorError(fmt::format("cannot read {}: check the path", options.answers));
    const std::string name = piped ? "standard input" : options.answers;
    RunPlan plan;
    plan.cases =
        chosen_cases(options, vector_catalogue(cases, judge_answers(piped ? std::cin : file, name, cases)));
    Report report;
    report.side = Side::vectors;
    report.target = name;
    report.software = "What was answered";
    report.world = fmt::format("protocol {}, model {}", protocol_version_max, model_version);
    plan.trial = [] { return std::make_unique<Trial>(); };
    plan.still_serves = [] {};
    options.jobs = 1;
    return carry_out(plan, report, options,
                     [] { return std::string("Every line was compared to the bit."); });
}

int run_program(int argc, char** argv) {
    auto options = read_options(argc, argv);
    if (!options) return 0;
    if (options->print_vectors) {
        fmt::print("{}", vectors_text(options->groups, options->questions));
        return 0;
    }
    if (options->list) {
        Catalogue all = options->side == Side::vectors ? vector_catalogue(vector_cases(options->groups))
                                                       : whole_catalogue();
        for (const Case& it : chosen_cases(*options, std::move(all))) fmt::print("{}\n", it.id);
        return 0;
    }
    if (options->side == Side::vectors) return check_vectors(*options);
    return options->side == Side::client ? test_client(*options) : test_server(*options);
}

}  // namespace
}  // namespace trochoid::conformance

int main(int argc, char** argv) {
    try {
        return trochoid::conformance::run_program(argc, argv);
    } catch (const trochoid::OperatorError& error) {
        fmt::print(stderr, "trochoid-conformance: {}\n", error.what());
        return 2;
    }
}
