#include "server/world/world_state.hpp"

#include "protocol/units/hash.hpp"
#include "server/world/train_spectrum.hpp"
#include "server/world/world.hpp"

namespace trochoid {

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
        line.trains = static_cast<uint16_t>(record.trains.size());
        line.significant_height = static_cast<float>(significant_height(record.trains));
        line.wind_speed = box->wind.speed;
        line.towards_degrees = box->wind.towards_degrees;
        line.gain_now = static_cast<float>(instant_of(record, now).time_gain) * 0x1p-24F;
        list.push_back(std::move(line));
    }
    return list;
}

uint64_t hash_of(const WorldState& state) {
    Hash64 hash;
    hash.text(state.name).u64(state.log_position.value).u64(state.log_hash);
    hash.u32(state.clock.epoch)
        .i64(state.clock.start.us)
        .i64(state.clock.monotonic_start_us)
        .u32(state.clock.rate_q16);
    hash.u32(state.next_box).u32(state.next_train).u32(state.next_field).u64(state.boxes.size());
    for (const auto& [id, box] : state.boxes) {
        hash.text(box->name)
            .u64(hash_of(box->sea->record))
            .f64(box->land_growth)
            .u64(box->sea->fields.size());
        for (const auto& field : box->sea->fields) {
            hash.u32(field->id().value).u8(field->step_log2()).u64(field->block_count());
            for (const auto& block : field->blocks()) hash.u64(hash_of(*block));
        }
    }
    return hash.value();
}

}  // namespace trochoid
