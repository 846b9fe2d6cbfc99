#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tests/conformance/local_sea.hpp"
#include "tests/conformance/server/refusals.hpp"

// a change of the land that the server carries out, seen by whoever looks on: reply, successors, fields, tiles, and the same sea
// to the bit. For scenes with land; it stays changed.
namespace trochoid::conformance::server {

namespace {

// A server traces all waves that the change reaches anew.
constexpr Milliseconds tracing{90'000};

ChangeLand breakwater(const Target& target) {
    const TerrainInfo& grid = target.hello.terrain;
    const int64_t spacing = int64_t{1} << grid.spacing_log2;
    // So wide that samples of the grid lie on its crest.
    const int64_t width = std::clamp<int64_t>(4 * spacing, 20 * lattice_per_metre, 1'000 * lattice_per_metre);
    ChangeLand change;
    change.line = {{target.place.x - 3 * width, target.place.z},
                   {target.place.x + 3 * width, target.place.z}};
    change.width = static_cast<float>(width) / static_cast<float>(lattice_per_metre);
    change.crest = 6.0F;
    return change;
}

CommandReply await_reply(ServerPeer& peer, uint32_t sequence) {
    const Deadline deadline(tracing);
    while (auto message = peer.receive(deadline.left()))
        if (const auto* reply = std::get_if<CommandReply>(&*message); reply && reply->sequence == sequence)
            return *reply;
    throw Failed{fmt::format("no reply to ChangeLand came within {} s", tracing.count() / 1000)};
}

void await_position(ServerPeer& peer, LogPosition position) {
    const Deadline deadline(peer.target().patience);
    while (!peer.held().last() || peer.held().last()->key.log_position < position)
        if (!peer.receive(deadline.left()))
            throw Failed{fmt::format("no result with the change (log position {}) came", position.value)};
}

bool same_waves(const WaveTrainBox& a, const WaveTrainBox& b) {
    return std::equal(a.trains.begin(), a.trains.end(), b.trains.begin(), b.trains.end(),
                      [](WaveTrain one, WaveTrain other) {
                          one.field = other.field = FieldId{};
                          return one == other;
                      });
}

/// What chapter 7 says of a successor and the box before it.
void check_successor(const WaveTrainBox& next, const WaveTrainBox& old, SeaTime effective) {
    const auto require = [&](bool holds, const char* what) {
        if (!holds)
            throw Failed{fmt::format("box {}, which succeeds box {}: {}", next.id.value, old.id.value, what)};
    };
    require(next.id > old.id, "its id is not above its predecessor's");
    require(old.end == effective, "its predecessor does not end when it begins");
    require(old.decay_us == next.fade_us, "it does not fade in as its predecessor decays");
    require(next.raised_us == (effective - old.begin) + old.raised_us,
            "it is not raised as far as its predecessor was old");
    require(next.build_up_us == old.build_up_us && next.front_speed == old.front_speed, "it grows otherwise");
    for (size_t i = 0; i < next.trains.size(); ++i) {
        const FieldId field = next.trains[i].field;
        if (field == old.trains[i].field) continue;
        require(field > old.trains[i].field, "a changed field's id is not new");
        if (old.trains[i].field.value == 0) continue;
        require(std::any_of(next.overlays.begin(), next.overlays.end(),
                            [&](const FieldOverlay& o) { return o.field == field && o.base < field; }),
                "a changed field lies over none");
    }
}

/// The number of successors, and the longest cross-fade.
std::pair<size_t, int64_t> check_successors(const InterestState& state, SeaTime effective) {
    size_t count = 0;
    int64_t fade_us = 0;
    for (const auto& held : state.boxes) {
        const BoxId id = held.first;
        const auto& next = held.second;
        if (next->begin != effective || next->fade_us == 0) continue;
        const auto with_its_waves = [&](const auto& entry) {
            return entry.first != id && same_waves(*entry.second, *next);
        };
        auto old = std::find_if(state.boxes.begin(), state.boxes.end(), [&](const auto& entry) {
            return with_its_waves(entry) && entry.second->end == effective;
        });
        if (old == state.boxes.end())
            old = std::find_if(state.boxes.begin(), state.boxes.end(), with_its_waves);
        if (old == state.boxes.end())
            throw Failed{fmt::format("box {} takes over from a box that is not there", id.value)};
        check_successor(*next, *old->second, effective);
        fade_us = std::max(fade_us, next->fade_us);
        ++count;
    }
    return {count, fade_us};
}

/// The server's samples at that time against what its records make up here.
void compare_at(ServerPeer& peer, LatticePoint place, SeaTime time) {
    const Deadline deadline(tracing);
    while (!peer.held().last() || time > peer.held().last()->key.until)
        if (!peer.receive(deadline.left())) throw Failed{"no result reaches as far as the cross-fade"};
    std::vector<LatticePoint> points;
    for (int64_t i = -6; i <= 6; ++i) points.push_back({place.x + i * 7'001, place.z + (i * i - 18) * 3'001});
    const SampleReply reply = peer.ask_samples(time, points);
    const SeaInstant sea(local_sea(peer.held().state()), time);
    for (size_t i = 0; i < points.size(); ++i)
        if (const std::string differs = difference_of(reply.samples[i], sea.evaluate(points[i]));
            !differs.empty())
            throw Failed{fmt::format("R-204: the sample at ({}, {}), {} us: {}", points[i].x, points[i].z,
                                     time.us, differs)};
}

/// Whether the tile has the crest at that place.
bool shows_crest(const TerrainTile& tile, LatticePoint place, float crest) {
    const int64_t column = (place.x - tile.origin_x) >> tile.spacing_log2;
    const int64_t row = (place.z - tile.origin_z) >> tile.spacing_log2;
    if (column < 0 || row < 0 || column > terrain_tile_cells || row > terrain_tile_cells) return false;
    const auto at = static_cast<size_t>(row * terrain_tile_samples + column);
    const double metres = static_cast<double>(int64_t{tile.heights[at]} << tile.height_step_log2) /
                          static_cast<double>(lattice_per_metre);
    return metres >= static_cast<double>(crest) - 0.1;
}

void build(ServerTrial& trial) {
    const Target& target = trial.target();
    if (target.hello.terrain.columns == 0) throw Skipped{"the scene has no terrain"};
    ClientHello hello = ServerPeer::usual_hello();
    hello.view = view_of_water(target);
    hello.regions = {{target.place, 300 * 1024}};
    ServerPeer& onlooker = trial.log_in(hello);
    ServerPeer& peer = trial.log_in_as(Role::director, hello);
    peer.await_result(0);
    onlooker.await_result(0);
    const ChangeLand change = breakwater(target);
    bool shown = false;
    peer.watch([&](const ServerMessage& message, int64_t) {
        if (const auto* tiles = std::get_if<TerrainTiles>(&message))
            for (const TerrainTile& tile : tiles->tiles)
                shown = shown || shows_crest(tile, target.place, change.crest);
    });
    Command command;
    command.sequence = peer.next_sequence();
    command.action = change;
    const int64_t asked_us = monotonic_us();
    peer.send(command);
    const CommandReply reply = await_reply(peer, command.sequence);
    if (reply.code != ErrorCode::none)
        throw Failed{fmt::format("the change was refused with code {} ({})",
                                 static_cast<unsigned>(reply.code), reply.message)};
    trial.note(fmt::format("answered after {} ms", (monotonic_us() - asked_us) / 1000));
    // Every result's hash is compared on its way in.
    await_position(peer, reply.log_position);
    await_position(onlooker, reply.log_position);
    const auto [count, fade_us] = check_successors(peer.held().state(), reply.effective);
    if (count == 0) throw Skipped{"the change in the middle of the scene reaches no waves there"};
    check_successors(onlooker.held().state(), reply.effective);
    trial.note(fmt::format("{} boxes succeeded, cross-fade {} s", count, fade_us / microseconds_per_second));

    Command second = command;
    second.sequence = peer.next_sequence();
    second.refuse_if_late = true;
    peer.send(second);
    if (const CommandReply late = await_reply(peer, second.sequence); late.code != ErrorCode::too_late)
        throw Failed{
            fmt::format("during the cross-fade a second change with refuse_if_late has code {}, not {}",
                        static_cast<unsigned>(late.code), static_cast<unsigned>(ErrorCode::too_late))};
    compare_at(peer, target.place, {reply.effective.us + fade_us / 2});
    compare_at(onlooker, target.place, {reply.effective.us + fade_us / 2});
    const Deadline deadline(target.patience);
    while (!shown && peer.receive(deadline.left())) {
    }
    if (!shown) throw Failed{"R-136: no tile came that shows the new land"};
}

}  // namespace

void add_land_change_cases(Catalogue& all) {
    Case made = server_case(
        "R-143/breakwater",
        "A breakwater: the reply, the successors, their fields, the tiles, and the sea in between", build);
    made.course = Course::alone;
    made.connections = 2;
    all.push_back(std::move(made));
}

}  // namespace trochoid::conformance::server
