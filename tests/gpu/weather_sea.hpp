#pragma once
#include <string_view>

#include "tests/gpu/fixture_sea.hpp"

namespace trochoid {

/// A wind sea for tests of the picture: significant height and peak wavelength, m; trains.
struct Weather {
    double height_m = 0.7;
    double peak_m = 26.0;
    int trains = 24;
    bool swell = true;  ///< the fixture's own swell stays
};

/// calm, breeze, gale, storm; breeze for any other name.
Weather weather_named(std::string_view name);

/// Puts a wind sea without borders, running to the north-east, in the place of the fixture's own.
void set_weather(FixtureSource& source, const Weather& weather);

}  // namespace trochoid
