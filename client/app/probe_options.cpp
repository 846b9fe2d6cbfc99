#include "client/app/probe_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string_view>

#include "client/app/login_options.hpp"
#include "client/app/probe_grid.hpp"
#include "client/sample/water_sampler.hpp"
#include "protocol/codec/messages.hpp"
#include "protocol/units/hash.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

constexpr double radius_around_points_m = 100.0;
constexpr double farthest_time_s = 2.3e12;  // 2^61 microseconds

/// Options as they are typed.
struct Typed {
    std::string server = default_server;
    std::string ca_file;
    TokenWords login;
    std::vector<std::string> regions;
    std::vector<std::string> points;
    uint32_t random_points = 0;
    uint64_t seed = 1;
    double patience_s = 30.0;
    bool json = false;
    bool bits = false;
};

/// "1.5,-2": so many finite numbers, by commas.
std::vector<double> numbers(const std::string& text, size_t count, const char* option, const char* form) {
    std::vector<double> out;
    size_t at = 0;
    while (out.size() < count) {
        const size_t end = std::min(text.find(',', at), text.size());
        const std::string part = text.substr(at, end - at);
        double value = 0.0;
        if (!CLI::detail::lexical_cast(part, value) || !std::isfinite(value)) break;
        out.push_back(value);
        at = end + 1;
        if (end == text.size()) break;
    }
    if (out.size() != count || at != text.size() + 1)
        throw OperatorError(fmt::format("{} wants {} in metres, not '{}'", option, form, text));
    return out;
}

LatticePoint place(double x, double z, const char* option) {
    constexpr auto farthest = to_metres(world_bound);
    if (std::abs(x) > farthest || std::abs(z) > farthest)
        throw OperatorError(
            fmt::format("{} lies outside the world (at most {:.0f} m from its middle)", option, farthest));
    return {to_lattice(x), to_lattice(z)};
}

SyncRegion region_of(const std::string& text) {
    const std::vector<double> v = numbers(text, 3, "--region", "X,Z,R");
    const double largest = to_metres(Limits{}.sync_radius);
    if (v[2] < 0.0 || v[2] > largest)
        throw OperatorError(fmt::format("--region wants a radius of 0 to {:.0f} m, not {:g}", largest, v[2]));
    return {place(v[0], v[1], "--region"), static_cast<uint32_t>(to_lattice(v[2]))};
}

void add_options(CLI::App& app, Typed& typed, ProbeOptions& options) {
    const auto within = [](auto least, auto most) { return CLI::Range(least, most).description(""); };
    app.add_option("--connect", typed.server, connect_help)->capture_default_str();
    app.add_option("--ca", typed.ca_file, ca_help)->check(CLI::ExistingFile);
    describe_login(app, typed.login, "Options");
    app.add_option("--region", typed.regions,
                   "Sync region X,Z,R: disc in metres; repeatable (default: 100 m around each --point)")
        ->allow_extra_args(false);
    app.add_option("--point", typed.points, "Rest point X,Z in metres (east, south); repeatable")
        ->allow_extra_args(false);
    app.add_option("--points", typed.random_points, "So many points inside the regions")
        ->check(within(1U, 1'000'000U));
    app.add_option("--seed", typed.seed, "Chooses them")->capture_default_str();
    app.add_option("--at", options.at_s, "Sea time in seconds (default: now)")
        ->check(within(-farthest_time_s, farthest_time_s));
    app.add_option("--in", options.in_s, "So many seconds later (negative: earlier)")
        ->check(within(-farthest_time_s, farthest_time_s));
    app.add_option("--times", options.times, "Number of sea times")
        ->check(within(1U, 1'000'000U))
        ->capture_default_str();
    app.add_option("--every", options.every_s, "Seconds between them; with --watch seconds between lines")
        ->check(within(0.001, 1e9))
        ->capture_default_str();
    CLI::Option* json = app.add_flag("--json", typed.json, "Print JSON");
    CLI::Option* bits = app.add_flag(
        "--bits", typed.bits,
        "Print the bits of the 15 floats at every rest point: time in us, x, z in lattice units, hexadecimal words");
    bits->excludes(json);
    app.add_flag("--compare", options.compare,
                 "Ask the server for the same points and times; exit 1 where any bit differs");
    CLI::Option* follow = app.add_flag(
        "--follow", options.follow, "Wait until each sea time has come and no event can change it any more");
    CLI::Option* watch =
        app.add_flag("--watch", options.watch,
                     "Print the water at the first point, as a floating body sees it, until Ctrl-C");
    watch->excludes(json)->excludes(bits)->excludes(follow);
    app.add_option("--seconds", options.seconds, "End watching after so long")
        ->check(within(0.001, 1e9))
        ->needs(watch);
    CLI::Option* budget =
        app.add_option(
               "--budget", options.budget,
               "Which trains so many point-trains buy on a grid inside the first region, and what is lost "
               "(1: one train at one point)")
            ->check(within(0.0, 1e15));
    CLI::Option* coarse =
        app.add_option(
               "--coarse", options.coarse,
               "Evaluate the long waves of that grid at every 2nd, 4th, 8th or 16th point only: error "
               "bound, error seen, time saved")
            ->check(CLI::IsMember({2, 4, 8, 16}));
    for (CLI::Option* of_grid : {budget, coarse})
        of_grid->excludes(watch)->excludes(bits)->excludes(follow)->excludes("--compare");
    app.add_option("--grid", options.grid, "Points along a side of the grid of --budget and --coarse")
        ->check(within(2U, 2048U))
        ->capture_default_str();
    app.add_option("--patience", typed.patience_s, "Seconds to wait for the server")
        ->check(within(0.1, 3600.0))
        ->capture_default_str();
}

