#pragma once
#include <cstdint>
#include <string>

#include "protocol/model/sea_clock.hpp"
#include "protocol/units/result.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// A lead in real milliseconds as microseconds of sea time at the clock's rate; 0 while the sea is paused.
constexpr int64_t lead_in_sea_time(const SeaClock& clock, uint32_t lead_ms) {
    return (int64_t{lead_ms} * 1000 * int64_t{clock.rate_q16}) >> 16;
}

/// A sea time as people read it, to the microsecond, from a minute on with days and clock: "98745.678000 s (1 d 03:25:45)".
std::string text_of(SeaTime t);

/// When a command takes hold: max(asked, now + lead), or too_late where the asked time cannot be met and the command would
/// rather be refused; value_out_of_range beyond ±2^61 us. `lead_us` in sea time.
Result<SeaTime> effective_time(SeaTime asked, SeaTime now, int64_t lead_us, bool refuse_if_late);

}  // namespace trochoid
