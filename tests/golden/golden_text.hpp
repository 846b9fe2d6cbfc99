#pragma once
#include <iosfwd>
#include <string>

#include "protocol/model/sea.hpp"

// What golden lines say: each part of the sea as this build computes it, in the words of the files.
namespace trochoid {

/// The hex digits of its bits.
std::string hex(float v);
std::string sincos_text(uint32_t phase);
/// system 0 transverse, 1 diverging; j up to wake_cells.
std::string wake_node_text(int system, size_t j);
/// What chapter 2.2 derives from a train.
std::string constants_text(const WaveTrain& train);
/// The phase of chapter 2.3, without land and roundness.
std::string phase_text(const WaveTrain& train, SeaTime t, LatticePoint p);
/// A land field at a point (chapter 2.6).
std::string land_text(const LandField& field, LatticePoint p);
std::string sample_text(const Sea& sea, SeaTime t, LatticePoint p, Layers layers = authoritative_layers);
std::string water_text(const Sea& sea, SeaTime t, LatticePoint p);

/// The field and its blocks.
void write_field(std::ostream& out, const LandField& field);
/// The boxes by ascending id, each with its features and trains, and behind the first that needs them the fields.
void write_records(std::ostream& out, const Sea& sea);

}  // namespace trochoid
