// Draws a fixture's sea in a chosen weather at a chosen hour to a PNG file, and the time of each pass:
// look_picture FILE [sea=calm|breeze|gale|storm] [at=X,Z,ALTITUDE,YAW,PITCH] [hour=H] [size=WxH] [frames=N] [step=SECONDS]
//              [far=combined|spectrum|texture] [quality=low|medium|high] [mesher=NAME] [land=0] [spray=0] [foam=0] [lean=1]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <string>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/picture_file.hpp"
#include "client/gpu/renderer.hpp"
#include "tests/gpu/picture_arguments.hpp"
#include "tests/gpu/weather_sea.hpp"

using namespace trochoid;

namespace {

DrawOptions options_of(Arguments& values) {
    DrawOptions options = options_for(quality_named(values["quality"]).value_or(Quality::medium));
    options.far_method = far_method_named(values["far"]).value_or(FarMethod::combined);
    options.mesher = mesher_named(values["mesher"]).value_or(MesherKind::patches);
    if (values.contains("hour")) options.hour = std::atof(values["hour"].c_str());
    options.foam_history = values["foam"] != "0";
    options.spray = values["spray"] != "0";
    options.wireframe = values["wireframe"] == "1";
    options.lean = values["lean"] == "1";
    return options;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 2;
    auto values = arguments(argc, argv);
    const DrawOptions options = options_of(values);
    const Camera camera = camera_of(values);
    const int frames = values.contains("frames") ? std::atoi(values["frames"].c_str()) : 40;
    const double step = values.contains("step") ? std::atof(values["step"].c_str()) : 0.1;
    OffscreenContext context;
    FixtureSource source(values["land"] == "0" ? TerrainGrid{} : shipped_terrain());
    set_weather(source, weather_named(values["sea"]));
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source.set_view(view);
    Renderer renderer;
    RenderTarget target(camera.width, camera.height, options.samples);
    std::map<std::string, double> total;
    FrameReport report;
    int counted = 0;
    for (int i = 0; i < frames; ++i) {
        const auto start = std::chrono::steady_clock::now();
        source.set_time(source.sea_time_now() + static_cast<int64_t>(step * 1e6));
        report = renderer.draw(target, source.snapshot(), camera, camera, options);
        glFinish();
        if (i < 6) continue;
        ++counted;
        for (const PassTime& pass : report.passes) total[pass.name] += pass.ms;
        total["wall"] +=
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
    for (const auto& [name, ms] : total) fmt::print("{} {:.2f}  ", name, ms / std::max(counted, 1));
    fmt::print("ms; {} triangles, {} trains\n", report.sea_triangles, report.trains);
    write_png(argv[1], target.read());
    return 0;
}
