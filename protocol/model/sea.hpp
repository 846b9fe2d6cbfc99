#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/wave_train_box.hpp"

namespace trochoid {

/// A box with all that evaluating it needs: the record, the constants of its trains, its land fields.
struct PreparedBox {
    WaveTrainBox record;
    std::vector<TrainConstants> constants;
    /// The distinct fields of the trains, ascending id.
    std::vector<std::shared_ptr<const LandField>> fields;
    /// For each train the index in fields, or -1.
    std::vector<int16_t> field_of_train;
};

/// What the sum is made of, in order of importance (paper A, section 5; row A9): a set is a mask of these.
enum class Layer : uint16_t {
    trains = 1U << 0,           ///< the wave trains themselves
    shelter = 1U << 1,          ///< gain of the land fields: shadow, shoaling, breaking
    refraction = 1U << 2,       ///< shift of the land fields
    wakes = 1U << 3,            ///< ship wakes
    irregular = 1U << 4,        ///< irregular heights
    orbits = 1U << 5,           ///< flatter orbits in shallow water
    round = 1U << 6,            ///< round waves
    noise = 1U << 7,            ///< noise that is part of the authoritative surface
    displayed_noise = 1U << 8,  ///< noise that is only displayed
};
struct Layers {
    uint16_t bits = 0;
    constexpr bool has(Layer layer) const { return (bits & static_cast<uint16_t>(layer)) != 0; }
    constexpr Layers with(Layer layer) const {
        return {static_cast<uint16_t>(bits | static_cast<uint16_t>(layer))};
    }
    constexpr Layers without(Layer layer) const {
        return {static_cast<uint16_t>(bits & ~static_cast<uint16_t>(layer))};
    }
    bool operator==(const Layers&) const = default;
};
/// The sea that physics, sync regions and hashes mean.
inline constexpr Layers authoritative_layers{0xff};
inline constexpr Layers displayed_layers{0x1ff};

/// Joins a record with its fields, their bases as the record's overlays say (any superset; a train whose field is missing reads shift 0 and gain 1).
std::shared_ptr<const PreparedBox> prepare(WaveTrainBox record,
                                           std::span<const std::shared_ptr<const LandField>> fields);

/// The surface at one rest point: displacement, partial derivatives, unnormalised normal and Jacobian determinant, and
/// particle velocity. All float32, bit-equal on every machine (model: "Sum over trains").
struct SurfaceSample {
    /// Sum of the horizontal shifts; the point lies at (X - ax, ay, Z - az), metres.
    float ax = 0.0F;
    float ay = 0.0F;
    float az = 0.0F;
    /// Derivatives of the displaced position: columns d/dX and d/dZ of (Px, Y, Pz).
    float pxx = 1.0F;
    float pxz = 0.0F;
    float pzx = 0.0F;
    float pzz = 1.0F;
    float yx = 0.0F;
    float yz = 0.0F;
    /// Unnormalised normal Tz x Tx; ny is also the Jacobian determinant (foam where it falls below 0.6).
    float nx = 0.0F;
    float ny = 1.0F;
    float nz = 0.0F;
    /// Particle velocity, m/s.
    float vx = 0.0F;
    float vy = 0.0F;
    float vz = 0.0F;
    bool operator==(const SurfaceSample&) const = default;
};

/// The authoritative sea of one moment of the log: all boxes by ascending id. Immutable; copying copies pointers.
class Sea {
public:
    Sea() = default;
    /// Boxes may come in any order; two boxes of one id are our bug.
    explicit Sea(std::vector<std::shared_ptr<const PreparedBox>> boxes);
    std::span<const std::shared_ptr<const PreparedBox>> boxes() const { return boxes_; }

private:
    std::vector<std::shared_ptr<const PreparedBox>> boxes_;
};

/// A box at one sea time: what the sum and its fast path read.
struct LiveBox {
    std::shared_ptr<const PreparedBox> box;
    BoxInstant instant;
    std::vector<uint32_t> phase;  ///< per train: phase at the origin, turns Q0.32
    IrregularPhases irregular;
    std::vector<NoiseOctave> noise;  ///< empty where the layers leave the noise out
};

/// The sea at one sea time: the per-train time phases are taken once, then points cost only products and sums.
/// Holds its own copy of the pointers, so it outlives the Sea it was made from.
class SeaInstant {
public:
    SeaInstant(const Sea& sea, SeaTime t, Layers layers = authoritative_layers);
    SeaTime time() const { return time_; }
    Layers layers() const { return layers_; }
    /// The boxes that are not still, ascending id.
    std::span<const LiveBox> live() const { return live_; }
    /// The same without one box; copies, computes nothing again.
    SeaInstant without(BoxId box) const;
    /// The surface at a rest point (inside the world's bounds).
    SurfaceSample evaluate(LatticePoint p) const;

private:
    SeaTime time_;
    Layers layers_;
    std::vector<LiveBox> live_;
};

/// Hash over every float of the samples, in order: the known answer that two parties compare.
uint64_t hash_of(std::span<const SurfaceSample> samples);

}  // namespace trochoid
