#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "client/gpu/key_bindings.hpp"
#include "client/scene/fly_camera.hpp"

struct GLFWwindow;

namespace trochoid {

/// A window with an OpenGL 4.1 core context, its keys, its mouse and the first gamepad. One at a time, on the main thread.
class Window {
public:
    /// Throws OperatorError where there is no display or no OpenGL 4.1. Sizes are the desktop's units, not pixels.
    Window(const std::string& title, uint32_t width, uint32_t height, bool full_screen);
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;
    ~Window();

    /// Handles what happened since the last call.
    void poll();
    bool wants_close() const;
    void close();
    /// Nothing of it is to be seen: drawing would be for nobody.
    bool minimised() const;
    /// Sleeps until something happens, a tenth of a second at most.
    void wait();

    /// What was held and moved since the last call, keys, mouse and gamepad together: WASD or arrows, Q and E (or page
    /// keys) down and up, shift fast, control slow, wheel; the mouse looks while a button is held, drags with the middle one. What the
    /// overlay takes is not ours.
    FlyInput take_input();
    /// Keys that went down since the last call, in their order.
    std::vector<KeyPress> take_presses();
    void show_frame();

    bool full_screen() const;
    /// To the monitor on which most of the window lies, and back to where it was.
    void set_full_screen(bool full);
    void set_title(const std::string& title);

    uint32_t pixel_width() const;
    uint32_t pixel_height() const;
    /// Size outside of full screen, in the desktop's units.
    uint32_t plain_width() const;
    uint32_t plain_height() const;
    /// How much larger than usual text has to be, in the units of the window's size: 2 on a screen of twice the usual density
    /// where the desktop counts pixels, 1 where it counts larger units.
    float text_scale() const;
    GLFWwindow* handle() const { return window_; }

private:
    /// Where the window lies on the desktop.
    struct Place {
        int x = 0;
        int y = 0;
        int width = 0;
        int height = 0;
    };
    static void on_key(GLFWwindow* window, int key, int scancode, int action, int mods);
    static void on_scroll(GLFWwindow* window, double x, double y);
    bool held(int key) const;
    bool any_held(std::initializer_list<int> keys) const;
    Place place() const;
    void add_keys(FlyInput& input) const;
    void add_mouse(FlyInput& input);

    GLFWwindow* window_ = nullptr;
    std::vector<KeyPress> presses_;
    Place windowed_;  // before full screen
    double wheel_ = 0;
    double last_x_ = 0;
    double last_y_ = 0;
    bool steering_ = false;
};

}  // namespace trochoid
