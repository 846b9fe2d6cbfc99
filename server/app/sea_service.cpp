#include "server/app/sea_service.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/model/simd/water_batch.hpp"
#include "protocol/wire/session_rules.hpp"
#include "server/interest/cull.hpp"
#include "server/interest/cull_key.hpp"
#include "server/interest/patch_priority.hpp"
#include "server/interest/patch_selection.hpp"
#include "server/net/monotonic.hpp"

namespace trochoid {

SeaService::SeaService(SeaAuthority& authority, WorldInstance instance, TokenDoor& door, ResultWorker* aside)
    : authority_(authority), instance_(instance), door_(door), aside_(aside) {}

HelloFacts SeaService::hello_facts() const {
    const WorldState& world = *authority_.state();
    HelloFacts facts;
    facts.world = world.name;
    facts.instance = instance_;
    facts.log_position = world.log_position;
    facts.clock = world.clock;
    if (const TerrainGrid* grid = world.terrain.get()) {
        facts.projection = grid->projection;
        facts.origin_lon = grid->origin_lon;
        facts.origin_lat = grid->origin_lat;
        facts.terrain = {grid->origin_x, grid->origin_z,         grid->spacing_log2,  grid->columns,
                         grid->rows,     grid->height_step_log2, grid->open_sea_depth};
    }
    return facts;
}

ClockFacts SeaService::clock_facts() const {
    const WorldState& world = *authority_.state();
    return {world.clock, authority_.watermark(), world.log_position, world.log_hash};
}

// When three quarters of the key's span have passed on the sea's clock; a paused sea never gets there.
int64_t SeaService::refresh_at_us(const CullKey& key) const {
    const SeaClock& clock = authority_.state()->clock;
    if (clock.rate_q16 == 0) return INT64_MAX;
    const int64_t sea_us = key.until - authority_.now() - span_default_us / 4;
    return monotonic_us() +
           std::max<int64_t>(sea_us, 0) / std::max<int64_t>(clock.rate_q16, 1) * (int64_t{1} << 16) + 1000;
}

namespace {

// What a result is made from, wherever that happens: nothing of it changes.
struct ResultTask {
    std::shared_ptr<const InterestIndex> index;
    ViewState view;
    std::vector<SyncRegion> regions;
    std::optional<CullKey> previous;
    SeaTime now;
    SeaTime watermark;
    Motion motion;
};

std::optional<MadeResult> result_of(const ResultTask& task) {
    const CullKey* previous = task.previous ? &*task.previous : nullptr;
    CullKey key = choose_key(*task.index, task.view, task.regions, previous, task.now, span_default_us,
                             Limits{}.patches, task.motion);
    if (previous != nullptr && *previous == key) return std::nullopt;
    MadeResult made;
    made.state = std::make_shared<const InterestState>(cull(*task.index, key).state);
    made.key = std::move(key);
    made.watermark = task.watermark;
    return made;
}

ResultTask task_of(SeaAuthority& authority, const ResultRequest& request) {
    // A view may be as old as the interval at which sessions consider them when it is taken up.
    constexpr double view_interval_s = 0.1;
    const Motion motion{static_cast<double>(request.round_trip_us) * 1e-6 + view_interval_s, request.turn};
    const auto previous =
        request.previous != nullptr ? std::optional<CullKey>(*request.previous) : std::nullopt;
    return {authority.index(), request.view,          request.regions, previous,
            authority.now(),   authority.watermark(), motion};
}

}  // namespace

std::optional<MadeResult> SeaService::make_result(const ResultRequest& request) {
    std::optional<MadeResult> made = result_of(task_of(authority_, request));
    if (made) made->refresh_at_us = refresh_at_us(made->key);
    return made;
}

void SeaService::make_result_aside(const ResultRequest& request,
                                   const std::function<void(std::optional<MadeResult>)>& done) {
    if (aside_ == nullptr) return done(make_result(request));
    // Shared: a std::function is copied, and what the task holds may be the last of an old world.
    auto task = std::make_shared<const ResultTask>(task_of(authority_, request));
    aside_->ask([this, task = std::move(task), done] {
        auto made = std::make_shared<std::optional<MadeResult>>(result_of(*task));
        return [this, made = std::move(made), done] {
            if (*made) {
                (*made)->refresh_at_us = refresh_at_us((*made)->key);
                // Nothing has come since: what is promised now holds of it too.
                if ((*made)->key.log_position == authority_.state()->log_position)
                    (*made)->watermark = authority_.watermark();
            }
            done(std::move(*made));
        };
    });
}

// Cheap checks first; what is left costs one cull, of no more patches than any view may ask for.
ResumeVerdict SeaService::judge(const ResumeState& claim, MadeResult& held) const {
    if (claim.instance != instance_) return ResumeVerdict::other_instance;
    // From another node, which has read more of the log: what is there is read now, not at the next look.
    const LogPosition told = std::max(claim.log_position, claim.key.log_position);
    if (told > authority_.state()->log_position) authority_.follow();
    const auto log_hash = authority_.log_hash_at(claim.log_position);
    if (!log_hash) return ResumeVerdict::unknown_position;
    if (*log_hash != claim.log_hash) return ResumeVerdict::other_history;
    const LogPosition position = claim.key.log_position;
    if (position > authority_.state()->log_position) return ResumeVerdict::unknown_position;
    // No span begins in a future that sea time has not reached.
    if (!could_be_chosen(claim.key) || claim.key.from > authority_.now()) return ResumeVerdict::no_such_key;
    const auto index = authority_.index_at(position);
    if (!index) return ResumeVerdict::too_old;
    if (!costs_no_more(*index, claim.key)) return ResumeVerdict::no_such_key;
    held.state = std::make_shared<const InterestState>(cull(*index, claim.key).state);
    return hash_of(*held.state) == claim.state_hash ? ResumeVerdict::resumed : ResumeVerdict::other_state;
}

Resumption SeaService::resume(const ResumeState& claim) {
    Resumption resumption;
    resumption.verdict = judge(claim, resumption.held);
    if (resumption.verdict != ResumeVerdict::resumed) return resumption;
    resumption.held.key = claim.key;
    resumption.held.watermark = authority_.watermark();
    resumption.held.refresh_at_us = refresh_at_us(claim.key);
    return resumption;
}

InterestDelta SeaService::change(const InterestState& base, const InterestState& target,
                                 const CullKey& key) const {
    InterestDelta delta = difference(base, target);
    sort_by_priority(delta.patches, key.anchor);
    return delta;
}

void SeaService::command(const Command& command, Role role, uint64_t session,
                         std::function<void(CommandReply)> reply) {
    const Result<Done> allowed = permitted(role, command);
    if (allowed) return authority_.command(command, std::move(reply), session);
    CommandReply refused;
    refused.sequence = command.sequence;
    refused.code = allowed.error().code;
    refused.message = fmt::format(
        "{}: {}", allowed.error().message,
        door_.knows_keys() ? "sign it with a key whose public half this server was started with (--token-key)"
                           : "start this server with --token-key FILE.pub, and sign it with the key FILE");
    reply(refused);
}

BoxList SeaService::list_boxes() const {
    BoxList list;
    list.now = authority_.now();
    list.boxes = summaries(*authority_.state(), list.now);
    return list;
}

Result<SampleReply> SeaService::sample(const SampleRequest& request) const {
    const WorldState& world = *authority_.state();
    SampleReply reply;
    reply.sequence = request.sequence;
    reply.time = request.time;
    reply.log_position = world.log_position;
    const SeaInstant instant(world.sea, request.time);
    // On the io thread's own core: a request's few hundred points take a fraction of a millisecond.
    Workers one_core(1);
    reply.samples.resize(request.points.size());
    evaluate_batch(instant, request.points, reply.samples, one_core);
    return reply;
}

Result<RaysReply> SeaService::rays(const RaysRequest& request) const {
    const WorldState& world = *authority_.state();
    const auto box = world.boxes.find(request.box);
    if (box == world.boxes.end())
        return Error{ErrorCode::unknown_box,
                     fmt::format("there is no box {}: list them first", request.box.value)};
    RaysReply reply;
    reply.sequence = request.sequence;
    reply.box = request.box;
    reply.rays = box->second->rays;
    return reply;
}

}  // namespace trochoid
