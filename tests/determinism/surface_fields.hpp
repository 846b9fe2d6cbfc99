#pragma once
#include <array>
#include <string_view>

#include "protocol/model/point_query.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid {

template <class Values>
struct NamedField {
    std::string_view name;
    float Values::*value;
};

inline constexpr std::array<NamedField<SurfaceSample>, 15> surface_fields{{
    {"ax", &SurfaceSample::ax},
    {"ay", &SurfaceSample::ay},
    {"az", &SurfaceSample::az},
    {"pxx", &SurfaceSample::pxx},
    {"pxz", &SurfaceSample::pxz},
    {"pzx", &SurfaceSample::pzx},
    {"pzz", &SurfaceSample::pzz},
    {"yx", &SurfaceSample::yx},
    {"yz", &SurfaceSample::yz},
    {"nx", &SurfaceSample::nx},
    {"ny", &SurfaceSample::ny},
    {"nz", &SurfaceSample::nz},
    {"vx", &SurfaceSample::vx},
    {"vy", &SurfaceSample::vy},
    {"vz", &SurfaceSample::vz},
}};

/// Of a query's answer, its rest point apart.
inline constexpr std::array<NamedField<WaterPoint>, 7> water_fields{{
    {"water.height", &WaterPoint::height},
    {"water.nx", &WaterPoint::nx},
    {"water.ny", &WaterPoint::ny},
    {"water.nz", &WaterPoint::nz},
    {"water.vx", &WaterPoint::vx},
    {"water.vy", &WaterPoint::vy},
    {"water.vz", &WaterPoint::vz},
}};

}  // namespace trochoid
