#include "tests/unit/server_net/fake_sea.hpp"

#include "protocol/units/hash.hpp"
#include "server/net/monotonic.hpp"

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

Result<Role> FakeSea::role_for(const std::string& given) const {
    if (given.empty()) return Role::viewer;
    if (given == token) return Role::director;
    return Error{ErrorCode::token_refused, "wrong token"};
}

InterestState FakeSea::state_for(const ViewState& view) const {
    InterestState state;
    const auto box = the_box();
    state.boxes.emplace(box->id, box);
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
    MadeResult made;
    made.key.anchor = request.view;
    made.key.regions = request.regions;
    made.key.log_position = {revision};
    made.key.until = {1'000'000};
    if (request.previous != nullptr && *request.previous == made.key && refresh_after_us == 0)
        return std::nullopt;
    ++results_made;
    made.state = std::make_shared<const InterestState>(state_for(request.view));
    made.watermark = {1000};
    if (refresh_after_us > 0) made.refresh_at_us = monotonic_us() + refresh_after_us;
    return made;
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
