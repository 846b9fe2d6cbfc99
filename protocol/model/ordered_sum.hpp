#pragma once
#include <vector>

#include "protocol/model/sea.hpp"

// The ordered sum of protocol/README.md, chapter 2.7: what SeaInstant::evaluate is made of.
namespace trochoid {

/// Accumulators of the ordered sum. Every update is acc = (coefficient * value) + acc, each rounded on its own.
struct Sums {
    float ax = 0.0F, ay = 0.0F, az = 0.0F;
    float bx = 0.0F, bz = 0.0F;
    float mxx = 0.0F, mxz = 0.0F, mzx = 0.0F, mzz = 0.0F;
    float vx = 0.0F, vy = 0.0F, vz = 0.0F;
};

/// What shapes a train at the point: its field's (or no field's) gain, shift and orbit, already combined with the box's envelope
/// and irregular heights.
struct Local {
    uint32_t shift = 0;
    float g = 0.0F;                // gain of the vertical orbit
    float gx = 0.0F, gz = 0.0F;    // its gradient, 1/m
    float gh = 0.0F;               // gain of the horizontal orbit
    float ghx = 0.0F, ghz = 0.0F;  // its gradient, 1/m
    float qx = 0.0F, qz = 0.0F;    // gradient of the shift, rad/m
};

/// That of a train in the box's envelope, on the land, where waves are so high.
Local combine(const Envelope& e, const LandSample& land, const HeightModulation& m);

/// Adds the box's trains at the point under the envelope e. `locals` is scratch of the caller, one for each field.
void add_trains(Sums& acc, const LiveBox& live, const Envelope& e, LatticePoint p, Layers layers,
                std::vector<Local>& locals);
/// Adds the box's wake, transverse waves first; the box must have one.
void add_wake(Sums& acc, const LiveBox& live, const Envelope& e, LatticePoint p);
/// Adds the box's noise.
void add_noise(Sums& acc, std::span<const NoiseOctave> octaves, const Envelope& e, LatticePoint p);
/// The surface that the sums describe.
SurfaceSample finish(const Sums& acc);

}  // namespace trochoid
