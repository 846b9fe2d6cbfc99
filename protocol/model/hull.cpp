#include "protocol/model/hull.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

namespace trochoid {

namespace {

bool finite(float v) { return (std::bit_cast<uint32_t>(v) & 0x7f800000U) != 0x7f800000U; }

}  // namespace

Result<Done> validate(const Hull& hull) {
    if (!finite(hull.length) || !finite(hull.beam))
        return Error{ErrorCode::not_finite, "a hull's length or beam is not finite"};
    if (hull == Hull{}) return Done{};
    if (hull.length < shortest_hull || hull.length > longest_hull)
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("a hull is {} m long, not 0 (none) or {} to {}", hull.length, shortest_hull,
                                 longest_hull)};
    if (hull.beam <= 0.0F || hull.beam > hull.length)
        return Error{
            ErrorCode::value_out_of_range,
            fmt::format("a hull's beam is {} m, not above 0 to its length, {} m", hull.beam, hull.length)};
    return Done{};
}

}  // namespace trochoid
