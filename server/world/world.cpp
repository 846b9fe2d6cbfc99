#include "server/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "protocol/model/round_wave.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "server/event/event_log.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/box_steering.hpp"
#include "server/world/effective_time.hpp"
#include "server/world/ship_box.hpp"
#include "server/world/steepness.hpp"
#include "server/world/terrain_edit.hpp"
#include "server/world/world_fold.hpp"

namespace trochoid {

namespace {

std::vector<SteepBox> steep_boxes(const WorldState& state) {
    std::vector<SteepBox> list;
    list.reserve(state.boxes.size());
    for (const auto& [id, box] : state.boxes)
        list.push_back({&box->sea->record, box->land_growth, box->predecessor});
    return list;
}

/// The same waves with the same growth behind them, from `effective` on (or from their beginning), before their land is known.
WaveTrainBox successor_of(const WaveTrainBox& old, NewIds ids, SeaTime effective) {
    WaveTrainBox box = old;
    box.id = ids.box;
    box.first_train = ids.first_train;
    box.begin = std::max(effective, old.begin);
    box.raised_us = old.raised_us + (box.begin - old.begin);
    box.fade_us = effective > old.begin ? land_fade_us : 0;
    box.gain_max = unit_node_gain;
    box.overlays.clear();
    for (WaveTrain& train : box.trains) train.field = {};
    return box;
}

/// A light wind over a short fetch raises waves that are too short to be round.
Result<Done> long_enough(const WaveTrainBox& box) {
    const auto too_short = [](const WaveTrain& train) {
        return whole_wave_number(train.kx, train.kz) >= largest_round_wave_number;
    };
    if (box.roundness == 0 || std::none_of(box.trains.begin(), box.trains.end(), too_short)) return Done{};
    return Error{ErrorCode::value_out_of_range,
                 "the wind raises waves shorter than 0.125 m, which cannot be round: give a stronger wind, a "
                 "longer fetch, or roundness 0"};
}

/// Wakes know no land, and a ship may sail across it; but none sets out on it.
Result<Done> afloat(const TerrainGrid* terrain, LatticePoint at) {
    const int32_t ground = terrain == nullptr ? -1 : height_at(*terrain, at.x, at.z);
    if (ground < 0) return Done{};
    return Error{
        ErrorCode::value_out_of_range,
        fmt::format("the ship begins on land, at x {} z {} m, {:.1f} m above still water: begin on water",
                    to_metres(at.x), to_metres(at.z), to_metres(ground))};
}

/// Whether a ship of that name sails at any time within [begin, end): then none could tell which one is meant. Winds may share names:
/// those are labels, and a wind's successors keep its name.
std::shared_ptr<const WorldBox> ship_named(const WorldState& state, const std::string& name, SeaTime begin,
                                           SeaTime end) {
    for (const auto& [id, box] : state.boxes) {
        const WaveTrainBox& record = box->sea->record;
        if (is_ship(record) && box->name == name && record.begin < end && begin < record.end) return box;
    }
    return nullptr;
}

/// The box that goes on in this one's place: since the land changed, or a ship's on her next course. nullptr: none.
const WorldBox* next_of(const WorldState& state, const WorldBox& box) {
    if (const auto next = state.boxes.find(box.successor); next != state.boxes.end())
        return next->second.get();
    const WaveTrainBox& record = box.sea->record;
    if (!is_ship(record)) return nullptr;
    // A course begins when and where the one before ends, by a later number.
    for (auto next = state.boxes.upper_bound(record.id); next != state.boxes.end(); ++next) {
        const WorldBox& other = *next->second;
        if (is_ship(other.sea->record) && other.name == box.name && other.sea->record.begin == record.end &&
            other.wind.origin == ship_place(record, record.end))
            return &other;
    }
    return nullptr;
}

}  // namespace

World::World(std::string name, std::shared_ptr<const TerrainGrid> terrain, SeaClock clock,
             size_t most_land_blocks) {
    auto state = std::make_shared<WorldState>();
    state->name = std::move(name);
    state->log_hash = empty_log_hash;
    state->clock = clock;
    state->terrain = std::move(terrain);
    state->most_land_blocks = most_land_blocks;
    state_ = std::move(state);
}

Result<Done> World::has_room(SeaTime begin, size_t boxes) const {
    // Numbers are never given twice: 2^32 trains are 45 hours of land that changes under 1024 full boxes without a pause.
    if (state_->next_train > UINT32_MAX - 256U * static_cast<uint32_t>(boxes + 1))
        return Error{ErrorCode::too_many_trains,
                     "the world has used up its numbers for wave trains: start it anew"};
    const size_t free = most_boxes - std::min<size_t>(state_->boxes.size(), most_boxes);
    // The new one takes its place when it is applied, not only when it begins.
    const SeaTime by = std::min(begin, present_);
    size_t still = 0;
    for (const auto& [id, box] : state_->boxes)
        if (box->sea->record.end + box->sea->record.decay_us <= by) ++still;
    if (boxes <= free + still) return Done{};
    return Error{
        ErrorCode::too_many_boxes,
        fmt::format(
            "the world has {} boxes and {} have fallen still, too few: stop a wind and wait for its decay",
            state_->boxes.size(), still)};
}

// Courses are settled up to now, as every plan is carried out later; before the first command none has been steered.
SteepCrowd World::crowd(std::span<const SteepBox> boxes) const {
    return SteepCrowd(boxes, present_ == end_of_time ? state_->clock.start : present_);
}

// All of them are steeper over their new land, if any is.
SteepCrowd World::crowd_over(std::span<const Retraced> touched) const {
    std::map<BoxId, const TracedLand*> land;
    for (const Retraced& next : touched) land.emplace(next.box, &next.land);
    std::vector<SteepBox> boxes = steep_boxes(*state_);
    for (SteepBox& box : boxes)
        if (const auto next = land.find(box.box->id); next != land.end())
            box.land_growth = std::max(box.land_growth, growth_of(*box.box, *next->second));
    return crowd(boxes);
}

Result<BoxStarted> World::admit(WaveTrainBox box, std::string name, const StartWind& wind) const {
    limit_steepness(box, state_->terrain ? expected_land_growth : 1.0, crowd(steep_boxes(*state_)));
    // What a plan's own checks let through must not end a running world.
    if (const auto ok = validate(box); !ok) return ok.error();
    if (name.empty()) name = fmt::format("{} {}", is_ship(box) ? "ship" : "wind", box.id.value);
    return BoxStarted{std::move(box), std::move(name), wind};
}

Result<BoxStarted> World::plan(const StartWind& asked, SeaTime begin, std::string name) const {
    if (auto ok = validate(asked); !ok) return ok.error();
    if (auto ok = has_room(begin); !ok) return ok.error();
    StartWind wind = asked;
    if (wind.seed == 0)
        wind.seed = splitmix64(splitmix64(static_cast<uint64_t>(begin.us)) + state_->next_box) | 1U;
    WaveTrainBox box = box_of(wind, begin, new_ids());
    if (auto ok = long_enough(box); !ok) return ok.error();
    return admit(std::move(box), std::move(name), wind);
}

Result<BoxStarted> World::plan(const SceneWind& scene) const {
    if (scene.legs.empty()) return plan(scene.wind, scene.begin, scene.name);
    if (auto ok = validate(scene.wind); !ok) return ok.error();
    if (auto ok = has_room(scene.begin); !ok) return ok.error();
    WaveTrainBox box = box_of(scene.wind, scene.begin, new_ids());
    if (auto ok = long_enough(box); !ok) return ok.error();
    auto course = course_of(box, scene.legs, box.end + box.decay_us);
    if (!course) return course.error();
    box.course = std::move(course).value();
    return admit(std::move(box), scene.name, scene.wind);
}

Result<BoxStarted> World::plan(const SceneBox& scene) const {
    if (auto ok = has_room(scene.begin); !ok) return ok.error();
    auto box = box_of(scene, new_ids());
    if (!box) return box.error();
    StartWind wind = equivalent_wind(scene);
    wind.trains = 0;  // no wind drew them
    return admit(std::move(box).value(), scene.name, wind);
}

Result<BoxStarted> World::plan(const StartShip& ship, SeaTime begin) const {
    auto started = plan_course(ship, begin);
    if (!started) return started;
    if (auto ok = afloat(state_->terrain.get(), ship.at); !ok) return ok.error();
    if (const auto other = ship_named(*state_, started->name, started->box.begin, started->box.end))
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("a ship named '{}' sails already, as box {}: give another name, or stop her",
                                 started->name, other->sea->record.id.value)};
    return started;
}

