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

// 1 to 2^63 - 1, as scene files allow.
uint64_t random_seed() {
    std::random_device device;
    const uint64_t bits = (uint64_t{device()} << 32) | device();
    return std::max<uint64_t>(bits >> 1, 1);
}

[[noreturn]] void refuse_scene(const std::string& what, const Error& error) {
    throw OperatorError(
        fmt::format("the scene's {} cannot be: {}; correct the scene file", what, error.message));
}

}  // namespace

SeaAuthority::SeaAuthority(IoLoop& loop, World& world, EventLog& log, LandWorker& worker, uint32_t lead_ms,
                           uint32_t node)
    : loop_(loop),
      world_(world),
      log_(log),
      worker_(worker),
      lead_ms_(lead_ms),
      node_(node),
      state_(world.state()),
      choice_(std::make_shared<const TerrainChoice>(state_->terrain)) {
    index_ = std::make_shared<const InterestIndex>(*state_);
    learn_from_log();
}

SeaTime SeaAuthority::now() const { return sea_time_at(state_->clock, monotonic_us()); }

void SeaAuthority::open(const Scene& scene) {
    // What falls still only later makes no room for what begins later still.
    world_.set_present(scene.clock_start);
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
    if (const LandRoom room = world_.room_for_land(planned->box.begin);
        blocks_of(derived.lands.front()) > room.left())
        refuse_scene(fmt::format("'{}'", name), too_much_land(room));
    BoxStarted started = world_.fit_to_land(*planned, derived.lands.front());
    const SeaTime begin = started.box.begin;
    append_to_own(single({0, begin, std::move(started)}, std::move(derived)));
}

void SeaAuthority::open_breakwaters(const Scene& scene) {
    for (size_t i = 0; i < scene.breakwaters.size(); ++i) {
        const std::string name = fmt::format("breakwater {}", i + 1);
        const LandAnswer answer =
            worker_.change_and_wait({world_.state(), {scene.breakwaters[i]}, {}, choice_, nullptr});
        if (!answer.changed) refuse_scene(name, answer.refused.front().value());
        auto planned = world_.plan(scene.breakwaters[i], scene.clock_start, {});
        if (!planned) refuse_scene(name, planned.error());
        append_to_own(single({0, scene.clock_start, std::move(planned).value()},
                             derived_from(answer.changed->outcome)));
        take_land(*answer.changed);
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
        append_to_own(planned_of(*steering));
        box = steering->box;
    }
}

void SeaAuthority::command(const Command& asked, Reply reply, uint64_t session) {
    loop_.assert_here();
    TROCHOID_ASSERT(!std::holds_alternative<ListBoxes>(asked.action), "lists change nothing");
    Command command = asked;
    if (auto* wind = std::get_if<StartWind>(&command.action); wind != nullptr && wind->seed == 0)
        wind->seed = random_seed();
    if (auto done = at_once(command)) return reply(std::move(*done));
    if (const auto room = queue_.has_room(session); !room) return reply(refused(command, room.error()));
    queue_.push({command, std::move(reply), session});
    go_on();
}

// The reply to a command for which nothing has to be traced; none where it has to wait for its turn.
std::optional<CommandReply> SeaAuthority::at_once(const Command& command) {
    if (const auto* wind = std::get_if<StartWind>(&command.action))
        return start_on_open_water(*wind, command);
    if (const auto* change = std::get_if<ChangeLand>(&command.action)) {
        if (const auto ok = validate(*change); !ok) return refused(command, ok.error());
        if (state_->terrain) return std::nullopt;
        return refused(command, {ErrorCode::no_terrain,
                                 "this world is open sea without a terrain: open a scene that has one to "
                                 "change it"});
    }
    // A box that is still to come may be one of those in the queue.
    const auto is_to_come = [this](BoxId box) { return box.value >= state_->next_box; };
    const auto* steer = std::get_if<Steer>(&command.action);
    const auto* stop = std::get_if<StopWind>(&command.action);
    const bool names_one =
        (steer != nullptr && is_to_come(steer->box)) || (stop != nullptr && is_to_come(stop->box));
    if (names_one && (tracing_ || !queue_.empty())) return std::nullopt;
    return carry_out(command);
}

Result<SeaTime> SeaAuthority::stamp(const Command& command) {
    const SeaTime present = now();
    world_.set_present(present);
    return effective_time(command.at, present, earliest() - present, command.refuse_if_late);
}

// A wind beside the terrain is started at once; none: its land has to be traced.
std::optional<CommandReply> SeaAuthority::start_on_open_water(const StartWind& wind, const Command& command) {
    while (true) {
        const Result<SeaTime> effective = stamp(command);
        if (!effective) return refused(command, effective.error());
        Result<BoxStarted> planned = world_.plan(wind, *effective);
        if (!planned) return refused(command, planned.error());
        std::optional<TracedLand> land = worker_.open_water(planned->box, {state_->next_field});
        if (!land) return std::nullopt;
        BoxStarted fitted = world_.fit_to_land(std::move(*planned), *land);
        const BoxId id = fitted.box.id;
        Derived derived;
        derived.lands.push_back(std::move(*land));
        if (Attempt reply =
                commit(command, single({0, *effective, std::move(fitted)}, std::move(derived)), id))
            return reply;
    }
}

CommandReply SeaAuthority::carry_out(const Command& command) {
    const auto once = [&](const auto& action) -> Attempt {
        if constexpr (requires { attempt(action, command); }) return attempt(action, command);
        TROCHOID_ASSERT(false, "action {} is not carried out at once", command.action.index());
        return CommandReply{};
    };
    while (true)
        if (Attempt reply = std::visit(once, command.action)) return std::move(*reply);
}

