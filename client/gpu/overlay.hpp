#pragma once
#include "client/gpu/window.hpp"
#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/frame_report.hpp"
#include "client/scene/scene_input.hpp"

namespace trochoid {

/// All that the overlay says.
struct OverlayContent {
    FrameReport report;
    SourceStatistics source;
    SeaTime now;
    Camera camera;
    double speed = 0;  ///< of the camera, m/s
    double frames_per_second = 0;
    double frame_ms = 0;
    DrawOptions options;
    bool frozen = false;  ///< culling camera
};

/// Numbers over the picture (Dear ImGui). One at a time; works with a window and without.
class Overlay {
public:
    /// `window` may be null: then nobody presses anything.
    explicit Overlay(const Window* window);
    Overlay(const Overlay&) = delete;
    Overlay& operator=(const Overlay&) = delete;
    ~Overlay();

    /// Draws into the framebuffer at hand: the numbers where they are wanted, and what is wrong with the connection as long as
    /// something is.
    void draw(const OverlayContent& content, bool numbers, uint32_t width, uint32_t height) const;

private:
    bool windowed_;
};

}  // namespace trochoid
