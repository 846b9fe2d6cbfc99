#include "server/world/effective_time.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid {

std::string text_of(SeaTime t) {
    // Whole microseconds, so that every time can be read to the last digit.
    const uint64_t us = t.us < 0 ? uint64_t{0} - static_cast<uint64_t>(t.us) : static_cast<uint64_t>(t.us);
    constexpr auto second = static_cast<uint64_t>(microseconds_per_second);
    const uint64_t seconds = us / second;
    std::string text = fmt::format("{}{}.{:06} s", t.us < 0 ? "-" : "", seconds, us % second);
    if (seconds >= 60)
        text += fmt::format(" ({}{} d {:02}:{:02}:{:02})", t.us < 0 ? "-" : "", seconds / 86400,
                            seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    return text;
}

Result<SeaTime> effective_time(SeaTime asked, SeaTime now, int64_t lead_us, bool refuse_if_late) {
    if (asked.us < -sea_time_bound || asked.us > sea_time_bound / 2)
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("the asked sea time {} is out of range: give one up to {}", text_of(asked),
                                 text_of({sea_time_bound / 2}))};
    const SeaTime earliest = now + lead_us;
    if (asked < earliest && refuse_if_late)
        return Error{
            ErrorCode::too_late,
            fmt::format("sea time {} cannot be met any more: ask for {} or later, or let it be deferred",
                        text_of(asked), text_of(earliest))};
    return std::max(asked, earliest);
}

}  // namespace trochoid
