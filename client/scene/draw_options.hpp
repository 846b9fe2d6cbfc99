#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "client/scene/camera.hpp"
#include "protocol/model/displayed.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid {

enum class Quality : uint8_t { low, medium, high };
std::optional<Quality> quality_named(std::string_view name);

/// How the sea is meshed (rows A1 and A14, B3, D1 to D3, D7); all draw the same surface.
enum class MesherKind : uint8_t {
    patches,    ///< the server's patches through hardware tessellation
    uniform,    ///< a square grid of equal cells under the camera (paper A)
    projected,  ///< a grid on the screen, cast on the sea, up to the horizon (paper B)
    coherent  ///< triangles that stay on the GPU and are refined and coarsened from their last state (paper D)
};
/// What displaces the mesh.
enum class Displacement : uint8_t {
    trains,  ///< the sea itself
    noise,   ///< gradient noise, for comparison (row D5)
    fft      ///< a tile made by Fourier transform, for comparison
};
/// What shows waves where (rows C3 to C5).
enum class FarMethod : uint8_t {
    combined,  ///< waves near, a scrolling normal map far
    spectrum,  ///< waves only
    texture    ///< the scrolling normal map only, on a flat sea
};
/// What makes a mesher refine (row D4), beyond the wanted spacing of vertices.
enum class Refinement : uint8_t {
    distance,  ///< the distance alone
    screen,    ///< the size on the screen, foreshortening included
    frustum    ///< the distance, and coarse outside of the view
};

std::optional<MesherKind> mesher_named(std::string_view name);
std::optional<Displacement> displacement_named(std::string_view name);
std::optional<FarMethod> far_method_named(std::string_view name);
std::optional<Refinement> refinement_named(std::string_view name);
std::string_view name_of(Quality quality);
std::string_view name_of(MesherKind kind);
std::string_view name_of(Displacement displacement);
std::string_view name_of(FarMethod method);
std::string_view name_of(Refinement refinement);

/// The uniform grid is made of tiles of so many cells a side.
inline constexpr uint32_t grid_cells_step = 32;

/// What to draw and how finely.
struct DrawOptions {
    /// Height error that the mesh may show, pixels; vertices are twice that apart (displayed.hpp).
    float error_px = 6.0F;
    float land_error_px = 4.0F;
    uint32_t samples = 1;  ///< per pixel
    uint32_t triangles_per_draw = 4'000;
    bool wireframe = false;
    bool boxes = false;                ///< outlines of wave train boxes
    bool rays = false;                 ///< wave rays and action points
    bool patches = false;              ///< outlines of sea patches, coloured by level
    bool fields = false;               ///< gain of land fields in false colours
    Layers layers = displayed_layers;  ///< what the sea's sum is made of
    bool authoritative = false;        ///< no train fades with distance: for tests
    bool land = true;
    bool far_sea = true;
    bool sky = true;
    bool ships = true;
    bool spray = true;
    bool foam_history = true;  ///< foam stays behind a breaking crest and fades; without it there is no spray
    uint32_t foam_map_side = 128;  ///< texels along the 256 m of remembered foam, a power of two, 64 to 1024
    MesherKind mesher = MesherKind::patches;
    Displacement displacement = Displacement::trains;
    FarMethod far_method = FarMethod::combined;
    Refinement refinement = Refinement::distance;
    uint32_t grid_cells = 256;    ///< uniform: cells along a side, up to 1024, rounded up to grid_cells_step
    float grid_spacing_m = 2.0F;  ///< uniform: a cell's side, rounded to a power of two from 1/16 to 64 m
    float attention =
        1.0F;            ///< projected: rows go to the foreground (> 1) or the background (< 1), 0.25 to 4
    double hour = 16.5;  ///< local solar time of the light, 0 to 24
    uint32_t projected_rows =
        0;  ///< projected: quads along the water's height in the picture, 2 to 512; 0 = from error_px
    uint32_t projected_columns = 0;       ///< projected: quads a row, 2 to 512; 0 = from error_px
    uint32_t most_triangles = 2'000'000;  ///< coherent: beyond, the whole mesh is made coarser, at least 4096
    bool coherent_land = false;           ///< land by the coherent mesher instead of tiles (row D9)
    float render_scale =
        1.0F;  ///< share of the picture's width and height that is drawn and then enlarged, 0.25 to 1
    bool foam_share =
        false;  ///< instead of colours the sea shows the square root of its share of foam: for tests
    /// What a renderer on the processor feels and people hardly see is left out: textures are taken from the nearest of their levels,
    /// not from between two, and what is seen flat counts as small (Refinement::screen instead of distance).
    bool lean = false;
    /// Each pass is waited for, so that its time is known on the processor, too (pass_timers.hpp); pictures take longer by that.
    bool time_passes = false;
    std::array<float, 3> clear_colour{0.0F, 0.0F, 0.0F};
    bool operator==(const DrawOptions&) const = default;
};

/// low: 9 px; medium: 6 px, meant for software rendering; high: 2 px, four samples a pixel.
DrawOptions options_for(Quality quality);

/// Takes over what the quality decides (errors, samples, draws) and leaves the rest as it is.
void set_quality(DrawOptions& options, Quality quality);

/// What the mesh is refined by: the option, unless a lean picture asks for less.
Refinement refinement_in_force(const DrawOptions& options);

/// How vertices are spaced: by the coarser of what we want and of what the server culls by (finer would show trains that
/// it has left out in one patch and not in the next).
DisplayFilter filter_of(const Camera& camera, const DrawOptions& options, float error_in_force_px);

}  // namespace trochoid
