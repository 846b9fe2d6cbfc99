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

/// Joins a record with its fields (any superset; a train whose field is missing reads shift 0 and gain 1).
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

/// The sea at one sea time: the per-train time phases are taken once, then points cost only products and sums.
/// Holds its own copy of the pointers, so it outlives the Sea it was made from.
class SeaInstant {
public:
    SeaInstant(const Sea& sea, SeaTime t);
    SeaTime time() const { return time_; }
    /// The surface at a rest point (inside the world's bounds).
    SurfaceSample evaluate(LatticePoint p) const;

private:
    struct Live {
        std::shared_ptr<const PreparedBox> box;
        BoxInstant instant;
        std::vector<uint32_t> phase;  // per train: phase at the origin, turns Q0.32
    };
    SeaTime time_;
    std::vector<Live> live_;
};

/// Hash over every float of the samples, in order: the known answer that two parties compare.
uint64_t hash_of(std::span<const SurfaceSample> samples);

}  // namespace trochoid
