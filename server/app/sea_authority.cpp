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

std::string text_of(SeaTime t) { return fmt::format("{:.3f} s", static_cast<double>(t.us) * 1e-6); }

}  // namespace

SeaAuthority::SeaAuthority(IoLoop& loop, World& world, EventLog& log, LandWorker& worker, uint32_t lead_ms)
    : loop_(loop), world_(world), log_(log), worker_(worker), lead_ms_(lead_ms), state_(world.state()) {
    index_ = std::make_shared<const InterestIndex>(*state_);
}

SeaTime SeaAuthority::now() const { return sea_time_at(state_->clock, monotonic_us()); }

SeaTime SeaAuthority::watermark() {
    loop_.assert_here();
    promised_ = std::max(promised_, now() + lead_in_sea_time(state_->clock, lead_ms_));
    return promised_;
}

void SeaAuthority::open(const Scene& scene) {
    const auto start = [this](const std::string& name, const Result<BoxStarted>& planned) {
        if (!planned)
            throw OperatorError(fmt::format("the scene's '{}' cannot be: {}; correct the scene file", name,
                                            planned.error().message));
        TracedLand land = worker_.trace_and_wait(planned->box, {state_->next_field});
        LogEvent event;
        BoxStarted started = world_.fit_to_land(*planned, land);
        event.effective = started.box.begin;
        event.what = std::move(started);
        append(std::move(event), std::move(land));
    };
    for (const SceneWind& wind : scene.winds) start(wind.name, world_.plan(wind.wind, wind.begin, wind.name));
    for (const SceneBox& box : scene.boxes) start(box.name, world_.plan(box));
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
        const auto action = waiting.command.action;
        if (const auto* start = std::get_if<StartWind>(&action))
            execute(*start, std::move(waiting));
        else if (const auto* stop = std::get_if<StopWind>(&action))
            execute(*stop, waiting);
        else
            execute(std::get<SetRate>(action), waiting);
    }
}

Result<SeaTime> SeaAuthority::stamp(const Command& command) {
    const SeaTime present = now();
    return effective_time(command.at, present, watermark() - present, command.refuse_if_late);
}

void SeaAuthority::execute(const StartWind& asked, Waiting waiting) {
    StartWind wind = asked;
    if (wind.seed == 0) wind.seed = random_seed();
    const Result<SeaTime> expected = stamp(waiting.command);
    if (!expected) return finish_refused(waiting, expected.error());
    const Result<BoxStarted> planned = world_.plan(wind, *expected);
    if (!planned) return finish_refused(waiting, planned.error());
    trace_then_start(*planned, wind, std::move(waiting), 1);
}

// Only when the land is known is the command stamped, and planned again for that time.
void SeaAuthority::trace_then_start(const BoxStarted& planned, StartWind wind, Waiting waiting, int attempt) {
    const uint64_t traced = worker_.key_of(planned.box);
    worker_.trace(planned.box, {state_->next_field},
                  [this, traced, wind, attempt, waiting = std::move(waiting)](TracedLand land) mutable {
                      const Result<SeaTime> effective = stamp(waiting.command);
                      if (!effective) return finish_refused(waiting, effective.error());
                      Result<BoxStarted> now_planned = world_.plan(wind, *effective);
                      if (!now_planned) return finish_refused(waiting, now_planned.error());
                      if (worker_.key_of(now_planned->box) != traced && attempt < most_traces)
                          return trace_then_start(*now_planned, wind, std::move(waiting), attempt + 1);
                      LogEvent event;
                      event.effective = *effective;
                      BoxStarted started = world_.fit_to_land(std::move(*now_planned), land);
                      const BoxId id = started.box.id;
                      event.what = std::move(started);
                      finish(waiting, commit(waiting.command, std::move(event), std::move(land), id));
                  });
}

void SeaAuthority::execute(const StopWind& stop, const Waiting& waiting) {
    const Result<SeaTime> effective = stamp(waiting.command);
    if (!effective) return finish_refused(waiting, effective.error());
    const Result<BoxEnding> planned = world_.plan(stop, *effective);
    if (!planned) return finish_refused(waiting, planned.error());
    LogEvent event;
    event.effective = *effective;
    event.what = *planned;
    finish(waiting, commit(waiting.command, std::move(event), {}, stop.box));
}

// A rate takes hold at once: until clients hear of it their clocks run on at the old one, and are slewed.
void SeaAuthority::execute(const SetRate& rate, const Waiting& waiting) {
    const int64_t now_us = monotonic_us();
    const Result<ClockChanged> planned = world_.plan(rate, now_us);
    if (!planned) return finish_refused(waiting, planned.error());
    LogEvent event;
    event.effective = planned->clock.start;
    event.what = *planned;
    finish(waiting, commit(waiting.command, std::move(event), {}, {}));
}

CommandReply SeaAuthority::commit(const Command& command, LogEvent event, TracedLand land, BoxId box) {
    CommandReply reply;
    reply.sequence = command.sequence;
    reply.effective = event.effective;
    reply.box = box;
    append(std::move(event), std::move(land));
    reply.log_position = state_->log_position;
    reply.message = fmt::format("takes hold at sea time {}", text_of(reply.effective));
    spdlog::info("command {}: box {}, {}, log position {}", command.sequence, box.value, reply.message,
                 reply.log_position.value);
    return reply;
}

// The event becomes bytes, the bytes become log, the log becomes the world's new state.
void SeaAuthority::append(LogEvent event, TracedLand land) {
    event.event_id = next_event_++;
    const Bytes bytes = encode(event);
    const AppendResult result = log_.append(state_->log_position, event.event_id, bytes);
    TROCHOID_ASSERT(std::holds_alternative<Appended>(result),
                    "this process alone writes its log, yet event {} met outcome {}", event.event_id,
                    result.index());
    state_ = world_.apply(event, bytes, std::move(land));
    index_ = std::make_shared<const InterestIndex>(*state_, index_.get());
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
