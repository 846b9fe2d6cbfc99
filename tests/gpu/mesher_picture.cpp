// Draws a fixture's sea by several meshers, one picture below the other, to a PNG file; says what each took:
// mesher_picture FILE [at=X,Z,ALTITUDE,YAW,PITCH] [meshers=patches,projected] [sea=calm|breeze|gale|storm] [size=WxH]
//                [attention=A] [rows=N] [columns=N] [cells=N] [spacing=M] [quality=low|medium|high] [wireframe=1] [bare=1]
//                [land=0] [frames=N] [hour=H] [error=PX] [truth=PX]
// With `truth`, patches that fine come first, four samples a pixel, and each mesher's mean difference from them is printed by
// distance along the sea.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/picture_file.hpp"
#include "client/gpu/renderer.hpp"
#include "tests/gpu/mesher_cases.hpp"
#include "tests/gpu/picture_arguments.hpp"
#include "tests/gpu/weather_sea.hpp"

using namespace trochoid;

namespace {

double number(const Arguments& values, const char* name, double otherwise) {
    const auto at = values.find(name);
    return at == values.end() ? otherwise : std::atof(at->second.c_str());
}

DrawOptions options_of(Arguments& values) {
    DrawOptions options = options_for(quality_named(values["quality"]).value_or(Quality::medium));
    options.attention = static_cast<float>(number(values, "attention", 1));
    options.projected_rows = static_cast<uint32_t>(number(values, "rows", 0));
    options.projected_columns = static_cast<uint32_t>(number(values, "columns", 0));
    options.grid_cells = static_cast<uint32_t>(number(values, "cells", 256));
    options.grid_spacing_m = static_cast<float>(number(values, "spacing", 2));
    options.hour = number(values, "hour", 16.5);
    options.error_px = static_cast<float>(number(values, "error", static_cast<double>(options.error_px)));
    if (values.contains("truth")) options.samples = 4;
    options.wireframe = values["wireframe"] == "1";
    if (values["bare"] == "1") {
        options.sky = options.far_sea = options.land = false;
        options.clear_colour = {1.0F, 0.0F, 1.0F};
    }
    return options;
}

Picture draw(MesherKind kind, FixtureSource& source, const Camera& camera, DrawOptions options, int frames) {
    options.mesher = kind;
    Renderer renderer;
    const RenderTarget target(camera.width, camera.height, options.samples);
    FrameReport report;
    source.set_time({60'000'000});
    double wall = 1e9;
    for (int i = 0; i < frames; ++i) {
        const auto start = std::chrono::steady_clock::now();
        source.set_time(source.sea_time_now() + 100'000);
        report = renderer.draw(target, source.snapshot(), camera, camera, options);
        glFinish();
        wall = std::min(
            wall,
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    fmt::print("{}: {:.1f} ms a picture, {} triangles in {} draws", name_of(kind), wall, report.sea_triangles,
               report.draws);
    for (const PassTime& pass : report.passes) fmt::print(", {} {:.2f} ms", pass.name, pass.ms);
    fmt::print("\n");
    return target.read();
}

/// Mean differences of channels, of 255, in bands between the distances in the table; of the rows next to the horizon, too.
void print_differences(std::string_view name, const Picture& truth, const Picture& picture,
                       const Camera& camera) {
    constexpr std::array edges{0.0, 30.0, 100.0, 300.0, 1'000.0, 3'000.0, 10'000.0, 1e9};
    std::array<double, edges.size()> sums{};
    std::array<double, edges.size()> pixels{};
    const uint32_t column = camera.width / 2;
    for (uint32_t y = 0; y < truth.height; ++y) {
        const double away = water_distance(camera, column, y, 0);
        const auto row_off = [&](int rows) {
            const auto at = static_cast<uint32_t>(
                std::clamp(static_cast<int>(y) + rows, 0, static_cast<int>(truth.height) - 1));
            return water_distance(camera, column, at, 0);
        };
        const bool horizon = (row_off(-6) < 0) != (row_off(6) < 0);
        double sum = 0;
        for (size_t i = size_t{y} * truth.width * 3; i < size_t{y + 1} * truth.width * 3; ++i)
            sum += std::abs(int{truth.rgb[i]} - int{picture.rgb[i]});
        const auto note = [&](size_t band) {
            sums[band] += sum;
            pixels[band] += 3.0 * truth.width;
        };
        if (horizon) note(0);
        if (away >= 0)
            note(static_cast<size_t>(std::upper_bound(edges.begin(), edges.end(), away) - edges.begin()));
    }
    fmt::print("{}: mean difference", name);
    for (size_t i = 1; i < edges.size(); ++i)
        if (pixels[i] > 0) fmt::print(", from {} m {:.2f}", edges[i - 1], sums[i] / pixels[i]);
    fmt::print("; within 6 pixels of the horizon {:.2f}\n", pixels[0] > 0 ? sums[0] / pixels[0] : 0.0);
}

void append(Picture& all, const Picture& one) {
    all.width = one.width;
    all.height += one.height;
    all.rgb.insert(all.rgb.end(), one.rgb.begin(), one.rgb.end());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 2;
    Arguments values = arguments(argc, argv);
    const DrawOptions options = options_of(values);
    const Camera camera = camera_of(values);
    OffscreenContext context;
    FixtureSource source(values["land"] == "0" ? TerrainGrid{} : shipped_terrain());
    if (!values["sea"].empty()) set_weather(source, weather_named(values["sea"]));
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source.set_view(view);
    const int frames = static_cast<int>(number(values, "frames", 4));
    Picture all;
    Picture truth;
    if (values.contains("truth")) {
        DrawOptions fine = options;
        fine.error_px = static_cast<float>(number(values, "truth", 1));
        ViewState close = view;
        close.accepted_error_px = fine.error_px;
        FixtureSource other(values["land"] == "0" ? TerrainGrid{} : shipped_terrain());
        if (!values["sea"].empty()) set_weather(other, weather_named(values["sea"]));
        other.set_view(close);
        truth = draw(MesherKind::patches, other, camera, fine, frames);
        append(all, truth);
    }
    std::istringstream names(values["meshers"].empty() ? "patches,projected" : values["meshers"]);
    for (std::string name; std::getline(names, name, ',');) {
        const auto kind = mesher_named(name);
        if (!kind) return 2;
        const Picture one = draw(*kind, source, camera, options, frames);
        if (!truth.rgb.empty()) print_differences(name, truth, one, camera);
        append(all, one);
    }
    write_png(argv[1], all);
    return 0;
}
