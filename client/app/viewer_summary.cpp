#include "client/app/viewer_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::string summary_line(const ViewerSummary& s) {
    return fmt::format(
        "{:.1f} frames/s (median of {}), {} patches drawn of {}, {} wave trains in {} boxes, {} bytes received, {} viewer",
        s.median_fps, s.frames, s.last.patches_drawn, s.last.patches_known, s.last.trains, s.last.boxes,
        s.source.bytes_received,
        s.source.fidelity == Fidelity::unknown ? "not compared" : name_of(s.source.fidelity));
}

void write_summary(const std::string& path, const ViewerSummary& s) {
    const nlohmann::ordered_json json{
        {"frames_per_second", s.median_fps},
        {"frames", s.frames},
        {"cpu_ms", s.median_cpu_ms},
        {"gpu_ms", s.median_gpu_ms},
        {"patches_known", s.last.patches_known},
        {"patches_drawn", s.last.patches_drawn},
        {"draws", s.last.draws},
        {"sea_triangles", s.last.sea_triangles},
        {"land_triangles", s.last.land_triangles},
        {"boxes", s.last.boxes},
        {"wave_trains", s.last.trains},
        {"land_blocks", s.last.land_blocks},
        {"land_blocks_left_out", s.last.land_blocks_left_out},
        {"bytes_received", s.source.bytes_received},
        {"bytes_per_second", s.source.bytes_per_second},
        {"clock_error_ms", s.source.clock_error_ms},
        {"viewer", name_of(s.source.fidelity)},
        {"results", s.source.deltas},
        {"resyncs", s.source.resyncs},
        {"log_position", s.source.log_position},
        {"connected", s.source.connected},
        {"server", s.source.server_version},
        {"sea_time_us", s.sea_time.us},
        {"gl", s.gl},
    };
    std::ofstream file(path);
    file << json.dump(2) << '\n';
    file.flush();
    if (!file)
        throw OperatorError(
            fmt::format("Cannot write the summary {}. Name a file in a folder that you may write to.", path));
}

}  // namespace trochoid
