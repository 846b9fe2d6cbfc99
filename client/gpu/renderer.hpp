#pragma once
#include <array>
#include <memory>

#include "client/gpu/coherent_land.hpp"
#include "client/gpu/far_sea_pass.hpp"
#include "client/gpu/foam_pass.hpp"
#include "client/gpu/frame_uniforms.hpp"
#include "client/gpu/land_pass.hpp"
#include "client/gpu/line_pass.hpp"
#include "client/gpu/mesher.hpp"
#include "client/gpu/other_seas.hpp"
#include "client/gpu/pass_timers.hpp"
#include "client/gpu/render_target.hpp"
#include "client/gpu/sea_buffers.hpp"
#include "client/gpu/ship_pass.hpp"
#include "client/gpu/sky_pass.hpp"
#include "client/gpu/spray_pass.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/frame_report.hpp"
#include "client/scene/ripple_scroll.hpp"
#include "client/scene/scene_input.hpp"

namespace trochoid {

/// Pictures of the sea: one call draws one into a target. Needs a current OpenGL 4.1 core context, as long as it lives.
class Renderer {
public:
    Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;
    ~Renderer() = default;

    /// Draws what the input shows from a camera. `culling_camera` is the one that the mesh is made for: usually the same,
    /// frozen where a debug view wants to see from outside what is drawn.
    FrameReport draw(const RenderTarget& target, const SceneInput& input, const Camera& camera,
                     const Camera& culling_camera, const DrawOptions& options);

    DepthRange depth_range() const { return depth_range_; }

private:
    struct Chosen;
    void take_over(const SceneInput& input);
    const InterestState& known_state() const;
    Chosen choose(const SceneInput& input, const Camera& camera, const Camera& culling_camera,
                  const DrawOptions& options) const;
    void upload(const Chosen& chosen, const Camera& camera, SeaTime now, const DrawOptions& options);
    void draw_passes(const Chosen& chosen, const Camera& camera, const DrawOptions& options);
    void draw_near_sea(Mesher& mesher, bool wireframe);
    /// The one asked for, made when it is first wanted.
    Mesher& mesher_of(MesherKind kind);
    void set_lean(bool lean);
    FrameReport report_of(const Chosen& chosen, const MeshCounts& mesh) const;

    DepthRange depth_range_;
    size_t texel_limit_;
    SeaBuffers buffers_;
    OtherSeas other_seas_;
    std::array<std::unique_ptr<Mesher>, 4> meshers_;
    FarSeaPass far_sea_;
    LandPass land_;
    std::unique_ptr<CoherentLand> coherent_land_;  // made when it is first wanted
    LinePass lines_;
    SkyPass sky_;
    FoamPass foam_;
    SprayPass spray_;
    ShipPass ships_;
    ShipWaters ship_waters_;
    GlBuffer uniforms_;

    // What the tables were made of; they are made anew when these change.
    std::shared_ptr<const InterestState> state_;
    std::vector<std::shared_ptr<const TerrainTile>> tiles_;
    TerrainExtent extent_;
    LandTable land_table_;
    SeaTable sea_table_;
    BedMap bed_;
    int ripple_axis_ = 0;
    RippleScroll scroll_;
    SeaWeather weather_;

    PatchDirectory directory_;
    PassTimers timers_;
    bool lean_ = false;  // how textures are filtered now
};

}  // namespace trochoid
