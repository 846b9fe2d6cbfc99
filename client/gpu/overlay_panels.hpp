#pragma once
#include <string>

#include "client/gpu/overlay_content.hpp"

namespace trochoid {

/// Each draws one panel between ImGui's NewFrame and Render; lengths in text heights, so that they grow with it.
void draw_numbers_panel(const OverlayContent& content);
/// The last frames' times against the target, and the GPU's time by pass; top right.
void draw_timers_panel(const OverlayContent& content);
/// Every key, in the middle.
void draw_help_panel();
/// A sentence at the picture's lower edge, `line` lines above the last one.
void draw_notice(const std::string& text, int line);
/// From above: where the person would look, in the picture's middle, or what the frozen camera sees; and north.
void draw_map_marks(const Camera& camera, const std::optional<Camera>& frozen);

}  // namespace trochoid
