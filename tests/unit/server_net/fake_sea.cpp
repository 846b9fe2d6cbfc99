#include "tests/unit/server_net/fake_sea.hpp"

#include <chrono>
#include <thread>

#include "protocol/units/hash.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/probe_answer.hpp"

namespace trochoid {

namespace {

std::shared_ptr<const WaveTrainBox> the_box() {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    WaveTrain train;
    train.kx = 42950;  // 97.7 m
    train.omega = 1'000'000'000'000;
    train.amplitude = 0.5F;
    train.choppiness = 1.0F;
    box.trains = {train};
    return std::make_shared<const WaveTrainBox>(box);
}

// 256 trains in which no column says anything about the next value.
std::shared_ptr<const WaveTrainBox> bulky_box(uint32_t number, uint64_t revision) {
    WaveTrainBox box;
    box.id = {2 + number};
    box.first_train = {1001 + 256 * number};
    for (uint64_t i = 0; i < 256; ++i) {
        const uint64_t noise = splitmix64(i + 256 * (number + 4096 * revision));
        WaveTrain train;
        train.kx = static_cast<int32_t>(noise >> 40) + 1;
        train.kz = static_cast<int32_t>(noise & 0xFFFFFF) + 1;
        train.omega = splitmix64(noise) >> 16;
        train.phase = static_cast<uint32_t>(splitmix64(noise + 1));
        train.amplitude = 0.25F;
        box.trains.push_back(train);
    }
    return std::make_shared<const WaveTrainBox>(box);
}

}  // namespace

HelloFacts FakeSea::hello_facts() const {
    HelloFacts facts;
    facts.world = "fake";
    facts.instance.bytes[0] = 7;
    facts.log_position = {revision};
    if (tiles > 0) facts.terrain = {0, 0, 15, 1025, 1025, 5, -61440};
    return facts;
}

ClockFacts FakeSea::clock_facts() const { return {SeaClock{}, SeaTime{1000}, LogPosition{revision}, 99}; }

// A ticket is the role and the session's number, in the open.
Result<LoginDecision> FakeSea::login(const ClientHello& hello, bool /*loopback*/) {
    if (hello.ticket.size() == 9) {
        LoginDecision decision{static_cast<Role>(hello.ticket[0]), 0};
        for (size_t i = 1; i < 9; ++i) decision.last_session = decision.last_session << 8 | hello.ticket[i];
        return decision;
    }
    if (hello.token.empty()) return LoginDecision{};
    if (hello.token == token) return LoginDecision{Role::director, 0};
    return Error{ErrorCode::token_refused, "wrong token"};
}

IssuedTicket FakeSea::new_ticket(uint64_t session, Role role) {
    IssuedTicket issued{{static_cast<uint8_t>(role)}, 600'000};
    for (int shift = 56; shift >= 0; shift -= 8)
        issued.ticket.push_back(static_cast<uint8_t>(session >> shift));
    return issued;
}

InterestState FakeSea::state_for(const ViewState& view) const {
    InterestState state;
    const auto box = the_box();
    state.boxes.emplace(box->id, box);
    for (uint32_t i = 0; i < bulk; ++i) {
        const auto one = bulky_box(i, revision);
        state.boxes.emplace(one->id, one);
    }
    const auto first = static_cast<int32_t>(view.position.x >> 16);
    for (uint32_t i = 0; i < patches; ++i) {
        PatchDescriptor patch;
        patch.key = {16, first + static_cast<int32_t>(i % 32), static_cast<int32_t>(i / 32)};
        patch.boxes = {{box->id, 1}};
        patch.left_out = static_cast<float>(revision) * 0x1p-10F;
        state.patches.emplace(patch.key, patch);
    }
    return state;
}

std::optional<MadeResult> FakeSea::make_result(const ResultRequest& request) {
    std::this_thread::sleep_for(std::chrono::microseconds(costs_us));
    return result_for(request);
}

std::optional<MadeResult> FakeSea::result_for(const ResultRequest& request) {
    MadeResult made;
    made.key.anchor = request.view;
    made.key.regions = request.regions;
    made.key.log_position = {revision};
    made.key.until = {1'000'000};
    if (request.previous != nullptr && *request.previous == made.key && refresh_after_us == 0)
        return std::nullopt;
    ++results_made;
    InterestState state = state_for(request.view);
    if (lies.exchange(false)) {
        auto wrong = std::make_shared<WaveTrainBox>(*the_box());
        wrong->trains[0].phase ^= 1U << 22;
        state.boxes[wrong->id] = wrong;
    }
    made.state = std::make_shared<const InterestState>(std::move(state));
    made.watermark = {1000};
    if (refresh_after_us > 0) made.refresh_at_us = monotonic_us() + refresh_after_us;
    return made;
}

void FakeSea::make_result_aside(const ResultRequest& request,
                                const std::function<void(std::optional<MadeResult>)>& done) {
    ++asked_aside;
    if (!holds_aside) return done(result_for(request));
    aside_.emplace_back([done, made = result_for(request)] { done(made); });
}

bool FakeSea::release_aside() {
    if (aside_.empty()) return false;
    const auto first = std::move(aside_.front());
    aside_.pop_front();
    first();
    return true;
}

Resumption FakeSea::resume(const ResumeState& claim) {
    ++resumes_asked;
    if (claim.instance != hello_facts().instance) return {ResumeVerdict::other_instance, {}};
    auto state = std::make_shared<const InterestState>(state_for(claim.key.anchor));
    if (hash_of(*state) != claim.state_hash) return {ResumeVerdict::other_state, {}};
    return {ResumeVerdict::resumed, {claim.key, std::move(state), {1000}, INT64_MAX}};
}

ProbeReply FakeSea::probe(const InterestState& state, const Probe& probe) const {
    InterestState truth = state;
    truth.boxes[the_box()->id] = the_box();
    return answer_probe(truth, probe);
}

InterestDelta FakeSea::change(const InterestState& base, const InterestState& target, const CullKey&) const {
    return difference(base, target);
}

std::vector<TerrainTileKey> FakeSea::tiles_for(const ViewState&) {
    std::vector<TerrainTileKey> keys;
    for (uint32_t i = 0; i < tiles; ++i)
        keys.push_back({0, static_cast<int32_t>(i % 16), static_cast<int32_t>(i / 16)});
    return keys;
}

uint32_t FakeSea::tile_revision(TerrainTileKey key) const {
    return static_cast<uint32_t>(key.z * 16 + key.x) < changed_tiles ? 1 : 0;
}

TerrainTile FakeSea::tile(TerrainTileKey key) {
    TerrainTile tile;
    tile.key = key;
    tile.origin_x = int64_t{key.x} * 64 * 32768;
    tile.origin_z = int64_t{key.z} * 64 * 32768;
    tile.spacing_log2 = 15;
    tile.height_step_log2 = 5;
    tile.heights.resize(size_t{terrain_tile_samples} * terrain_tile_samples);
    uint64_t noise = static_cast<uint64_t>(key.x) + 1 + 1000U * tile_revision(key);
    for (int16_t& height : tile.heights) height = static_cast<int16_t>(noise = splitmix64(noise));
    return tile;
}

void FakeSea::command(const Command& command, Role role, uint64_t, std::function<void(CommandReply)> reply) {
    CommandReply answer;
    answer.sequence = command.sequence;
    if (role == Role::viewer) answer.code = ErrorCode::token_required;
    answer.message = "as you wish";
    reply(answer);
}

BoxList FakeSea::list_boxes() const {
    BoxList list;
    for (uint32_t i = 1; i <= 1024; ++i) {
        BoxSummary box;
        box.box = {i};
        box.name = "wind " + std::to_string(i);
        list.boxes.push_back(box);
    }
    return list;
}

Result<SampleReply> FakeSea::sample(const SampleRequest& request) const {
    SampleReply reply;
    reply.sequence = request.sequence;
    reply.time = request.time;
    reply.samples.resize(request.points.size());
    return reply;
}

Result<RaysReply> FakeSea::rays(const RaysRequest& request) const {
    if (request.box.value != 1) return Error{ErrorCode::unknown_box, "no such box"};
    RaysReply reply;
    reply.sequence = request.sequence;
    reply.box = request.box;
    WaveRay ray;
    ray.end = {1024, 1024};
    ray.points.assign(64, {{512, 512}, ActionKind::blocked});
    reply.rays.assign(128, ray);
    return reply;
}

}  // namespace trochoid
