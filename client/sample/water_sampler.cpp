#include "client/sample/water_sampler.hpp"

#include <algorithm>

#include "protocol/model/simd/water_batch.hpp"

namespace trochoid {

bool contains(const SyncRegion& region, LatticePoint place) {
    const int64_t dx = place.x - region.centre.x;
    const int64_t dz = place.z - region.centre.z;
    const int64_t r = region.radius;
    // Bounds first, so the squares stay far below 2^63.
    if (dx > r || dx < -r || dz > r || dz < -r) return false;
    return dx * dx + dz * dz <= r * r;
}

WaterSampler::WaterSampler(std::shared_ptr<const StoreSnapshot> snapshot, SeaTime t, Layers layers)
    : snapshot_(std::move(snapshot)), instant_(snapshot_->sea, t, layers) {}

const PatchDescriptor* WaterSampler::patch_at(LatticePoint place) const {
    for (uint8_t level = finest_patch_level; level <= coarsest_patch_level; ++level) {
        const auto found = snapshot_->interest->patches.find(trochoid::patch_at(place, level));
        if (found != snapshot_->interest->patches.end()) return &found->second;
    }
    return nullptr;
}

Trust WaterSampler::trust(LatticePoint place) const {
    const SeaTime t = instant_.time();
    const auto& regions = snapshot_->regions;
    const bool kept = t >= snapshot_->key.from - sync_history_us;
    if (kept &&
        std::any_of(regions.begin(), regions.end(), [&](const SyncRegion& r) { return contains(r, place); }))
        return Trust::exact;
    // A patch's bound speaks of its key's span of time and of the authoritative sea only.
    const bool in_span =
        instant_.layers() == authoritative_layers && t >= snapshot_->key.from && t < snapshot_->key.until;
    return in_span && patch_at(place) != nullptr ? Trust::bounded : Trust::unknown;
}

WaterAnswer WaterSampler::answer(LatticePoint place, const WaterPoint& water) const {
    WaterAnswer answer;
    answer.water = water;
    answer.trust = trust(place);
    answer.confirmed = instant_.time() <= snapshot_->watermark;
    if (answer.trust == Trust::bounded) answer.height_error = patch_at(place)->height_error;
    return answer;
}

// A place alone would leave the other lanes of the fast path's vectors empty: the reference is as fast.
WaterAnswer WaterSampler::water(LatticePoint place) const { return answer(place, water_at(instant_, place)); }

std::vector<WaterAnswer> WaterSampler::water(std::span<const LatticePoint> places) const {
    Workers one_core(1);
    std::vector<WaterPoint> water(places.size());
    water_at_batch(instant_, places, water, one_core);
    std::vector<WaterAnswer> answers;
    answers.reserve(places.size());
    for (size_t i = 0; i < places.size(); ++i) answers.push_back(answer(places[i], water[i]));
    return answers;
}

std::vector<SurfaceSample> WaterSampler::surface(std::span<const LatticePoint> rests) const {
    Workers one_core(1);
    std::vector<SurfaceSample> samples(rests.size());
    evaluate_batch(instant_, rests, samples, one_core);
    return samples;
}

}  // namespace trochoid