Result<BoxStarted> World::plan_course(const StartShip& ship, SeaTime begin) const {
    if (auto ok = validate(ship); !ok) return ok.error();
    if (auto ok = has_room(begin); !ok) return ok.error();
    auto box = box_of(ship, begin, new_ids());
    if (!box) return box.error();
    return admit(std::move(box).value(), ship.name, logged_wind(ship));
}

BoxStarted World::fit_to_land(BoxStarted planned, const TracedLand& land) const {
    if (!state_->terrain) return planned;
    limit_steepness(planned.box, std::max(growth_of(planned.box, land), expected_land_growth),
                    crowd(steep_boxes(*state_)));
    return planned;
}

/// The box, unless its decay has begun by then.
Result<std::shared_ptr<const WorldBox>> World::going_on(BoxId box, SeaTime effective) const {
    const auto found = state_->boxes.find(box);
    if (found == state_->boxes.end())
        return Error{ErrorCode::unknown_box, fmt::format("there is no box {}: ask for the list", box.value)};
    const WorldBox* last = found->second.get();
    while (const WorldBox* next = next_of(*state_, *last)) last = next;
    if (last != found->second.get())
        return Error{ErrorCode::already_ending,
                     fmt::format("box {} goes on as box {}, since {}: name that one", box.value,
                                 last->sea->record.id.value,
                                 is_ship(last->sea->record) ? "her course changed" : "the land changed")};
    const WaveTrainBox& record = found->second->sea->record;
    if (std::max(effective, record.begin) < record.end) return found->second;
    return Error{ErrorCode::already_ending,
                 fmt::format("box {} decays from sea time {} on: it needs no stop and takes no course",
                             box.value, text_of(record.end))};
}

