#pragma once
#include <optional>
#include <string>

#include "client/app/viewer_settings.hpp"
#include "client/gpu/overlay_content.hpp"
#include "client/net/token_source.hpp"
#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"

namespace trochoid {

/// What the operator of trochoid-viewer asks for.
struct ViewerOptions {
    std::string connect = "127.0.0.1:7421";  ///< as parse_endpoint takes it
    std::string ca_file;                     ///< certificates to trust, PEM; empty: the system's
    TokenWords login;                        ///< empty: a viewer without a token

    bool offscreen = false;
    bool full_screen = false;
    bool keeps_settings = true;  ///< a window takes what the last one had, and leaves its own
    float text_scale = 0.0F;     ///< 0: as dense as the display

    double seconds =
        0;  ///< 0: a window runs until it is closed, offscreen 5 s; of sea time where that has a fixed step
    uint64_t frames = 0;     ///< end after so many, 0: no such end
    double patience_s = 30;  ///< offscreen: how long to wait for the first sea, or for a server that is gone
    std::optional<double> at_s;  ///< show this sea time, seconds; else the server's
    double fixed_step_s = 0;     ///< each picture is this much later, whatever it took; 0: the server's clock

    std::string picture;                ///< PNG file written at the end
    std::string second_picture;         ///< PNG file written `second_picture_after` later
    double second_picture_after = 1.0;  ///< seconds
    std::string record;                 ///< folder or video file, empty: no recording from the start
    std::string summary_json;

    Camera camera;
    bool birds_eye = false;
    bool freeze = false;  ///< the culling camera stays where the viewer starts
    std::string preset;   ///< empty: none
    Quality quality = Quality::medium;
    DrawOptions draw = options_for(Quality::medium);
    std::optional<bool> lean;  ///< DrawOptions::lean; else where the processor draws
    double target_ms = 0;      ///< frame time that the controller holds, 0: no controller
    OverlayPanels panels;
    bool operator==(const ViewerOptions&) const = default;
};

/// Reads the command line; nothing where --help, --version or --list-presets has been answered. What is not named is as `kept` has it where a window
/// opens, else as it comes. Throws OperatorError where it makes no sense.
std::optional<ViewerOptions> parse_viewer_options(int argc, const char* const* argv,
                                                  const ViewerSettings& kept = {});

/// What --help prints.
std::string viewer_help();

}  // namespace trochoid
