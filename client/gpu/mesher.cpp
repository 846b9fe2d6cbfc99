#include "client/gpu/mesher.hpp"

#include "client/gpu/coherent_mesher.hpp"
#include "client/gpu/patch_mesher.hpp"
#include "client/gpu/projected_mesher.hpp"
#include "client/gpu/uniform_mesher.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

std::unique_ptr<Mesher> make_mesher(MesherKind kind, MesherUse use) {
    switch (kind) {
        case MesherKind::patches: return std::make_unique<PatchMesher>(use);
        case MesherKind::uniform: return std::make_unique<UniformMesher>(use);
        case MesherKind::projected: return std::make_unique<ProjectedMesher>(use);
        case MesherKind::coherent: return std::make_unique<CoherentMesher>(use);
    }
    TROCHOID_ASSERT(false, "no mesher {}", static_cast<int>(kind));
}

ShaderProgramOptions options_of(MesherUse use) {
    if (use == MesherUse::picture) return {};
    return {{"TROCHOID_PROBE 1"},
            {"probe_place", "probe_shift", "probe_normal", "probe_phases", "probe_trains"}};
}

std::vector<std::string_view> stages_of(MesherUse use, std::vector<std::string_view> geometry) {
    if (use == MesherUse::picture) geometry.emplace_back("sea.frag");
    return geometry;
}

}  // namespace trochoid
