#include "client/gpu/window.hpp"

#include <epoxy/gl.h>
// epoxy first, and GLFW without a loader of its own.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

std::string why() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text != nullptr ? text : "no reason given";
}

}  // namespace

Window::Window(const std::string& title, uint32_t width, uint32_t height) {
    if (glfwInit() != GLFW_TRUE)
        throw OperatorError(
            fmt::format("Cannot open a window: {}. Without a display use --offscreen.", why()));
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 1);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    // Everything is drawn elsewhere and copied here.
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    window_ =
        glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        const std::string reason = why();
        glfwTerminate();
        throw OperatorError(fmt::format(
            "Cannot open a window with OpenGL 4.1: {}. Update the graphics driver, or use --offscreen.",
            reason));
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, on_key);
    glfwSetScrollCallback(window_, on_scroll);
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void Window::poll() { glfwPollEvents(); }

bool Window::wants_close() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }

bool Window::held(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }

FlyInput Window::take_input() {
    FlyInput input;
    const auto axis = [this](std::initializer_list<int> more, std::initializer_list<int> less) {
        const auto any = [this](std::initializer_list<int> keys) {
            return std::any_of(keys.begin(), keys.end(), [this](int k) { return held(k); });
        };
        return (any(more) ? 1.0 : 0.0) - (any(less) ? 1.0 : 0.0);
    };
    input.ahead = axis({GLFW_KEY_W, GLFW_KEY_UP}, {GLFW_KEY_S, GLFW_KEY_DOWN});
    input.right = axis({GLFW_KEY_D, GLFW_KEY_RIGHT}, {GLFW_KEY_A, GLFW_KEY_LEFT});
    input.up = axis({GLFW_KEY_E, GLFW_KEY_PAGE_UP}, {GLFW_KEY_Q, GLFW_KEY_PAGE_DOWN});
    input.fast = held(GLFW_KEY_LEFT_SHIFT) || held(GLFW_KEY_RIGHT_SHIFT);
    input.wheel = std::exchange(wheel_, 0.0);
    const bool steering = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS ||
                          glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
    if (steering != steering_)
        glfwSetInputMode(window_, GLFW_CURSOR, steering ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    double x = 0;
    double y = 0;
    glfwGetCursorPos(window_, &x, &y);
    if (steering && steering_) {
        input.turn_x = x - last_x_;
        input.turn_y = y - last_y_;
    }
    steering_ = steering;
    last_x_ = x;
    last_y_ = y;
    return input;
}

std::vector<Toggle> Window::take_toggles() { return std::exchange(toggles_, {}); }

std::vector<int> Window::take_digits() { return std::exchange(digits_, {}); }

void Window::show_frame() { glfwSwapBuffers(window_); }

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

void Window::on_key(GLFWwindow* window, int key, int /*scancode*/, int action, int /*mods*/) {
    if (action != GLFW_PRESS) return;
    if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(window, GLFW_TRUE);
    auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F7)
        self->toggles_.push_back(static_cast<Toggle>(key - GLFW_KEY_F1));
    if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9) self->digits_.push_back(key - GLFW_KEY_0);
}

void Window::on_scroll(GLFWwindow* window, double /*x*/, double y) {
    static_cast<Window*>(glfwGetWindowUserPointer(window))->wheel_ += y;
}

}  // namespace trochoid
