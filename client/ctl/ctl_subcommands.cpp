#include "client/ctl/ctl_subcommands.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "protocol/codec/codec.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr double longest_km = 1048.576;  // 2^30 lattice units
constexpr double shortest_km = 0.032;
constexpr double farthest_m = 33'554'432.0;  // the world's bound
constexpr double longest_life_s = 3.6e10;    // 1100 years
constexpr double farthest_time_s = 2.3e12;   // 2^61 microseconds

const std::map<std::string, Spectrum> spectra{{"automatic", Spectrum::automatic},
                                              {"pierson-moskowitz", Spectrum::pierson_moskowitz},
                                              {"jonswap", Spectrum::jonswap},
                                              {"neumann", Spectrum::neumann}};
const std::map<std::string, Spreading> spreadings{{"automatic", Spreading::automatic},
                                                  {"cosine-squared", Spreading::cosine_squared},
                                                  {"hasselmann", Spreading::hasselmann}};

/// A range check, which "nan" does not pass; the help leaves ranges to the options' own words.
template <class Number>
CLI::Validator within(Number least, Number most) {
    return CLI::Validator(
        [least, most](std::string& text) -> std::string {
            Number value{};
            if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return {};
            return fmt::format("{} is not a number in {} to {}", text.empty() ? "nothing" : text, least,
                               most);
        },
        "");
}

/// "X,Z" in metres.
LatticePoint point_of(const std::string& text) {
    const size_t comma = text.find(',');
    double x = 0.0;
    double z = 0.0;
    const bool numbers = comma != std::string::npos && CLI::detail::lexical_cast(text.substr(0, comma), x) &&
                         CLI::detail::lexical_cast(text.substr(comma + 1), z);
    if (!numbers || !(std::abs(x) <= farthest_m && std::abs(z) <= farthest_m))
        throw OperatorError(fmt::format(
            "--point wants X,Z in metres (east, south), at most {:.0f} each, not '{}'", farthest_m, text));
    return {to_lattice(x), to_lattice(z)};
}

float heading_of(double degrees) { return degrees >= 360.0 ? 0.0F : static_cast<float>(degrees); }

/// Metres per second east or south, without the dust that a sine leaves of a right angle.
float component(double metres_per_second) {
    return static_cast<float>(std::round(metres_per_second * 1.0e6) * 1.0e-6);
}

/// What a server would refuse to read is refused here.
CtlCommand legal(CommandAction action, const AskedTime& when) {
    const auto read = decode_client(encode(ClientMessage{Command{1, {}, false, action}}));
    if (!read) throw OperatorError(fmt::format("{} (see trochoid-ctl --help)", read.error().message));
    return {std::move(action), when};
}

}  // namespace

CtlSubcommands::CtlSubcommands(CLI::App& app) {
    add_start_wind(app);
    add_start_ship(app);
    add_steer(app);
    add_stop(app);
    add_breakwater(app);
    add_list_and_time(app);
    token_.emplace(app);
}

void CtlSubcommands::add_when(CLI::App& command) {
    CLI::Option* at = command
                          .add_option("--at", typed_.when.at_s,
                                      "Sea time in seconds at which it takes hold (default: soon)")
                          ->check(within(-farthest_time_s, farthest_time_s));
    command.add_option("--in", typed_.when.in_s, "The same, in seconds of sea time from now")
        ->check(within(0.0, farthest_time_s))
        ->excludes(at);
    command.add_flag("--or-refuse", typed_.when.or_refuse,
                     "Refuse rather than defer when that time cannot be met");
}

void CtlSubcommands::add_towards(CLI::App& command, const char* help) {
    command.add_option("--towards", typed_.towards, help)->required()->check(within(0.0, 360.0));
}

void CtlSubcommands::add_box(CLI::App& command, const char* help) {
    command.add_option("BOX", typed_.box, help)->required()->check(within(1U, UINT32_MAX));
}