Result<BoxEnding> World::plan(const StopWind& stop, SeaTime effective) const {
    const auto box = going_on(stop.box, effective);
    if (!box) return box.error();
    return BoxEnding{stop.box, std::max(effective, (*box)->sea->record.begin)};
}

Result<Steering> World::plan(const Steer& steer, SeaTime effective) const {
    const auto box = going_on(steer.box, effective);
    if (!box) return box.error();
    const WaveTrainBox& record = (*box)->sea->record;
    const SeaTime start = std::max(effective, record.begin);
    if (is_ship(record)) return steer_ship(**box, steer, start);
    const auto leg =
        next_leg(record, start, static_cast<double>(steer.towards_degrees), static_cast<double>(steer.speed));
    if (!leg) return leg.error();
    return Steering{{BoxSteered{steer.box, *leg}}, start, steer.box};
}

Result<Steering> World::steer_ship(const WorldBox& ship, const Steer& steer, SeaTime effective) const {
    Steering steering{{BoxEnding{steer.box, effective}}, effective, steer.box};
    if (steer.speed == 0.0F) {
        auto lying = plan_lying(ship, effective);
        if (!lying) return lying.error();
        steering.box = lying->box.id;
        steering.events.emplace_back(std::move(lying).value());
        return steering;
    }
    StartShip next = logged_ship(ship.wind);
    next.at = ship_place(ship.sea->record, effective);
    next.towards_degrees = steer.towards_degrees;
    next.speed = steer.speed;
    next.name = ship.name;
    auto started = plan_course(next, effective);
    if (!started) return started.error();
    steering.box = started->box.id;
    steering.events.emplace_back(std::move(started).value());
    return steering;
}

Result<BoxStarted> World::plan_lying(const WorldBox& ship, SeaTime effective) const {
    const WaveTrainBox& record = ship.sea->record;
    if (!has_wake(record.wake))
        return Error{
            ErrorCode::not_moving,
            fmt::format("box {} is a ship that lies still already: give her a speed above 0, or stop "
                        "the box to take her out",
                        record.id.value)};
    if (auto ok = has_room(effective); !ok) return ok.error();
    StartWind logged = ship.wind;
    logged.speed = 0.0F;
    logged.origin = ship_place(record, effective);
    return admit(lying_box(record, effective, new_ids()), ship.name, logged);
}

Result<ClockChanged> World::plan(const SetRate& rate, int64_t monotonic_us) const {
    if (rate.rate_q16 > largest_rate_q16)
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("rate {:.6g} is out of range: give 0 (paused) to {}",
                                 static_cast<double>(rate.rate_q16) / 65536.0, largest_rate_q16 >> 16)};
    const SeaClock& old = state_->clock;
    return ClockChanged{{old.epoch + 1, sea_time_at(old, monotonic_us), monotonic_us, rate.rate_q16}};
}

