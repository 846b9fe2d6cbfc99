// Draws the fixture's sea to a PNG file: fixture_picture FILE X,Z,ALTITUDE,YAW,PITCH [quality [debug,debug… [frames]]]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/picture_file.hpp"
#include "client/gpu/renderer.hpp"
#include "tests/gpu/fixture_sea.hpp"

using namespace trochoid;

int main(int argc, char** argv) {
    if (argc < 3) return 2;
    double x = 0;
    double z = 0;
    Camera camera;
    double yaw = 0;
    double pitch = 0;
    if (std::sscanf(argv[2], "%lf,%lf,%lf,%lf,%lf", &x, &z, &camera.altitude_m, &yaw, &pitch) != 5) return 2;
    camera.position = {to_lattice(x), to_lattice(z)};
    camera.yaw = yaw / 57.29577951;
    camera.pitch = pitch / 57.29577951;
    DrawOptions options = options_for(quality_named(argc > 3 ? argv[3] : "medium").value_or(Quality::medium));
    const std::string debug = argc > 4 ? argv[4] : "";
    options.wireframe = debug.find("wireframe") != std::string::npos;
    options.boxes = debug.find("boxes") != std::string::npos;
    options.rays = debug.find("rays") != std::string::npos;
    options.patches = debug.find("patches") != std::string::npos;
    options.fields = debug.find("fields") != std::string::npos;
    options.sky = debug.find("nosky") == std::string::npos;
    options.far_sea = debug.find("nofar") == std::string::npos;
    options.land = debug.find("noland") == std::string::npos;
    if (debug.find("magenta") != std::string::npos) options.clear_colour = {1.0F, 0.0F, 1.0F};
    if (debug.find("tiny") != std::string::npos) camera.width = 64, camera.height = 36;
    OffscreenContext context;
    FixtureSource source(shipped_terrain());
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source.set_view(view);
    source.request_rays({1});
    Renderer renderer;
    RenderTarget target(camera.width, camera.height, options.samples);
    std::vector<double> times;
    FrameReport report;
    const int frames = argc > 5 ? std::atoi(argv[5]) : 9;
    for (int i = 0; i < frames; ++i) {
        const auto start = std::chrono::steady_clock::now();
        source.set_time(source.sea_time_now() + 100'000);
        report = renderer.draw(target, source.snapshot(), camera, camera, options);
        glFinish();
        times.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(times.begin(), times.end());
    fmt::print(
        "{}: {:.1f} ms a picture, cpu {:.2f} ms, patches {}/{}, draws {}, sea triangles {}, land triangles {}, trains {}, vertex angle 1/{:.0f}\n",
        describe_gl(), times[times.size() / 2], report.cpu_ms, report.patches_drawn, report.patches_known,
        report.draws, report.sea_triangles, report.land_triangles, report.trains, 1.0F / report.vertex_angle);
    write_png(argv[1], target.read());
    return 0;
}
