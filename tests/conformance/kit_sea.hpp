#pragma once
#include "protocol/model/interest_state.hpp"
#include "protocol/model/terrain.hpp"

// The sea that the kit shows to clients under test: small, but with something of everything.
namespace trochoid::conformance {

/// Sea time at the beginning of each of our sessions.
inline constexpr SeaTime kit_sea_begin{int64_t{3600} * microseconds_per_second};

/// Three trains everywhere, a box whose trains read two land blocks, sixteen patches of 64 m around the middle.
InterestState small_sea();
/// What it has become: the box ends, there is another with noise and a course, a block has changed, patches have gone and come.
InterestState grown_sea();
/// A box with everything that a record may have.
WaveTrainBox laden_box(BoxId id);
/// The small sea and that box.
InterestState laden_sea();

}  // namespace trochoid::conformance
