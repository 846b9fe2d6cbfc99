#include "server/land/land_cache.hpp"

#include <algorithm>

#include "protocol/units/hash.hpp"
#include "server/land/land_trace.hpp"

namespace trochoid {

uint64_t land_key(const WaveTrainBox& box, uint64_t terrain_hash, const LandSettings& s) {
    Hash64 hash;
    hash.u64(terrain_hash);
    const LatticePoint origin = box.course.empty() ? box.origin : corner_at(box.course, box.begin);
    hash.u8(box.course.empty() ? 0 : 1);
    hash.i64(origin.x).i64(origin.z).i32(box.ux).i32(box.uz).i64(box.length).i64(box.width);
    hash.u64(box.trains.size());
    for (const WaveTrain& train : box.trains) hash.i32(train.kx).i32(train.kz).f32(train.amplitude);
    hash.u8(s.step_log2)
        .u8(s.rows_per_node)
        .u8(static_cast<uint8_t>(s.refraction))
        .u8(static_cast<uint8_t>(s.shoaling))
        .u8(static_cast<uint8_t>(s.diffraction))
        .u8(s.shallow_orbits ? 1 : 0);
    for (const double v : {s.depth_min, s.run_up, s.breaking_ratio, s.recovery, s.spread, s.growth,
                           s.shore_decrease, s.phase_shift_turns, s.steepness_max, s.turn_limit,
                           s.crest_spread, s.run_out, s.waves_per_node_max})
        hash.f64(v);
    return hash.u32(s.nodes_max).value();
}

TracedLand LandCache::trace(const WaveTrainBox& box, const TerrainGrid& terrain, uint64_t terrain_hash,
                            FieldId first_field, const LandSettings& settings) {
    const uint64_t key = land_key(box, terrain_hash, settings);
    if (terrain_hash != terrain_hash_) {
        entries_.clear();
        blocks_ = 0;
        terrain_hash_ = terrain_hash;
    }
    const auto known =
        std::find_if(entries_.begin(), entries_.end(), [key](const Entry& e) { return e.key == key; });
    if (known != entries_.end()) {
        ++hits_;
        entries_.splice(entries_.begin(), entries_, known);
        return with_first_field(known->land, first_field);
    }
    ++misses_;
    TracedLand land = trace_land(box, terrain, first_field, settings);
    entries_.push_front({key, land, blocks_of(land)});
    blocks_ += entries_.front().blocks;
    while (entries_.size() > capacity_ || (entries_.size() > 1 && blocks_ > most_blocks_)) {
        blocks_ -= entries_.back().blocks;
        entries_.pop_back();
    }
    return land;
}

}  // namespace trochoid
