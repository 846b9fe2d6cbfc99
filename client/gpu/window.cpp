#include "client/gpu/window.hpp"

#include <epoxy/gl.h>
// epoxy first, and GLFW without a loader of its own.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "client/gpu/gamepad.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

std::string why() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text != nullptr ? text : "no reason given";
}

bool overlay_has_mouse() { return ImGui::GetCurrentContext() != nullptr && ImGui::GetIO().WantCaptureMouse; }

/// The first gamepad that GLFW knows the layout of; at rest where there is none.
FlyInput gamepad_input() {
    for (int pad = GLFW_JOYSTICK_1; pad <= GLFW_JOYSTICK_LAST; ++pad) {
        GLFWgamepadstate state;
        if (glfwJoystickIsGamepad(pad) != GLFW_TRUE || glfwGetGamepadState(pad, &state) != GLFW_TRUE)
            continue;
        const auto axis = [&state](int number) { return static_cast<double>(state.axes[number]); };
        return fly_input_of({axis(GLFW_GAMEPAD_AXIS_LEFT_X), axis(GLFW_GAMEPAD_AXIS_LEFT_Y),
                             axis(GLFW_GAMEPAD_AXIS_RIGHT_X), axis(GLFW_GAMEPAD_AXIS_RIGHT_Y),
                             axis(GLFW_GAMEPAD_AXIS_LEFT_TRIGGER), axis(GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER),
                             state.buttons[GLFW_GAMEPAD_BUTTON_A] == GLFW_PRESS});
    }
    return {};
}

/// The monitor that shows most of a rectangle of the desktop.
GLFWmonitor* monitor_under(int x, int y, int width, int height) {
    int count = 0;
    GLFWmonitor** monitors = glfwGetMonitors(&count);
    GLFWmonitor* best = glfwGetPrimaryMonitor();
    int most = 0;
    for (int i = 0; i < count; ++i) {
        int left = 0;
        int top = 0;
        glfwGetMonitorPos(monitors[i], &left, &top);
        const GLFWvidmode* mode = glfwGetVideoMode(monitors[i]);
        if (mode == nullptr) continue;
        const int common_width = std::min(x + width, left + mode->width) - std::max(x, left);
        const int common_height = std::min(y + height, top + mode->height) - std::max(y, top);
        const int common = std::max(common_width, 0) * std::max(common_height, 0);
        if (common > most) {
            most = common;
            best = monitors[i];
        }
    }
    return best;
}

}  // namespace

Window::Window(const std::string& title, uint32_t width, uint32_t height, bool full_screen) {
    if (glfwInit() != GLFW_TRUE)
        throw OperatorError(
            fmt::format("Cannot open a window: {}. Without a display use --offscreen.", why()));
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 1);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    // Drivers that can tell of a reset do.
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    // Everything is drawn elsewhere and copied here.
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    window_ =
        glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        const std::string reason = why();
        glfwTerminate();
        throw OperatorError(fmt::format(
            "Cannot open a window with OpenGL 4.1: {}. Update the graphics driver, take Mesa's software renderer "
            "(LIBGL_ALWAYS_SOFTWARE=1), or use --offscreen.",
            reason));
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, on_key);
    glfwSetScrollCallback(window_, on_scroll);
    windowed_ = place();
    if (full_screen) set_full_screen(true);
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void Window::poll() { glfwPollEvents(); }

bool Window::wants_close() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }

void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }

bool Window::minimised() const {
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return width == 0 || height == 0 || glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE;
}

void Window::wait() { glfwWaitEventsTimeout(0.1); }

bool Window::held(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }

bool Window::any_held(std::initializer_list<int> keys) const {
    return std::any_of(keys.begin(), keys.end(), [this](int k) { return held(k); });
}

