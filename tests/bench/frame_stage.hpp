#pragma once
#include <memory>
#include <vector>

#include "client/gpu/renderer.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid::bench {

/// Median of some pictures, each until the GPU had done it.
struct FrameCost {
    double ms = 0;       ///< by the wall clock
    double core_ms = 0;  ///< of all the program's threads, ms of a core; the least of the pictures
    FrameReport report;  ///< of the last picture; its passes are medians
    double fps() const { return 1e3 / ms; }
    /// What parts of pictures are compared by: the threads' time where the processor draws, which other programs disturb little,
    /// else the wall clock's.
    double work_ms() const;
};

/// What a client knows of a sea without land: boxes and fields, patches around a camera.
struct KnownSea {
    std::vector<WaveTrainBox> boxes;
    std::vector<FieldBlock> blocks;
};
SceneInput scene_of(const KnownSea& sea, const Camera& camera, const DrawOptions& options);

/// An unlimited box of a wind sea with so many trains of 3 to 90 m, at most 256.
WaveTrainBox wind_box(int trains);

/// The fixture's sea over a terrain, which may be empty, with a third box: 60 trains.
std::unique_ptr<FixtureSource> sea_of_60_trains(const TerrainGrid& terrain);
/// The scene of a source whose patches are made for this view.
SceneInput scene_of(FixtureSource& source, const Camera& camera, const DrawOptions& options);

/// A camera `altitude` m above the origin; angles in radians.
Camera looking(double altitude, double pitch, uint32_t width, uint32_t height);

/// Pictures of one size by the viewer's own renderer.
class Stage {
public:
    Stage(uint32_t width, uint32_t height, uint32_t samples = 1, float scale = 1.0F)
        : target_(width, height, samples, scale) {}

    /// Draws `frames` pictures after `warm` others; between two the sea's clock goes on by a sixtieth of a second and the camera by
    /// so many metres. The camera's own size decides how fine the mesh is; the target's, how many pixels are shaded.
    FrameCost measure(SceneInput scene, Camera camera, const DrawOptions& options, int frames, int warm = 2,
                      double metres_a_frame = 0.0);

private:
    RenderTarget target_;
    Renderer renderer_;
};

/// Options with which a mesher draws about `triangles` of the sea of 60 trains for this camera: sought until no more than `off` of
/// them are missing or too many, as far as the mesher comes.
DrawOptions options_for_triangles(MesherKind kind, double triangles, const Camera& camera, double off = 0.01);

/// Nothing but the sea's mesh, for tables about meshes and waves.
DrawOptions bare_options(MesherKind kind);

}  // namespace trochoid::bench
