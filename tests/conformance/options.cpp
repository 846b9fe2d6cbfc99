#include "tests/conformance/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>

#include "protocol/login/key_file.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "tests/conformance/golden_vectors.hpp"

namespace trochoid::conformance {

namespace {

constexpr double shortest_wait_s = 0.1;
constexpr double longest_wait_s = 3600.0;

std::string first_line_of(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    if (!file || !std::getline(file, line) || line.empty())
        throw OperatorError(
            fmt::format("cannot read a token from the first line of {}: check --token-file", path));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    return line;
}

/// What both sides' subcommands take.
void add_common(CLI::App& app, Options& options) {
    app.add_option("--only", options.only,
                   "Only cases whose id fits: 'R-117/*' (may be given more than once)");
    app.add_option("--except", options.except, "Not the cases whose id fits");
    app.add_flag("--list", options.list, "Print the ids of the cases, one a line, and run nothing");
    app.add_flag("--quiet", options.quiet, "No line for each case, only failures and sums");
    app.add_option("--junit", options.junit, "Write a JUnit XML report");
    app.add_option("--json", options.json, "Write a JSON report");
    app.add_option("--html", options.html, "Write an HTML report: one page that needs no other file");
    app.add_option("--expect-failures", options.expected_failures,
                   "File of cases known to fail: 'ID reason' a line; ids may hold * and ?");
    app.add_flag("--forgive-passes", options.forgive_passes,
                 "A case on that list may pass (else that is a failure: the list is out of date)");
}

void add_server(CLI::App& app, Options& options, std::string& address, std::string& ca_file,
                std::string& token_file, std::string& key_file, double& timeout_s, double& longest_s) {
    add_common(app, options);
    app.add_option("--connect", address, connect_help)->capture_default_str();
    app.add_option("--ca", ca_file, ca_help);
    app.add_option("--token-file", token_file,
                   "File with a token in its first line, for servers that take one more than once");
    app.add_option(
        "--sign-with", key_file,
        "File with the private key (Ed25519, PEM) that signs tokens: each case that changes the sea makes its own. "
        "Without it those cases are skipped");
    app.add_option("--jobs", options.jobs, "Cases side by side")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    app.add_option("--connections", options.connections, "Most connections of the cases at a time")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    app.add_option("--timeout", timeout_s, "Seconds to wait for each answer")
        ->check(CLI::Range(shortest_wait_s, longest_wait_s))
        ->capture_default_str();
    app.add_option("--longest-wait", longest_s,
                   "Seconds: cases that have to wait longer for a deadline are skipped")
        ->check(CLI::Range(0.0, longest_wait_s))
        ->capture_default_str();
}

CLI::App* add_client(CLI::App& app, Options& options, std::string& transport, double& timeout_s,
                     double& longest_s) {
    CLI::App* client =
        app.add_subcommand("client", "Tests a client: takes the part of a server on the loopback interface");
    add_common(*client, options);
    CLI::Option* run = client->add_option(
        "--run", options.client.command,
        "Command that starts the client, for a shell; {address} in it stands for HOST:PORT (behind tls://, ws:// or wss://, as "
        "--transport says), {ca} for a PEM file of the certificate to trust. Every case starts it anew and ends it (SIGTERM)");
    CLI::Option* listen = client->add_option(
        "--listen", options.listen,
        "Listen at this port instead: the client is started by hand, or in a loop, once a case");
    run->excludes(listen);
    client->add_option("--transport", transport, "How the client comes: tcp, tls, ws or wss")
        ->check(CLI::IsMember({"tcp", "tls", "ws", "wss"}))
        ->capture_default_str();
    client->add_option("--jobs", options.jobs, "Cases side by side (with --run)")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    client->add_option("--timeout", timeout_s, "Seconds to wait for each answer")
        ->check(CLI::Range(shortest_wait_s, longest_wait_s))
        ->capture_default_str();
    client->add_option("--longest-wait", longest_s, "Seconds to wait for a client that may connect again")
        ->check(CLI::Range(0.0, longest_wait_s))
        ->capture_default_str();
    return client;
}

/// Subcommands about golden vectors.
struct VectorCommands {
    CLI::App* print;
    CLI::App* check;
};
VectorCommands add_vectors(CLI::App& app, Options& options) {
    const auto add_groups = [&](CLI::App& to) {
        to.add_option("groups", options.groups, "Which (all)")->check(CLI::IsMember(vector_groups()));
    };
    CLI::App* print =
        app.add_subcommand("vectors", "Prints the golden vectors that every program has to reproduce");
    print->add_flag("--questions", options.questions,
                    "Leave the answers out, for a program that fills them in");
    add_groups(*print);
    CLI::App* check =
        app.add_subcommand("check-vectors", "Compares a program's answers to the golden vectors, to the bit");
    check->add_option("answers", options.answers, "File of the answers; -: standard input")->required();
    add_groups(*check);
    add_common(*check, options);
    return {print, check};
}

Milliseconds milliseconds(double seconds) { return Milliseconds(static_cast<int64_t>(seconds * 1000.0)); }

}  // namespace

std::optional<Options> read_options(int argc, char** argv) {
    Options options;
    std::string address = default_server;
    std::string ca_file;
    std::string token_file;
    std::string key_file;
    std::string transport = "tcp";
    double timeout_s = 5.0;
    double longest_s = 8.0;
    CLI::App app("Tests whether a program keeps the Trochoid standard (protocol/README.md).",
                 "trochoid-conformance");
    app.set_version_flag("--version", version_text("trochoid-conformance"));
    app.require_subcommand(1);
    app.footer(
        "Example:\n  trochoid-conformance server --connect 127.0.0.1:7421 --token-file token --html report.html\n"
        "Exit: 0 it conforms, 1 it does not, 2 bad options or files, or nothing could be tested.");
    add_server(*app.add_subcommand("server", "Tests a server: connects to it as its clients would"), options,
               address, ca_file, token_file, key_file, timeout_s, longest_s);
    const CLI::App* client = add_client(app, options, transport, timeout_s, longest_s);
    const VectorCommands vectors = add_vectors(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& wish) {
        app.exit(wish);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw OperatorError(fmt::format("{}: see --help", error.what()));
    }
    options.client.patience = milliseconds(timeout_s);
    options.client.longest_wait = milliseconds(longest_s);
    options.print_vectors = vectors.print->parsed();
    if (vectors.print->parsed() || vectors.check->parsed()) {
        options.side = Side::vectors;
        return options;
    }
    if (client->parsed()) {
        options.side = Side::client;
        if (options.client.command.empty() && options.listen == 0 && !options.list)
            throw OperatorError(
                "say how the client is started (--run 'PROGRAM {address}') or where it will come (--listen PORT)");
        // The port only fills the address.
        if (!options.list)
            use_transport(options.client, parse_endpoint(transport + "://127.0.0.1:1").transport);
        return options;
    }
    options.target.server = endpoint_from_options(address, ca_file);
    options.target.patience = milliseconds(timeout_s);
    options.target.longest_wait = milliseconds(longest_s);
    if (!token_file.empty()) options.target.tokens = Tokens(first_line_of(token_file));
    if (!key_file.empty()) options.target.tokens = Tokens(read_signing_key(key_file, "--sign-with").key);
    return options;
}

}  // namespace trochoid::conformance
