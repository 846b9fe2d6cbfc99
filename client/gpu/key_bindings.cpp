#include "client/gpu/key_bindings.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>

namespace trochoid {

namespace {

// A second key for the same action stands behind the first and is shown by it.
constexpr std::array bindings{
    KeyBinding{GLFW_KEY_H, false, Action::help, false, "H, F12", "this help"},
    KeyBinding{GLFW_KEY_F12, false, Action::help, false, "", ""},
    KeyBinding{GLFW_KEY_F1, false, Action::overlay, false, "F1", "numbers"},
    KeyBinding{GLFW_KEY_F2, false, Action::wireframe, false, "F2", "wireframe"},
    KeyBinding{GLFW_KEY_F3, false, Action::boxes, false, "F3", "wave train boxes"},
    KeyBinding{GLFW_KEY_F4, false, Action::rays, false, "F4", "wave rays and action points"},
    KeyBinding{GLFW_KEY_F5, false, Action::patches, false, "F5", "sea patches by level"},
    KeyBinding{GLFW_KEY_F6, false, Action::fields, false, "F6", "gain of land fields"},
    KeyBinding{GLFW_KEY_F7, false, Action::freeze, false, "F7", "freeze the culling camera"},
    KeyBinding{GLFW_KEY_F8, false, Action::timers, false, "F8", "frame graph and GPU passes"},
    KeyBinding{GLFW_KEY_B, false, Action::birds_eye, false, "B", "bird's eye, with boxes"},
    KeyBinding{GLFW_KEY_F11, false, Action::full_screen, false, "F11, Alt+Enter", "full screen"},
    KeyBinding{GLFW_KEY_ENTER, true, Action::full_screen, false, "", ""},
    KeyBinding{GLFW_KEY_P, false, Action::picture, false, "P", "write a picture (PNG)"},
    KeyBinding{GLFW_KEY_V, false, Action::record, false, "V", "start or stop recording"},
    KeyBinding{GLFW_KEY_O, false, Action::next_preset, false, "O", "next preset"},
    KeyBinding{GLFW_KEY_U, false, Action::next_quality, false, "U", "quality: low, medium, high"},
    KeyBinding{GLFW_KEY_M, false, Action::next_mesher, false, "M", "next mesher"},
    KeyBinding{GLFW_KEY_N, false, Action::next_displacement, false, "N", "next displacement"},
    KeyBinding{GLFW_KEY_T, false, Action::next_far_method, false, "T", "next far method"},
    KeyBinding{GLFW_KEY_R, false, Action::next_refinement, false, "R", "next refinement"},
    KeyBinding{GLFW_KEY_COMMA, false, Action::earlier, true, ",", "a quarter of an hour earlier"},
    KeyBinding{GLFW_KEY_PERIOD, false, Action::later, true, ".", "a quarter of an hour later"},
    KeyBinding{GLFW_KEY_G, false, Action::budget, false, "G", "hold the target frame time"},
    KeyBinding{GLFW_KEY_K, false, Action::spray, false, "K", "spray"},
    KeyBinding{GLFW_KEY_J, false, Action::foam_history, false, "J", "foam that stays"},
    KeyBinding{GLFW_KEY_L, false, Action::ships, false, "L", "ships"},
    KeyBinding{GLFW_KEY_1, false, Action::layer, false, "1 to 9", "layers of the sea, by importance"},
    KeyBinding{GLFW_KEY_ESCAPE, false, Action::close, false, "Esc", "end"},
};

constexpr std::array held{
    HeldControl{"W A S D, arrows", "fly"},
    HeldControl{"E Q, Page Up/Down", "up and down"},
    HeldControl{"Shift, Ctrl", "five times as fast, a fifth as fast"},
    HeldControl{"mouse, left or right button", "look"},
    HeldControl{"mouse, middle button", "drag"},
    HeldControl{"wheel", "speed; from above, height"},
    HeldControl{"gamepad", "left stick flies, right looks, triggers up and down, A fast"},
};

}  // namespace

std::span<const KeyBinding> key_bindings() { return bindings; }
std::span<const HeldControl> held_controls() { return held; }

std::optional<KeyPress> key_press_of(int key, int event, int modifiers) {
    if (event == GLFW_RELEASE) return std::nullopt;
    const bool alt = (modifiers & GLFW_MOD_ALT) != 0;
    // With the system's key it is the desktop's; shift and control say how fast one flies.
    if ((modifiers & GLFW_MOD_SUPER) != 0) return std::nullopt;
    if (!alt && event == GLFW_PRESS && key >= GLFW_KEY_1 && key <= GLFW_KEY_9)
        return KeyPress{Action::layer, static_cast<size_t>(key - GLFW_KEY_1)};
    for (const KeyBinding& binding : bindings)
        if (binding.key == key && binding.with_alt == alt && (event == GLFW_PRESS || binding.repeats))
            return KeyPress{binding.action, 0};
    return std::nullopt;
}

std::string_view keys_shown(Action action) {
    for (const KeyBinding& binding : bindings)
        if (binding.action == action) return binding.shown;
    return "";
}

}  // namespace trochoid