void CtlSubcommands::add_start_wind(CLI::App& app) {
    start_wind_ =
        app.add_subcommand("start-wind", "Raise a wind: its waves build up, last for its life and decay");
    start_wind_->add_option("--speed", typed_.speed, "Wind in m/s at 19.5 m height, 1 to 40")
        ->required()
        ->check(within(1.0, 40.0));
    add_towards(*start_wind_, "Heading that the waves travel towards, degrees clockwise from north");
    start_wind_
        ->add_option("--origin", typed_.place, "Metres X,Z (east, south) of the middle of the rear edge")
        ->required()
        ->delimiter(',')
        ->expected(2)
        ->check(within(-farthest_m, farthest_m));
    start_wind_->add_option("--fetch-km", typed_.fetch_km, "Length along travel, 0.032 to 1048")
        ->required()
        ->check(within(shortest_km, longest_km));
    start_wind_->add_option("--width-km", typed_.width_km, "Width across, 0.032 to 1048")
        ->required()
        ->check(within(shortest_km, longest_km));
    start_wind_->add_option("--life-s", typed_.life_s, "Seconds until the decay starts; 0: until stopped")
        ->check(within(0.0, longest_life_s))
        ->capture_default_str();
    add_waves(*start_wind_);
    CLI::Option* towards = start_wind_
                               ->add_option("--move-towards", typed_.move_towards,
                                            "The wind's area moves: heading in degrees clockwise from north")
                               ->check(within(0.0, 360.0));
    start_wind_->add_option("--move-speed", typed_.move_speed, "and at how many m/s, above 0 to 100")
        ->check(within(0.001, static_cast<double>(fastest_wind_box)))
        ->needs(towards);
    towards->needs(start_wind_->get_option("--move-speed"));
    add_when(*start_wind_);
    start_wind_->footer(
        "Examples:\n  trochoid-ctl --sign-with director-key start-wind --speed 12 --towards 68 \\\n"
        "      --origin -4000,2500 --fetch-km 20 --width-km 8 --life-s 600\n"
        "A storm of 256 trains that moves eastwards, crests bent, heights in groups:\n"
        "  trochoid-ctl --sign-with director-key start-wind --speed 25 --towards 90 \\\n"
        "      --origin -20000,0 --fetch-km 15 --width-km 10 --trains 256 --directions 8 --spectrum jonswap \\\n"
        "      --round 0.3 --irregular 0.5 --noise 0.03 --move-towards 90 --move-speed 12");
}

void CtlSubcommands::add_waves(CLI::App& start) {
    start.add_option("--trains", typed_.trains, "Wave trains, 1 to 256")
        ->check(within(1U, Limits{}.trains_per_box))
        ->capture_default_str();
    start.add_option("--seed", typed_.seed, "Chooses phases and directions; 0: the server does")
        ->check(within(uint64_t{0}, uint64_t{INT64_MAX}))
        ->capture_default_str();
    start
        .add_option("--spectrum", typed_.spectrum,
                    "automatic, pierson-moskowitz, jonswap or neumann: how energy spreads over frequencies")
        ->check(CLI::IsMember(spectra).description(""))
        ->capture_default_str();
    start
        .add_option("--spreading", typed_.spreading,
                    "automatic, cosine-squared or hasselmann: how it spreads over directions")
        ->check(CLI::IsMember(spreadings).description(""))
        ->capture_default_str();
    start
        .add_option("--directions", typed_.directions,
                    "Directions of each frequency, a divisor of --trains; 0: each train has its own")
        ->check(within(0U, Limits{}.trains_per_box))
        ->capture_default_str();
    start
        .add_option("--reference-depth", typed_.reference_depth,
                    "Metres of water that the waves grow in, 1 to 12000; 0: deep water")
        ->check(within(0.0, static_cast<double>(deepest_reference)))
        ->capture_default_str();
    start
        .add_option("--round", typed_.round,
                    "How far crests are bent across the width, 0 (straight) to 1 (45 degrees at the sides)")
        ->check(within(0.0, 1.0))
        ->capture_default_str();
    start
        .add_option("--irregular", typed_.irregular,
                    "How much heights rise and fall in groups, 0 (even) to 1 (down to nothing)")
        ->check(within(0.0, 1.0))
        ->capture_default_str();
    start.add_option("--noise", typed_.noise, "Metres of ripples that the wind adds, 0 to 1")
        ->check(within(0.0, 1.0))
        ->capture_default_str();
}

