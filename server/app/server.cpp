#include "server/app/server.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "protocol/login/key_file.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "server/app/land_worker.hpp"
#include "server/app/opening.hpp"
#include "server/app/result_worker.hpp"
#include "server/app/sea_authority.hpp"
#include "server/app/sea_service.hpp"
#include "server/app/token_door.hpp"
#include "server/event/event_log.hpp"
#include "server/event/scene.hpp"
#include "server/net/front_door.hpp"
#include "server/net/io_loop.hpp"
#include "server/net/listener.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/peer_address.hpp"
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

TicketKey ticket_key_of(const ServerConfig& config) {
    if (config.ticket_key.empty()) return TicketKey::random();
    KeptSecret<TicketKey> kept = read_ticket_key(config.ticket_key, "--ticket-key");
    if (!kept.warning.empty()) spdlog::warn("{}", kept.warning);
    return std::move(kept.key);
}

// Without keys no token can be checked: who needs one stays outside.
void check_viewers_way_in(const ServerConfig& config) {
    if (!config.token_keys.empty() || config.viewer_tokens == ViewerTokens::never) return;
    if (config.viewer_tokens == ViewerTokens::always)
        throw OperatorError("--viewer-tokens always lets nobody in without --token-key FILE: give both");
    if (std::all_of(config.bind.begin(), config.bind.end(), is_loopback_address)) return;
    spdlog::warn(
        "only viewers on this machine come in: give --token-key FILE, or --viewer-tokens never to open the sea to all");
}

std::unique_ptr<TlsIdentity> identity_of(const DoorOptions& options) {
    if (options.allow_plaintext)
        spdlog::warn(
            "--allow-plaintext: whoever is on the way between this server and its clients reads and changes all");
    if (!options.tls()) return nullptr;
    auto identity = std::make_unique<TlsIdentity>(options.tls_cert, options.tls_key);
    spdlog::info("TLS: {}", identity->text());
    if (const std::string warning = identity->warning(); !warning.empty()) spdlog::warn("{}", warning);
    return identity;
}

void reload_on_hangup(IoLoop& loop, TlsIdentity* identity) {
    if (identity == nullptr) return;
    loop.on_hangup([identity] {
        try {
            identity->reload();
            spdlog::info("TLS, read again: {}", identity->text());
            if (const std::string warning = identity->warning(); !warning.empty())
                spdlog::warn("{}", warning);
        } catch (const OperatorError& mistake) {
            spdlog::error("the certificate in use stays: {}", mistake.what());
        }
    });
}

struct Reception {
    Listener& listener;
    FrontDoor& front;
    SessionServer& sessions;
};

void shut_down_on_signal(IoLoop& loop, Reception at, LoopTimer& delay, uint32_t drain_ms) {
    const auto drain = [&loop, at] {
        at.listener.close();
        at.front.close();
        at.sessions.drain([&loop] { loop.stop(); });
    };
    loop.on_terminate([at, &delay, drain, drain_ms](int signal) {
        spdlog::info("signal {}: shutting down", signal);
        at.front.begin_draining();
        if (drain_ms == 0)
            drain();
        else
            delay.start(std::chrono::milliseconds(drain_ms), drain);
    });
}

}  // namespace

void run_server(const ServerConfig& config) {
    log_to_standard_error(config.log_level);
    spdlog::info("{}: {}", version_text("trochoid-server"), text_of(config));
    self_check();
    forget_port(config.port_file);

    const Scene scene = load_scene(config.scene);
    TokenDoor door(read_token_keys(config.token_keys, "--token-key"), ticket_key_of(config),
                   config.viewer_tokens);
    check_viewers_way_in(config);
    const auto terrain = load_terrain(scene.terrain);

    IoLoop loop;
    LandWorker worker(loop, terrain, land_settings_of(scene.land));
    World world(scene.name, terrain, opening_clock(scene, config.paused), land_blocks_of(config));
    InMemoryEventLog log;
    SeaAuthority authority(loop, world, log, worker, config.lead_ms);
    ResultWorker aside(loop);
    SeaService sea(authority, random_instance(), door, &aside);

    SessionServer sessions(loop, sea, limits_of(config), config.door.logins_per_address);
    const auto identity = identity_of(config.door);
    FrontDoor front(loop, sessions, limits_of(config), policy_of(config.door, config.bind), identity.get(),
                    scene.name);
    const bool off_loopback = identity != nullptr || config.door.allow_plaintext;
    Listener listener(loop, {config.bind, config.port, off_loopback},
                      [&front](std::unique_ptr<Transport> transport) { front.accept(std::move(transport)); });
    LoopTimer drain_delay(loop);
    shut_down_on_signal(loop, {listener, front, sessions}, drain_delay, config.door.drain_ms);
    reload_on_hangup(loop, identity.get());

    authority.open(scene);
    front.set_ready();
    authority.on_change([&sessions] { sessions.sea_changed(); });
    write_port(config.port_file, listener.port());
    spdlog::info("'{}' with {} boxes, listening on {}; {}", scene.name, authority.state()->boxes.size(),
                 listener.text(),
                 door.knows_keys() ? "who has a signed token may change the sea"
                                   : "nobody may change the sea (no --token-key)");
    loop.run();
    spdlog::info("stopped: {}", text_of(sessions.stats()));
    spdlog::info("at the door: {}", text_of(front.stats()));
}

}  // namespace trochoid
