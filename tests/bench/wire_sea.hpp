#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "protocol/model/view.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid::bench {

/// Seven winds over open water with 60 trains together, all around the origin, grown since long ago.
inline std::string open_water_scene() {
    std::string text = "name = \"open water\"\n";
    for (int i = 0; i < 7; ++i) {
        const int towards = 250 + 15 * i;
        const double radians = towards * 3.14159265358979 / 180.0;
        text += fmt::format(
            "[[wind]]\nname = \"wind {}\"\nspeed = {}\ntowards = {}\norigin = [{:.0f}, {:.0f}]\nfetch_m = 240000\n"
            "width_m = 200000\nbegin_s = -86400\ntrains = {}\nseed = {}\n",
            i, 8 + i, towards, -120000.0 * std::sin(radians), 120000.0 * std::cos(radians), i < 4 ? 9 : 8,
            i + 1);
    }
    return text;
}

/// A camera 12 m above the water, heading so many degrees clockwise from north, that sees about as many patches as its budget of 512.
inline ViewState sea_camera(double x_m, double z_m, double heading_degrees) {
    ViewState view;
    view.position = {to_lattice(x_m), to_lattice(z_m)};
    view.altitude = 12 * lattice_per_metre;
    const double half_turn = -heading_degrees * 3.14159265358979 / 360.0;
    view.qy = static_cast<float>(std::sin(half_turn));
    view.qw = static_cast<float>(std::cos(half_turn));
    view.accepted_error_px = 1.0F;
    view.patch_budget = 512;
    return view;
}

}  // namespace trochoid::bench
