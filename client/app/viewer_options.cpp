#include "client/app/viewer_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>

#include "client/scene/layer_names.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

constexpr double radians_per_degree = 0.017453292519943295;

void set_size(const std::string& text, Camera& camera) {
    unsigned width = 0;
    unsigned height = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%ux%u%c", &width, &height, &rest) != 2 || width < 16 || height < 16 ||
        width > 8192 || height > 8192)
        throw OperatorError(
            fmt::format("--size {}: give WIDTHxHEIGHT in pixels, each 16 to 8192, as in 1280x720.", text));
    camera.width = width;
    camera.height = height;
}

void set_place(const std::string& text, Camera& camera) {
    std::array<double, 5> v{};
    char rest = 0;
    const int count =
        std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf%c", &v[0], &v[1], &v[2], &v[3], &v[4], &rest);
    const double bound = to_metres(world_bound);
    bool good = count == 5;
    for (const double value : v) good = good && std::isfinite(value);
    if (!good || std::abs(v[0]) > bound || std::abs(v[2]) > bound || std::abs(v[4]) > 89.0)
        throw OperatorError(fmt::format(
            "--camera {}: give X,Y,Z,YAW,PITCH: metres east, up and south, degrees clockwise from north and upwards "
            "(±89), as in 0,30,-2000,180,-5.",
            text));
    camera.position = {};
    move(camera, v[0], v[1] - camera.altitude_m, v[2]);
    camera.yaw = std::remainder(v[3], 360.0) * radians_per_degree;
    camera.pitch = v[4] * radians_per_degree;
}

void set_debug(const std::string& text, DrawOptions& options) {
    if (text.empty()) return;
    for (const std::string& name : CLI::detail::split(text, ',')) {
        if (name == "wireframe")
            options.wireframe = true;
        else if (name == "boxes")
            options.boxes = true;
        else if (name == "rays")
            options.rays = true;
        else if (name == "patches")
            options.patches = true;
        else if (name == "fields")
            options.fields = true;
        else
            throw OperatorError(
                fmt::format("--debug {}: there are wireframe, boxes, rays, patches and fields.", name));
    }
}

Layers layers_of(const std::string& text) {
    const auto layers = layers_named(text);
    if (layers) return *layers;
    std::string names;
    for (const NamedLayer& l : layers_by_importance) names += fmt::format("{}, ", l.name);
    throw OperatorError(fmt::format(
        "--layers {}: there are {}and all, none and authoritative; -NAME leaves one out, as in -noise.", text,
        names));
}

/// Texts as given, before they mean anything.
struct Texts {
    std::string size = "1280x720";
    std::string camera;
    std::string debug;
    std::string layers = "all";
    std::string quality = "medium";
};

void describe(CLI::App& app, ViewerOptions& options, Texts& texts) {
    app.add_option("--connect", options.connect, "Server, HOST:PORT")->capture_default_str();
    app.add_option("--token", options.token, "Token to log in with; without one a plain viewer");
    app.add_flag("--offscreen", options.offscreen, "Draw without a window or display");
    app.add_option("--seconds", options.seconds,
                   "Run this long once the sea is there (0: until closed; offscreen 5)")
        ->check(CLI::Range(0.0, 1e6));
    app.add_option("--patience", options.patience_s, "Offscreen: seconds to wait for the first sea")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1e6));
    app.add_option("--picture", options.picture, "Write the last frame to this PNG file");
    app.add_option("--second-picture", options.second_picture,
                   "Write a second PNG file, later: the sea has moved");
    app.add_option("--second-picture-after", options.second_picture_after, "Seconds between both pictures")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1e6));
    app.add_option("--size", texts.size, "Picture size, WIDTHxHEIGHT")->capture_default_str();
    app.add_option("--camera", texts.camera,
                   "X,Y,Z,YAW,PITCH: metres east, up, south; degrees clockwise from north, upwards");
    app.add_option("--quality", texts.quality, "low, medium or high")->capture_default_str();
    app.add_option("--debug", texts.debug, "Debug views: wireframe,boxes,rays,patches,fields");
    app.add_option(
           "--layers", texts.layers,
           "What the sea is made of: trains,shelter,refraction,wakes,irregular,orbits,round,noise,capillary; "
           "all, none, authoritative; -NAME leaves one out")
        ->capture_default_str();
    app.add_flag("--overlay", options.overlay, "Start with the numbers shown");
    app.add_option("--summary-json", options.summary_json, "Write the summary to this JSON file");
    app.footer(
        "Keys: WASD or arrows fly, Q and E down and up, shift faster, wheel changes the speed, mouse with a button held looks,\n"
        "F1 numbers, F2 wireframe, F3 wave train boxes, F4 wave rays, F5 patches, F6 land fields, F7 freeze the culling camera, Esc ends.\n"
        "1 to 9 switch the layers of the sea, in order of importance.");
}

}  // namespace

std::optional<ViewerOptions> parse_viewer_options(int argc, const char* const* argv) {
    ViewerOptions options;
    Texts texts;
    CLI::App app("Shows a running Trochoid sea, in a window or as a picture.", "trochoid-viewer");
    app.set_version_flag("--version", version_text("trochoid-viewer"));
    describe(app, options, texts);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& answered) {
        app.exit(answered);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw OperatorError(fmt::format("{} (see trochoid-viewer --help)", error.what()));
    }
    for (const double value : {options.seconds, options.patience_s, options.second_picture_after})
        if (!std::isfinite(value))
            throw OperatorError("options want finite numbers (see trochoid-viewer --help)");
    set_size(texts.size, options.camera);
    if (!texts.camera.empty()) set_place(texts.camera, options.camera);
    set_debug(texts.debug, options.debug);
    options.layers = layers_of(texts.layers);
    const auto quality = quality_named(texts.quality);
    if (!quality)
        throw OperatorError(fmt::format("--quality {}: there are low, medium and high.", texts.quality));
    options.quality = *quality;
    if (options.offscreen && options.seconds == 0) options.seconds = 5;
    if (!options.second_picture.empty() && options.seconds == 0)
        throw OperatorError(
            "--second-picture needs --seconds: the first picture is taken when they are over.");
    return options;
}

DrawOptions draw_options_of(const ViewerOptions& options) {
    DrawOptions draw = options_for(options.quality);
    draw.wireframe = options.debug.wireframe;
    draw.boxes = options.debug.boxes;
    draw.rays = options.debug.rays;
    draw.patches = options.debug.patches;
    draw.fields = options.debug.fields;
    draw.layers = options.layers;
    return draw;
}

}  // namespace trochoid
