#include "server/app/sea_authority.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <random>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/operator_error.hpp"
#include "server/net/monotonic.hpp"
#include "server/world/effective_time.hpp"

namespace trochoid {

namespace {

// While a box was traced another may have begun or ended, which changes its choppiness and with it the land. Commands go one
// by one, so a second trace is always enough.
constexpr int most_traces = 3;

// How long a change of the land may have to wait for those before it, sea time. Winds cannot be stopped before the changes that they
// are to outlive, so these must not pile up.
constexpr int64_t longest_land_wait_us = 6 * land_fade_us;

// 1 to 2^63 - 1, as scene files allow.
uint64_t random_seed() {
    std::random_device device;
    const uint64_t bits = (uint64_t{device()} << 32) | device();
    return std::max<uint64_t>(bits >> 1, 1);
}

CommandReply refusal(const Command& command, const Error& error) {
    CommandReply reply;
    reply.sequence = command.sequence;
    reply.code = error.code;
    reply.message = error.message;
    return reply;
}

[[noreturn]] void refuse_scene(const std::string& what, const Error& error) {
    throw OperatorError(
        fmt::format("the scene's {} cannot be: {}; correct the scene file", what, error.message));
}

}  // namespace

SeaAuthority::SeaAuthority(IoLoop& loop, World& world, EventLog& log, LandWorker& worker, uint32_t lead_ms)
    : loop_(loop),
      world_(world),
      log_(log),
      worker_(worker),
      lead_ms_(lead_ms),
      state_(world.state()),
      choice_(std::make_shared<const TerrainChoice>(state_->terrain)) {
    index_ = std::make_shared<const InterestIndex>(*state_);
}

SeaTime SeaAuthority::now() const { return sea_time_at(state_->clock, monotonic_us()); }

SeaTime SeaAuthority::watermark() {
    loop_.assert_here();
    promised_ = std::max(promised_, now() + lead_in_sea_time(state_->clock, lead_ms_));
    return promised_;
}

void SeaAuthority::open(const Scene& scene) {
    open_breakwaters(scene);
    for (const SceneWind& wind : scene.winds) open_box(wind.name, world_.plan(wind));
    for (const SceneBox& box : scene.boxes) open_box(box.name, world_.plan(box));
    for (const SceneShip& ship : scene.ships) open_ship(ship);
    publish();
}

void SeaAuthority::open_box(const std::string& name, const Result<BoxStarted>& planned) {
    if (!planned) refuse_scene(fmt::format("'{}'", name), planned.error());
    Derived derived;
    derived.lands.push_back(worker_.trace_and_wait(planned->box, {world_.state()->next_field}));
    BoxStarted started = world_.fit_to_land(*planned, derived.lands.front());
    const SeaTime begin = started.box.begin;
    append(single({0, begin, std::move(started)}, std::move(derived)));
}

void SeaAuthority::open_breakwaters(const Scene& scene) {
    for (size_t i = 0; i < scene.breakwaters.size(); ++i) {
        const std::string name = fmt::format("breakwater {}", i + 1);
        auto changed = worker_.change_and_wait(world_.state(), scene.breakwaters[i], {}, choice_);
        if (!changed) refuse_scene(name, changed.error());
        auto planned = world_.plan(scene.breakwaters[i], scene.clock_start, {});
        if (!planned) refuse_scene(name, planned.error());
        append(single({0, scene.clock_start, std::move(planned).value()}, derived_from(changed->outcome)));
        take_land(*changed);
    }
}

std::vector<SeaAuthority::Planned> SeaAuthority::single(LogEvent event, Derived derived) {
    std::vector<Planned> planned(1);
    planned.front().event = std::move(event);
    planned.front().derived = std::move(derived);
    return planned;
}

// Neither moving winds nor wakes have land to be traced for it.
std::vector<SeaAuthority::Planned> SeaAuthority::planned_of(const Steering& steering) {
    std::vector<Planned> planned;
    for (const auto& what : steering.events) planned.push_back({{0, steering.effective, what}, {}});
    return planned;
}

void SeaAuthority::open_ship(const SceneShip& ship) {
    open_box(ship.ship.name, world_.plan(ship.ship, ship.begin));
    BoxId box{world_.state()->next_box - 1};
    for (const SceneLeg& leg : ship.legs) {
        auto steering = world_.plan(
            Steer{box, static_cast<float>(leg.towards_degrees), static_cast<float>(leg.speed)}, leg.at);
        if (!steering)
            refuse_scene(fmt::format("'{}' from {} on", ship.ship.name, text_of(leg.at)), steering.error());
        append(planned_of(*steering));
        box = steering->box;
    }
}

void SeaAuthority::command(const Command& command, Reply reply) {
    loop_.assert_here();
    TROCHOID_ASSERT(!std::holds_alternative<ListBoxes>(command.action), "lists change nothing");
    if (waiting_.size() >= most_waiting) {
        reply(refusal(command, {ErrorCode::rate_limited,
                                "too many commands wait for their land to be traced: send it again later"}));
        return;
    }
    waiting_.push_back({command, std::move(reply)});
    if (!busy_) next();
}

void SeaAuthority::next() {
    while (!busy_ && !waiting_.empty()) {
        busy_ = true;
        Waiting waiting = std::move(waiting_.front());
        waiting_.pop_front();
        std::visit([&](const auto& action) { execute(action, waiting); }, waiting.command.action);
    }
}

// Sessions answer lists themselves.
void SeaAuthority::execute(const ListBoxes&, const Waiting&) {
    TROCHOID_ASSERT(false, "lists change nothing");
}

Result<SeaTime> SeaAuthority::stamp(const Command& command) {
    const SeaTime present = now();
    world_.set_present(present);
    return effective_time(command.at, present, watermark() - present, command.refuse_if_late);
}

// While the last change of the land is still cross-fading the next one waits.
Result<SeaTime> SeaAuthority::stamp_land(const Command& command) {
    Result<SeaTime> effective = stamp(command);
    if (!effective) return effective;
    // Chart and bed are the new ones for whoever asks from then on, so the change may not lie far ahead.
    if (*effective - now() > longest_land_wait_us)
        return Error{ErrorCode::value_out_of_range,
                     "the land can change at most 60 s of sea time ahead: send it later"};
    const SeaTime settled = world_.land_settled();
    if (*effective >= settled) return effective;
    if (command.refuse_if_late || settled - *effective > longest_land_wait_us)
        return Error{
            ErrorCode::too_late,
            fmt::format("the land changes until sea time {}: ask for a later time", text_of(settled))};
    return settled;
}

void SeaAuthority::execute(const StartWind& asked, const Waiting& waiting) {
    StartWind wind = asked;
    if (wind.seed == 0) wind.seed = random_seed();
    const Result<SeaTime> expected = stamp(waiting.command);
    if (!expected) return finish_refused(waiting, expected.error());
    const Result<BoxStarted> planned = world_.plan(wind, *expected);
    if (!planned) return finish_refused(waiting, planned.error());
    trace_then_start(*planned, wind, waiting, 1);
}

// Only when the land is known is the command stamped, and planned again for that time.
void SeaAuthority::trace_then_start(const BoxStarted& planned, StartWind wind, Waiting waiting, int attempt) {
    const uint64_t traced = worker_.key_of(planned.box);
    worker_.trace(planned.box, {state_->next_field},
                  [this, traced, wind, attempt, waiting = std::move(waiting)](TracedLand land,
                                                                              IndexedLand indexed) mutable {
                      const Result<SeaTime> effective = stamp(waiting.command);
                      if (!effective) return finish_refused(waiting, effective.error());
                      Result<BoxStarted> now_planned = world_.plan(wind, *effective);
                      if (!now_planned) return finish_refused(waiting, now_planned.error());
                      if (worker_.key_of(now_planned->box) != traced && attempt < most_traces)
                          return trace_then_start(*now_planned, wind, std::move(waiting), attempt + 1);
                      Planned started{{}, {}};
                      started.event.effective = *effective;
                      BoxStarted fitted = world_.fit_to_land(std::move(*now_planned), land);
                      const BoxId id = fitted.box.id;
                      started.event.what = std::move(fitted);
                      started.derived.lands.push_back(std::move(land));
                      indexed_ = std::move(indexed);
                      finish(waiting, commit(waiting.command, {std::move(started)}, id));
                  });
}

void SeaAuthority::execute(const StopWind& stop, const Waiting& waiting) {
    const Result<SeaTime> effective = stamp(waiting.command);
    if (!effective) return finish_refused(waiting, effective.error());
    const Result<BoxEnding> planned = world_.plan(stop, *effective);
    if (!planned) return finish_refused(waiting, planned.error());
    finish(waiting, commit(waiting.command, {{{0, planned->end, *planned}, {}}}, stop.box));
}

// Wakes know no land: nothing to trace.
void SeaAuthority::execute(const StartShip& ship, const Waiting& waiting) {
    const Result<SeaTime> effective = stamp(waiting.command);
    if (!effective) return finish_refused(waiting, effective.error());
    Result<BoxStarted> planned = world_.plan(ship, *effective);
    if (!planned) return finish_refused(waiting, planned.error());
    const BoxId id = planned->box.id;
    finish(waiting, commit(waiting.command, {{{0, *effective, std::move(*planned)}, {}}}, id));
}

// A moving wind's land was traced wherever it may come, and wakes know none.
void SeaAuthority::execute(const Steer& steer, const Waiting& waiting) {
    const Result<SeaTime> effective = stamp(waiting.command);
    if (!effective) return finish_refused(waiting, effective.error());
    Result<Steering> steering = world_.plan(steer, *effective);
    if (!steering) return finish_refused(waiting, steering.error());
    finish(waiting, commit(waiting.command, planned_of(*steering), steering->box));
}

void SeaAuthority::execute(const ChangeLand& change, const Waiting& waiting) {
    const Result<SeaTime> expected = stamp_land(waiting.command);
    if (!expected) return finish_refused(waiting, expected.error());
    const std::vector<BoxId> boxes = world_.on_land_at(*expected);
    worker_.change(state_, change, boxes, choice_, index_,
                   [this, boxes, change, waiting](const Result<ChangedLand>& changed) {
                       if (!changed) return finish_refused(waiting, changed.error());
                       change_land_with(*changed, boxes, change, waiting);
                   });
}

void SeaAuthority::change_land_with(const ChangedLand& changed, const std::vector<BoxId>& traced,
                                    const ChangeLand& change, const Waiting& waiting) {
    const Result<SeaTime> effective = stamp_land(waiting.command);
    if (!effective) return finish_refused(waiting, effective.error());
    // A box may have begun its decay meanwhile: then there are fewer to trace, and the fields' numbers are others.
    if (world_.on_land_at(*effective) != traced) return execute(change, waiting);
    Result<LandChanged> planned = world_.plan(change, *effective, changed.outcome.touched);
    if (!planned) return finish_refused(waiting, planned.error());
    std::vector<Planned> land(1);
    land.front().event.effective = *effective;
    land.front().event.what = std::move(*planned);
    land.front().derived = derived_from(changed.outcome);
    take_land(changed);
    finish(waiting, commit(waiting.command, std::move(land), {}));
}

// A rate takes hold at once: until clients hear of it their clocks run on at the old one, and are slewed.
void SeaAuthority::execute(const SetRate& rate, const Waiting& waiting) {
    const int64_t now_us = monotonic_us();
    const Result<ClockChanged> planned = world_.plan(rate, now_us);
    if (!planned) return finish_refused(waiting, planned.error());
    finish(waiting, commit(waiting.command, {{{0, planned->clock.start, *planned}, {}}}, {}));
}

CommandReply SeaAuthority::commit(const Command& command, std::vector<Planned> planned, BoxId box) {
    CommandReply reply;
    reply.sequence = command.sequence;
    reply.effective = planned.front().event.effective;
    reply.box = box;
    append(std::move(planned));
    publish();
    reply.log_position = state_->log_position;
    reply.message = fmt::format("takes hold at sea time {}", text_of(reply.effective));
    spdlog::info("command {}: box {}, {}, log position {}", command.sequence, box.value, reply.message,
                 reply.log_position.value);
    return reply;
}

// Events become bytes, the bytes become log, the log becomes the world's new state. The log takes all of them or none, so a journal
// that is cut short never holds a ship that has ended her course without the next one.
void SeaAuthority::append(std::vector<Planned> planned) {
    std::vector<NewEvent> batch;
    for (Planned& next : planned) {
        next.event.event_id = next_event_++;
        batch.push_back({next.event.event_id, encode(next.event)});
    }
    const AppendResult result = log_.append(world_.state()->log_position, batch);
    TROCHOID_ASSERT(std::holds_alternative<Appended>(result),
                    "this process alone writes its log, yet event {} met outcome {}", batch.front().id,
                    result.index());
    for (size_t i = 0; i < planned.size(); ++i)
        world_.apply(planned[i].event, batch[i].bytes, std::move(planned[i].derived));
}

void SeaAuthority::take_land(const ChangedLand& changed) {
    choice_ = changed.choice;
    indexed_ = changed.indexed;
    worker_.take_terrain(changed.outcome.edit.terrain, changed.terrain_hash);
}

// All events of a command at once: readers see none or all of them.
void SeaAuthority::publish() {
    state_ = world_.state();
    index_ = std::make_shared<const InterestIndex>(*state_, index_.get(), std::exchange(indexed_, {}));
    if (changed_) changed_();
}

void SeaAuthority::finish(const Waiting& waiting, CommandReply reply) {
    waiting.reply(std::move(reply));
    busy_ = false;
    next();
}

void SeaAuthority::finish_refused(const Waiting& waiting, const Error& error) {
    spdlog::info("command {} refused: {} {}", waiting.command.sequence, static_cast<unsigned>(error.code),
                 error.message);
    finish(waiting, refusal(waiting.command, error));
}

}  // namespace trochoid
