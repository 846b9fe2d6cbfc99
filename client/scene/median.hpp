#pragma once
#include <span>

namespace trochoid {

/// Median of durations or rates, the upper of two middle ones; 0 of nothing.
double median_of(std::span<const double> values);

}  // namespace trochoid