void Window::add_keys(FlyInput& input) const {
    const auto axis = [this](std::initializer_list<int> more, std::initializer_list<int> less) {
        return (any_held(more) ? 1.0 : 0.0) - (any_held(less) ? 1.0 : 0.0);
    };
    input.ahead = axis({GLFW_KEY_W, GLFW_KEY_UP}, {GLFW_KEY_S, GLFW_KEY_DOWN});
    input.right = axis({GLFW_KEY_D, GLFW_KEY_RIGHT}, {GLFW_KEY_A, GLFW_KEY_LEFT});
    input.up = axis({GLFW_KEY_E, GLFW_KEY_PAGE_UP}, {GLFW_KEY_Q, GLFW_KEY_PAGE_DOWN});
    input.fast = any_held({GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT});
    input.slow = any_held({GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL});
}

void Window::add_mouse(FlyInput& input) {
    input.wheel = std::exchange(wheel_, 0.0);
    const auto pressed = [this](int button) { return glfwGetMouseButton(window_, button) == GLFW_PRESS; };
    const bool looking = pressed(GLFW_MOUSE_BUTTON_LEFT) || pressed(GLFW_MOUSE_BUTTON_RIGHT);
    const bool dragging = pressed(GLFW_MOUSE_BUTTON_MIDDLE);
    // A button that went down over the overlay is the overlay's until it goes up.
    const bool steering = (looking || dragging) && (steering_ || !overlay_has_mouse());
    if (steering != steering_)
        glfwSetInputMode(window_, GLFW_CURSOR, steering ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    double x = 0;
    double y = 0;
    glfwGetCursorPos(window_, &x, &y);
    if (steering && steering_) {
        (looking ? input.turn_x : input.pan_x) = x - last_x_;
        (looking ? input.turn_y : input.pan_y) = y - last_y_;
    }
    steering_ = steering;
    last_x_ = x;
    last_y_ = y;
}

FlyInput Window::take_input() {
    FlyInput input;
    add_keys(input);
    add_mouse(input);
    return together(input, gamepad_input());
}

std::vector<KeyPress> Window::take_presses() { return std::exchange(presses_, {}); }

void Window::show_frame() { glfwSwapBuffers(window_); }

Window::Place Window::place() const {
    Place p;
    glfwGetWindowPos(window_, &p.x, &p.y);
    glfwGetWindowSize(window_, &p.width, &p.height);
    return p;
}

bool Window::full_screen() const { return glfwGetWindowMonitor(window_) != nullptr; }

void Window::set_full_screen(bool full) {
    if (full == full_screen()) return;
    if (!full) {
        glfwSetWindowMonitor(window_, nullptr, windowed_.x, windowed_.y, windowed_.width, windowed_.height,
                             GLFW_DONT_CARE);
        return;
    }
    windowed_ = place();
    GLFWmonitor* monitor = monitor_under(windowed_.x, windowed_.y, windowed_.width, windowed_.height);
    const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
    if (mode == nullptr) return;
    glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
    // Some drivers forget.
    glfwSwapInterval(1);
}

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

uint32_t Window::pixel_width() const {
    int width = 0;
    glfwGetFramebufferSize(window_, &width, nullptr);
    return static_cast<uint32_t>(std::max(width, 1));
}

uint32_t Window::pixel_height() const {
    int height = 0;
    glfwGetFramebufferSize(window_, nullptr, &height);
    return static_cast<uint32_t>(std::max(height, 1));
}

uint32_t Window::plain_width() const {
    return static_cast<uint32_t>(std::max(full_screen() ? windowed_.width : place().width, 1));
}

uint32_t Window::plain_height() const {
    return static_cast<uint32_t>(std::max(full_screen() ? windowed_.height : place().height, 1));
}

float Window::text_scale() const {
    float scale = 1.0F;
    glfwGetWindowContentScale(window_, &scale, nullptr);
    const auto units = static_cast<float>(std::max(place().width, 1));
    return std::clamp(scale * units / static_cast<float>(pixel_width()), 0.5F, 8.0F);
}

void Window::on_key(GLFWwindow* window, int key, int /*scancode*/, int action, int mods) {
    auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
    if (const auto press = key_press_of(key, action, mods)) self->presses_.push_back(*press);
}

void Window::on_scroll(GLFWwindow* window, double /*x*/, double y) {
    if (!overlay_has_mouse()) static_cast<Window*>(glfwGetWindowUserPointer(window))->wheel_ += y;
}

}  // namespace trochoid