void CtlSubcommands::add_start_ship(CLI::App& app) {
    start_ship_ = app.add_subcommand("start-ship", "Set a ship on her course: she draws her wake behind her");
    start_ship_->add_option("--from", typed_.place, "Metres X,Z (east, south) where she starts")
        ->required()
        ->delimiter(',')
        ->expected(2)
        ->check(within(-farthest_m, farthest_m));
    add_towards(*start_ship_, "Course in degrees clockwise from north");
    start_ship_->add_option("--speed", typed_.speed, "m/s through the water, 0.5 to 30")
        ->required()
        ->check(within(static_cast<double>(slowest_ship), static_cast<double>(fastest_ship)));
    start_ship_->add_option("--length", typed_.length, "Metres of hull at the water line, 1 to 500")
        ->check(within(1.0, static_cast<double>(longest_ship)))
        ->capture_default_str();
    start_ship_
        ->add_option("--beam", typed_.beam, "Her width in metres, up to the length; 0: a seventh of it")
        ->check(within(0.0, static_cast<double>(longest_ship)))
        ->capture_default_str();
    start_ship_->add_option("--name", typed_.name, "As `list` shows her, up to 64 bytes (default: ship N)");
    add_when(*start_ship_);
    start_ship_->footer(
        "Example:\n  trochoid-ctl --sign-with director-key start-ship --from 0,-1500 --towards 200 --speed 9 \\\n"
        "      --length 140 --name \"MS Harbour\"");
}

void CtlSubcommands::add_steer(CLI::App& app) {
    steer_ = app.add_subcommand("steer", "Give a ship or a moving wind a new course");
    add_box(*steer_, "Number of its box, as `list` shows it");
    add_towards(*steer_, "New course in degrees clockwise from north");
    steer_->add_option("--speed", typed_.speed, "m/s: ships 0 (lies still) to 30, winds 0 to 100")
        ->required()
        ->check(within(0.0, static_cast<double>(fastest_wind_box)));
    add_when(*steer_);
    steer_->footer(
        "Example:\n  trochoid-ctl --sign-with director-key steer 5 --towards 90 --speed 6 --in 30\n"
        "A ship's wake so far decays under its number; she goes on under the number that the answer names. At speed 0\n"
        "she lies still, turned as she was (--towards counts for winds alone), until she gets another course.");
}

void CtlSubcommands::add_stop(CLI::App& app) {
    stop_ = app.add_subcommand("stop-wind", "End a wind, or take a ship out: the waves decay from then on");
    stop_->alias("stop");
    add_box(*stop_, "Number of its wave train box, as `list` shows it");
    add_when(*stop_);
    stop_->footer(
        "Examples:\n  trochoid-ctl --sign-with director-key stop-wind 3 --in 60\n"
        "  trochoid-ctl --sign-with director-key stop 5");
}

void CtlSubcommands::add_breakwater(CLI::App& app) {
    breakwater_ =
        app.add_subcommand("breakwater", "Raise the bed along a line while the sea runs, or dig it");
    breakwater_
        ->add_option("--point", typed_.points,
                     "Metres X,Z (east, south) of a point of the line; give it 2 to 64 times, in order")
        ->allow_extra_args(false);
    breakwater_->add_option("--width", typed_.width, "Metres of the crest, 1 to 2000")
        ->check(within(1.0, 2000.0))
        ->capture_default_str();
    breakwater_->add_option("--crest", typed_.crest, "Metres above still water, -200 (under it) to 200")
        ->check(within(-200.0, 200.0))
        ->capture_default_str();
    breakwater_->add_flag("--dig", typed_.dig, "Lower what is higher instead of raising what is lower");
    add_when(*breakwater_);
    breakwater_->footer(
        "Examples:\n  trochoid-ctl --sign-with director-key breakwater --point 200,-300 --point 450,-120 \\\n"
        "      --point 500,100 --width 15 --crest 4\n"
        "A channel 8 m deep:\n"
        "  trochoid-ctl --sign-with director-key breakwater --point 0,0 --point 900,0 --width 60 --crest -8 --dig");
}

void CtlSubcommands::add_list_and_time(CLI::App& app) {
    list_ =
        app.add_subcommand("list", "Show all wave train boxes: winds, ships, waves and noise of the scene");
    list_->footer("Example:\n  trochoid-ctl list --json");
    time_ = app.add_subcommand("time", "Show sea time and its rate, set the rate, or skip time");
    CLI::Option* rate =
        time_->add_option("--rate", typed_.rate, "Seconds of sea time a second, 0 (paused) to 16")
            ->check(within(0.0, 16.0));
    time_->add_option("--skip", typed_.skip_s, "Seconds of sea time to go forward at once, 0.000001 to 1e9")
        ->check(within(1e-6, 1e9))
        ->excludes(rate);
    time_->footer(
        "Examples:\n  trochoid-ctl time\n  trochoid-ctl --sign-with director-key time --rate 0.5\n"
        "  trochoid-ctl --sign-with director-key time --skip 3600");
}

