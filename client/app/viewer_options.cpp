#include "client/app/viewer_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "client/app/login_options.hpp"
#include "client/app/viewer_presets.hpp"
#include "client/app/viewer_words.hpp"
#include "client/gpu/key_bindings.hpp"
#include "client/net/endpoint.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

/// As given, before it means anything; empty and none: not named.
struct Words {
    std::string size;
    std::string camera;
    std::string preset;
    std::string quality;
    std::string mesher;
    std::string displacement;
    std::string far_method;
    std::string refinement;
    std::string grid;
    std::string projected;
    std::string hour;
    std::string layers;
    std::string debug;
    std::optional<double> error_px;
    std::optional<uint32_t> samples;
    std::optional<float> scale;
    std::optional<float> attention;
    std::optional<uint32_t> most_triangles;
    std::optional<double> target_ms;
    std::optional<double> target_fps;
    bool coherent_land = false;
    bool no_land = false;
    bool no_far_sea = false;
    bool no_sky = false;
    bool no_ships = false;
    bool no_spray = false;
    bool no_foam_history = false;
    std::string detail;
    bool time_passes = false;
    bool no_settings = false;
    bool list_presets = false;
};

void describe_connection(CLI::App& app, ViewerOptions& options) {
    app.add_option("--connect", options.connect, connect_help)->capture_default_str()->group("Server");
    app.add_option("--ca", options.ca_file, ca_help)->check(CLI::ExistingFile)->group("Server");
    describe_login(app, options.login, "Server");
    app.add_option("--patience", options.patience_s,
                   "Offscreen: seconds to wait for the first sea, or for a server that is gone")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1e6))
        ->group("Server");
}

void describe_run(CLI::App& app, ViewerOptions& options, Words& words) {
    const char* group = "Window and run";
    app.add_flag("--offscreen", options.offscreen, "Draw without a window or display")->group(group);
    app.add_flag("--full-screen", options.full_screen, "Start in full screen")->group(group);
    app.add_option("--size", words.size, "Picture size, WIDTHxHEIGHT (1280x720)")->group(group);
    app.add_option("--text-scale", options.text_scale,
                   "Size of the overlay's text (0: as the display is dense)")
        ->check(CLI::Range(0.0, 8.0))
        ->group(group);
    app.add_flag("--no-settings", words.no_settings, "Neither take nor keep the window's settings")
        ->group(group);
    app.add_option("--seconds", options.seconds,
                   "Run this long once the sea is there (0: until closed; offscreen 5)")
        ->check(CLI::Range(0.0, 1e6))
        ->group(group);
    app.add_option("--frames", options.frames, "End after so many frames")
        ->check(CLI::Range(0.0, 1e15))
        ->group(group);
    app.add_option("--at", options.at_s, "Show this sea time, seconds, instead of the server's")
        ->check(CLI::Range(-1e12, 1e12))
        ->group(group);
    app.add_option("--fixed-step", options.fixed_step_s,
                   "Each frame is this many seconds of sea time later, however long it took")
        ->check(CLI::Range(0.0, 3600.0))
        ->group(group);
}

void describe_files(CLI::App& app, ViewerOptions& options) {
    const char* group = "Files";
    app.add_option("--picture", options.picture, "Write the last frame to this PNG file")->group(group);
    app.add_option("--second-picture", options.second_picture,
                   "Write a second PNG file, later: the sea has moved")
        ->group(group);
    app.add_option("--second-picture-after", options.second_picture_after, "Seconds between both pictures")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1e6))
        ->group(group);
    app.add_option(
           "--record", options.record,
           "Record: a new folder gets PNG files, a name ending in .mp4, .mkv or .webm a video (needs ffmpeg)")
        ->group(group);
    app.add_option("--summary-json", options.summary_json, "Write the summary to this JSON file")
        ->group(group);
}

void describe_view(CLI::App& app, ViewerOptions& options, Words& words) {
    const char* group = "View";
    app.add_option("--preset", words.preset, "Camera, light and quality for a scene: " + preset_names())
        ->group(group);
    app.add_flag("--list-presets", words.list_presets, "Print the presets with their scenes, and end")
        ->group(group);
    app.add_option("--camera", words.camera,
                   "X,Y,Z,YAW,PITCH: metres east, up, south; degrees clockwise from north, upwards")
        ->group(group);
    app.add_flag("--birds-eye", options.birds_eye,
                 "Look straight down from high above the camera's place, with boxes")
        ->group(group);
    app.add_flag("--freeze", options.freeze, "The culling camera stays where the viewer starts")
        ->group(group);
    app.add_option("--hour", words.hour, "Time of day of the light, 0 to 24, as in 16.5 or 16:30")
        ->group(group);
    app.add_flag("--overlay", options.panels.numbers, "Show the numbers")->group(group);
    app.add_flag("--timers", options.panels.timers, "Show the frame graph and the GPU's passes")
        ->group(group);
    app.add_flag("--time-passes", words.time_passes,
                 "Wait for each pass, so that its time is right where the processor draws, too; slower")
        ->group(group);
    app.add_flag("--keys", options.panels.help, "Show the keys")->group(group);
    app.add_option("--debug", words.debug, "Debug views: wireframe,boxes,rays,patches,fields")->group(group);
}

