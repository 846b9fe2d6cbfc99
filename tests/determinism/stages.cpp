#include "tests/determinism/stages.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "protocol/model/point_query.hpp"
#include "protocol/model/terrain_file.hpp"
#include "protocol/units/hash.hpp"
#include "server/interest/cull.hpp"
#include "server/interest/cull_key.hpp"
#include "tests/determinism/fast_path.hpp"
#include "tests/determinism/fault.hpp"
#include "tests/determinism/places.hpp"
#include "tests/determinism/surface_fields.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;
/// After the opening: at once, a moment, an hour, 30 days, ten years.
constexpr std::array<int64_t, 5> after_opening{0, 1'234'567, 3600 * second, 2'592'000 * second,
                                               315'576'000 * second};
/// Of a scene with commands besides: how long after each of them; in the midst of the cross-fade after a change of the land.
constexpr int64_t after_command = 3'300'000;
constexpr uint32_t points_around = 40;

/// Calls f(0), f(1), … f(count - 1) on the threads; results go to places of their own, so their order does not matter.
void in_parallel(size_t count, uint32_t threads, const std::function<void(size_t)>& f) {
    std::atomic<size_t> next{0};
    const auto work = [&] {
        for (size_t i = next++; i < count; i = next++) f(i);
    };
    std::vector<std::thread> others;
    for (uint32_t i = 1; i < threads; ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
}

void trace_world(Trace& trace, const std::string& stage, const WorldState& state) {
    trace.begin_stage(stage);
    if (state.terrain) {
        trace.at("terrain", {});
        trace.u64("hash", terrain_hash(*state.terrain));
    }
    for (const auto& [id, held] : state.boxes) {
        const WaveTrainBox& box = held->sea->record;
        trace.at(fmt::format("box {}", id.value), box.begin);
        trace.i64("origin.x", box.origin.x);
        trace.i64("origin.z", box.origin.z);
        trace.u32("ux", static_cast<uint32_t>(box.ux));
        trace.u32("uz", static_cast<uint32_t>(box.uz));
        trace.i64("length", box.length);
        trace.i64("width", box.width);
        trace.i64("build_up_us", box.build_up_us);
        trace.i64("end", box.end.us);
        trace.u32("front_speed", box.front_speed);
        trace.u32("gain_max", box.gain_max);
        for (size_t i = 0; i < box.trains.size(); ++i) {
            const WaveTrain& train = box.trains[i];
            const auto field = [i](const char* name) { return fmt::format("train[{}].{}", i, name); };
            trace.u32(field("kx"), static_cast<uint32_t>(train.kx));
            trace.u32(field("kz"), static_cast<uint32_t>(train.kz));
            trace.u64(field("omega"), train.omega);
            trace.u32(field("phase"), train.phase);
            trace.f32(field("amplitude"), train.amplitude);
            trace.f32(field("choppiness"), train.choppiness);
            trace.u32(field("field"), train.field.value);
        }
        trace.f64("land_growth", held->land_growth);
        // The rest of the record: ramps, course, irregular heights, noise, wake.
        trace.u64("record", hash_of(box));
    }
}

void trace_land_fields(Trace& trace, const std::string& stage, const WorldState& state) {
    trace.begin_stage(stage);
    for (const auto& [id, held] : state.boxes)
        for (const auto& field : held->sea->fields)
            for (const auto& block : field->blocks()) {
                trace.at(fmt::format("box {} field {} block {},{}", id.value, field->id().value, block->key.x,
                                     block->key.z),
                         held->sea->record.begin);
                trace.rows("shift", std::span<const int32_t>(block->shift), block_nodes);
                trace.rows("gain", std::span<const uint16_t>(block->gain), block_nodes);
                trace.rows("orbit", std::span<const uint16_t>(block->orbit), block_nodes);
            }
}

void trace_constants(Trace& trace, const std::string& stage, const Sea& sea) {
    trace.begin_stage(stage);
    for (const auto& box : sea.boxes())
        for (size_t i = 0; i < box->constants.size(); ++i) {
            const TrainConstants& c = box->constants[i];
            trace.at(fmt::format("box {} train {}", box->record.id.value, i), box->record.begin);
            trace.f32("k", c.k);
            trace.f32("dx", c.dx);
            trace.f32("dz", c.dz);
            trace.f32("kx", c.kx);
            trace.f32("kz", c.kz);
            trace.f32("a", c.a);
            trace.f32("hx", c.hx);
            trace.f32("hz", c.hz);
            trace.f32("wavelength", c.wavelength);
            trace.f32("omega", c.omega);
            trace.u32("whole", c.whole);
        }
}

/// A ship's deck, level; and from 400 m down at 30 degrees.
std::array<ViewState, 2> cameras_at(LatticePoint place) {
    ViewState deck;
    deck.position = place;
    deck.altitude = 12 * lattice_per_metre;
    ViewState above = deck;
    above.altitude = 400 * lattice_per_metre;
    above.qx = -0x1.0907dcp-2F;
    above.qw = 0x1.ee8dd4p-1F;
    above.accepted_error_px = 2.0F;
    return {deck, above};
}

void trace_patches(Trace& trace, const std::string& stage, const WorldState& state,
                   std::span<const SeaTime> ticks, uint32_t threads) {
    trace.begin_stage(stage);
    const InterestIndex index(state);
    struct View {
        SeaTime tick;
        ViewState camera;
        CullKey key;
        CullResult result;
    };
    std::vector<View> views;
    for (const SeaTime tick : ticks)
        for (const LatticePoint place : places_to_look_at(SeaInstant(state.sea, tick)))
            for (const ViewState& camera : cameras_at(place)) views.push_back({tick, camera, {}, {}});
    in_parallel(views.size(), threads, [&](size_t i) {
        View& view = views[i];
        const std::array<SyncRegion, 1> hull{{{view.camera.position, 256U * 1024U}}};
        view.key = choose_key(index, view.camera, hull, nullptr, view.tick);
        view.result = cull(index, view.key);
    });
    const bool spoil = fault_in(stage);
    for (size_t i = 0; i < views.size(); ++i) {
        const View& view = views[i];
        const InterestState& seen = view.result.state;
        trace.at(fmt::format("view {}", i), view.tick);
        trace.u64("key", hash_of(view.key));
        trace.f32("error_in_force_px", view.key.error_in_force_px);
        for (const auto& [key, patch] : seen.patches) {
            trace.at(fmt::format("view {} tile {}/{},{}", i, key.level, key.x, key.z), view.tick);
            for (const PatchBox& box : patch.boxes) {
                trace.u32("box", box.box.value);
                trace.u32("train_count", box.train_count);
            }
            trace.f32("left_out", patch.left_out);
            const bool spoil_this = spoil && i == 1 && key == std::next(seen.patches.begin(), 3)->first;
            trace.f32("height_error", spoil_this ? one_ulp_off(patch.height_error) : patch.height_error);
        }
        trace.at(fmt::format("view {}", i), view.tick);
        trace.u64("state", hash_of(seen));
    }
}

struct Probe {
    LatticePoint point;
    SurfaceSample surface;
    SurfaceSample displayed;
    WaterPoint water;
};

/// Near the place mostly, every fourth within 4 km, every eighth within 300 km.
LatticePoint point_near(LatticePoint place, uint32_t i) {
    const uint64_t a = splitmix64(0x7ace + i);
    const uint64_t b = splitmix64(a);
    const int64_t reach = (i % 8 == 7 ? 300'000 : i % 4 == 3 ? 4000 : 128) * lattice_per_metre;
    const auto spread = static_cast<uint64_t>(2 * reach);
    return {place.x + static_cast<int64_t>(a % spread) - reach,
            place.z + static_cast<int64_t>(b % spread) - reach};
}

void trace_surface(Trace& trace, std::string_view kind, const SurfaceSample& surface) {
    for (const auto& [name, value] : surface_fields)
        trace.f32(fmt::format("{}{}", kind, name), surface.*value);
}

void trace_displacement(Trace& trace, const std::string& stage, const Sea& sea,
                        std::span<const SeaTime> ticks, uint32_t threads) {
    trace.begin_stage(stage);
    const bool spoil = fault_in(stage);
    for (const SeaTime tick : ticks) {
        const SeaInstant instant(sea, tick);
        const SeaInstant shown(sea, tick, displayed_layers);
        const std::vector<LatticePoint> places = places_to_look_at(instant);
        std::vector<Probe> probes(places.size() * points_around);
        in_parallel(probes.size(), threads, [&](size_t i) {
            Probe& probe = probes[i];
            probe.point = point_near(places[i / points_around], static_cast<uint32_t>(i));
            probe.surface = instant.evaluate(probe.point);
            probe.displayed = shown.evaluate(probe.point);
            if (i % 4 == 0) probe.water = water_at(instant, probe.point);
        });
        if (spoil && tick == ticks[2]) probes[5].surface.ay = one_ulp_off(probes[5].surface.ay);
        for (size_t i = 0; i < probes.size(); ++i) {
            const Probe& probe = probes[i];
            trace.at(tile_and_point(probe.point), tick);
            trace_surface(trace, "", probe.surface);
            trace_surface(trace, "displayed.", probe.displayed);
            if (i % 4 != 0) continue;
            for (const auto& [name, value] : water_fields) trace.f32(name, probe.water.*value);
            trace.i64("water.rest.x", probe.water.rest.x);
            trace.i64("water.rest.z", probe.water.rest.z);
        }
    }
}

/// What the authority answered, the log's bytes by their hash, and the world, after each command. Whoever reads the log's bytes alone
/// has to come to the same world.
void trace_live_log(Trace& trace, const FoldedScene& scene) {
    trace.begin_stage("live-log");
    for (size_t i = 0; i < scene.live.size(); ++i) {
        const LiveStep& step = scene.live[i];
        const CommandReply& reply = step.reply;
        trace.at(fmt::format("command {}", i), reply.effective);
        trace.u32("code", static_cast<uint32_t>(reply.code));
        trace.u32("box", reply.box.value);
        trace.u64("log_position", step.log_position.value);
        trace.u64("log_hash", step.log_hash);
        trace.u64("world", step.world_hash);
    }
    trace.u64("followed", scene.followed);
    if (scene.followed != hash_of(*scene.lived))
        trace.disagree("followed", "replaying the log's bytes gives another world than the authority's");
}

/// All that a state means: `kind` goes before the stages' names.
void trace_state(Trace& trace, const std::string& kind, const WorldState& state,
                 std::span<const SeaTime> ticks, std::span<const SeaTime> views, uint32_t threads) {
    trace_world(trace, kind + "world", state);
    trace_land_fields(trace, kind + "land", state);
    const Sea sea = spoiled(state.sea);
    trace_constants(trace, kind + "constants", sea);
    trace_patches(trace, kind + "patch", state, views, threads);
    trace_displacement(trace, kind + "displacement", sea, ticks, threads);
    trace_fast_path(trace, kind + "vectors", sea, ticks, threads);
}

}  // namespace

void trace_stages(Trace& trace, const FoldedScene& scene, uint32_t threads) {
    std::vector<SeaTime> ticks;
    for (const int64_t after : after_opening) ticks.push_back(scene.opens + after);
    trace_state(trace, "", *scene.state, ticks, std::array{ticks[0], ticks[2]}, threads);
    if (!scene.live.empty()) {
        ticks.clear();
        for (const LiveStep& step : scene.live)
            if (step.reply.code == ErrorCode::none) ticks.push_back(step.reply.effective + after_command);
        trace_live_log(trace, scene);
        trace_state(trace, "live-", *scene.lived, ticks, std::array{ticks[0], ticks.back()}, threads);
    }
    trace.finish();
}

}  // namespace trochoid
