#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "client/scene/camera.hpp"
#include "client/scene/land_table.hpp"
#include "client/scene/sea_weather.hpp"
#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/model/wave_train.hpp"

namespace trochoid {

/// One texel of the records that shaders/sea.glsl reads (RGBA32I); floats travel as their bits.
using RecordTexel = std::array<int32_t, 4>;
/// Texels of a box's and of a train's row. The layout is stated in sea_table.cpp and read by shaders/sea.glsl, which gets
/// the two counts as defines.
inline constexpr int box_row_texels = 8;
inline constexpr int train_row_texels = 3;
/// Of the features that a box may have: irregular heights, a ship's wake, an octave of noise. Round waves take one texel for
/// four trains.
inline constexpr int irregular_row_texels = 3;
inline constexpr int wake_row_texels = 3;
inline constexpr int octave_row_texels = 3;
/// Mean square of the gradient of an octave of noise per cell (both axes), measured.
inline constexpr float octave_mean_square = 1.05F;

/// What waves can do at most where a list of boxes acts, metres.
struct WaveBounds {
    float height = 0;
    float displacement = 0;
    bool operator==(const WaveBounds&) const = default;
};

/// One texel (RG32I) of the patch lists: a header (number of entries, 0), then entries (row of the box, trains).
using ListTexel = std::array<int32_t, 2>;

/// wake_table() as texels (RGBA32I): the transverse train's nodes, the diverging train's, then one texel a node of the root.
std::vector<RecordTexel> wake_texels();

/// The boxes and trains of a state as the shaders want them: what does not change with time is derived once per state, what does
/// (phases, envelopes in time, the anchor) once per frame.
class SeaTable {
public:
    /// Takes over a state; `land` must have been made of the same one.
    void rebuild(const InterestState& state, const LandTable& land);

    /// All rows at a sea time: boxes first (ascending id), then their trains, the land fields, the boxes' features. Of the
    /// layers wakes, irregular heights, round waves and noise are left out here, the others by the shader.
    std::vector<RecordTexel> records(const LandTable& land, LatticePoint anchor, SeaTime now,
                                     Layers layers = displayed_layers) const;
    const std::vector<ListTexel>& lists() const { return lists_; }
    /// Header's index in lists() of a patch; list 0 holds every box with all its trains.
    int list_of(PatchKey key) const;
    WaveBounds bounds_of_list(int list) const;

    /// What the waves at a place say about its wind; Jacobians count the trains longer than `shortest_m`.
    SeaWeather weather_at(LatticePoint p, SeaTime now, float shortest_m) const;

    size_t box_count() const { return boxes_.size(); }
    size_t train_count() const { return train_count_; }

private:
    struct Box {
        std::shared_ptr<const WaveTrainBox> record;
        std::vector<TrainConstants> constants;
        std::vector<int> fields;            // row of the train's land field, -1 = none
        std::vector<float> slope_variance;  // (kA)^2 / 2 of each train
        WaveBounds bounds;
        LatticeRect reach;    // where it can ever act
        int first_texel = 0;  // of its trains
    };
    void add_box(const std::shared_ptr<const WaveTrainBox>& record, const LandTable& land);
    std::vector<ListTexel> entries_of(const PatchDescriptor& patch) const;
    int add_list(const std::vector<ListTexel>& entries);

    std::vector<Box> boxes_;
    std::vector<ListTexel> lists_;
    std::map<std::vector<ListTexel>, int> list_starts_;
    std::map<int, WaveBounds> bounds_;
    std::map<PatchKey, int> list_of_patch_;
    size_t train_count_ = 0;
};

}  // namespace trochoid
