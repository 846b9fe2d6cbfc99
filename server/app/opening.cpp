#include "server/app/opening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>
#include <vector>

#include "protocol/model/terrain_file.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

Refraction refraction_of(SceneLand::Refraction refraction) {
    switch (refraction) {
        case SceneLand::Refraction::none: return Refraction::none;
        case SceneLand::Refraction::phase_shift: return Refraction::phase_shift;
        case SceneLand::Refraction::straight: return Refraction::straight;
        case SceneLand::Refraction::eikonal: break;
    }
    return Refraction::eikonal;
}

Shoaling shoaling_of(SceneLand::Shoaling shoaling) {
    switch (shoaling) {
        case SceneLand::Shoaling::paper: return Shoaling::paper;
        case SceneLand::Shoaling::linear: break;
        case SceneLand::Shoaling::decrease: return Shoaling::decrease;
        case SceneLand::Shoaling::none: return Shoaling::none;
    }
    return Shoaling::linear;
}

Diffraction diffraction_of(SceneLand::Diffraction diffraction) {
    switch (diffraction) {
        case SceneLand::Diffraction::none: return Diffraction::none;
        case SceneLand::Diffraction::wedge: break;
        case SceneLand::Diffraction::parabolic: return Diffraction::parabolic;
    }
    return Diffraction::wedge;
}

// One core stays free for the io thread while a command's land is traced.
uint32_t tracing_threads() { return std::max(1U, std::max(1U, std::thread::hardware_concurrency()) - 1U); }

}  // namespace

std::shared_ptr<const TerrainGrid> load_terrain(const std::filesystem::path& file) {
    if (file.empty()) return nullptr;
    std::error_code failed;
    std::ifstream in(file, std::ios::binary);
    if (!in || !std::filesystem::is_regular_file(file, failed))
        throw OperatorError(fmt::format(
            "the scene's terrain {} cannot be read; correct `terrain` in the scene file, or make it "
            "with trochoid-import",
            file.string()));
    const std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    Result<TerrainGrid> grid = decode_terrain(bytes);
    if (!grid)
        throw OperatorError(fmt::format("the scene's terrain {}: {}", file.string(), grid.error().message));
    return std::make_shared<const TerrainGrid>(std::move(grid).value());
}

LandSettings land_settings_of(const SceneLand& land) {
    LandSettings settings;
    settings.step_log2 = land.node_step_log2;
    settings.refraction = refraction_of(land.refraction);
    settings.shoaling = shoaling_of(land.shoaling);
    settings.diffraction = diffraction_of(land.diffraction);
    settings.run_up = land.run_up_m;
    settings.shore_decrease = land.shore_decrease;
    settings.shallow_orbits = land.shallow_orbits;
    settings.depth_min = land.depth_min_m;
    settings.breaking_ratio = land.breaking_ratio;
    settings.recovery = land.recovery_m;
    settings.spread = land.spread;
    settings.threads = tracing_threads();
    const char* fault = land_settings_fault(settings);
    if (fault != nullptr)
        throw OperatorError(fmt::format("the scene's [land]: {}; correct the scene file", fault));
    return settings;
}

}  // namespace trochoid
