#pragma once
#include <cstdint>

namespace trochoid::bench {

/// Executes about `count` independent vector products and sums in the vector target in use; returns how many exactly.
int64_t vector_work(int64_t count);
/// Floats of its vectors.
int vector_width();

}  // namespace trochoid::bench