Result<ClockChanged> World::plan(const SkipTime& skip, int64_t monotonic_us) const {
    const SeaClock& old = state_->clock;
    const SeaTime present = sea_time_at(old, monotonic_us);
    // Room for what the clock runs on after it, at any rate.
    constexpr int64_t latest_us = sea_time_bound / 2;
    if (skip.forward_us < 1 || skip.forward_us > longest_skip_us || present.us > latest_us - skip.forward_us)
        return Error{
            ErrorCode::value_out_of_range,
            fmt::format("time cannot be skipped by {} us: give 1 to {} us, as far as the world's time goes",
                        skip.forward_us, longest_skip_us)};
    return ClockChanged{{old.epoch + 1, present + skip.forward_us, monotonic_us, old.rate_q16}};
}

SeaTime World::land_settled() const {
    SeaTime settled{-sea_time_bound};
    for (const auto& [id, box] : state_->boxes)
        // A wind that was still to come was replaced without a cross-fade.
        if (box->predecessor.value != 0 && box->sea->record.fade_us != 0)
            settled = std::max(settled, box->sea->record.begin + box->sea->record.fade_us);
    return settled;
}

std::vector<BoxId> World::on_land_at(SeaTime effective) const { return boxes_on_land(*state_, effective); }

std::vector<BoxId> boxes_on_land(const WorldState& state, SeaTime effective) {
    std::vector<BoxId> list;
    for (const auto& [id, box] : state.boxes) {
        const WaveTrainBox& record = box->sea->record;
        if (!record.trains.empty() && !is_ship(record) &&
            std::max(effective, record.begin) + land_fade_us < record.end)
            list.push_back(id);
    }
    return list;
}

LandRoom World::room_for_land(SeaTime effective) const {
    // As for boxes: the new land comes when it is applied, not only when it takes hold.
    return land_room(*state_, std::min(effective, present_));
}

Result<LandChanged> World::plan(const ChangeLand& change, SeaTime effective,
                                std::span<const Retraced> touched, std::vector<ChangeLand> also) const {
    if (auto ok = validate(change); !ok) return ok.error();
    if (!state_->terrain)
        return Error{ErrorCode::no_terrain,
                     "this world is open sea without a terrain: open a scene that has one to change it"};
    TROCHOID_ASSERT(effective >= land_settled(), "the land changes at {} us, before it has settled",
                    effective.us);
    if (auto ok = has_room(effective, touched.size()); !ok) return ok.error();
    if (!room_after(*state_, touched, std::min(effective, present_)).fits())
        return too_much_land(room_for_land(effective));
    const SteepCrowd others = crowd_over(touched);
    LandChanged event{change, {}, std::move(also)};
    NewIds ids = new_ids();
    for (const Retraced& next : touched) {
        const auto box = going_on(next.box, effective);
        TROCHOID_ASSERT(box.has_value(), "box {} cannot go on: {}", next.box.value, box.error().message);
        WaveTrainBox record = successor_of((*box)->sea->record, ids, effective);
        limit_successor(record, next.box, growth_of(record, next.land), others);
        const auto ok = validate(record);
        TROCHOID_ASSERT(ok.has_value(), "successor {}: {}", record.id.value, ok.error().message);
        ids.box.value += 1;
        ids.first_train.value += static_cast<uint32_t>(record.trains.size());
        event.boxes.push_back({next.box, std::move(record)});
    }
    return event;
}

std::shared_ptr<const WorldState> World::apply(const LogEvent& event, std::span<const uint8_t> bytes,
                                               TracedLand land) {
    Derived derived;
    if (std::holds_alternative<BoxStarted>(event.what)) derived.lands.push_back(std::move(land));
    return apply(event, bytes, std::move(derived));
}

std::shared_ptr<const WorldState> World::apply(const LogEvent& event, std::span<const uint8_t> bytes,
                                               Derived derived) {
    auto next = std::make_shared<WorldState>(*state_);
    fold(*next, event, std::move(derived));
    next->log_position.value += 1;
    next->log_hash = chain_hash(next->log_hash, bytes);
    state_ = std::move(next);
    return state_;
}

}  // namespace trochoid
