#include "server/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "server/event/event_log.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/steepness.hpp"
#include "server/world/wind_box.hpp"

namespace trochoid {

namespace {

using Boxes = std::map<BoxId, std::shared_ptr<const WorldBox>>;

/// The box that fell still first, or end() where none has by `now`.
Boxes::const_iterator first_still(const Boxes& boxes, SeaTime now) {
    const auto stillness = [](const auto& entry) {
        return entry.second->sea->record.end + entry.second->sea->record.decay_us;
    };
    const auto first = std::min_element(boxes.begin(), boxes.end(), [&](const auto& a, const auto& b) {
        return stillness(a) < stillness(b);
    });
    return first != boxes.end() && stillness(*first) <= now ? first : boxes.end();
}

std::vector<SteepBox> steep_boxes(const WorldState& state) {
    std::vector<SteepBox> list;
    list.reserve(state.boxes.size());
    for (const auto& [id, box] : state.boxes) list.push_back({&box->sea->record, box->land_growth});
    return list;
}

double growth_of(const TracedLand& land) {
    return std::max(static_cast<double>(land.gain_max) / 32768.0, static_cast<double>(land.steepness_growth));
}

Sea sea_of(const Boxes& boxes) {
    std::vector<std::shared_ptr<const PreparedBox>> list;
    list.reserve(boxes.size());
    for (const auto& [id, box] : boxes) list.push_back(box->sea);
    return Sea(std::move(list));
}

/// The record as the log has it, with what its land was traced to.
WaveTrainBox join(const WaveTrainBox& planned, const TracedLand& land, uint32_t next_field) {
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
    return record;
}

void fold(WorldState& state, const BoxStarted& event, TracedLand land) {
    TROCHOID_ASSERT(event.box.id.value == state.next_box && event.box.first_train.value == state.next_train,
                    "box {} with train {} comes where {} and {} are next", event.box.id.value,
                    event.box.first_train.value, state.next_box, state.next_train);
    if (state.boxes.size() >= most_boxes) {
        const auto still = first_still(state.boxes, event.box.begin);
        TROCHOID_ASSERT(still != state.boxes.end(), "box {} comes to a full world", event.box.id.value);
        state.boxes.erase(still);
    }
    auto box = std::make_shared<WorldBox>();
    box->sea = prepare(join(event.box, land, state.next_field), land.fields);
    box->name = event.name;
    box->wind = event.wind;
    box->rays = std::move(land.rays);
    box->land_growth = growth_of(land);
    state.next_box += 1;
    state.next_train += static_cast<uint32_t>(event.box.trains.size());
    state.next_field += static_cast<uint32_t>(land.fields.size());
    state.boxes.emplace(event.box.id, std::move(box));
    state.sea = sea_of(state.boxes);
}

void fold(WorldState& state, const BoxEnding& event, const TracedLand&) {
    const auto place = state.boxes.find(event.box);
    TROCHOID_ASSERT(place != state.boxes.end(), "unknown box {} ends", event.box.value);
    WaveTrainBox record = place->second->sea->record;
    TROCHOID_ASSERT(event.end < record.end && event.end >= record.begin,
                    "box {} of [{}, {}) us ends at {} us", event.box.value, record.begin.us, record.end.us,
                    event.end.us);
    record.end = event.end;
    // A wind that is stopped before it blows leaves nothing to decay: growth would outrun the decay at first.
    if (record.end == record.begin) record.decay_us = 0;
    auto box = std::make_shared<WorldBox>(*place->second);
    box->sea = prepare(std::move(record), place->second->sea->fields);
    place->second = std::move(box);
    state.sea = sea_of(state.boxes);
}

void fold(WorldState& state, const ClockChanged& event, const TracedLand&) {
    TROCHOID_ASSERT(event.clock.epoch == state.clock.epoch + 1, "clock epoch {} follows {}",
                    event.clock.epoch, state.clock.epoch);
    state.clock = event.clock;
}

}  // namespace

World::World(std::string name, std::shared_ptr<const TerrainGrid> terrain, SeaClock clock) {
    auto state = std::make_shared<WorldState>();
    state->name = std::move(name);
    state->log_hash = empty_log_hash;
    state->clock = clock;
    state->terrain = std::move(terrain);
    state_ = std::move(state);
}

Result<Done> World::has_room(SeaTime begin) const {
    if (state_->boxes.size() < most_boxes || first_still(state_->boxes, begin) != state_->boxes.end())
        return Done{};
    return Error{
        ErrorCode::too_many_boxes,
        fmt::format("the world has {} boxes and none has fallen still: stop a wind and wait for its decay",
                    most_boxes)};
}

BoxStarted World::admit(WaveTrainBox box, std::string name, StartWind wind) const {
    limit_steepness(box, state_->terrain ? expected_land_growth : 1.0, steep_boxes(*state_));
    const auto ok = validate(box);
    TROCHOID_ASSERT(ok.has_value(), "planned box {}: {}", box.id.value, ok.error().message);
    if (name.empty()) name = fmt::format("wind {}", box.id.value);
    return {std::move(box), std::move(name), std::move(wind)};
}

Result<BoxStarted> World::plan(const StartWind& asked, SeaTime begin, std::string name) const {
    if (auto ok = validate(asked); !ok) return ok.error();
    if (auto ok = has_room(begin); !ok) return ok.error();
    StartWind wind = asked;
    if (wind.seed == 0)
        wind.seed = splitmix64(splitmix64(static_cast<uint64_t>(begin.us)) + state_->next_box) | 1U;
    return admit(box_of(wind, begin, {{state_->next_box}, {state_->next_train}}), std::move(name), wind);
}

Result<BoxStarted> World::plan(const SceneBox& scene) const {
    if (auto ok = has_room(scene.begin); !ok) return ok.error();
    auto box = box_of(scene, {{state_->next_box}, {state_->next_train}});
    if (!box) return box.error();
    return admit(std::move(box).value(), scene.name, equivalent_wind(scene));
}

BoxStarted World::fit_to_land(BoxStarted planned, const TracedLand& land) const {
    if (!state_->terrain) return planned;
    limit_steepness(planned.box, std::max(growth_of(land), expected_land_growth), steep_boxes(*state_));
    return planned;
}

Result<BoxEnding> World::plan(const StopWind& stop, SeaTime effective) const {
    const auto found = state_->boxes.find(stop.box);
    if (found == state_->boxes.end())
        return Error{ErrorCode::unknown_box,
                     fmt::format("there is no box {}: ask for the list", stop.box.value)};
    const WaveTrainBox& record = found->second->sea->record;
    const SeaTime end = std::max(effective, record.begin);
    if (end >= record.end)
        return Error{ErrorCode::already_ending, fmt::format("box {} decays from {} us on: it needs no stop",
                                                            stop.box.value, record.end.us)};
    return BoxEnding{stop.box, end};
}

Result<ClockChanged> World::plan(const SetRate& rate, int64_t monotonic_us) const {
    if (rate.rate_q16 > largest_rate_q16)
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("rate {:.6g} is out of range: give 0 (paused) to {}",
                                 static_cast<double>(rate.rate_q16) / 65536.0, largest_rate_q16 >> 16)};
    const SeaClock& old = state_->clock;
    return ClockChanged{{old.epoch + 1, sea_time_at(old, monotonic_us), monotonic_us, rate.rate_q16}};
}

std::shared_ptr<const WorldState> World::apply(const LogEvent& event, std::span<const uint8_t> bytes,
                                               TracedLand land) {
    auto next = std::make_shared<WorldState>(*state_);
    std::visit([&](const auto& what) { fold(*next, what, std::move(land)); }, event.what);
    next->log_position.value += 1;
    next->log_hash = chain_hash(next->log_hash, bytes);
    state_ = std::move(next);
    return state_;
}

}  // namespace trochoid
