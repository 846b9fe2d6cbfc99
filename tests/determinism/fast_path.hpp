#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "protocol/model/sea.hpp"
#include "tests/determinism/trace.hpp"

namespace trochoid {

/// Traces, under the stage's name, small grids and batched queries around the places by protocol/model/simd, and compares every value of every
/// instruction set that this machine has with the scalar reference: one that differs is a disagreement of the trace. Alternately with the
/// authoritative and the displayed layers.
void trace_fast_path(Trace& trace, const std::string& stage, const Sea& sea, std::span<const SeaTime> ticks,
                     uint32_t threads);

/// The instruction sets that trace_fast_path tries here, best first: "AVX3 AVX2 SSE4 SSE2".
std::string fast_path_targets();

}  // namespace trochoid
