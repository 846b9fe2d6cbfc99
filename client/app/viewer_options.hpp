#pragma once
#include <optional>
#include <string>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"

namespace trochoid {

/// What the operator of trochoid-viewer asks for.
struct ViewerOptions {
    std::string connect = "127.0.0.1:7421";  ///< HOST:PORT
    std::string token;                       ///< empty: viewer
    bool offscreen = false;
    double seconds = 0;                 ///< 0: a window runs until it is closed, offscreen 5 s
    double patience_s = 30;             ///< offscreen: how long to wait for the first sea
    std::string picture;                ///< PNG file written at the end
    std::string second_picture;         ///< PNG file written `second_picture_after` later
    double second_picture_after = 1.0;  ///< seconds
    std::string summary_json;
    Camera camera;
    Quality quality = Quality::medium;
    DrawOptions debug;  ///< only the debug views of it count
    Layers layers = displayed_layers;
    bool overlay = false;
    bool operator==(const ViewerOptions&) const = default;
};

/// Reads the command line; nothing where --help or --version has been answered. Throws OperatorError where it makes no sense.
std::optional<ViewerOptions> parse_viewer_options(int argc, const char* const* argv);

/// Options of the picture: the quality's, with the debug views asked for.
DrawOptions draw_options_of(const ViewerOptions& options);

}  // namespace trochoid
