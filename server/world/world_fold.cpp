#include "server/world/world_fold.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <variant>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/box_steering.hpp"
#include "server/world/land_room.hpp"
#include "server/world/ship_box.hpp"
#include "server/world/terrain_edit.hpp"

namespace trochoid {

namespace {

using Boxes = std::map<BoxId, std::shared_ptr<const WorldBox>>;
using Fields = std::vector<std::shared_ptr<const LandField>>;

Sea sea_of(const Boxes& boxes) {
    std::vector<std::shared_ptr<const PreparedBox>> list;
    list.reserve(boxes.size());
    for (const auto& [id, box] : boxes) list.push_back(box->sea);
    return Sea(std::move(list));
}

/// Of all overlays those that the trains' fields rest on.
std::vector<FieldOverlay> overlays_in_use(const WaveTrainBox& record, const std::vector<FieldOverlay>& all) {
    std::set<FieldId> used;
    for (const WaveTrain& train : record.trains) used.insert(train.field);
    std::vector<FieldOverlay> kept;
    // A base's id is below its field's, so from the highest field down all that rests on it is known already.
    for (size_t i = all.size(); i-- > 0;)
        if (used.contains(all[i].field)) {
            used.insert(all[i].base);
            kept.push_back(all[i]);
        }
    return {kept.rbegin(), kept.rend()};
}

/// The record as the log has it, with what its land was traced to.
WaveTrainBox join(const WaveTrainBox& planned, const TracedLand& land, uint32_t next_field,
                  const WaveTrainBox* predecessor) {
    WaveTrainBox record = planned;
    record.gain_max = land.gain_max;
    TROCHOID_ASSERT(land.field_of_train.empty() || land.field_of_train.size() == record.trains.size(),
                    "box {}: {} trains, but fields for {}", record.id.value, record.trains.size(),
                    land.field_of_train.size());
    for (size_t i = 0; i < land.field_of_train.size(); ++i) record.trains[i].field = land.field_of_train[i];
    for (size_t i = 0; i < land.fields.size(); ++i)
        TROCHOID_ASSERT(land.fields[i]->id().value == next_field + i,
                        "box {}: field {} comes where {} is next", record.id.value,
                        land.fields[i]->id().value, next_field + i);
    std::vector<FieldOverlay> overlays;
    if (predecessor != nullptr) overlays = predecessor->overlays;
    overlays.insert(overlays.end(), land.overlays.begin(), land.overlays.end());
    record.overlays = overlays_in_use(record, overlays);
    return record;
}

std::shared_ptr<const WorldBox> with_record(const WorldBox& box, WaveTrainBox record, BoxId successor = {}) {
    auto changed = std::make_shared<WorldBox>(box);
    if (successor.value != 0) {
        changed->successor = successor;
        changed->land_memory = nullptr;  // from now on only the successor is traced again
    }
    changed->sea = prepare(std::move(record), fields_with_bases(*box.sea));
    return changed;
}

void make_room(WorldState& state, const WaveTrainBox& box) {
    if (state.boxes.size() < most_boxes) return;
    const auto still = first_still(state.boxes, box.begin);
    TROCHOID_ASSERT(still != state.boxes.end(), "box {} comes to a full world", box.id.value);
    state.boxes.erase(still);
}

/// Puts a box in; the predecessor's fields serve it too.
void put(WorldState& state, const WaveTrainBox& planned, std::shared_ptr<WorldBox> box, TracedLand land,
         const WorldBox* predecessor) {
    TROCHOID_ASSERT(planned.id.value == state.next_box && planned.first_train.value == state.next_train,
                    "box {} with train {} comes where {} and {} are next", planned.id.value,
                    planned.first_train.value, state.next_box, state.next_train);
    Fields fields = land.fields;
    if (predecessor != nullptr) {
        const Fields old = fields_with_bases(*predecessor->sea);
        fields.insert(fields.end(), old.begin(), old.end());
    }
    box->sea = prepare(
        join(planned, land, state.next_field, predecessor != nullptr ? &predecessor->sea->record : nullptr),
        fields);
    box->rays = std::move(land.rays);
    box->land_memory = std::move(land.memory);
    box->land_growth = growth_of(planned, land);
    state.next_box += 1;
    state.next_train += static_cast<uint32_t>(planned.trains.size());
    state.next_field += static_cast<uint32_t>(land.fields.size());
    make_room(state, planned);
    state.boxes.emplace(planned.id, std::move(box));
}

TracedLand only_land(Derived derived, BoxId box) {
    TROCHOID_ASSERT(derived.lands.size() <= 1, "box {} comes with {} lands", box.value, derived.lands.size());
    return derived.lands.empty() ? TracedLand{} : std::move(derived.lands.front());
}

void take(WorldState& state, const BoxStarted& event, Derived derived) {
    TracedLand land = only_land(std::move(derived), event.box.id);
    auto box = std::make_shared<WorldBox>();
    box->name = event.name;
    box->wind = event.wind;
    WaveTrainBox planned = event.box;
    // The log keeps a hull under way in the wind's place, as it did before boxes had hulls.
    if (has_wake(planned.wake) && !has_hull(planned.hull)) planned.hull = logged_hull(event.wind);
    put(state, planned, std::move(box), std::move(land), nullptr);
    state.sea = sea_of(state.boxes);
}

void take(WorldState& state, const BoxEnding& event, const Derived&) {
    const auto place = state.boxes.find(event.box);
    TROCHOID_ASSERT(place != state.boxes.end(), "unknown box {} ends", event.box.value);
    WaveTrainBox record = place->second->sea->record;
    TROCHOID_ASSERT(event.end < record.end && event.end >= record.begin,
                    "box {} of [{}, {}) us ends at {} us", event.box.value, record.begin.us, record.end.us,
                    event.end.us);
    record.end = event.end;
    // A wind that is stopped before it blows leaves nothing to decay: growth would outrun the decay at first. One that
    // takes over from another decays as that one would have.
    if (record.end == record.begin && record.fade_us == 0) record.decay_us = 0;
    place->second = with_record(*place->second, std::move(record));
    state.sea = sea_of(state.boxes);
}

void take(WorldState& state, const BoxSteered& event, const Derived&) {
    const auto place = state.boxes.find(event.box);
    TROCHOID_ASSERT(place != state.boxes.end(), "unknown box {} is steered", event.box.value);
    WaveTrainBox record = place->second->sea->record;
    steer(record, event.leg);
    const auto ok = validate(record);
    TROCHOID_ASSERT(ok.has_value(), "steered box {}: {}", event.box.value, ok.error().message);
    place->second = with_record(*place->second, std::move(record));
    state.sea = sea_of(state.boxes);
}

void take(WorldState& state, const LandChanged& event, Derived derived) {
    TROCHOID_ASSERT(state.terrain != nullptr, "the land of a world without terrain changes");
    TROCHOID_ASSERT(derived.lands.size() == event.boxes.size(), "{} boxes go on over {} lands",
                    event.boxes.size(), derived.lands.size());
    if (!derived.terrain) {
        auto edit = edited(*state.terrain, changes_of(event));
        TROCHOID_ASSERT(edit.has_value(), "the land's change: {}", edit.error().message);
        derived.terrain = edit->terrain;
    }
    state.terrain = std::move(derived.terrain);
    for (Retraced& same : derived.untouched) {
        auto box = std::make_shared<WorldBox>(*state.boxes.at(same.box));
        box->rays = std::move(same.land.rays);
        box->land_memory = std::move(same.land.memory);
        state.boxes[same.box] = std::move(box);
    }
    for (size_t i = 0; i < event.boxes.size(); ++i) {
        const BoxSucceeded& next = event.boxes[i];
        const auto place = state.boxes.find(next.predecessor);
        TROCHOID_ASSERT(place != state.boxes.end(), "unknown box {} is succeeded", next.predecessor.value);
        const std::shared_ptr<const WorldBox> old = place->second;
        WaveTrainBox record = old->sea->record;
        TROCHOID_ASSERT(next.box.begin < record.end && next.box.begin >= record.begin,
                        "box {} of [{}, {}) us is succeeded at {} us", next.predecessor.value,
                        record.begin.us, record.end.us, next.box.begin.us);
        record.end = next.box.begin;
        record.decay_us = next.box.fade_us;
        place->second = with_record(*old, std::move(record), next.box.id);
        auto box = std::make_shared<WorldBox>();
        box->name = old->name;
        box->wind = old->wind;
        box->predecessor = next.predecessor;
        put(state, next.box, std::move(box), std::move(derived.lands[i]), old.get());
    }
    state.sea = sea_of(state.boxes);
}

void take(WorldState& state, const ClockChanged& event, const Derived&) {
    TROCHOID_ASSERT(event.clock.epoch == state.clock.epoch + 1, "clock epoch {} follows {}",
                    event.clock.epoch, state.clock.epoch);
    state.clock = event.clock;
}

}  // namespace

Boxes::const_iterator first_still(const Boxes& boxes, SeaTime now) {
    const auto stillness = [](const auto& entry) {
        return entry.second->sea->record.end + entry.second->sea->record.decay_us;
    };
    const auto first = std::min_element(boxes.begin(), boxes.end(), [&](const auto& a, const auto& b) {
        return stillness(a) < stillness(b);
    });
    return first != boxes.end() && stillness(*first) <= now ? first : boxes.end();
}

double growth_of(const WaveTrainBox& box, const TracedLand& land) {
    const bool alike = std::all_of(box.trains.begin(), box.trains.end(), [&](const WaveTrain& train) {
        return train.choppiness == box.trains.front().choppiness;
    });
    return static_cast<double>(alike ? land.steepness_growth
                                     : std::max(land.steepness_growth, land.steepness_growth_most));
}

Fields fields_with_bases(const PreparedBox& box) {
    Fields all;
    for (const auto& top : box.fields)
        for (std::shared_ptr<const LandField> field = top; field; field = field->base()) {
            const auto same = [&](const auto& known) { return known->id() == field->id(); };
            if (std::none_of(all.begin(), all.end(), same)) all.push_back(field);
        }
    return all;
}

void fold(WorldState& state, const LogEvent& event, Derived derived) {
    if (std::holds_alternative<LandChanged>(event.what)) let_go_of_old_land(state, event.effective);
    size_t coming = 0;
    for (const TracedLand& land : derived.lands) coming += blocks_of(land);
    // The land comes now, not only when it takes hold: nothing goes for it that still moves the sea.
    make_room_for_land(state, coming, std::min(event.effective, event.present));
    std::visit([&](const auto& what) { take(state, what, std::move(derived)); }, event.what);
}

}  // namespace trochoid