StartWind CtlSubcommands::wind() const {
    if (typed_.life_s > 0.0 && typed_.life_s < 1.0)
        throw OperatorError(
            "--life-s wants at least 1 second, or 0 for a wind that lasts until it is stopped");
    if (typed_.directions > 0 && typed_.trains % typed_.directions != 0)
        throw OperatorError(fmt::format(
            "--directions {} does not divide --trains {}: give as many trains as frequencies times directions",
            typed_.directions, typed_.trains));
    if (typed_.reference_depth > 0.0 && typed_.reference_depth < static_cast<double>(shallowest_reference))
        throw OperatorError("--reference-depth wants 1 to 12000 metres, or 0 for deep water");
    StartWind wind;
    wind.speed = static_cast<float>(typed_.speed);
    wind.towards_degrees = heading_of(typed_.towards);
    wind.origin = {to_lattice(typed_.place[0]), to_lattice(typed_.place[1])};
    wind.fetch = to_lattice(typed_.fetch_km * 1000.0);
    wind.width = to_lattice(typed_.width_km * 1000.0);
    wind.life_us = seconds_to_us(typed_.life_s);
    wind.trains = static_cast<uint16_t>(typed_.trains);
    wind.seed = typed_.seed;
    wind.spectrum = spectra.at(typed_.spectrum);
    wind.spreading = spreadings.at(typed_.spreading);
    wind.directions = static_cast<uint16_t>(typed_.directions);
    wind.reference_depth = static_cast<float>(typed_.reference_depth);
    wind.roundness = static_cast<float>(typed_.round);
    wind.irregularity = static_cast<float>(typed_.irregular);
    wind.noise = static_cast<float>(typed_.noise);
    const double heading = typed_.move_towards * std::numbers::pi / 180.0;
    wind.vx = component(typed_.move_speed * std::sin(heading));
    wind.vz = component(-typed_.move_speed * std::cos(heading));
    return wind;
}

StartShip CtlSubcommands::ship() const {
    if (typed_.beam > typed_.length)
        throw OperatorError(fmt::format("--beam {:g} is above --length {:g}: a ship is longer than wide",
                                        typed_.beam, typed_.length));
    return {{to_lattice(typed_.place[0]), to_lattice(typed_.place[1])},
            heading_of(typed_.towards),
            static_cast<float>(typed_.speed),
            static_cast<float>(typed_.length),
            static_cast<float>(typed_.beam),
            typed_.name};
}

ChangeLand CtlSubcommands::breakwater() const {
    if (typed_.points.size() < 2 || typed_.points.size() > most_line_points)
        throw OperatorError(
            fmt::format("breakwater wants a line of 2 to {} points, not {}: give --point X,Z for each",
                        most_line_points, typed_.points.size()));
    ChangeLand change;
    for (const std::string& point : typed_.points) change.line.push_back(point_of(point));
    change.width = static_cast<float>(typed_.width);
    change.crest = static_cast<float>(typed_.crest);
    change.dig = typed_.dig;
    return change;
}

CtlAction CtlSubcommands::action() const {
    const AskedTime& when = typed_.when;
    if (when.or_refuse && !when.at_s && !when.in_s)
        throw OperatorError("--or-refuse wants --at or --in: the time that must be met");
    if (start_wind_->parsed()) return legal(wind(), when);
    if (start_ship_->parsed()) return legal(ship(), when);
    if (steer_->parsed())
        return legal(Steer{{typed_.box}, heading_of(typed_.towards), static_cast<float>(typed_.speed)}, when);
    if (stop_->parsed()) return legal(StopWind{{typed_.box}}, when);
    if (breakwater_->parsed()) return legal(breakwater(), when);
    if (list_->parsed()) return CtlList{};
    if (token_->parsed()) return token_->action();
    if (time_->parsed() && time_->count("--rate") > 0)
        return legal(SetRate{static_cast<uint32_t>(std::lround(typed_.rate * 65536.0))}, {});
    if (time_->parsed() && time_->count("--skip") > 0)
        return legal(SkipTime{seconds_to_us(typed_.skip_s)}, {});
    if (time_->parsed()) return CtlTime{};
    throw OperatorError(
        "say what to do: start-wind, start-ship, steer, stop-wind, breakwater, list, time or token (see "
        "trochoid-ctl --help)");
}

}  // namespace trochoid
