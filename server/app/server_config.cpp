#include "server/app/server_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "server/world/world_state.hpp"

namespace trochoid {

namespace {

constexpr uint32_t longest_lead_ms = 10'000;
constexpr uint32_t least_land_mib = 16;
constexpr uint32_t most_land_mib = 1U << 20;

/// An unset shell variable gives an empty value; taken as "none" it would silently switch something off.
std::string refuse_empty(const std::string& value) { return value.empty() ? "is empty: give a value" : ""; }

void add_options(CLI::App& app, ServerConfig& config) {
    app.add_option("--scene", config.scene, "Scene file (TOML) with terrain, winds and boxes")->required();
    app.add_option("--port", config.port, "TCP port, 0 for any free one")
        ->check(refuse_empty)
        ->capture_default_str();
    app.add_option("--bind", config.bind, "Loopback address to listen on; may be given more than once")
        ->capture_default_str();
    app.add_option("--port-file", config.port_file,
                   "Write the port in use to this file once connections are taken")
        ->check(refuse_empty);
    app.add_option(
           "--director-token-file", config.token_file,
           "File with the token that lets trochoid-ctl change the sea (8 to 1024 characters, first line)")
        ->check(refuse_empty);
    app.add_option("--log-level", config.log_level, "trace, debug, info, warn, error or off")
        ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
        ->capture_default_str();
    app.add_option("--lead-ms", config.lead_ms, "Milliseconds from a command's stamp to its effect")
        ->check(CLI::Range(0U, longest_lead_ms))
        ->capture_default_str();
    app.add_option("--land-mib", config.land_mib, "Most MiB of memory for what land does to waves")
        ->check(CLI::Range(least_land_mib, most_land_mib))
        ->capture_default_str();
    app.add_flag("--paused", config.paused, "Start with sea time standing still");
}

}  // namespace

std::optional<ServerConfig> parse_command_line(int argc, const char* const* argv) {
    ServerConfig config;
    CLI::App app("Runs one sea for any number of clients", "trochoid-server");
    app.set_version_flag("--version", version_text("trochoid-server"));
    add_options(app, config);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& answered) {  // --help, --version
        app.exit(answered);
        return std::nullopt;
    } catch (const CLI::ParseError& wrong) {
        throw OperatorError(fmt::format("{}; trochoid-server --help lists all options", wrong.what()));
    }
    return config;
}

std::string text_of(const ServerConfig& config) {
    const auto file = [](const std::filesystem::path& path) { return path.empty() ? "none" : path.string(); };
    return fmt::format(
        "scene {}, bind {}, port {}, port file {}, director token file {}, log level {}, lead {} ms, land {} MiB, {}",
        config.scene.string(), fmt::join(config.bind, " "), config.port, file(config.port_file),
        file(config.token_file), config.log_level, config.lead_ms, config.land_mib,
        config.paused ? "paused" : "running");
}

size_t land_blocks_of(const ServerConfig& config) {
    return (size_t{config.land_mib} << 20) / land_block_bytes;
}

Limits limits_of(const ServerConfig& config) {
    Limits limits;
    limits.command_lead_ms = config.lead_ms;
    return limits;
}

}  // namespace trochoid
