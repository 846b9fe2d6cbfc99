// The viewer over the fixture instead of a server: same options as trochoid-viewer.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "client/app/viewer_loop.hpp"
#include "protocol/units/operator_error.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace {

/// Sea time runs with the clock on the wall.
class RunningFixture : public trochoid::FixtureSource {
public:
    using FixtureSource::FixtureSource;
    trochoid::SceneInput snapshot() override {
        const auto passed = std::chrono::steady_clock::now() - start_;
        set_time(trochoid::SeaTime{60'000'000} +
                 std::chrono::duration_cast<std::chrono::microseconds>(passed).count());
        return FixtureSource::snapshot();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto kept = trochoid::load_settings(trochoid::settings_file());
        const auto options = trochoid::parse_viewer_options(argc, argv, kept.values);
        if (!options) return 0;
        RunningFixture source(trochoid::shipped_terrain());
        fmt::print("{}\n", trochoid::summary_line(trochoid::run_viewer(
                               source, *options, [] { return false; }, trochoid::settings_file())));
        return 0;
    } catch (const trochoid::OperatorError& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    }
}
