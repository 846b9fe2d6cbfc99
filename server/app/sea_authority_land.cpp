// The commands that wait for land to be traced.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "protocol/units/assert.hpp"
#include "server/app/sea_authority.hpp"
#include "server/land/land_trace.hpp"
#include "server/world/effective_time.hpp"

namespace trochoid {

namespace {

// While a box was traced another node may have changed the land: a second trace is nearly always enough. Land that is not that of the
// event may never be used: whoever reads the event traces it for himself.
constexpr int most_traces = 3;
Error land_never_rests() {
    return {ErrorCode::queue_overflow,
            fmt::format("busy: the land has changed {} times while this wind's was traced; try again later",
                        most_traces)};
}

// How long a change of the land may have to wait for those before it, sea time. Winds cannot be stopped before the changes that they
// are to outlive, so these must not pile up.
constexpr int64_t longest_land_wait_us = 6 * land_fade_us;

const ChangeLand& change_of(const WaitingCommand& waiting) {
    return std::get<ChangeLand>(waiting.command.action);
}

}  // namespace

void SeaAuthority::session_over(uint64_t session) {
    loop_.assert_here();
    if (const size_t dropped = queue_.drop(session); dropped > 0)
        spdlog::info("session {} is over: {} of its commands were not begun and are dropped", session,
                     dropped);
}

void SeaAuthority::answer(const WaitingCommand& waiting, CommandReply reply) {
    reply.sequence = waiting.command.sequence;
    waiting.reply(std::move(reply));
}

void SeaAuthority::go_on() {
    while (!tracing_ && !queue_.empty()) {
        WaitingCommand next = queue_.pop();
        if (const auto* wind = std::get_if<StartWind>(&next.command.action))
            begin(StartWind(*wind), std::move(next));
        else if (std::holds_alternative<ChangeLand>(next.command.action))
            begin_land_change(std::move(next));
        else
            answer(next, carry_out(next.command));
    }
}

void SeaAuthority::begin(const StartWind& wind, WaitingCommand waiting) {
    const Result<SeaTime> expected = stamp(waiting.command);
    if (!expected) return answer(waiting, refused(waiting.command, expected.error()));
    const Result<BoxStarted> planned = world_.plan(wind, *expected);
    if (!planned) return answer(waiting, refused(waiting.command, planned.error()));
    if (const LandRoom room = world_.room_for_land(*expected); room.left() == 0)
        return answer(waiting, refused(waiting.command, too_much_land(room)));
    tracing_ = true;
    trace_then_start(*planned, wind, std::move(waiting), 1);
}

// Only when the land is known is the command stamped, and planned again for that time.
void SeaAuthority::trace_then_start(const BoxStarted& planned, const StartWind& wind, WaitingCommand waiting,
                                    int attempt) {
    const uint64_t traced = worker_.key_of(planned.box);
    worker_.trace(planned.box, {state_->next_field},
                  [this, traced, wind, attempt, waiting = std::move(waiting)](TracedLand land,
                                                                              IndexedLand indexed) mutable {
                      const Result<SeaTime> effective = stamp(waiting.command);
                      Result<BoxStarted> planned_now =
                          effective ? world_.plan(wind, *effective) : Result<BoxStarted>(effective.error());
                      const bool in_vain = planned_now && worker_.key_of(planned_now->box) != traced;
                      if (in_vain && attempt < most_traces)
                          return trace_then_start(*planned_now, wind, std::move(waiting), attempt + 1);
                      tracing_ = false;
                      if (!planned_now)
                          answer(waiting, refused(waiting.command, planned_now.error()));
                      else if (in_vain)
                          answer(waiting, refused(waiting.command, land_never_rests()));
                      else
                          start_traced(*planned_now, std::move(waiting), std::move(land), std::move(indexed));
                      go_on();
                  });
}

void SeaAuthority::start_traced(const BoxStarted& planned, WaitingCommand waiting, TracedLand land,
                                IndexedLand indexed) {
    // Another node's land may have come meanwhile, and taken the numbers.
    if (!land.fields.empty() && land.fields.front()->id() != FieldId{state_->next_field}) {
        land = with_first_field(land, {state_->next_field});
        indexed = {};
    }
    const SeaTime effective = planned.box.begin;
    if (const LandRoom room = world_.room_for_land(effective); blocks_of(land) > room.left())
        return answer(waiting, refused(waiting.command, too_much_land(room)));
    BoxStarted fitted = world_.fit_to_land(planned, land);
    const BoxId id = fitted.box.id;
    Derived derived;
    derived.lands.push_back(std::move(land));
    indexed_ = std::move(indexed);
    const Attempt reply =
        commit(waiting.command, single({0, effective, std::move(fitted)}, std::move(derived)), id);
    if (reply) return answer(waiting, *reply);
    indexed_ = {};
    const StartWind wind = std::get<StartWind>(waiting.command.action);
    begin(wind, std::move(waiting));
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

// Changes that follow in the queue and would take hold no later are traced with the first: the log then has one event for all, in
// their order, and one cross-fade shows them.
void SeaAuthority::begin_land_change(WaitingCommand first) {
    const Result<SeaTime> expected = stamp_land(first.command);
    if (!expected) return answer(first, refused(first.command, expected.error()));
    first.begun = true;
    Together changes;
    changes.push_back(std::move(first));
    const auto joins = [&](const Command& next) {
        // One that must be met to the microsecond goes alone.
        return std::holds_alternative<ChangeLand>(next.action) && next.at <= *expected &&
               !next.refuse_if_late;
    };
    const bool alone = changes.front().command.refuse_if_late;
    while (!alone && changes.size() <= most_joined_changes && !queue_.empty() &&
           joins(queue_.front()->command)) {
        WaitingCommand joining = queue_.pop();
        joining.begun = true;
        if (const auto time = stamp_land(joining.command); time)
            changes.push_back(std::move(joining));
        else
            answer(joining, refused(joining.command, time.error()));
    }
    tracing_ = true;
    trace_changes(std::move(changes), *expected, nullptr);
}

void SeaAuthority::trace_changes(Together changes, SeaTime expected,
                                 std::shared_ptr<const ChangedLand> earlier) {
    LandTask task{state_, {}, world_.on_land_at(expected), choice_, index_};
    for (const WaitingCommand& waiting : changes) task.changes.push_back(change_of(waiting));
    const LandRoom room = world_.room_for_land(expected);
    if (!task.boxes.empty() && room.left() == 0) return one_by_one(std::move(changes), too_much_land(room));
    // What overlays hide is let go with them, so that more may come up than there seems to be room for; what is left counts in the end.
    task.most_blocks = std::max(room.left(), room.most / 2);
    task.earlier = std::move(earlier);
    worker_.change(std::move(task), [this, changes = std::move(changes)](const LandAnswer& traced) mutable {
        changes_traced(std::move(changes), traced);
    });
}

// One that is refused after others of its batch is answered only when these have come to be: without them it might have been possible.
void SeaAuthority::changes_traced(Together changes, const LandAnswer& traced) {
    if (traced.changed) return change_land_with(traced.changed, std::move(changes));
    if (traced.error) return one_by_one(std::move(changes), too_much_land(world_.room_for_land(now())));
    tracing_ = false;
    for (size_t i = 0; i < changes.size(); ++i)
        answer(changes[i], refused(changes[i].command, traced.refused[i].value()));
    go_on();
}

// What cannot be all at once may be one after the other: the first is tried alone. One that is alone is refused.
void SeaAuthority::one_by_one(Together changes, const Error& error) {
    Together first(1);
    first.front() = std::move(changes.front());
    for (size_t i = changes.size(); i-- > 1;) queue_.put_back(std::move(changes[i]));
    const bool alone = changes.size() == 1;
    const Result<SeaTime> expected = stamp_land(first.front().command);
    if (!alone && expected) return trace_changes(std::move(first), *expected, nullptr);
    tracing_ = false;
    answer(first.front(), refused(first.front().command, alone ? error : expected.error()));
    go_on();
}

// Only now are the commands stamped, for the same time all of them. Where one has come too late, the others begin anew without it.
void SeaAuthority::change_land_with(const std::shared_ptr<const ChangedLand>& changed, Together changes) {
    SeaTime effective{-sea_time_bound};
    std::vector<ChangeLand> wanted;
    Together in_time;
    for (size_t i = 0; i < changes.size(); ++i) {
        if (!changed->refused[i]) {
            const Result<SeaTime> time = stamp_land(changes[i].command);
            if (!time) {
                answer(changes[i], refused(changes[i].command, time.error()));
                continue;
            }
            effective = std::max(effective, *time);
            wanted.push_back(change_of(changes[i]));
        }
        in_time.push_back(std::move(changes[i]));
    }
    if (in_time.size() != changes.size()) {
        while (!in_time.empty()) {
            queue_.put_back(std::move(in_time.back()));
            in_time.pop_back();
        }
        tracing_ = false;
        return go_on();
    }
    // A box may have begun its decay meanwhile, or a new one begun beside the land: then the fields' numbers are others.
    if (!worker_.still_holds(changed->outcome, *state_, world_.on_land_at(effective)))
        return trace_changes(std::move(in_time), effective, changed);
    const ChangeLand first = wanted.front();
    wanted.erase(wanted.begin());
    Result<LandChanged> planned = world_.plan(first, effective, changed->outcome.touched, std::move(wanted));
    if (!planned) return one_by_one(std::move(in_time), planned.error());
    const Attempt reply = commit(in_time.front().command,
                                 single({0, effective, std::move(*planned)}, derived_from(changed->outcome)),
                                 {}, changed.get());
    if (!reply) return trace_changes(std::move(in_time), effective, changed);
    tracing_ = false;
    for (size_t i = 0; i < in_time.size(); ++i) {
        const std::optional<Error>& error = changed->refused[i];
        answer(in_time[i], error ? refused(in_time[i].command, *error) : *reply);
    }
    go_on();
}

}  // namespace trochoid
