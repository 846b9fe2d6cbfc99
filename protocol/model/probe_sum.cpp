#include "protocol/model/probe_sum.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/ordered_sum.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

uint64_t hash_of(const Sums& acc) {
    Hash64 hash;
    for (const float v :
         {acc.ax, acc.ay, acc.az, acc.bx, acc.bz, acc.mxx, acc.mxz, acc.mzx, acc.mzz, acc.vx, acc.vy, acc.vz})
        hash.f32(v);
    return hash.value();
}

/// The field with the one block that a sample at the point reads, if it lies there; nullptr where the state has none of its blocks.
std::shared_ptr<const LandField> field_at(const InterestState& state, FieldId id, LatticePoint p) {
    constexpr int32_t lowest = std::numeric_limits<int32_t>::min();
    const auto first = state.blocks.lower_bound({id, {lowest, lowest}});
    if (first == state.blocks.end() || first->first.field != id) return nullptr;
    const uint8_t step_log2 = first->second.step_log2;
    auto field = std::make_shared<LandField>(id, step_log2);
    const BlockKey key = blocks_touching({p, p}, step_log2).first;
    const auto block = state.blocks.find({id, key});
    if (block != state.blocks.end()) field->set(block->second.block);
    return field;
}

/// The box with as much of its land as the point reads.
std::shared_ptr<const PreparedBox> prepare_at(const InterestState& state, const WaveTrainBox& box,
                                              LatticePoint p) {
    std::set<FieldId> ids;
    for (const WaveTrain& train : box.trains)
        if (train.field.value != 0) ids.insert(train.field);
    for (const FieldOverlay& overlay : box.overlays) {
        ids.insert(overlay.field);
        ids.insert(overlay.base);
    }
    std::vector<std::shared_ptr<const LandField>> fields;
    for (const FieldId id : ids)
        if (auto field = field_at(state, id, p)) fields.push_back(std::move(field));
    return prepare(box, fields);
}

/// Adds up one box after the other.
class Steps {
public:
    Steps(const InterestState& state, SeaTime time, LatticePoint p, size_t most_parts)
        : state_(state), time_(time), p_(p), most_parts_(most_parts) {}

    void add(const WaveTrainBox& box, size_t trains) {
        // Most boxes of a state have no water at the point: their trains need no preparing.
        if (envelope_at(box, instant_of(box, time_), p_).gain == 0) return;
        const SeaInstant instant(Sea({prepare_at(state_, box, p_)}), time_, displayed_layers);
        if (instant.live().empty()) return;
        const LiveBox& live = instant.live().front();
        const Envelope e = envelope_at(box, live.instant, p_);
        if (e.gain == 0) return;
        add_trains_one_by_one(live, e, std::min(trains, box.trains.size()));
        if (has_wake(box.wake)) {
            add_wake(acc_, live, e, p_);
            note(box.id, wake_part);
        }
        if (!live.noise.empty()) {
            add_noise(acc_, live.noise, e, p_);
            note(box.id, noise_part);
        }
    }
    PointSum result() && {
        const SurfaceSample sample = finish(acc_);
        out_.sample = trochoid::hash_of({&sample, 1});
        return std::move(out_);
    }

private:
    /// The box with one of its trains at a time.
    void add_trains_one_by_one(const LiveBox& whole, const Envelope& e, size_t trains) {
        const PreparedBox& box = *whole.box;
        auto single = std::make_shared<PreparedBox>();
        single->record = box.record;
        single->record.trains.resize(1);
        LiveBox live{single, whole.instant, {0}, whole.irregular, {}};
        for (size_t i = 0; i < trains; ++i) {
            single->record.trains[0] = box.record.trains[i];
            single->constants.assign(1, box.constants[i]);
            single->fields.clear();
            const int16_t field = box.field_of_train[i];
            if (field >= 0) single->fields.push_back(box.fields[static_cast<size_t>(field)]);
            single->field_of_train.assign(1, field < 0 ? int16_t{-1} : int16_t{0});
            live.phase[0] = whole.phase[i];
            add_trains(acc_, live, e, p_, displayed_layers, locals_);
            note(box.record.id, static_cast<uint16_t>(i));
        }
    }
    void note(BoxId box, uint16_t part) {
        if (out_.parts.size() < most_parts_) out_.parts.push_back({box, part, hash_of(acc_)});
    }

    const InterestState& state_;
    SeaTime time_;
    LatticePoint p_;
    size_t most_parts_;
    Sums acc_;
    std::vector<Local> locals_;
    PointSum out_;
};

}  // namespace

const PatchDescriptor* patch_holding(const InterestState& state, LatticePoint p) {
    for (uint8_t level = finest_patch_level; level <= coarsest_patch_level; ++level)
        if (const auto patch = state.patches.find(patch_at(p, level)); patch != state.patches.end())
            return &patch->second;
    return nullptr;
}

PointSum probe_sum(const InterestState& state, SeaTime time, LatticePoint p, size_t most_parts) {
    Steps steps(state, time, p, most_parts);
    if (const PatchDescriptor* patch = patch_holding(state, p)) {
        for (const PatchBox& reference : patch->boxes)
            if (const auto box = state.boxes.find(reference.box); box != state.boxes.end())
                steps.add(*box->second, reference.train_count);
    } else {
        for (const auto& [id, box] : state.boxes) steps.add(*box, box->trains.size());
    }
    return std::move(steps).result();
}

std::optional<PartDifference> first_difference(const PointSum& theirs, const PointSum& ours) {
    const size_t both = std::min(theirs.parts.size(), ours.parts.size());
    for (size_t i = 0; i < both; ++i) {
        const PartSum& a = theirs.parts[i];
        const PartSum& b = ours.parts[i];
        if (a == b) continue;
        const auto place_a = std::pair(a.box, a.part);
        const auto place_b = std::pair(b.box, b.part);
        if (place_a == place_b) return PartDifference{a.box, a.part, a.sum, b.sum};
        if (place_a < place_b) return PartDifference{a.box, a.part, a.sum, 0};
        return PartDifference{b.box, b.part, 0, b.sum};
    }
    if (theirs.sample == ours.sample) return std::nullopt;
    if (theirs.parts.size() > both)
        return PartDifference{theirs.parts[both].box, theirs.parts[both].part, theirs.parts[both].sum, 0};
    if (ours.parts.size() > both)
        return PartDifference{ours.parts[both].box, ours.parts[both].part, 0, ours.parts[both].sum};
    return PartDifference{{}, 0, theirs.sample, ours.sample};
}

}  // namespace trochoid
