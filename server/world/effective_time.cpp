#include "server/world/effective_time.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid {

Result<SeaTime> effective_time(SeaTime asked, SeaTime now, int64_t lead_us, bool refuse_if_late) {
    if (asked.us < -sea_time_bound || asked.us > sea_time_bound / 2)
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("the asked time {} us is out of range: give one up to 2^60 us", asked.us)};
    const SeaTime earliest = now + lead_us;
    if (asked < earliest && refuse_if_late)
        return Error{
            ErrorCode::too_late,
            fmt::format("sea time {} us cannot be met any more: ask for {} us or later, or allow deferral",
                        asked.us, earliest.us)};
    return std::max(asked, earliest);
}

}  // namespace trochoid
