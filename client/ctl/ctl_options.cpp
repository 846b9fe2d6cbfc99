#include "client/ctl/ctl_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>

#include "client/ctl/ctl_subcommands.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

constexpr size_t longest_token = 1024;

std::string token_from(const std::string& file) {
    if (file.empty()) return {};
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw OperatorError(fmt::format(
            "cannot read the token file {}: give the file that trochoid-server was started with", file));
    std::string token;
    std::getline(in, token);
    constexpr const char* blanks = " \t\r";
    token.erase(0, std::min(token.size(), token.find_first_not_of(blanks)));
    token.erase(token.find_last_not_of(blanks) + 1);
    if (token.empty() || token.size() > longest_token)
        throw OperatorError(fmt::format(
            "the token file {} holds no token of 1 to {} characters in its first line", file, longest_token));
    return token;
}

}  // namespace

std::optional<CtlOptions> read_ctl_options(int argc, const char* const* argv) {
    CLI::App app("Tells a running sea what its winds, ships and land shall do.", "trochoid-ctl");
    app.set_version_flag("--version", version_text("trochoid-ctl"));
    app.require_subcommand(0, 1);
    app.fallthrough();
    app.footer(
        "Example:\n  trochoid-ctl --connect 127.0.0.1:7421 list\n"
        "All but list and time without --rate need a director's token (--token-file).\n"
        "Exit: 0 done, 1 the server refused or went away, 2 bad options, files or address.");
    CtlOptions options;
    std::string server = default_server;
    std::string token_file;
    double patience_s = 30.0;
    app.add_option("--connect", server, "HOST:PORT of the server")->capture_default_str();
    app.add_option("--token-file", token_file, "File with the director's token")
        ->check([](const std::string& file) { return file.empty() ? "is empty: give a file" : ""; });
    app.add_flag("--json", options.json, "Print JSON instead of tables");
    app.add_option("--patience", patience_s, "Seconds to wait for each answer")
        ->check([](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value >= 0.1 && value <= 3600.0;
            return good ? std::string() : text + " is not a number in 0.1 to 3600";
        })
        ->capture_default_str();
    const CtlSubcommands subcommands(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) {
            app.exit(error);
            return std::nullopt;
        }
        throw OperatorError(fmt::format("{} (see trochoid-ctl --help)", error.what()));
    }
    options.action = subcommands.action();
    options.server = parse_endpoint(server);
    options.token = token_from(token_file);
    options.patience = std::chrono::milliseconds(static_cast<int64_t>(patience_s * 1000.0));
    return options;
}

SeaTime asked_time(const AskedTime& when, SeaTime now) {
    if (when.at_s) return {seconds_to_us(*when.at_s)};
    if (when.in_s) return now + seconds_to_us(*when.in_s);
    return {-sea_time_bound};
}

}  // namespace trochoid
