#pragma once
#include <memory>
#include <vector>

#include "client/scene/sea_source.hpp"
#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_train_box.hpp"

namespace trochoid {

/// A train of a wavelength (m), heading (radians, 0 = east, clockwise seen from above) and amplitude (m) in deep water.
WaveTrain deep_train(double wavelength, double heading, float amplitude, float choppiness, uint32_t phase);

/// A wind sea: trains by falling wavelength about a heading, amplitudes falling off like a sea of this significant
/// height (m) and peak wavelength.
std::vector<WaveTrain> wind_sea(double peak_wavelength, double heading, double significant_height, int count,
                                uint32_t seed);

/// Patches as a server would send them: a quadtree that splits with nearness, neighbours at most one level apart.
std::vector<PatchKey> ring_of_patches(LatticePoint centre, double altitude_m, double reach_m,
                                      double angle_per_vertex);

/// A land field over a terrain: waves shrink over shallows, end at land; made up, for pictures only.
std::vector<FieldBlock> shore_field(FieldId id, const TerrainGrid& grid, uint8_t step_log2);

/// A sea for tests without a server: it grows patches around the last view that it was told of.
class FixtureSource : public SeaSource {
public:
    /// Two boxes (a wind sea and a swell) over a terrain, which may be empty.
    explicit FixtureSource(const TerrainGrid& terrain);

    SceneInput snapshot() override;
    void set_view(const ViewState& view) override;
    SeaTime sea_time_now() override { return now_; }
    void request_rays(BoxId box) override;

    void set_time(SeaTime now) { now_ = now; }
    void add_box(const WaveTrainBox& box);
    const InterestState& state() const { return *state_; }

private:
    void remake_patches(LatticePoint centre, double altitude_m, double angle_per_vertex);

    SeaTime now_{60'000'000};
    TerrainExtent extent_;
    std::vector<std::shared_ptr<const TerrainTile>> tiles_;
    std::vector<WaveRay> rays_;
    std::shared_ptr<InterestState> state_ = std::make_shared<InterestState>();
    ViewState viewed_;
    bool placed_ = false;
};

/// The shipped terrain of the Isles of Scilly, or an empty grid where it is missing.
TerrainGrid shipped_terrain();

}  // namespace trochoid
