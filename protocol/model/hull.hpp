#pragma once
#include "protocol/units/result.hpp"

namespace trochoid {

/// Hull of a ship at the water line, metres. Data beside the sea: no sum reads it.
inline constexpr float shortest_hull = 1.0F;
inline constexpr float longest_hull = 500.0F;

/// A ship's hull at the water line; length 0 = none.
struct Hull {
    float length = 0.0F;  ///< m, 1 to 500
    float beam = 0.0F;    ///< m, above 0 to the length
    bool operator==(const Hull&) const = default;
};

inline constexpr bool has_hull(const Hull& hull) { return hull.length != 0.0F; }

/// Nothing is wrong with none. Errors: not_finite, value_out_of_range.
Result<Done> validate(const Hull& hull);

}  // namespace trochoid
