#pragma once
#include <cstdint>
#include <memory>

#include "client/gpu/shader_program.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/edge_level.hpp"
#include "client/scene/frustum.hpp"
#include "client/scene/sea_table.hpp"
#include "protocol/model/interest_state.hpp"

namespace trochoid {

/// What a mesh of the sea is made for. References hold during the call only.
struct MesherInput {
    const InterestState& state;
    const SeaTable& table;
    const CameraFrame&
        culling;  ///< of the camera that the mesh is made for, relative to the drawn frame's anchor
    const FrustumPlanes& planes;  ///< of `culling`
    const MeshEye& eye;
    const DrawOptions& options;
};

/// What came out.
struct MeshCounts {
    uint32_t patches_drawn = 0;  ///< sea patches, where the mesher knows them
    uint32_t triangles = 0;
    uint32_t draws = 0;
    bool operator==(const MeshCounts&) const = default;
};

/// Whether a mesher's programs end in pictures or in transform feedback that a test reads (see tests/gpu/sea_probe.hpp).
enum class MesherUse : uint8_t { picture, probe };

/// A way to mesh the sea. All evaluate the same surface at lattice places through shaders/surface.glsl and are shaded by
/// sea.frag; what is displaced at a place, and how much of each train, follows from the place and the eye alone, so that
/// triangles that share a place share the displaced vertex to the bit.
class Mesher {
public:
    Mesher() = default;
    Mesher(const Mesher&) = delete;
    Mesher& operator=(const Mesher&) = delete;
    virtual ~Mesher() = default;

    /// Makes the mesh, on the CPU or the GPU. The Frame block and the sea's buffers are bound; the framebuffer may be changed
    /// by nobody.
    virtual MeshCounts prepare(const MesherInput& input) = 0;
    /// Makes its program and layout current; before draw(), since a program cannot change while vertices are captured.
    virtual void bind() = 0;
    /// Draws it; blending, stencil, depth test and polygon mode are the caller's.
    virtual void draw() = 0;
};

std::unique_ptr<Mesher> make_mesher(MesherKind kind, MesherUse use);

/// The options of a mesher's last program: with MesherUse::probe it captures ProbedVertex (sea_probe.hpp) instead of drawing.
ShaderProgramOptions options_of(MesherUse use);
/// And its stages: those of the geometry, and sea.frag for pictures.
std::vector<std::string_view> stages_of(MesherUse use, std::vector<std::string_view> geometry);

}  // namespace trochoid
