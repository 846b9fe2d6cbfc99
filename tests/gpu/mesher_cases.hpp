#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "client/gpu/render_target.hpp"
#include "client/gpu/renderer.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid {

inline constexpr std::array<MesherKind, 4> all_meshers{MesherKind::patches, MesherKind::uniform,
                                                       MesherKind::projected, MesherKind::coherent};

/// A view of 512 x 288 pixels from `altitude` m above still water; angles in radians.
Camera standing_at(double x, double z, double altitude, double yaw, double pitch);
/// The same with 1280 x 720 pixels, for finer meshes that nobody draws.
Camera probing(Camera camera);

/// Views that a mesher of the whole sea has to stand: near the surface and 10 km high, straight down and up, towards all sides, at
/// the ends of the world.
struct NamedView {
    std::string name;
    Camera camera;
    bool storm = false;  ///< with waves higher than the camera
};
std::vector<NamedView> demanding_views();

/// The fixture's open sea, or one with a storm in it, with patches for a view; waves stay below the camera.
std::unique_ptr<FixtureSource> open_sea(Camera& camera, bool storm, const DrawOptions& options);

/// Pictures of one mesher.
class Painter {
public:
    /// `meshed` is the camera that the mesh is made for.
    Picture picture(FixtureSource& source, const Camera& camera, const Camera& meshed,
                    const DrawOptions& options);
    const FrameReport& report() const { return report_; }

private:
    Renderer renderer_;
    std::unique_ptr<RenderTarget> target_;
    FrameReport report_;
};

/// Nothing but the sea's mesh before a background that no sea has.
DrawOptions bare(MesherKind kind);
bool is_background(const Picture& picture, uint32_t x, uint32_t y);

/// How far away a pixel's line of sight has left the layer of waves, m along the sea, for still water `below_m` under its level;
/// negative for pixels above the horizon.
double water_distance(const Camera& camera, uint32_t x, uint32_t y, double below_m);

}  // namespace trochoid
