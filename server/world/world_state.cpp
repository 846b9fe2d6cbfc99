#include "server/world/world_state.hpp"

#include <algorithm>

#include "protocol/model/interest_state.hpp"
#include "protocol/model/terrain_file.hpp"
#include "protocol/units/hash.hpp"
#include "server/world/ship_box.hpp"
#include "server/world/train_spectrum.hpp"
#include "server/world/world.hpp"
#include "server/world/world_fold.hpp"

namespace trochoid {

namespace {

BoxKind kind_of(const WorldBox& box) {
    if (is_ship(box.sea->record)) return BoxKind::ship;
    if (box.sea->record.trains.empty()) return BoxKind::noise;
    return box.wind.trains > 0 ? BoxKind::wind : BoxKind::waves;
}

/// The summary's at, vx, vz, as messages.hpp says.
void place_and_motion(BoxSummary& line, const WaveTrainBox& record, SeaTime now) {
    if (line.kind == BoxKind::ship) {
        line.at = ship_place(record, now);
    } else {
        const LatticePoint corner = record.course.empty() ? record.origin : corner_at(record.course, now);
        const int64_t half = record.width / 2;
        line.at = {corner.x - ((half * record.uz) >> 30), corner.z + ((half * record.ux) >> 30)};
    }
    line.at.x = std::clamp(line.at.x, -world_bound, world_bound);
    line.at.z = std::clamp(line.at.z, -world_bound, world_bound);
    constexpr float metres_per_second = 15625.0F * 0x1p-28F;  // of Q.24 lattice units per microsecond
    for (const CourseLeg& leg : record.course) {
        if (now < leg.from) break;
        const bool sails = now < leg.from + leg.duration_us;
        line.vx = sails ? static_cast<float>(leg.vx) * metres_per_second : 0.0F;
        line.vz = sails ? static_cast<float>(leg.vz) * metres_per_second : 0.0F;
    }
}

}  // namespace

std::vector<BoxSummary> summaries(const WorldState& state, SeaTime now) {
    std::vector<BoxSummary> list;
    list.reserve(state.boxes.size());
    for (const auto& [id, box] : state.boxes) {
        const WaveTrainBox& record = box->sea->record;
        BoxSummary line;
        line.box = id;
        line.name = box->name;
        line.begin = record.begin;
        line.end = record.end;
        line.decay_us = record.decay_us;
        // A wake's waves are as high, from trough to crest, as twice their amplitude one wavelength behind the ship.
        line.significant_height = has_wake(record.wake)
                                      ? 2.0F * std::max(record.wake.transverse, record.wake.diverging)
                                      : static_cast<float>(significant_height(record.trains));
        line.kind = kind_of(*box);
        // The train of a ship that lies still is none to speak of.
        line.trains = line.kind == BoxKind::ship ? uint16_t{0} : static_cast<uint16_t>(record.trains.size());
        line.hull = record.hull;
        line.wind_speed = line.kind == BoxKind::ship ? 0.0F : box->wind.speed;
        line.towards_degrees = box->wind.towards_degrees;
        line.gain_now = static_cast<float>(instant_of(record, now).time_gain) * 0x1p-24F;
        place_and_motion(line, record, now);
        list.push_back(std::move(line));
    }
    return list;
}

namespace {

void add(Hash64& hash, const StartWind& w) {
    hash.f32(w.speed)
        .f32(w.towards_degrees)
        .i64(w.origin.x)
        .i64(w.origin.z)
        .i64(w.fetch)
        .i64(w.width)
        .i64(w.life_us);
    hash.u16(w.trains).u64(w.seed).u8(static_cast<uint8_t>(w.spectrum)).u8(static_cast<uint8_t>(w.spreading));
    hash.u16(w.directions)
        .f32(w.reference_depth)
        .f32(w.roundness)
        .f32(w.irregularity)
        .f32(w.noise)
        .f32(w.vx)
        .f32(w.vz);
}

void add(Hash64& hash, const LandField& field) {
    hash.u32(field.id().value).u8(field.step_log2()).u64(field.block_count());
    for (const auto& block : field.blocks()) hash.i32(block->key.x).i32(block->key.z).u64(hash_of(*block));
}

void add(Hash64& hash, const WaveRay& ray) {
    hash.i64(ray.start.x).i64(ray.start.z).i64(ray.end.x).i64(ray.end.z).u64(ray.points.size());
    for (const ActionPoint& point : ray.points)
        hash.i64(point.at.x).i64(point.at.z).u8(static_cast<uint8_t>(point.kind));
}

void add(Hash64& hash, const WorldBox& box) {
    hash.text(box.name).u64(hash_of(box.sea->record)).f64(box.land_growth).u32(box.predecessor.value);
    add(hash, box.wind);
    const auto fields = fields_with_bases(*box.sea);
    hash.u64(fields.size());
    for (const auto& field : fields) add(hash, *field);
    hash.u64(box.rays.size());
    for (const WaveRay& ray : box.rays) add(hash, ray);
}

}  // namespace

uint64_t hash_of(const WorldState& state) {
    Hash64 hash;
    hash.text(state.name).u64(state.log_position.value).u64(state.log_hash);
    hash.u32(state.clock.epoch)
        .i64(state.clock.start.us)
        .i64(state.clock.monotonic_start_us)
        .u32(state.clock.rate_q16);
    hash.u64(state.terrain ? terrain_hash(*state.terrain) : 0);
    hash.u32(state.next_box).u32(state.next_train).u32(state.next_field).u64(state.boxes.size());
    for (const auto& [id, box] : state.boxes) add(hash, *box);
    return hash.value();
}

}  // namespace trochoid
