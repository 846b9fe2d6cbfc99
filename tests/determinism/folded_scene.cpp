#include "tests/determinism/folded_scene.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/units/operator_error.hpp"
#include "server/app/opening.hpp"
#include "server/event/scene.hpp"
#include "server/land/land_trace.hpp"
#include "server/world/terrain_edit.hpp"
#include "server/world/world.hpp"
#include "tests/determinism/fault.hpp"

namespace trochoid {
namespace {

/// Opens a scene as the server's authority does, without bytes: the log's hash is not traced.
class Folder {
public:
    Folder(World& world, const LandSettings& land) : world_(world), land_(land) {}

    void lay(const ChangeLand& change, SeaTime at) {
        const auto state = world_.state();
        const TerrainEdit edit = taken(edited(*state->terrain, change), "breakwater");
        append(at, taken(world_.plan(change, at, {}), "breakwater"), {{}, edit.terrain});
    }
    void start(const std::string& name, const Result<BoxStarted>& planned) {
        const BoxStarted box = taken(planned, name);
        const auto state = world_.state();
        TracedLand land;
        if (state->terrain && !box.box.trains.empty())
            land = trace_land(box.box, *state->terrain, {state->next_field}, land_);
        spoil_land(land);
        BoxStarted started = world_.fit_to_land(box, land);
        spoil_record(started.box);
        Derived derived;
        derived.lands.push_back(std::move(land));
        const SeaTime begin = started.box.begin;
        append(begin, std::move(started), std::move(derived));
    }
    void sail(const SceneShip& ship) {
        start(ship.ship.name, world_.plan(ship.ship, ship.begin));
        BoxId box{world_.state()->next_box - 1};
        for (const SceneLeg& leg : ship.legs) {
            const Steer steer{box, static_cast<float>(leg.towards_degrees), static_cast<float>(leg.speed)};
            Steering steering = taken(world_.plan(steer, leg.at), ship.ship.name);
            for (auto& what : steering.events) append(steering.effective, std::move(what), {});
            box = steering.box;
        }
    }

private:
    template <class T>
    static T taken(Result<T> planned, const std::string& name) {
        if (!planned)
            throw OperatorError(fmt::format("the scene's '{}' cannot be: {}; correct the scene file", name,
                                            planned.error().message));
        return std::move(planned).value();
    }
    void append(SeaTime effective, decltype(LogEvent::what) what, Derived derived) {
        world_.apply({++events_, effective, std::move(what)}, {}, std::move(derived));
    }

    World& world_;
    LandSettings land_;
    uint64_t events_ = 0;
};

}  // namespace

FoldedScene fold_scene(const std::filesystem::path& file, uint32_t threads) {
    const Scene scene = load_scene(file);
    World world(scene.name, load_terrain(scene.terrain), {1, scene.clock_start, 0, scene.rate_q16});
    LandSettings land = land_settings_of(scene.land);
    land.threads = threads;
    Folder folder(world, land);
    for (const ChangeLand& change : scene.breakwaters) folder.lay(change, scene.clock_start);
    for (const SceneWind& wind : scene.winds) folder.start(wind.name, world.plan(wind));
    for (const SceneBox& box : scene.boxes) folder.start(box.name, world.plan(box));
    for (const SceneShip& ship : scene.ships) folder.sail(ship);
    return {world.state(), scene.clock_start};
}

}  // namespace trochoid
