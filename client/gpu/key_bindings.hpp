#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace trochoid {

/// What a key asks for once, when it goes down.
enum class Action : uint8_t {
    close,
    help,
    overlay,
    wireframe,
    boxes,
    rays,
    patches,
    fields,
    freeze,
    timers,
    birds_eye,
    full_screen,
    picture,
    record,
    next_preset,
    next_quality,
    next_mesher,
    next_displacement,
    next_far_method,
    next_refinement,
    earlier,
    later,
    budget,
    spray,
    foam_history,
    ships,
    layer  ///< the number of KeyPress
};

/// An action, and for Action::layer its place in layers_by_importance, from 0.
struct KeyPress {
    Action action = Action::close;
    size_t layer = 0;
    bool operator==(const KeyPress&) const = default;
};

/// A key (GLFW's number: the place on an American keyboard) with what it does, as help and reference show it.
struct KeyBinding {
    int key = 0;
    bool with_alt = false;
    Action action = Action::close;
    bool repeats = false;  ///< goes on while the key is held
    std::string_view shown;
    std::string_view about;
};

/// Every key that has an action, in the order of the help; the digits 1 to 9 switch layers and stand in it once.
std::span<const KeyBinding> key_bindings();

/// What is held rather than pressed: keys of flying, mouse and gamepad, for help and reference.
struct HeldControl {
    std::string_view shown;
    std::string_view about;
};
std::span<const HeldControl> held_controls();

/// What a key event asks for: GLFW's key, action (GLFW_PRESS, GLFW_REPEAT, GLFW_RELEASE) and modifiers.
std::optional<KeyPress> key_press_of(int key, int event, int modifiers);

/// The keys that an action has, as shown: "F11, Alt+Enter".
std::string_view keys_shown(Action action);

}  // namespace trochoid
