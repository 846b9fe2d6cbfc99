#pragma once
#include <string_view>

#include "protocol/model/sea.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/world/traced_land.hpp"

namespace trochoid {

/// Where a test build (-DTROCHOID_FAULT_INJECTION) errs by one unit in the last place, as the environment variable TROCHOID_FAULT
/// says: one of the stages' names. Everything computed from it goes wrong too, as after a real fault.
bool fault_in(std::string_view stage);

/// The same float, one unit in the last place away from zero.
float one_ulp_off(float v);

/// "world": the amplitude of the second train of box 1, before the log takes it.
void spoil_record(WaveTrainBox& box);
/// "land": one node's gain of the middle block of box 1's first field, by one count.
void spoil_land(TracedLand& land);
/// "constants": the amplitude of the last train of the last box.
Sea spoiled(const Sea& sea);

}  // namespace trochoid
