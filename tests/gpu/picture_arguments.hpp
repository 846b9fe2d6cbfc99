#pragma once
#include <cstdio>
#include <map>
#include <string>

#include "client/scene/camera.hpp"

namespace trochoid {

/// What programs that draw one picture are asked for, NAME=VALUE after the file's name.
using Arguments = std::map<std::string, std::string>;

inline Arguments arguments(int argc, char** argv) {
    Arguments values;
    for (int i = 2; i < argc; ++i) {
        const std::string text = argv[i];
        const size_t sign = text.find('=');
        if (sign != std::string::npos) values[text.substr(0, sign)] = text.substr(sign + 1);
    }
    return values;
}

/// The camera of at=X,Z,ALTITUDE,YAW,PITCH and size=WxH.
inline Camera camera_of(Arguments& values) {
    Camera camera;
    camera.width = 960;
    camera.height = 540;
    double x = -9'000;
    double z = 5'000;
    double yaw = 250;
    double pitch = -4;
    camera.altitude_m = 12;
    std::sscanf(values["at"].c_str(), "%lf,%lf,%lf,%lf,%lf", &x, &z, &camera.altitude_m, &yaw, &pitch);
    std::sscanf(values["size"].c_str(), "%ux%u", &camera.width, &camera.height);
    camera.position = {to_lattice(x), to_lattice(z)};
    camera.yaw = yaw / 57.29577951;
    camera.pitch = pitch / 57.29577951;
    return camera;
}

}  // namespace trochoid
