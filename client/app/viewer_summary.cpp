#include "client/app/viewer_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/scene/layer_names.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

nlohmann::ordered_json choices_of(const ViewerSummary& s) {
    std::vector<std::string> layers;
    for (const NamedLayer& l : layers_by_importance)
        if (s.options.layers.has(l.layer)) layers.emplace_back(l.name);
    return {
        {"quality", name_of(s.quality)},
        {"preset", s.preset},
        {"mesher", name_of(s.options.mesher)},
        {"refine", name_of(refinement_in_force(s.options))},
        {"detail", s.options.lean ? "lean" : "full"},
        {"displacement", name_of(s.options.displacement)},
        {"far", name_of(s.options.far_method)},
        {"hour", s.options.hour},
        {"error_px", s.options.error_px},
        {"samples", s.options.samples},
        {"scale", s.options.render_scale},
        {"layers", layers},
    };
}

nlohmann::ordered_json budget_of(const BudgetReport& b) {
    std::vector<std::string> given;
    for (const Sacrifice what : b.given_up) given.emplace_back(name_of(what));
    return {
        {"target_ms", b.target_ms},    {"takes_ms", b.load_ms},
        {"state", name_of(b.verdict)}, {"mesh_coarser_by", b.error_factor},
        {"given_up", given},           {"left_to_give_up", b.left_to_give},
        {"changes", b.changes},
    };
}

nlohmann::ordered_json trains_of(const TrainAccount& t) {
    return {
        {"shown", t.shown},
        {"known", t.known},
        {"at_most_lost_m", t.lost_m},
        {"best_choice_loses_m", t.best_lost_m},
        {"best_choice_proven", t.best_proven},
        {"not_sent_m", t.server_left_out_m},
    };
}

}  // namespace

std::string summary_line(const ViewerSummary& s) {
    return fmt::format(
        "{:.1f} frames/s (median of {}), {} patches drawn of {}, {} wave trains in {} boxes, {} bytes received, {} viewer",
        s.median_fps, s.frames, s.last.patches_drawn, s.last.patches_known, s.last.trains, s.last.boxes,
        s.source.bytes_received,
        s.source.fidelity == Fidelity::unknown ? "not compared" : name_of(s.source.fidelity));
}

void write_summary(const std::string& path, const ViewerSummary& s) {
    nlohmann::ordered_json json{
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
        {"desyncs", s.source.desyncs},
        {"log_position", s.source.log_position},
        {"connected", s.source.connected},
        {"server", s.source.server_version},
        {"sea_time_us", s.sea_time.us},
        {"gl", s.gl},
        {"options", choices_of(s)},
        {"pass_ms", s.median_pass_ms},
        {"passes_waited_for", s.last.passes_waited},
        {"recorded_pictures", s.recorded_pictures},
    };
    if (s.budget) json["budget"] = budget_of(*s.budget);
    if (s.trains) json["trains_at_camera"] = trains_of(*s.trains);
    std::ofstream file(path);
    file << json.dump(2) << '\n';
    file.flush();
    if (!file)
        throw OperatorError(
            fmt::format("Cannot write the summary {}. Name a file in a folder that you may write to.", path));
}

}  // namespace trochoid
