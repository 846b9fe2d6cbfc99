#include "tests/simulation/happenings.hpp"

namespace trochoid {

namespace {

LatticePoint a_place(Dice& dice, int64_t reach_m) {
    return {to_lattice(static_cast<double>(dice.between(-reach_m, reach_m))),
            to_lattice(static_cast<double>(dice.between(-reach_m, reach_m)))};
}

// Over the land it comes from the west, as far as the terrain is wide: its land is traced.
StartWind a_wind(Dice& dice, bool over_land) {
    StartWind wind;
    wind.speed = 6.0F + static_cast<float>(dice.below(8));
    wind.trains = over_land ? 3 : 1;
    wind.seed = 1 + dice.below(1U << 30);
    if (over_land) {
        wind.towards_degrees = 90.0F;
        wind.origin = {to_lattice(-1500), 0};
        wind.fetch = to_lattice(3000);
        wind.width = to_lattice(2000);
        return wind;
    }
    wind.towards_degrees = static_cast<float>(dice.below(360));
    wind.origin = a_place(dice, 1000);
    wind.fetch = to_lattice(20000);
    wind.width = to_lattice(20000);
    if (dice.one_in(4)) wind.vx = 8.0F;
    return wind;
}

StartShip a_ship(Dice& dice) {
    StartShip ship;
    ship.at = a_place(dice, 800);
    ship.at.x -= to_lattice(1200);
    ship.towards_degrees = static_cast<float>(dice.below(360));
    ship.speed = static_cast<float>(4 + dice.below(8));
    return ship;
}

ChangeLand a_mole(Dice& dice) {
    ChangeLand mole;
    mole.line = {a_place(dice, 250), a_place(dice, 250)};
    mole.line.back().x += to_lattice(5);
    mole.width = 30.0F;
    mole.crest = static_cast<float>(dice.between(-4, 4));
    return mole;
}

}  // namespace

decltype(Command::action) some_command(Dice& dice, const std::vector<BoxId>& boxes, bool land) {
    const BoxId box = boxes.empty() ? BoxId{1} : boxes[dice.below(boxes.size())];
    const BoxId newest = boxes.empty() ? BoxId{1} : boxes.back();
    switch (dice.below(16)) {
        case 0:
        case 1:
        case 2:
        case 3: return a_wind(dice, land && dice.one_in(3));
        case 4:
        case 5:
        case 6: return StopWind{box};
        case 7:
        case 8: return a_ship(dice);
        case 9:
        case 10:
        case 11: return Steer{newest, static_cast<float>(dice.below(360)), static_cast<float>(dice.below(9))};
        case 12: {
            constexpr uint32_t rates[] = {0, 1U << 14, 1U << 16, 1U << 16, 4U << 16, 16U << 16};
            return SetRate{rates[dice.below(6)]};
        }
        case 13: return SkipTime{dice.between(1, dice.one_in(2) ? 600'000'000 : 5'000'000)};
        default: return land ? decltype(Command::action)(a_mole(dice)) : a_wind(dice, false);
    }
}

std::vector<SyncRegion> some_regions(Dice& dice) {
    std::vector<SyncRegion> regions;
    const uint64_t count = 1 + dice.below(3);
    for (uint64_t i = 0; i < count; ++i)
        regions.push_back({a_place(dice, 700),
                           static_cast<uint32_t>(to_lattice(static_cast<double>(dice.between(20, 100))))});
    return regions;
}

}  // namespace trochoid
