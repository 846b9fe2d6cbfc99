#include "client/app/viewer_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "client/scene/layer_names.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr double radians_per_degree = 0.017453292519943295;

template <class T>
T named(std::optional<T> found, const char* option, const std::string& text, const char* names) {
    if (!found) throw OperatorError(fmt::format("{} {}: there are {}.", option, text, names));
    return *found;
}

}  // namespace

void set_size(const std::string& text, Camera& camera) {
    unsigned width = 0;
    unsigned height = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%ux%u%c", &width, &height, &rest) != 2 ||
        std::min(width, height) < fewest_pixels || std::max(width, height) > most_pixels)
        throw OperatorError(
            fmt::format("--size {}: give WIDTHxHEIGHT in pixels, each {} to {}, as in 1280x720.", text,
                        fewest_pixels, most_pixels));
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
    if (v[1] < lowest_altitude_m || v[1] > highest_altitude_m)
        throw OperatorError(fmt::format(
            "--camera {}: the height, {:g} m, is not within {:g} to {:g} m above still water (--birds-eye "
            "looks down from higher).",
            text, v[1], lowest_altitude_m, highest_altitude_m));
    camera.position = {};
    camera.fraction_x = camera.fraction_z = 0;
    move(camera, v[0], v[1] - camera.altitude_m, v[2]);
    camera.yaw = std::remainder(v[3], 360.0) * radians_per_degree;
    camera.pitch = v[4] * radians_per_degree;
}

void set_debug(const std::string& text, DrawOptions& options) {
    for (size_t from = 0; from < text.size();) {
        const size_t comma = std::min(text.find(',', from), text.size());
        const std::string name = text.substr(from, comma - from);
        from = comma + 1;
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

void set_grid(const std::string& text, DrawOptions& options) {
    unsigned cells = 0;
    double spacing = 0;
    char rest = 0;
    int exponent = 0;
    const bool read = std::sscanf(text.c_str(), "%ux%lf%c", &cells, &spacing, &rest) == 2;
    if (!read || cells == 0 || cells % grid_cells_step != 0 || cells > 1024 ||
        std::frexp(spacing, &exponent) != 0.5 || spacing < 0.0625 || spacing > 64.0)
        throw OperatorError(fmt::format(
            "--grid {}: give CELLSxSPACING: cells along a side, a multiple of {} up to 1024, and their length, a power "
            "of two from 0.0625 to 64 m, as in 256x2.",
            text, grid_cells_step));
    options.grid_cells = cells;
    options.grid_spacing_m = static_cast<float>(spacing);
}

void set_projected(const std::string& text, DrawOptions& options) {
    unsigned rows = 0;
    unsigned columns = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%ux%u%c", &rows, &columns, &rest) != 2 || rows < 2 || rows > 512 ||
        columns < 2 || columns > 512)
        throw OperatorError(fmt::format(
            "--projected {}: give ROWSxCOLUMNS of the grid on the screen, each 2 to 512, as in 100x160.",
            text));
    options.projected_rows = rows;
    options.projected_columns = columns;
}

double hour_of(const std::string& text) {
    int hours = 0;
    int minutes = 0;
    double decimal = 0;
    char rest = 0;
    double hour = -1;
    if (std::sscanf(text.c_str(), "%d:%2d%c", &hours, &minutes, &rest) == 2 && hours >= 0 && minutes >= 0 &&
        minutes < 60)
        hour = hours + minutes / 60.0;
    else if (std::sscanf(text.c_str(), "%lf%c", &decimal, &rest) == 1)
        hour = decimal;
    if (!std::isfinite(hour) || hour < 0 || hour > 24)
        throw OperatorError(
            fmt::format("--hour {}: give the time of day, 0 to 24, as in 16.5 or 16:30.", text));
    return hour;
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

Quality quality_of(const std::string& text) {
    return named(quality_named(text), "--quality", text, "low, medium and high");
}
MesherKind mesher_of(const std::string& text) {
    return named(mesher_named(text), "--mesher", text, "patches, uniform, projected and coherent");
}
Displacement displacement_of(const std::string& text) {
    return named(displacement_named(text), "--displacement", text, "trains, noise and fft");
}
std::optional<bool> lean_of(const std::string& text) {
    if (text == "auto") return std::nullopt;
    if (text == "full" || text == "lean") return text == "lean";
    throw OperatorError(fmt::format("--detail {}: give full, lean or auto.", text));
}

FarMethod far_method_of(const std::string& text) {
    return named(far_method_named(text), "--far", text, "combined, spectrum and texture");
}
Refinement refinement_of(const std::string& text) {
    return named(refinement_named(text), "--refine", text, "distance, screen and frustum");
}

}  // namespace trochoid