void describe_picture(CLI::App& app, Words& words) {
    const char* group = "Picture";
    app.add_option("--quality", words.quality, "low, medium or high (medium)")->group(group);
    app.add_option("--detail", words.detail, "full or lean; auto is lean where the processor draws (auto)")
        ->group(group);
    app.add_option("--error-px", words.error_px,
                   "Height error that the mesh may show, pixels, instead of the quality's")
        ->check(CLI::Range(0.25, 100.0))
        ->group(group);
    app.add_option("--samples", words.samples, "Samples a pixel, 1 to 16, instead of the quality's")
        ->check(CLI::Range(1, 16))
        ->group(group);
    app.add_option("--scale", words.scale, "Draw this share of width and height and enlarge it, 0.25 to 1")
        ->check(CLI::Range(0.25, 1.0))
        ->group(group);
    app.add_option("--target-ms", words.target_ms,
                   "Hold this frame time: give up fineness, then layers, and take them back")
        ->check(CLI::Range(0.5, 10'000.0))
        ->group(group);
    app.add_option("--target-fps", words.target_fps, "The same as frames a second")
        ->check(CLI::Range(0.1, 2'000.0))
        ->group(group);
    app.add_option(
           "--layers", words.layers,
           "What the sea is made of: trains,shelter,refraction,wakes,irregular,orbits,round,noise,capillary; "
           "all, none, authoritative; -NAME leaves one out (all)")
        ->group(group);
    app.add_flag("--no-land", words.no_land, "Leave out the land")->group(group);
    app.add_flag("--no-far-sea", words.no_far_sea, "Leave out the sea beyond the patches")->group(group);
    app.add_flag("--no-sky", words.no_sky, "Leave out the sky")->group(group);
    app.add_flag("--no-ships", words.no_ships, "Leave out the ships")->group(group);
    app.add_flag("--no-spray", words.no_spray, "Leave out the spray")->group(group);
    app.add_flag("--no-foam-history", words.no_foam_history, "Foam only where crests break, none that stays")
        ->group(group);
}

void describe_methods(CLI::App& app, Words& words) {
    const char* group = "Methods";
    app.add_option("--mesher", words.mesher, "patches, uniform, projected or coherent (patches)")
        ->group(group);
    app.add_option("--refine", words.refinement, "Meshers refine by distance, screen or frustum (distance)")
        ->group(group);
    app.add_option("--displacement", words.displacement, "trains, noise or fft (trains)")->group(group);
    app.add_option("--far", words.far_method, "Near and far: combined, spectrum or texture (combined)")
        ->group(group);
    app.add_option("--grid", words.grid, "uniform: CELLSxSPACING, cells a side and their metres (256x2)")
        ->group(group);
    app.add_option("--projected", words.projected, "projected: ROWSxCOLUMNS (as the error wants)")
        ->group(group);
    app.add_option("--attention", words.attention,
                   "projected: rows to the foreground (above 1) or the background, 0.25 to 4 (1)")
        ->check(CLI::Range(0.25, 4.0))
        ->group(group);
    app.add_option("--most-triangles", words.most_triangles,
                   "coherent: beyond, the whole mesh is coarser (2000000)")
        ->check(CLI::Range(4096, 100'000'000))
        ->group(group);
    app.add_flag("--coherent-land", words.coherent_land, "Land by the coherent mesher too")->group(group);
}

std::string footer() {
    std::string text = "Keys:\n";
    for (const KeyBinding& binding : key_bindings())
        if (!binding.shown.empty()) text += fmt::format("  {:<16} {}\n", binding.shown, binding.about);
    for (const HeldControl& control : held_controls())
        text += fmt::format("  {:<28} {}\n", control.shown, control.about);
    return text +
           "\nExit: 0 all went well, 1 the server is gone, 2 bad options or files, 3 the graphics driver failed.";
}

void describe(CLI::App& app, ViewerOptions& options, Words& words) {
    app.set_version_flag("--version", version_text("trochoid-viewer"));
    describe_connection(app, options);
    describe_run(app, options, words);
    describe_view(app, options, words);
    describe_picture(app, words);
    describe_methods(app, words);
    describe_files(app, options);
    app.footer(footer());
}

/// What the last window left, for a new window.
void take_over(const ViewerSettings& kept, ViewerOptions& options) {
    options.camera.width = kept.width;
    options.camera.height = kept.height;
    options.full_screen = options.full_screen || kept.full_screen;
    options.panels.numbers = options.panels.numbers || kept.numbers;
    options.quality = kept.quality;
    options.draw = options_for(kept.quality);
    options.draw.mesher = kept.mesher;
    options.draw.far_method = kept.far_method;
    options.draw.refinement = kept.refinement;
    options.target_ms = kept.target_ms;
}

void take_over(const Words& words, DrawOptions& draw) {
    if (words.error_px) draw.error_px = static_cast<float>(*words.error_px);
    if (words.samples) draw.samples = *words.samples;
    if (words.scale) draw.render_scale = *words.scale;
    if (!words.layers.empty()) draw.layers = layers_of(words.layers);
    if (!words.mesher.empty()) draw.mesher = mesher_of(words.mesher);
    if (!words.refinement.empty()) draw.refinement = refinement_of(words.refinement);
    if (!words.displacement.empty()) draw.displacement = displacement_of(words.displacement);
    if (!words.far_method.empty()) draw.far_method = far_method_of(words.far_method);
    if (!words.grid.empty()) set_grid(words.grid, draw);
    if (!words.projected.empty()) set_projected(words.projected, draw);
    if (words.attention) draw.attention = *words.attention;
    if (words.most_triangles) draw.most_triangles = *words.most_triangles;
    if (!words.hour.empty()) draw.hour = hour_of(words.hour);
    draw.coherent_land = words.coherent_land;
    draw.time_passes = words.time_passes;
    draw.land = !words.no_land;
    draw.far_sea = !words.no_far_sea;
    draw.sky = !words.no_sky;
    if (words.no_ships) draw.ships = false;
    if (words.no_spray) draw.spray = false;
    if (words.no_foam_history) draw.foam_history = false;
    set_debug(words.debug, draw);
}

void take_over(const Words& words, ViewerOptions& options) {
    if (!words.preset.empty()) take_preset(words.preset, options);
    if (!words.size.empty()) set_size(words.size, options.camera);
    if (!words.camera.empty()) set_place(words.camera, options.camera);
    if (!words.quality.empty()) {
        options.quality = quality_of(words.quality);
        set_quality(options.draw, options.quality);
    }
    if (!words.detail.empty()) options.lean = lean_of(words.detail);
    take_over(words, options.draw);
    if (words.target_ms && words.target_fps)
        throw OperatorError("--target-ms and --target-fps say the same thing: give one of them.");
    if (words.target_ms) options.target_ms = *words.target_ms;
    if (words.target_fps) options.target_ms = 1e3 / *words.target_fps;
}

void check(const ViewerOptions& options) {
    for (const double value : {options.seconds, options.patience_s, options.second_picture_after,
                               options.fixed_step_s, options.at_s.value_or(0.0)})
        if (!std::isfinite(value))
            throw OperatorError("options want finite numbers (see trochoid-viewer --help)");
    if (!options.second_picture.empty() && options.seconds == 0 && options.frames == 0)
        throw OperatorError(
            "--second-picture needs --seconds or --frames: the first picture is taken when they are over.");
    if (options.full_screen && options.offscreen)
        throw OperatorError("--full-screen is for a window: leave out --offscreen or it.");
}

}  // namespace

std::optional<ViewerOptions> parse_viewer_options(int argc, const char* const* argv,
                                                  const ViewerSettings& kept) {
    ViewerOptions options;
    Words words;
    CLI::App app("Shows a running Trochoid sea, in a window or as a picture.", "trochoid-viewer");
    describe(app, options, words);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& answered) {
        app.exit(answered);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw OperatorError(fmt::format("{} (see trochoid-viewer --help)", error.what()));
    }
    if (words.list_presets) {
        fmt::print("{}", preset_list());
        return std::nullopt;
    }
    options.keeps_settings = !words.no_settings && !options.offscreen;
    if (options.keeps_settings) take_over(kept, options);
    take_over(words, options);
    if (options.offscreen && options.seconds == 0 && options.frames == 0) options.seconds = 5;
    check(options);
    return options;
}

std::string viewer_help() {
    ViewerOptions options;
    Words words;
    CLI::App app("Shows a running Trochoid sea, in a window or as a picture.", "trochoid-viewer");
    describe(app, options, words);
    return app.help();
}

}  // namespace trochoid