SeaAuthority::Attempt SeaAuthority::attempt(const StopWind& stop, const Command& command) {
    const Result<SeaTime> effective = stamp(command);
    if (!effective) return refused(command, effective.error());
    const Result<BoxEnding> planned = world_.plan(stop, *effective);
    if (!planned) return refused(command, planned.error());
    return commit(command, single({0, planned->end, *planned}, {}), stop.box);
}

// Wakes know no land: nothing to trace.
SeaAuthority::Attempt SeaAuthority::attempt(const StartShip& ship, const Command& command) {
    const Result<SeaTime> effective = stamp(command);
    if (!effective) return refused(command, effective.error());
    Result<BoxStarted> planned = world_.plan(ship, *effective);
    if (!planned) return refused(command, planned.error());
    const BoxId id = planned->box.id;
    return commit(command, single({0, *effective, std::move(*planned)}, {}), id);
}

// A moving wind's land was traced wherever it may come, and wakes know none.
SeaAuthority::Attempt SeaAuthority::attempt(const Steer& steer, const Command& command) {
    const Result<SeaTime> effective = stamp(command);
    if (!effective) return refused(command, effective.error());
    const Result<Steering> steering = world_.plan(steer, *effective);
    if (!steering) return refused(command, steering.error());
    return commit(command, planned_of(*steering), steering->box);
}

// A rate takes hold at once: until clients hear of it their clocks run on at the old one, and are slewed.
SeaAuthority::Attempt SeaAuthority::attempt(const SetRate& rate, const Command& command) {
    const Result<ClockChanged> planned = world_.plan(rate, monotonic_us());
    if (!planned) return refused(command, planned.error());
    return commit(command, single({0, planned->clock.start, *planned}, {}), {});
}

// Like a rate at once; what was still to come before the new present has then happened.
SeaAuthority::Attempt SeaAuthority::attempt(const SkipTime& skip, const Command& command) {
    const Result<ClockChanged> planned = world_.plan(skip, monotonic_us());
    if (!planned) return refused(command, planned.error());
    return commit(command, single({0, planned->clock.start, *planned}, {}), {});
}

SeaAuthority::Attempt SeaAuthority::commit(const Command& command, std::vector<Planned> planned, BoxId box,
                                           const ChangedLand* land) {
    CommandReply reply;
    reply.sequence = command.sequence;
    reply.effective = planned.front().event.effective;
    reply.box = box;
    if (!append(std::move(planned))) {
        follow();
        return std::nullopt;
    }
    if (land != nullptr) take_land(*land);
    publish();
    reply.log_position = state_->log_position;
    reply.message = fmt::format("takes hold at sea time {}", text_of(reply.effective));
    spdlog::info("command {}: box {}, {}, log position {}", command.sequence, box.value, reply.message,
                 reply.log_position.value);
    return reply;
}

// Events become bytes, the bytes become log, the log becomes the world's new state. The log takes all of them or none, so a journal
// that is cut short never holds a ship that has ended her course without the next one. False: another node was first, nothing is done.
bool SeaAuthority::append(std::vector<Planned> planned) {
    std::vector<NewEvent> batch;
    for (Planned& next : planned) {
        next.event.event_id = (uint64_t{node_} << event_number_bits) | next_event_++;
        next.event.present = world_.present();
        batch.push_back({next.event.event_id, encode(next.event)});
    }
    const LogPosition expected = world_.state()->log_position;
    const AppendResult result = log_.append(expected, batch);
    if (node_ != 0 && std::holds_alternative<Conflict>(result)) return false;
    const auto* appended = std::get_if<Appended>(&result);
    TROCHOID_ASSERT(appended != nullptr, "event {} of node {} met outcome {} of the log", batch.front().id,
                    node_, result.index());
    // Another place: the log has held an event of this number before, and not taken this one.
    TROCHOID_ASSERT(appended->position == expected,
                    "event {} of node {} is at position {} of the log, not {}", batch.front().id, node_,
                    appended->position.value, expected.value);
    for (size_t i = 0; i < planned.size(); ++i) {
        if (const auto* clock = std::get_if<ClockChanged>(&planned[i].event.what))
            clock_changes(clock->clock);
        world_.apply(planned[i].event, batch[i].bytes, std::move(planned[i].derived));
    }
    TROCHOID_ASSERT(appended->log_hash == world_.state()->log_hash,
                    "the log's hash at position {} is not the world's", world_.state()->log_position.value);
    return true;
}

// While a scene opens, other nodes do not write yet.
void SeaAuthority::append_to_own(std::vector<Planned> planned) {
    const bool first = append(std::move(planned));
    TROCHOID_ASSERT(first, "another node has written the log at position {} while the scene opened",
                    world_.state()->log_position.value);
}

void SeaAuthority::take_land(const ChangedLand& changed) {
    choice_ = changed.choice;
    indexed_ = changed.indexed;
    worker_.take_terrain(changed.outcome.edit.terrain, changed.terrain_hash);
}

// All events of a command at once: readers see none or all of them.
void SeaAuthority::publish() {
    renew();
    if (changed_) changed_();
}

CommandReply SeaAuthority::refused(const Command& command, const Error& error) {
    spdlog::info("command {} refused: {} {}", command.sequence, static_cast<unsigned>(error.code),
                 error.message);
    CommandReply reply;
    reply.sequence = command.sequence;
    reply.code = error.code;
    reply.message = error.message;
    return reply;
}

}  // namespace trochoid
