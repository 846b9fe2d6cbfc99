#include "protocol/model/sea.hpp"

#include <algorithm>
#include <iterator>

#include "protocol/model/ordered_sum.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

/// The field with its bases as the overlays say. A field that is not given reads as its base alone; a base of another step does not
/// count (such a record is a peer's mistake).
std::shared_ptr<const LandField> joined(const WaveTrainBox& record, FieldId id,
                                        std::span<const std::shared_ptr<const LandField>> fields) {
    const auto given =
        std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f->id() == id; });
    const auto overlay = std::find_if(record.overlays.begin(), record.overlays.end(),
                                      [&](const FieldOverlay& o) { return o.field == id && o.base < id; });
    std::shared_ptr<const LandField> base;
    if (overlay != record.overlays.end()) base = joined(record, overlay->base, fields);
    if (given == fields.end()) return base;
    if (base && base->step_log2() != (*given)->step_log2()) base = nullptr;
    if ((*given)->base() == base) return *given;
    auto layered_field = std::make_shared<LandField>(**given);
    layered_field->set_base(std::move(base));
    return layered_field;
}

}  // namespace

std::shared_ptr<const PreparedBox> prepare(WaveTrainBox record,
                                           std::span<const std::shared_ptr<const LandField>> fields) {
    auto box = std::make_shared<PreparedBox>();
    std::vector<FieldId> joined_ids;
    for (const WaveTrain& train : record.trains) {
        box->constants.push_back(derive_constants(train));
        int16_t index = -1;
        if (train.field.value != 0) {
            const auto known = std::find(joined_ids.begin(), joined_ids.end(), train.field);
            if (known != joined_ids.end()) {
                index = static_cast<int16_t>(known - joined_ids.begin());
            } else if (auto field = joined(record, train.field, fields)) {
                index = static_cast<int16_t>(box->fields.size());
                box->fields.push_back(std::move(field));
                joined_ids.push_back(train.field);
            }
        }
        box->field_of_train.push_back(index);
    }
    box->record = std::move(record);
    return box;
}

Sea::Sea(std::vector<std::shared_ptr<const PreparedBox>> boxes) : boxes_(std::move(boxes)) {
    std::sort(boxes_.begin(), boxes_.end(),
              [](const auto& a, const auto& b) { return a->record.id < b->record.id; });
    for (size_t i = 1; i < boxes_.size(); ++i)
        TROCHOID_ASSERT(boxes_[i - 1]->record.id < boxes_[i]->record.id, "box {} twice",
                        boxes_[i]->record.id.value);
}

SeaInstant::SeaInstant(const Sea& sea, SeaTime t, Layers layers) : time_(t), layers_(layers) {
    for (const auto& box : sea.boxes()) {
        const WaveTrainBox& record = box->record;
        const BoxInstant instant = instant_of(record, t);
        if (instant.time_gain == 0) continue;
        LiveBox live{box, instant, {}, phases_at_origin(record.irregular, t), {}};
        live.phase.reserve(record.trains.size());
        for (const WaveTrain& train : record.trains) live.phase.push_back(phase_at_origin(train, t.us));
        if (layers.has(record.noise.displayed_only ? Layer::displayed_noise : Layer::noise))
            live.noise = octaves_at(record.noise, t);
        live_.push_back(std::move(live));
    }
}

SeaInstant SeaInstant::without(BoxId box) const {
    SeaInstant rest(Sea{}, time_, layers_);
    rest.live_.reserve(live_.size());
    std::copy_if(live_.begin(), live_.end(), std::back_inserter(rest.live_),
                 [&](const LiveBox& live) { return live.box->record.id != box; });
    return rest;
}

SurfaceSample SeaInstant::evaluate(LatticePoint p) const {
    Sums acc;
    std::vector<Local> locals;
    for (const LiveBox& live : live_) {
        const Envelope e = envelope_at(live.box->record, live.instant, p);
        if (e.gain == 0) continue;
        if (layers_.has(Layer::trains)) add_trains(acc, live, e, p, layers_, locals);
        if (has_wake(live.box->record.wake) && layers_.has(Layer::wakes)) add_wake(acc, live, e, p);
        if (!live.noise.empty()) add_noise(acc, live.noise, e, p);
    }
    return finish(acc);
}

uint64_t hash_of(std::span<const SurfaceSample> samples) {
    Hash64 hash;
    for (const SurfaceSample& s : samples)
        for (const float v :
             {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz})
            hash.f32(v);
    return hash.value();
}

}  // namespace trochoid
