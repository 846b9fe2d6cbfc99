#pragma once
#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <thread>

#include "server/app/opening.hpp"
#include "server/app/sea_authority.hpp"
#include "server/app/sea_service.hpp"
#include "server/net/listener.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/session_server.hpp"
#include "tests/support/net/raw_client.hpp"

namespace trochoid {

inline constexpr uint32_t lead_ms = 200;

// A shoal rising out of 20 m of water around an island, 4 km across.
inline std::shared_ptr<const TerrainGrid> island() {
    TerrainGrid grid;
    grid.columns = grid.rows = 129;
    grid.origin_x = grid.origin_z = -64 * 32768;
    for (int64_t z = -64; z <= 64; ++z)
        for (int64_t x = -64; x <= 64; ++x) {
            const int64_t metres = std::max<int64_t>(-20, 10 - (x * x + z * z) / 40);
            grid.heights.push_back(static_cast<int16_t>(metres * 32));
        }
    grid.open_sea_depth = -20 * 1024;
    return std::make_shared<const TerrainGrid>(grid);
}

inline StartWind wind_over_the_origin() {
    StartWind wind;
    wind.speed = 12.0F;
    wind.towards_degrees = 90.0F;
    wind.origin = {to_lattice(-3000), 0};
    wind.fetch = to_lattice(6000);
    wind.width = to_lattice(4000);
    return wind;
}

// The real server without its process: world, authority, service, sessions on a loopback port.
class RealServer : public testing::Test {
protected:
    void start(const std::shared_ptr<const TerrainGrid>& terrain, const Scene& scene) {
        SeaClock clock;
        clock.monotonic_start_us = monotonic_us();
        world = std::make_unique<World>(scene.name, terrain, clock, most_land_blocks);
        worker = std::make_unique<LandWorker>(loop, terrain, land_settings_of(scene.land));
        authority = std::make_unique<SeaAuthority>(loop, *world, log, *worker, lead_ms);
        authority->open(scene);
        aside = std::make_unique<ResultWorker>(loop);
        sea = std::make_unique<SeaService>(*authority, WorldInstance{}, *door, aside.get());
        sessions = std::make_unique<SessionServer>(loop, *sea, Limits{});
        authority->on_change([this] { sessions->sea_changed(); });
        listener = std::make_unique<Listener>(loop, ListenAddresses{}, [this](std::unique_ptr<Transport> t) {
            sessions->accept(std::move(t));
        });
        thread = std::thread([this] { loop.run(); });
    }
    void TearDown() override {
        if (!thread.joinable()) return;
        loop.post([this] { loop.stop(); });
        thread.join();
    }
    static Scene scene_with_wind() {
        Scene scene;
        scene.name = "test";
        SceneWind wind{"old wind", wind_over_the_origin(), {-3600 * microseconds_per_second}, {}};
        wind.wind.seed = 5;
        scene.winds.push_back(wind);
        return scene;
    }
    template <class F>
    auto on_loop(F f) {
        std::promise<decltype(f())> promise;
        loop.post([&] { promise.set_value(f()); });
        return promise.get_future().get();
    }
    // Hands over a command and gives its reply's future.
    std::future<CommandReply> command(const Command& c) {
        auto promise = std::make_shared<std::promise<CommandReply>>();
        loop.post([this, c, promise] {
            authority->command(c, [promise](CommandReply reply) { promise->set_value(std::move(reply)); });
        });
        return promise->get_future();
    }
    SeaTime watermark() {
        return on_loop([this] { return authority->watermark(); });
    }

    static SigningKey test_key() {
        std::array<uint8_t, SigningKey::bytes> seed{};
        seed[0] = 7;
        return SigningKey::from_seed(seed);
    }
    /// A hello with a fresh token for the world of `scene_with_wind`.
    static ClientHello hello_as(Role role) {
        ClientHello hello = RawClient::usual_hello();
        const UnixSeconds now = unix_now();
        hello.token = sign_token({role, now, {now.value + 60}, random_nonce(), "test"}, test_key());
        return hello;
    }

    std::unique_ptr<TokenDoor> door =
        std::make_unique<TokenDoor>(TokenKeys({test_key().public_key()}), TicketKey::random(),
                                    ViewerTokens::off_loopback);  // replace before start
    size_t most_land_blocks = usual_land_blocks;
    IoLoop loop;
    InMemoryEventLog log;
    std::unique_ptr<World> world;
    std::unique_ptr<LandWorker> worker;
    std::unique_ptr<SeaAuthority> authority;
    std::unique_ptr<ResultWorker> aside;
    std::unique_ptr<SeaService> sea;
    std::unique_ptr<SessionServer> sessions;
    std::unique_ptr<Listener> listener;
    std::thread thread;
};

}  // namespace trochoid
