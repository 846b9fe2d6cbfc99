#include "tests/gpu/weather_sea.hpp"

namespace trochoid {

Weather weather_named(std::string_view name) {
    if (name == "calm") return {0.10, 8.0, 20, true};
    if (name == "gale") return {4.2, 150.0, 28, false};
    if (name == "storm") return {8.5, 255.0, 32, false};
    return {};
}

void set_weather(FixtureSource& source, const Weather& weather) {
    const bool land = !source.state().blocks.empty();
    WaveTrainBox wind;
    wind.id = {1};
    wind.first_train = {1};
    wind.trains = wind_sea(weather.peak_m, -0.7, weather.height_m, weather.trains, 7);
    for (WaveTrain& train : wind.trains) train.field = {land ? 1U : 0U};
    wind.gain_max = 41'000;
    source.add_box(wind);
    WaveTrainBox swell;
    swell.id = {2};
    swell.first_train = {100};
    swell.trains = wind_sea(170.0, -0.2, weather.swell ? 0.5 : 0.01, 6, 3);
    for (WaveTrain& train : swell.trains) train.field = {land ? 1U : 0U};
    swell.gain_max = 41'000;
    source.add_box(swell);
}

}  // namespace trochoid
