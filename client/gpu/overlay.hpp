#pragma once
#include <string>

#include "client/gpu/overlay_content.hpp"
#include "client/gpu/window.hpp"

namespace trochoid {

/// Numbers, timers and help over the picture (Dear ImGui). One at a time; works with a window and without.
class Overlay {
public:
    /// `window` may be null: then nobody presses anything. `text_scale` 0 follows the display's density.
    Overlay(const Window* window, float text_scale);
    Overlay(const Overlay&) = delete;
    Overlay& operator=(const Overlay&) = delete;
    ~Overlay();

    /// Draws into the framebuffer at hand: the panels that are wanted, and what is to be told as long as it is.
    void draw(const OverlayContent& content, OverlayPanels panels, uint32_t width, uint32_t height);

private:
    void follow_density();

    const Window* window_;
    float wanted_scale_;
    float scale_ = 0.0F;
};

}  // namespace trochoid