void choose_places(const Typed& typed, ProbeOptions& options) {
    for (const std::string& text : typed.regions) options.regions.push_back(region_of(text));
    for (const std::string& text : typed.points) {
        const std::vector<double> v = numbers(text, 2, "--point", "X,Z");
        options.points.push_back(place(v[0], v[1], "--point"));
    }
    const bool around_points = options.regions.empty();
    if (around_points)
        for (const LatticePoint& point : options.points) {
            const SyncRegion around{point, static_cast<uint32_t>(to_lattice(radius_around_points_m))};
            const bool known = std::any_of(options.regions.begin(), options.regions.end(),
                                           [&](const SyncRegion& r) { return contains(r, point); });
            if (!known) options.regions.push_back(around);
        }
    if (options.regions.empty())
        throw OperatorError(
            "say where: --point X,Z, or --region X,Z,R with --points N (see trochoid-probe --help)");
    if (options.regions.size() > Limits{}.sync_regions)
        throw OperatorError(
            fmt::format("{} regions are too many: a server takes {}; give fewer, larger ones with --region",
                        options.regions.size(), Limits{}.sync_regions));
    const auto more = points_inside(options.regions, typed.random_points, typed.seed);
    options.points.insert(options.points.end(), more.begin(), more.end());
    const bool on_a_grid = options.budget || options.coarse;
    if (on_a_grid && !grid_within(options.regions.front(), options.grid))
        throw OperatorError(fmt::format(
            "--grid {} finds no room in a region of {:g} m: give a larger --region X,Z,R, or fewer points",
            options.grid, to_metres(options.regions.front().radius)));
    if (options.points.empty() && !on_a_grid)
        throw OperatorError("no points: give --point X,Z or --points N");
}

}  // namespace

std::optional<ProbeOptions> read_probe_options(int argc, const char* const* argv) {
    CLI::App app("Reads the water of a running sea, and compares it with the server's to the bit.",
                 "trochoid-probe");
    app.set_version_flag("--version", version_text("trochoid-probe"));
    app.footer(
        "Examples:\n"
        "  trochoid-probe --point 100,-250 --times 5 --every 0.5\n"
        "  trochoid-probe --region 0,0,500 --region 3000,0,200 --points 1000 --compare\n"
        "  trochoid-probe --point 0,0 --watch --every 0.2\n"
        "  trochoid-probe --region 0,0,500 --budget 500000 --grid 256\n"
        "  trochoid-probe --region 0,0,500 --coarse 8\n"
        "Exit: 0 all well, 1 bits differ, the server refused or went away, 2 bad options or address.");
    Typed typed;
    ProbeOptions options;
    add_options(app, typed, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) {
            app.exit(error);
            return std::nullopt;
        }
        throw OperatorError(fmt::format("{} (see trochoid-probe --help)", error.what()));
    }
    for (const double v : {typed.patience_s, options.at_s.value_or(0.0), options.in_s, options.every_s,
                           options.seconds.value_or(0.0), options.budget.value_or(0.0)})
        if (!std::isfinite(v)) throw OperatorError("options want finite numbers (see trochoid-probe --help)");
    options.server = endpoint_from_options(typed.server, typed.ca_file);
    options.login = TokenSource(typed.login);
    options.output = typed.json ? ProbeOutput::json : typed.bits ? ProbeOutput::bits : ProbeOutput::table;
    options.patience = std::chrono::milliseconds(static_cast<int64_t>(typed.patience_s * 1000.0));
    choose_places(typed, options);
    return options;
}

std::vector<LatticePoint> points_inside(const std::vector<SyncRegion>& regions, uint32_t count,
                                        uint64_t seed) {
    std::vector<LatticePoint> points;
    points.reserve(count);
    uint64_t state = splitmix64(seed);
    const auto dice = [&state](uint64_t sides) {
        return static_cast<int64_t>((state = splitmix64(state)) % sides);
    };
    for (uint32_t i = 0; i < count; ++i) {
        const SyncRegion& region = regions[i % regions.size()];
        const uint64_t sides = 2 * uint64_t{region.radius} + 1;
        LatticePoint point;
        // Four points in five of the square lie inside its disc, so this ends.
        do {
            const int64_t dx = dice(sides);
            point = {region.centre.x + dx - int64_t{region.radius},
                     region.centre.z + dice(sides) - int64_t{region.radius}};
        } while (!contains(region, point));
        points.push_back(point);
    }
    return points;
}

}  // namespace trochoid
