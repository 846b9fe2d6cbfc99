#include "server/app/server_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <map>

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

const std::map<std::string, ViewerTokens> viewer_tokens{{"off-loopback", ViewerTokens::off_loopback},
                                                        {"always", ViewerTokens::always},
                                                        {"never", ViewerTokens::never}};

std::string name_of(ViewerTokens when) {
    for (const auto& [name, value] : viewer_tokens)
        if (value == when) return name;
    return "unknown";
}

void add_login_options(CLI::App& app, ServerConfig& config) {
    app.add_option(
           "--token-key", config.token_keys,
           "Public key (PEM) that signs the tokens of who may change the sea; may be given more than once")
        ->check(refuse_empty)
        ->allow_extra_args(false);
    app.add_option("--ticket-key", config.ticket_key,
                   "File with 64 hexadecimal digits, the same for all servers that a client may come back to")
        ->check(refuse_empty);
    app.add_option_function<std::string>(
           "--viewer-tokens",
           [&config](const std::string& when) { config.viewer_tokens = viewer_tokens.at(when); },
           "Which viewers need a token: always, never or off-loopback (those that are not on this machine)")
        ->check(CLI::IsMember(viewer_tokens).description(""))
        ->default_str(name_of(config.viewer_tokens));
}

void add_options(CLI::App& app, ServerConfig& config) {
    app.add_option("--scene", config.scene, "Scene file (TOML) with terrain, winds and boxes")->required();
    app.add_option("--port", config.port, "TCP port, 0 for any free one")
        ->check(refuse_empty)
        ->capture_default_str();
    app.add_option("--bind", config.bind,
                   "Address to listen on, others than loopback with TLS; may be given more than once")
        ->capture_default_str();
    app.add_option("--port-file", config.port_file,
                   "Write the port in use to this file once connections are taken")
        ->check(refuse_empty);
    add_door_options(app, config.door);
    add_login_options(app, config);
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
    check(config.door);
    return config;
}

std::string text_of(const ServerConfig& config) {
    const auto file = [](const std::filesystem::path& path) { return path.empty() ? "none" : path.string(); };
    std::string token_keys;
    for (const std::filesystem::path& key : config.token_keys)
        token_keys += (token_keys.empty() ? "" : " ") + key.string();
    return fmt::format(
        "scene {}, bind {}, port {}, port file {}, {}, token keys {}, ticket key {}, viewer tokens {}, log level {}, lead {} ms, land {} MiB, {}",
        config.scene.string(), fmt::join(config.bind, " "), config.port, file(config.port_file),
        text_of(config.door), token_keys.empty() ? "none" : token_keys,
        config.ticket_key.empty() ? "drawn" : config.ticket_key.string(), name_of(config.viewer_tokens),
        config.log_level, config.lead_ms, config.land_mib, config.paused ? "paused" : "running");
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
