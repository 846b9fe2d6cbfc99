#pragma once
#include "tests/determinism/folded_scene.hpp"
#include "tests/determinism/trace.hpp"

namespace trochoid {

/// Traces a folded scene: "world" (every box's record), "land" (every node), "constants" (of every train), "patch" (what fixed
/// cameras get) and "displacement" (samples and queries, from the opening to ten years later), the last two on `threads`
/// threads.
void trace_stages(Trace& trace, const FoldedScene& scene, uint32_t threads);

}  // namespace trochoid
