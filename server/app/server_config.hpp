#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "server/app/door_options.hpp"
#include "server/app/viewer_tokens.hpp"

namespace trochoid {

/// All that the operator decides; validated at start, and logged as it is in force.
struct ServerConfig {
    std::filesystem::path scene;  ///< scene file (server/event/scene-reference.md); required
    uint16_t port = 7421;         ///< TCP; 0: one that is free
    std::vector<std::string> bind{
        "127.0.0.1", "::1"};  ///< addresses; others than loopback need TLS or door.allow_plaintext
    std::filesystem::path
        port_file;  ///< the port in use is written here once connections are taken; empty: nowhere
    std::vector<std::filesystem::path>
        token_keys;  ///< public keys (PEM) that sign tokens, at most 16; none: nobody may change the sea
    std::filesystem::path
        ticket_key;  ///< 64 hexadecimal digits that seal resume tickets; empty: drawn at start
    ViewerTokens viewer_tokens = ViewerTokens::off_loopback;
    std::string log_level = "info";  ///< trace, debug, info, warn, error, off
    uint32_t lead_ms = 500;          ///< real time between a command's stamp and its effect, 0 to 10,000
    bool paused = false;             ///< sea time stands still until an admin sets a rate
    /// Memory for what land does to waves, MiB, 16 to 1,048,576: commands that would go beyond are refused (too_much_land).
    uint32_t land_mib = 4096;
    DoorOptions door;
    bool operator==(const ServerConfig&) const = default;
};

/// The command line as a config; nullopt where --help or --version has been answered. Throws OperatorError for what it
/// does not understand and for values out of range.
std::optional<ServerConfig> parse_command_line(int argc, const char* const* argv);

/// One line for the log, the effective values of everything.
std::string text_of(const ServerConfig& config);

/// WorldState::most_land_blocks as this config sets it.
size_t land_blocks_of(const ServerConfig& config);

/// The protocol's limits as this config sets them; stated in every hello.
Limits limits_of(const ServerConfig& config);

}  // namespace trochoid
