#include "tests/gpu/sea_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "client/gpu/offscreen_context.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {

Sea sea_of(const InterestState& state) {
    std::map<FieldId, std::shared_ptr<LandField>> fields;
    for (const auto& [key, entry] : state.blocks) {
        auto& field = fields[entry.field];
        if (!field) field = std::make_shared<LandField>(entry.field, entry.step_log2);
        field->set(entry.block);
    }
    std::vector<std::shared_ptr<const LandField>> list;
    list.reserve(fields.size());
    for (const auto& [id, field] : fields) list.push_back(field);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, box] : state.boxes) boxes.push_back(prepare(*box, list));
    return Sea(std::move(boxes));
}

namespace {

/// Phases of a box's trains with all that shifts them.
void add_trains(uint32_t& digest, const LiveBox& live, LatticePoint p, Layers layers) {
    const PreparedBox& box = *live.box;
    const int64_t v = box_position(box.record, live.instant, p).v;
    for (size_t i = 0; i < box.record.trains.size(); ++i) {
        const int16_t field = box.field_of_train[i];
        uint32_t shift = 0;
        if (field >= 0 && layers.has(Layer::refraction))
            shift = box.fields[static_cast<size_t>(field)]->sample(p).shift;
        if (box.record.roundness != 0 && layers.has(Layer::round))
            shift += round_shift(box.record.roundness, box.constants[i].whole, box.record.width, v).shift;
        digest =
            (digest ^ (phase_from_place(box.record.trains[i], p.x, p.z) + live.phase[i] + shift)) * 16777619U;
    }
}

/// The digest of sea.glsl over the CPU's phases.
uint32_t phases_of(const SeaInstant& sea, LatticePoint p) {
    uint32_t digest = 2166136261U;
    for (const LiveBox& live : sea.live()) {
        const WaveTrainBox& box = live.box->record;
        if (envelope_at(box, live.instant, p).gain == 0) continue;
        if (sea.layers().has(Layer::trains)) add_trains(digest, live, p, sea.layers());
        if (!has_wake(box.wake) || !sea.layers().has(Layer::wakes)) continue;
        const BoxPosition at = box_position(box, live.instant, p);
        const WakeSample w = wake_at(box.wake, box.length - at.u, at.v - box.width / 2,
                                     live.instant.wake_rear, live.instant.wake_front);
        if (box.wake.transverse != 0.0F && w.transverse.gain != 0)
            digest = (digest ^ w.transverse.phase) * 16777619U;
        if (box.wake.diverging != 0.0F && w.diverging.gain != 0)
            digest = (digest ^ w.diverging.phase) * 16777619U;
    }
    return digest;
}

}  // namespace

Comparison compare_sea(const InterestState& state, SeaTime now, const Camera& camera, DrawOptions options) {
    options.authoritative = true;
    const Layers layers = options.layers;
    const Probe probe = probe_sea(state, now, camera, options);
    const SeaInstant instant(sea_of(state), now, layers);
    const SeaInstant whole(sea_of(state), now, displayed_layers);
    Comparison result;
    for (size_t i = 0; i < probe.vertices.size(); i += 7) {
        const ProbedVertex& v = probe.vertices[i];
        const LatticePoint p{probe.anchor.x + v.x, probe.anchor.z + v.z};
        const SurfaceSample cpu = instant.evaluate(p);
        ++result.vertices;
        if (cpu.ay != 0.0F) ++result.moved;
        if (layers != displayed_layers && cpu != whole.evaluate(p)) ++result.changed;
        if (phases_of(instant, p) != v.phases) ++result.phase_differs;
        const float shift[3] = {cpu.ax, cpu.ay, cpu.az};
        const float normal[3] = {cpu.nx, cpu.ny, cpu.nz};
        bool same = true;
        for (int k = 0; k < 3; ++k) {
            // Zeros of either sign are the same place.
            same = same && shift[k] == v.shift[k] && normal[k] == v.normal[k];
            result.worst_mm = std::max(result.worst_mm, 1e3 * std::abs(static_cast<double>(shift[k]) -
                                                                       static_cast<double>(v.shift[k])));
            result.worst_normal = std::max(result.worst_normal, std::abs(static_cast<double>(normal[k]) -
                                                                         static_cast<double>(v.normal[k])));
        }
        if (!same) ++result.bits_differ;
    }
    fmt::print(
        "{}: {} vertices, {} moved, phases differ at {}, bits differ at {}, worst {:.6f} mm, worst normal {:.2e}\n",
        describe_gl(), result.vertices, result.moved, result.phase_differs, result.bits_differ,
        result.worst_mm, result.worst_normal);
    return result;
}

}  // namespace trochoid
