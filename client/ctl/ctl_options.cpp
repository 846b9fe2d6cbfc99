#include "client/ctl/ctl_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <iostream>
#include <vector>

#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

constexpr double longest_km = 1048.576;  // 2^30 lattice units
constexpr double shortest_km = 0.032;
constexpr double farthest_m = 33'554'432.0;  // the world's bound
constexpr double longest_life_s = 3.6e10;    // 1100 years
constexpr double farthest_time_s = 2.3e12;   // 2^61 microseconds
constexpr size_t longest_token = 1024;

/// Options as they are typed.
struct Typed {
    std::string server = default_server;
    std::string token_file;
    double patience_s = 30.0;
    double speed = 0.0;
    double towards = 0.0;
    std::vector<double> origin;
    double fetch_km = 0.0;
    double width_km = 0.0;
    double life_s = 0.0;
    unsigned trains = 16;
    uint64_t seed = 0;
    unsigned box = 0;
    double rate = 1.0;
    AskedTime when;
};

/// A range check that leaves the help to the option's own words.
template <class Number>
CLI::Validator within(Number least, Number most) {
    return CLI::Range(least, most).description("");
}

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

void add_when(CLI::App& command, Typed& typed) {
    CLI::Option* at =
        command
            .add_option("--at", typed.when.at_s, "Sea time in seconds at which it takes hold (default: soon)")
            ->check(within(-farthest_time_s, farthest_time_s));
    command.add_option("--in", typed.when.in_s, "The same, in seconds of sea time from now")
        ->check(within(0.0, farthest_time_s))
        ->excludes(at);
    command.add_flag("--or-refuse", typed.when.or_refuse,
                     "Refuse rather than defer when that time cannot be met");
}

CLI::App* add_start_wind(CLI::App& app, Typed& typed) {
    CLI::App* start =
        app.add_subcommand("start-wind", "Raise a wind: its waves build up, last for its life and decay");
    start->add_option("--speed", typed.speed, "Wind in m/s at 19.5 m height, 1 to 40")
        ->required()
        ->check(within(1.0, 40.0));
    start
        ->add_option("--towards", typed.towards,
                     "Heading that the waves travel towards, degrees clockwise from north")
        ->required()
        ->check(within(0.0, 360.0));
    start->add_option("--origin", typed.origin, "Metres X,Z (east, south) of the middle of the rear edge")
        ->required()
        ->delimiter(',')
        ->expected(2)
        ->check(within(-farthest_m, farthest_m));
    start->add_option("--fetch-km", typed.fetch_km, "Length along travel")
        ->required()
        ->check(within(shortest_km, longest_km));
    start->add_option("--width-km", typed.width_km, "Width across")
        ->required()
        ->check(within(shortest_km, longest_km));
    start->add_option("--life-s", typed.life_s, "Seconds until the decay starts; 0: until stopped")
        ->check(within(0.0, longest_life_s))
        ->capture_default_str();
    start->add_option("--trains", typed.trains, "Wave trains, 1 to 64")
        ->check(within(1U, 64U))
        ->capture_default_str();
    start->add_option("--seed", typed.seed, "Chooses phases and directions; 0: the server does")
        ->check(within(uint64_t{0}, uint64_t{INT64_MAX}))
        ->capture_default_str();
    add_when(*start, typed);
    start->footer(
        "Example:\n  trochoid-ctl --token-file director-token start-wind --speed 12 --towards 68 \\\n"
        "      --origin -4000,2500 --fetch-km 20 --width-km 8 --life-s 600");
    return start;
}

CLI::App* add_stop_wind(CLI::App& app, Typed& typed) {
    CLI::App* stop = app.add_subcommand("stop-wind", "End a wind: its waves decay from then on");
    stop->add_option("BOX", typed.box, "Number of its wave train box, as `list` shows it")
        ->required()
        ->check(within(1U, UINT32_MAX));
    add_when(*stop, typed);
    stop->footer("Example:\n  trochoid-ctl --token-file director-token stop-wind 3 --in 60");
    return stop;
}

CLI::App* add_time(CLI::App& app, Typed& typed) {
    CLI::App* time = app.add_subcommand("time", "Show sea time and its rate, or set the rate");
    time->add_option("--rate", typed.rate, "Seconds of sea time a second, 0 (paused) to 16")
        ->check(within(0.0, 16.0));
    time->footer(
        "Examples:\n  trochoid-ctl time\n  trochoid-ctl --token-file director-token time --rate 0.5");
    return time;
}

