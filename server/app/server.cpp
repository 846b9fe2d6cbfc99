#include "server/app/server.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "protocol/model/self_check.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "server/app/director_token.hpp"
#include "server/app/land_worker.hpp"
#include "server/app/opening.hpp"
#include "server/app/sea_authority.hpp"
#include "server/app/sea_service.hpp"
#include "server/event/event_log.hpp"
#include "server/event/scene.hpp"
#include "server/net/io_loop.hpp"
#include "server/net/listener.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/session_server.hpp"
#include "server/world/world.hpp"

namespace trochoid {

namespace {

WorldInstance random_instance() {
    std::random_device device;
    WorldInstance instance;
    for (uint8_t& byte : instance.bytes) byte = static_cast<uint8_t>(device());
    return instance;
}

SeaClock opening_clock(const Scene& scene, bool paused) {
    SeaClock clock;
    clock.start = scene.clock_start;
    clock.monotonic_start_us = monotonic_us();
    clock.rate_q16 = paused ? 0 : scene.rate_q16;
    return clock;
}

// A file of an earlier run would lead clients astray until the new one is written.
void forget_port(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!file.empty() && std::filesystem::is_regular_file(file, ignored))
        std::filesystem::remove(file, ignored);
}

// Whoever waits for the file sees it whole or not at all.
void write_port(const std::filesystem::path& file, uint16_t port) {
    if (file.empty()) return;
    // Renaming over a device or a pipe would replace it.
    std::error_code unknown;
    if (std::filesystem::exists(file, unknown) && !std::filesystem::is_regular_file(file, unknown))
        throw OperatorError(
            fmt::format("--port-file '{}' is no regular file: name a file to write to", file.string()));
    std::filesystem::path partial = file;
    partial += ".partial";
    std::ofstream out(partial);
    out << port << '\n';
    out.close();
    std::error_code failed;
    if (out) std::filesystem::rename(partial, file, failed);
    if (!out || failed)
        throw OperatorError(fmt::format(
            "--port-file {}: cannot be written; name a file in a folder that exists", file.string()));
}

void log_to_standard_error(const std::string& level) {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "trochoid-server", std::make_shared<spdlog::sinks::stderr_color_sink_mt>()));
    spdlog::set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
    spdlog::set_level(spdlog::level::from_str(level));
}

void shut_down_on_signal(IoLoop& loop, Listener& listener, SessionServer& sessions) {
    loop.on_terminate([&](int signal) {
        spdlog::info("signal {}: shutting down", signal);
        listener.close();
        sessions.drain([&loop] { loop.stop(); });
    });
}

}  // namespace

void run_server(const ServerConfig& config) {
    log_to_standard_error(config.log_level);
    spdlog::info("{}: {}", version_text("trochoid-server"), text_of(config));
    self_check();
    forget_port(config.port_file);

    const Scene scene = load_scene(config.scene);
    const DirectorToken token =
        config.token_file.empty() ? DirectorToken() : DirectorToken(config.token_file);
    const auto terrain = load_terrain(scene.terrain);

    IoLoop loop;
    LandWorker worker(loop, terrain, land_settings_of(scene.land));
    World world(scene.name, terrain, opening_clock(scene, config.paused), land_blocks_of(config));
    InMemoryEventLog log;
    SeaAuthority authority(loop, world, log, worker, config.lead_ms);
    SeaService sea(authority, random_instance(), token);

    SessionServer sessions(loop, sea, limits_of(config));
    Listener listener(loop, {config.bind, config.port}, [&sessions](std::unique_ptr<Transport> transport) {
        sessions.accept(std::move(transport));
    });
    shut_down_on_signal(loop, listener, sessions);

    authority.open(scene);
    authority.on_change([&sessions] { sessions.sea_changed(); });
    write_port(config.port_file, listener.port());
    spdlog::info("'{}' with {} boxes, listening on {}; {}", scene.name, authority.state()->boxes.size(),
                 listener.text(),
                 token.exists() ? "directors need their token"
                                : "nobody may change the sea (no --director-token-file)");
    loop.run();
    spdlog::info("stopped: {}", text_of(sessions.stats()));
}

}  // namespace trochoid
