#include "client/ctl/ctl_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "client/ctl/ctl_subcommands.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/session_rules.hpp"

namespace trochoid {

namespace {

std::string refuse_empty(const std::string& file) { return file.empty() ? "is empty: give a file" : ""; }

void add_login(CLI::App& app, TokenWords& words) {
    app.add_option("--sign-with", words.key_file, sign_with_help)->check(refuse_empty);
    app.add_option("--world", words.world, "The world that it is for (default: as the server names itself)")
        ->check(refuse_empty);
    app.add_option("--token-file", words.token_file, token_file_help)->check(refuse_empty);
}

}  // namespace

std::optional<CtlOptions> read_ctl_options(int argc, const char* const* argv) {
    CLI::App app("Tells a running sea what its winds, ships and land shall do.", "trochoid-ctl");
    app.set_version_flag("--version", version_text("trochoid-ctl"));
    app.require_subcommand(0, 1);
    app.fallthrough();
    app.footer(
        "Example:\n  trochoid-ctl --connect 127.0.0.1:7421 list\n"
        "Winds, ships and land need a director's token, time --rate and --skip an admin's: --sign-with KEY signs one.\n"
        "Exit: 0 done, 1 the server refused or went away, 2 bad options, files or address.");
    CtlOptions options;
    std::string server = default_server;
    std::string ca_file;
    TokenWords login;
    double patience_s = 30.0;
    app.add_option("--connect", server, connect_help)->capture_default_str();
    app.add_option("--ca", ca_file, ca_help)->check(CLI::ExistingFile);
    add_login(app, login);
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
    options.server = endpoint_from_options(server, ca_file);
    options.login = TokenSource(login);
    options.patience = std::chrono::milliseconds(static_cast<int64_t>(patience_s * 1000.0));
    return options;
}

Role role_for(const CtlAction& action) {
    const auto* command = std::get_if<CtlCommand>(&action);
    if (command == nullptr) return Role::viewer;
    for (const Role role : {Role::viewer, Role::director})
        if (permitted(role, Command{1, {}, false, command->action})) return role;
    return Role::admin;
}

SeaTime asked_time(const AskedTime& when, SeaTime now) {
    if (when.at_s) return {seconds_to_us(*when.at_s)};
    if (when.in_s) return now + seconds_to_us(*when.in_s);
    return {-sea_time_bound};
}

}  // namespace trochoid