StartWind wind_of(const Typed& typed) {
    StartWind wind;
    wind.speed = static_cast<float>(typed.speed);
    wind.towards_degrees = typed.towards >= 360.0 ? 0.0F : static_cast<float>(typed.towards);
    wind.origin = {to_lattice(typed.origin[0]), to_lattice(typed.origin[1])};
    wind.fetch = to_lattice(typed.fetch_km * 1000.0);
    wind.width = to_lattice(typed.width_km * 1000.0);
    wind.life_us = seconds_to_us(typed.life_s);
    wind.trains = static_cast<uint16_t>(typed.trains);
    wind.seed = typed.seed;
    if (typed.life_s > 0.0 && typed.life_s < 1.0)
        throw OperatorError(
            "--life-s wants at least 1 second, or 0 for a wind that lasts until it is stopped");
    return wind;
}

/// A number that is none (CLI11 takes "nan") passes every range check.
void refuse_nan(const Typed& typed) {
    for (const double v :
         {typed.patience_s, typed.speed, typed.towards, typed.fetch_km, typed.width_km, typed.life_s,
          typed.rate, typed.when.at_s.value_or(0.0), typed.when.in_s.value_or(0.0),
          typed.origin.empty() ? 0.0 : typed.origin[0], typed.origin.empty() ? 0.0 : typed.origin[1]})
        if (!std::isfinite(v)) throw OperatorError("options want finite numbers (see trochoid-ctl --help)");
}

}  // namespace

std::optional<CtlOptions> read_ctl_options(int argc, const char* const* argv) {
    CLI::App app("Tells a running sea what its winds shall do.", "trochoid-ctl");
    app.set_version_flag("--version", version_text("trochoid-ctl"));
    app.require_subcommand(0, 1);
    app.fallthrough();
    app.footer(
        "Example:\n  trochoid-ctl --connect 127.0.0.1:7421 list\n"
        "start-wind, stop-wind and time --rate need a director's token (--token-file).\n"
        "Exit: 0 done, 1 the server refused or went away, 2 bad options, files or address.");
    Typed typed;
    CtlOptions options;
    app.add_option("--connect", typed.server, "HOST:PORT of the server")->capture_default_str();
    app.add_option("--token-file", typed.token_file, "File with the director's token")
        ->check([](const std::string& file) { return file.empty() ? "is empty: give a file" : ""; });
    app.add_flag("--json", options.json, "Print JSON instead of tables");
    app.add_option("--patience", typed.patience_s, "Seconds to wait for each answer")
        ->check(within(0.1, 3600.0))
        ->capture_default_str();
    const CLI::App* start = add_start_wind(app, typed);
    const CLI::App* stop = add_stop_wind(app, typed);
    CLI::App* list = app.add_subcommand("list", "Show all wave train boxes");
    list->footer("Example:\n  trochoid-ctl list --json");
    const CLI::App* time = add_time(app, typed);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) {
            app.exit(error);
            return std::nullopt;
        }
        throw OperatorError(fmt::format("{} (see trochoid-ctl --help)", error.what()));
    }
    if (app.get_subcommands().empty())
        throw OperatorError("say what to do: start-wind, stop-wind, list or time (see trochoid-ctl --help)");
    refuse_nan(typed);
    if (typed.when.or_refuse && !typed.when.at_s && !typed.when.in_s)
        throw OperatorError("--or-refuse wants --at or --in: the time that must be met");
    options.server = parse_endpoint(typed.server);
    options.token = token_from(typed.token_file);
    options.patience = std::chrono::milliseconds(static_cast<int64_t>(typed.patience_s * 1000.0));
    if (start->parsed()) options.action = CtlStartWind{wind_of(typed), typed.when};
    if (stop->parsed()) options.action = CtlStopWind{{typed.box}, typed.when};
    if (list->parsed()) options.action = CtlList{};
    if (time->parsed())
        options.action = CtlTime{time->count("--rate") > 0 ? std::optional(typed.rate) : std::nullopt};
    return options;
}

SeaTime asked_time(const AskedTime& when, SeaTime now) {
    if (when.at_s) return {seconds_to_us(*when.at_s)};
    if (when.in_s) return now + seconds_to_us(*when.in_s);
    return {-sea_time_bound};
}

}  // namespace trochoid
