#include "tests/determinism/live_script.hpp"

#include <utility>

namespace trochoid {
namespace {

LatticePoint metres(double x, double z) { return {to_lattice(x), to_lattice(z)}; }

StartShip ship(LatticePoint at, float towards_degrees, float speed) {
    StartShip wanted;
    wanted.at = at;
    wanted.towards_degrees = towards_degrees;
    wanted.speed = speed;
    wanted.length = 60.0F;
    wanted.beam = 11.0F;
    wanted.name = "pilot";
    return wanted;
}

StartWind storm(LatticePoint origin, float towards_degrees, double fetch_m, double width_m, float vx,
                float vz) {
    StartWind wind;
    wind.speed = 13.0F;
    wind.towards_degrees = towards_degrees;
    wind.origin = origin;
    wind.fetch = to_lattice(fetch_m);
    wind.width = to_lattice(width_m);
    wind.trains = 5;
    wind.seed = 4711;
    wind.vx = vx;
    wind.vz = vz;
    return wind;
}

ChangeLand wall(LatticePoint from, LatticePoint to, float width, float crest, bool dig) {
    ChangeLand change;
    change.line = {from, to};
    change.width = width;
    change.crest = crest;
    change.dig = dig;
    return change;
}

class Script {
public:
    explicit Script(SeaTime opens) : opens_(opens) {}
    void at(int64_t seconds, decltype(Command::action) action, int box_of = -1) {
        commands_.push_back(
            {{0, opens_ + seconds * microseconds_per_second, false, std::move(action)}, box_of});
    }
    std::vector<LiveCommand> commands() && { return std::move(commands_); }

private:
    SeaTime opens_;
    std::vector<LiveCommand> commands_;
};

/// Over ground: every kind of command, and two changes of the land, the second over the overlays of the first.
void over_ground(Script& script) {
    script.at(5, ship(metres(-500, 1300), 20.0F, 7.5F));
    script.at(10, storm(metres(-900, 1500), 30.0F, 1500, 900, 3.0F, -2.0F));
    script.at(20, wall(metres(-700, 700), metres(-150, 820), 24.0F, 3.0F, false));
    script.at(30, Steer{{}, 75.0F, 6.0F}, 0);
    script.at(35, Steer{{}, 340.0F, 8.0F}, 1);
    script.at(45, wall(metres(-420, 600), metres(-420, 1000), 60.0F, -9.0F, true));
    script.at(55, storm(metres(600, 1600), 330.0F, 1200, 800, 0.0F, 0.0F));
    script.at(90, StopWind{}, 1);
    script.at(95, Steer{{}, 10.0F, 5.0F}, 0);  // refused: that course has ended
    script.at(120, Steer{{}, 0.0F, 0.0F}, 3);
}

/// On open sea: the scene's own storm is steered too.
void over_open_sea(Script& script) {
    script.at(1, ship(metres(-1200, 800), 100.0F, 11.0F));
    script.at(7, Steer{{1}, 120.0F, 14.0F});
    script.at(40, Steer{{}, 135.0F, 9.0F}, 0);
    script.at(3000, storm(metres(-4000, 2000), 80.0F, 6000, 5000, 9.0F, 1.0F));
    script.at(3300, Steer{{}, 200.0F, 10.0F}, 3);
    script.at(3400, StopWind{}, 3);
    script.at(3500, StopWind{}, 3);  // refused: it ends already
}

}  // namespace

std::vector<LiveCommand> live_script(std::string_view scene, SeaTime opens) {
    Script script(opens);
    if (scene == "harbour") over_ground(script);
    if (scene == "storm-cell") over_open_sea(script);
    return std::move(script).commands();
}

}  // namespace trochoid
