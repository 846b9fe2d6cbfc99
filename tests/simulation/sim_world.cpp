#include "tests/simulation/sim_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"
#include "server/app/opening.hpp"
#include "server/app/sea_authority.hpp"

namespace trochoid {

namespace {

constexpr int64_t world_began_us = 900'000'000;
constexpr SeaTime none_promised{INT64_MIN};

Scene the_scene() {
    Scene scene;
    scene.name = "simulated";
    StartWind wind;
    wind.speed = 9.0F;
    wind.towards_degrees = 90.0F;
    wind.origin = {to_lattice(-20000), 0};
    wind.fetch = to_lattice(60000);
    wind.width = to_lattice(40000);
    wind.trains = 4;
    wind.seed = 5;
    scene.winds.push_back({"old wind", wind, {-7200 * microseconds_per_second}, {}});
    return scene;
}

// A shoal rising out of 20 m of water around an island, 512 m across.
std::shared_ptr<const TerrainGrid> the_island() {
    TerrainGrid grid;
    grid.columns = grid.rows = 17;
    grid.origin_x = grid.origin_z = -8 * 32768;
    for (int64_t z = -8; z <= 8; ++z)
        for (int64_t x = -8; x <= 8; ++x)
            grid.heights.push_back(
                static_cast<int16_t>(32 * std::max<int64_t>(-20, 6 - (3 * (x * x + z * z)) / 4)));
    grid.open_sea_depth = -20 * 1024;
    return std::make_shared<const TerrainGrid>(grid);
}

LandSettings settings_for(const Scene& scene) {
    LandSettings settings = land_settings_of(scene.land);
    // Little land, quickly traced.
    settings.threads = 1;
    settings.run_out = 256.0;
    settings.recovery = 200.0;
    settings.refraction = Refraction::straight;
    return settings;
}

}  // namespace

SeaClock clock_of_the_beginning() {
    SeaClock clock;
    clock.monotonic_start_us = world_began_us;
    return clock;
}

SimWorld::SimWorld(bool land)
    : scene_(the_scene()), terrain_(land ? the_island() : nullptr), settings_(settings_for(scene_)) {
    // The scene's own events, by somebody who is no node.
    IoLoop loop;
    World world(scene_.name, terrain_, clock_of_the_beginning());
    LandWorker worker(loop, terrain_, settings_);
    SeaAuthority(loop, world, log_, worker, 500).open(scene_);
}

void SimWorld::promised(LogPosition position, SeaTime watermark) {
    if (promises_.size() <= position.value) promises_.resize(position.value + 1, none_promised);
    promises_[position.value] = std::max(promises_[position.value], watermark);
}

std::string SimWorld::broken_promise() const {
    SeaTime highest = none_promised;
    for (const StoredEvent& stored : log_.read({0}, SIZE_MAX)) {
        const uint64_t at = stored.position.value;
        if (at < promises_.size()) highest = std::max(highest, promises_[at]);
        const auto event = decode_event(stored.bytes);
        TROCHOID_ASSERT(event.has_value(), "event {}: {}", at, event.error().message);
        if (std::holds_alternative<ClockChanged>(event->what) || event->effective >= highest) continue;
        return fmt::format("event {} takes effect at {} us, before the watermark of {} us told before it", at,
                           event->effective.us, highest.us);
    }
    return {};
}

}  // namespace trochoid
