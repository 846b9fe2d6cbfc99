#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "client/scene/draw_options.hpp"

namespace trochoid {

/// What a window keeps from one run to the next.
struct ViewerSettings {
    uint32_t width = 1280;  ///< of the window, the desktop's units
    uint32_t height = 720;
    bool full_screen = false;
    bool numbers = false;  ///< panel shown
    Quality quality = Quality::medium;
    MesherKind mesher = MesherKind::patches;
    FarMethod far_method = FarMethod::combined;
    Refinement refinement = Refinement::distance;
    double target_ms = 0;  ///< frame time to hold, 0: none
    bool operator==(const ViewerSettings&) const = default;
};

/// What a settings file holds, and what was wrong with it.
struct KeptSettings {
    ViewerSettings values;  ///< the defaults where the file has none or a bad one
    std::string complaint;  ///< one sentence, empty: nothing was wrong
};

/// $XDG_CONFIG_HOME/trochoid/viewer.toml, else $HOME/.config/trochoid/viewer.toml; empty where neither is set.
std::filesystem::path settings_file();

/// Reads a file; one that is not there is no complaint. The file is left as it is, whatever it holds.
KeptSettings load_settings(const std::filesystem::path& file);

/// Writes a file beside and moves it into place, so that a reader sees the old one or the new one whole. Throws OperatorError where
/// that fails.
void save_settings(const std::filesystem::path& file, const ViewerSettings& settings);

}  // namespace trochoid
