#pragma once
#include <glm/vec4.hpp>

#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// How far the layers of ripples have travelled. Their speed changes with the wind (scroll_speed), so the way is summed up from
/// frame to frame; it begins at a place that follows from the sea time alone.
class RippleScroll {
public:
    /// Moves on to a sea time under a wind (m/s); jumps of more than ten seconds, and steps back, begin anew.
    void advance(SeaTime now, float wind_m_s);
    /// Tiles travelled along by the finest, the middle and the coarsest layer; w: by all of them across. Each below 1.
    const glm::vec4& tiles() const { return tiles_; }

private:
    glm::vec4 tiles_{0};
    SeaTime last_{-1};
};

}  // namespace trochoid
