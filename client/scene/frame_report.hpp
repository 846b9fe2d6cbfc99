#pragma once
#include <cstdint>
#include <vector>

namespace trochoid {

/// What a pass of a picture took on the GPU.
struct PassTime {
    const char* name = "";
    double ms = 0;
    bool operator==(const PassTime&) const = default;
};

/// What one picture took; counts of what was drawn and of what was known.
struct FrameReport {
    uint32_t patches_drawn = 0;
    uint32_t patches_known = 0;
    uint32_t draws = 0;          ///< of the near sea
    uint32_t sea_triangles = 0;  ///< estimate from the edge levels
    uint32_t land_triangles = 0;
    uint32_t boxes = 0;
    uint32_t trains = 0;
    uint32_t land_blocks = 0;
    uint32_t land_blocks_left_out = 0;  ///< for which the driver's texture buffers had no room
    float vertex_angle = 0;             ///< vertex spacing over distance
    double cpu_ms = 0;                  ///< of this picture, until the commands were given
    double gpu_ms = 0;                  ///< of an earlier picture, as the driver's timer says
    std::vector<PassTime> passes;       ///< of the same picture as gpu_ms, in their order
    bool passes_waited =
        false;  ///< each pass was waited for (DrawOptions::time_passes): gpu_ms and passes are then of this picture
    bool operator==(const FrameReport&) const = default;
};

}  // namespace trochoid
