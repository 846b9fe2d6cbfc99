#pragma once
#include <string>
#include <vector>

namespace trochoid {

/// The instruction sets that this build has code for and this machine can run, best first ("AVX3", "AVX2", "SSE4", "SSE2", "NEON", …;
/// AVX3 is AVX-512).
std::vector<std::string> vector_targets();

/// The one in use; the best unless forced.
std::string vector_target();

/// Uses only this one from now on, in the whole process; "" chooses the best again. For tests and benchmarks. False
/// where it is none of vector_targets().
bool force_vector_target(const std::string& name);

}  // namespace trochoid
