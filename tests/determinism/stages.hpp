#pragma once
#include "tests/determinism/folded_scene.hpp"
#include "tests/determinism/trace.hpp"

namespace trochoid {

/// Traces a folded scene: "world" (every box's record), "land" (every node), "constants" (of every train), "patch" (what fixed
/// cameras get), "displacement" (samples and queries of the scalar reference, from the opening to ten years later) and "vectors" (the
/// fast path, compared with the reference), the last three on `threads` threads. Of a scene with commands also "live-log" (replies,
/// log, followers) and the same stages, as "live-…", of the world after all commands, around the times at which they take hold.
void trace_stages(Trace& trace, const FoldedScene& scene, uint32_t threads);

}  // namespace trochoid
