#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "client/scene/fly_camera.hpp"

struct GLFWwindow;

namespace trochoid {

/// Debug views that a key switches, F1 to F7.
enum class Toggle : uint8_t { overlay, wireframe, boxes, rays, patches, fields, freeze };

/// A window with an OpenGL 4.1 core context, its keys and its mouse. One at a time, on the main thread.
class Window {
public:
    /// Throws OperatorError where there is no display or no OpenGL 4.1.
    Window(const std::string& title, uint32_t width, uint32_t height);
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;
    ~Window();

    /// Handles what happened since the last call.
    void poll();
    bool wants_close() const;
    /// Keys held and mouse moved since the last call: WASD or arrows, Q and E (or page keys) down and up, shift fast, wheel
    /// speed; the mouse looks while a button is held.
    FlyInput take_input();
    /// Toggles pressed since the last call.
    std::vector<Toggle> take_toggles();
    /// Digit keys pressed since the last call, 1 to 9.
    std::vector<int> take_digits();
    void show_frame();

    uint32_t pixel_width() const;
    uint32_t pixel_height() const;
    GLFWwindow* handle() const { return window_; }

private:
    static void on_key(GLFWwindow* window, int key, int scancode, int action, int mods);
    static void on_scroll(GLFWwindow* window, double x, double y);
    bool held(int key) const;

    GLFWwindow* window_ = nullptr;
    std::vector<Toggle> toggles_;
    std::vector<int> digits_;
    double wheel_ = 0;
    double last_x_ = 0;
    double last_y_ = 0;
    bool steering_ = false;
};

}  // namespace trochoid
