#include <fmt/format.h>

#include "protocol/model/wave_train_box.hpp"
#include "tests/conformance/hostile.hpp"
#include "tests/conformance/server/field_rows.hpp"

// the fields of commands, probes and reports of differences. No right is needed to be refused here: fields are looked
// at before roles; and what is legal is refused in a reply, as the sender is a viewer.
namespace trochoid::conformance::server {

namespace {

namespace fb = wire_fb;

template <class Action>
Bytes command(const Action& action) {
    Command asked;
    asked.sequence = 1;
    asked.action = action;
    return encode(ClientMessage{asked});
}

void add_winds(Catalogue& all) {
    using W = StartWind;
    Rows wind(all, "wind", W{}, [](const W& w) { return command(w); });
    for (const FloatRow<W>& row :
         std::vector<FloatRow<W>>{{"speed", &W::speed, 0.99F, 1.0F, 40.0F, 40.01F},
                                  {"towards_degrees", &W::towards_degrees, -0.01F, 0.0F, 359.99F, 360.0F},
                                  {"reference_depth", &W::reference_depth, -1.0F, 0.0F, 12000.0F, 12001.0F},
                                  {"roundness", &W::roundness, -0.001F, 0.0F, 1.0F, 1.001F},
                                  {"irregularity", &W::irregularity, -0.001F, 0.0F, 1.0F, 1.001F},
                                  {"noise", &W::noise, -0.001F, 0.0F, 1.0F, 1.001F},
                                  {"vx", &W::vx, -101.0F, -100.0F, 100.0F, 101.0F},
                                  {"vz", &W::vz, -101.0F, -100.0F, 100.0F, 101.0F}})
        wind.add(row);
    wind.add(NumberRow<W, int64_t>{
        "fetch", &W::fetch, {-1, longest_side + 1, INT64_MAX, INT64_MIN}, {0, longest_side}});
    wind.add(NumberRow<W, int64_t>{
        "width", &W::width, {-1, longest_side + 1, INT64_MAX, INT64_MIN}, {0, longest_side}});
    wind.add(NumberRow<W, int64_t>{
        "life_us", &W::life_us, {-1, sea_time_bound + 1, INT64_MIN}, {0, sea_time_bound}});
    wind.add(NumberRow<W, uint16_t>{"trains", &W::trains, {0}, {1, 256}});
    constexpr Answer too_many{ErrorCode::too_many_trains, requirement::ranges};
    wind.wrong(117, "trains-257", "A wind of 257 trains", too_many, [](W& w) { w.trains = 257; });
    wind.wrong(117, "trains-65535", "A wind of 65,535 trains", too_many, [](W& w) { w.trains = 65535; });
    wind.add(NumberRow<W, uint16_t>{"directions", &W::directions, {3, 5, 15, 17, 32, 65535}, {1, 4, 16}});
    wind.wrong(117, "spectrum-4", "A spectrum that there is not", out_of_range,
               [](W& w) { w.spectrum = static_cast<Spectrum>(4); });
    wind.wrong(117, "spectrum-255", "The spectrum 255", out_of_range,
               [](W& w) { w.spectrum = static_cast<Spectrum>(255); });
    wind.wrong(117, "spreading-3", "A spreading that there is not", out_of_range,
               [](W& w) { w.spreading = static_cast<Spreading>(3); });
    wind.wrong(117, "spreading-255", "The spreading 255", out_of_range,
               [](W& w) { w.spreading = static_cast<Spreading>(255); });
    wind.wrong(117, "depth-between", "A reference depth of 0.9 m, neither deep water nor 1 m", out_of_range,
               [](W& w) { w.reference_depth = 0.9F; });
    wind.wrong(117, "too-fast", "A wind that moves with 100 m/s along both axes", out_of_range,
               [](W& w) { w.vx = w.vz = 100.0F; });
    wind.right(117, "fast", "A wind that moves with 60 and 80 m/s along the axes",
               [](W& w) { w.vx = 60.0F, w.vz = -80.0F; });
    for (const int64_t at : {world_bound + 1, -world_bound - 1, INT64_MIN}) {
        wind.wrong(117, fmt::format("x-{}", at), "A wind outside the world", out_of_range,
                   [&](W& w) { w.origin.x = at; });
        wind.wrong(117, fmt::format("z-{}", at), "A wind outside the world", out_of_range,
                   [&](W& w) { w.origin.z = at; });
    }
    all.push_back(refused(
        "R-115/wind-wind", "A wind without its figures",
        built_command(fb::Action::StartWind, [](Builder& b) { return fb::CreateStartWind(b).Union(); }),
        absent));
}

void add_ships(Catalogue& all) {
    using S = StartShip;
    Rows ship(all, "ship", S{}, [](const S& s) { return command(s); });
    for (const FloatRow<S>& row :
         std::vector<FloatRow<S>>{{"towards_degrees", &S::towards_degrees, -0.01F, 0.0F, 359.99F, 360.0F},
                                  {"speed", &S::speed, 0.49F, 0.5F, 30.0F, 30.01F},
                                  {"length", &S::length, 0.99F, 1.0F, 500.0F, 500.1F},
                                  {"beam", &S::beam, -0.1F, 0.0F, 100.0F, 500.1F}})
        ship.add(row);
    ship.wrong(117, "beam-above-length", "A ship wider than she is long", out_of_range,
               [](S& s) { s.beam = 100.5F; });
    ship.wrong(117, "x", "A ship outside the world", out_of_range, [](S& s) { s.at.x = world_bound + 1; });
    ship.wrong(117, "z", "A ship outside the world", out_of_range, [](S& s) { s.at.z = INT64_MIN; });
    all.push_back(refused("R-115/ship-ship", "A ship without her figures",
                          built_command(fb::Action::StartShip,
                                        [](Builder& b) {
                                            const auto name = b.CreateString("x");
                                            return fb::CreateStartShip(b, nullptr, name).Union();
                                        }),
                          absent));
    all.push_back(refused("R-115/ship-name", "A ship without a name, not even an empty one",
                          built_command(fb::Action::StartShip,
                                        [](Builder& b) {
                                            const fb::Ship figures(0, 0, 0.0F, 5.0F, 100.0F, 0.0F);
                                            return fb::CreateStartShip(b, &figures).Union();
                                        }),
                          absent));
    using T = Steer;
    Rows steer(all, "steer", T{}, [](const T& s) { return command(s); });
    steer.add({"towards_degrees", &T::towards_degrees, -0.01F, 0.0F, 359.99F, 360.0F});
    steer.add({"speed", &T::speed, -0.1F, 0.0F, 100.0F, 100.1F});
}

void add_land(Catalogue& all) {
    using L = ChangeLand;
    const L mole{{{0, 0}, {1024, 0}}, 20.0F, 3.0F, false};
    Rows land(all, "land", mole, [](const L& c) { return command(c); });
    land.add({"width", &L::width, 0.99F, 1.0F, 2000.0F, 2001.0F});
    land.add({"crest", &L::crest, -200.1F, -200.0F, 200.0F, 200.1F});
    land.wrong(117, "no-places", "A change of the land along no line", out_of_range,
               [](L& c) { c.line.clear(); });
    land.wrong(117, "1-place", "A change of the land along a single place", out_of_range,
               [](L& c) { c.line.resize(1); });
    land.wrong(117, "65-places", "A change of the land along 65 places", out_of_range,
               [](L& c) { c.line.resize(65); });
    land.right(117, "64-places", "A change of the land along 64 places", [](L& c) { c.line.resize(64); });
    land.wrong(117, "x", "A change of the land outside the world", out_of_range,
               [](L& c) { c.line[1].x = world_bound + 1; });
    land.wrong(117, "z", "A change of the land outside the world", out_of_range,
               [](L& c) { c.line[0].z = INT64_MIN; });
    all.push_back(
        refused("R-115/land-line", "A change of the land without its list",
                built_command(fb::Action::ChangeLand,
                              [](Builder& b) { return fb::CreateChangeLand(b, 0, 20.0F, 3.0F).Union(); }),
                absent));
}

void add_time(Catalogue& all) {
    for (const uint32_t rate : {largest_rate_q16 + 1, UINT32_MAX})
        all.push_back(refused(fmt::format("R-117/rate-{}", rate), "A rate above 16", command(SetRate{rate}),
                              out_of_range));
    all.push_back(taken("R-117/rate-16", "A rate of 16", command(SetRate{largest_rate_q16})));
    all.push_back(taken("R-117/rate-0", "A rate of 0", command(SetRate{0})));
    for (const int64_t forward : {int64_t{0}, int64_t{-1}, longest_skip_us + 1, INT64_MIN, INT64_MAX})
        all.push_back(refused(fmt::format("R-117/skip-{}", forward),
                              "Time that is not skipped forwards by 1 to 2⁵⁰ µs", command(SkipTime{forward}),
                              out_of_range));
    all.push_back(taken("R-117/skip-1", "Time skipped by 1 µs", command(SkipTime{1})));
    for (const int64_t at : {sea_time_bound + 1, -sea_time_bound - 1, INT64_MAX, INT64_MIN}) {
        Command asked;
        asked.sequence = 1;
        asked.at = {at};
        asked.action = ListBoxes{};
        all.push_back(refused(fmt::format("R-117/command-at-{}", at),
                              "A command for a sea time beyond its bounds", encode(ClientMessage{asked}),
                              out_of_range));
    }
}

void add_probes(Catalogue& all) {
    const auto probe = [](SeaTime time, std::vector<LatticePoint> points) {
        return encode(ClientMessage{Probe{1, 1, time, std::move(points)}});
    };
    all.push_back(refused("R-117/probe-no-points", "A probe of no points", probe({}, {}), out_of_range));
    all.push_back(refused("R-117/probe-17-points", "A probe of 17 points",
                          probe({}, std::vector<LatticePoint>(17)), out_of_range));
    all.push_back(refused("R-117/probe-x", "A probe outside the world", probe({}, {{world_bound + 1, 0}}),
                          out_of_range));
    all.push_back(refused("R-117/probe-time", "A probe at a sea time beyond its bounds",
                          probe({sea_time_bound + 1}, {{0, 0}}), out_of_range));
    all.push_back(
        refused("R-115/probe-points", "A probe without its list",
                built(fb::ClientBody::Probe, [](Builder& b) { return fb::CreateProbe(b, 1, 1, 0).Union(); }),
                absent));
    const auto desync = [](auto change) {
        Desync found;
        found.sequence = 1;
        found.result = 1;
        change(found);
        return encode(ClientMessage{found});
    };
    all.push_back(refused("R-117/desync-x", "A difference outside the world",
                          desync([](Desync& d) { d.at.x = world_bound + 1; }), out_of_range));
    all.push_back(refused("R-117/desync-time", "A difference at a sea time beyond its bounds",
                          desync([](Desync& d) { d.time.us = INT64_MIN; }), out_of_range));
    all.push_back(refused("R-117/desync-level", "A difference in a patch of level 14",
                          desync([](Desync& d) { d.patch.level = 14; }), out_of_range));
    all.push_back(refused(
        "R-115/desync-difference", "A report of a difference without it",
        built(fb::ClientBody::Desync, [](Builder& b) { return fb::CreateDesync(b, 1, 1).Union(); }), absent));
}

}  // namespace

void add_command_field_cases(Catalogue& all) {
    add_winds(all);
    add_ships(all);
    add_land(all);
    add_time(all);
    add_probes(all);
}

}  // namespace trochoid::conformance::server
