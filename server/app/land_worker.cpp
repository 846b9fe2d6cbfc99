#include "server/app/land_worker.hpp"

#include <spdlog/spdlog.h>

#include <future>
#include <utility>

#include "protocol/model/terrain_file.hpp"
#include "server/net/monotonic.hpp"

namespace trochoid {

LandWorker::LandWorker(IoLoop& loop, std::shared_ptr<const TerrainGrid> terrain, const LandSettings& settings)
    : loop_(loop), settings_(settings) {
    const uint64_t hash = terrain ? terrain_hash(*terrain) : 0;
    take_terrain(std::move(terrain), hash);
    thread_ = std::thread([this] { work(); });
}

LandWorker::~LandWorker() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
        jobs_.clear();
    }
    wake_.notify_one();
    thread_.join();
}

void LandWorker::work() {
    while (true) {
        std::function<void()> job;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
            if (stopping_) return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        job();
    }
}

void LandWorker::ask(std::function<void()> job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.push_back(std::move(job));
    }
    wake_.notify_one();
}

void LandWorker::take_terrain(std::shared_ptr<const TerrainGrid> terrain, uint64_t terrain_hash) {
    ground_ = {std::move(terrain), terrain_hash};
}

TracedLand LandWorker::trace_now(const WaveTrainBox& box, FieldId first_field, const Ground& ground) {
    if (!ground.terrain || box.trains.empty()) return {};
    const int64_t begun_us = monotonic_us();
    TracedLand land = cache_.trace(box, *ground.terrain, ground.hash, first_field, settings_);
    size_t blocks = 0;
    for (const auto& field : land.fields) blocks += field->block_count();
    spdlog::info("traced the land of box {}: {} fields, {} blocks, {} rays in {} ms", box.id.value,
                 land.fields.size(), blocks, land.rays.size(), (monotonic_us() - begun_us) / 1000);
    return land;
}

Result<ChangedLand> LandWorker::change_now(const WorldState& world, const ChangeLand& change,
                                           std::span<const BoxId> boxes, const TerrainChoice& choice,
                                           const InterestIndex* index) const {
    const int64_t begun_us = monotonic_us();
    auto outcome = change_land(world, change, boxes, settings_);
    if (!outcome) return outcome.error();
    ChangedLand changed{std::move(outcome).value(), 0, nullptr, {}};
    const TerrainEdit& edit = changed.outcome.edit;
    changed.terrain_hash = terrain_hash(*edit.terrain);
    changed.choice = std::make_shared<const TerrainChoice>(choice, edit.terrain, edit.touched);
    changed.indexed.terrain = std::make_shared<const TerrainMinima>(edit.terrain);
    size_t blocks = 0;
    for (const Retraced& next : changed.outcome.touched)
        for (const auto& field : next.land.fields) {
            blocks += field->block_count();
            changed.indexed.fields.push_back(
                index_blocks(field, index == nullptr ? nullptr : index->find(next.box)));
        }
    spdlog::info("changed {} samples of the terrain; of {} boxes {} are touched: {} blocks in {} ms",
                 edit.samples, boxes.size(), changed.outcome.touched.size(), blocks,
                 (monotonic_us() - begun_us) / 1000);
    return changed;
}

void LandWorker::trace(WaveTrainBox box, FieldId first_field,
                       std::function<void(TracedLand, IndexedLand)> done) {
    loop_.assert_here();
    ask([this, box = std::move(box), first_field, ground = ground_, done = std::move(done)] {
        TracedLand land = trace_now(box, first_field, ground);
        IndexedLand indexed;
        for (const auto& field : land.fields) indexed.fields.push_back(index_blocks(field, nullptr));
        loop_.post([done, land = std::move(land), indexed = std::move(indexed)]() mutable {
            done(std::move(land), std::move(indexed));
        });
    });
}

TracedLand LandWorker::trace_and_wait(const WaveTrainBox& box, FieldId first_field) {
    std::promise<TracedLand> traced;
    ask([&] { traced.set_value(trace_now(box, first_field, ground_)); });
    return traced.get_future().get();
}

void LandWorker::change(std::shared_ptr<const WorldState> world, ChangeLand change, std::vector<BoxId> boxes,
                        std::shared_ptr<const TerrainChoice> choice,
                        std::shared_ptr<const InterestIndex> index,
                        std::function<void(Result<ChangedLand>)> done) {
    loop_.assert_here();
    ask([this, world = std::move(world), change = std::move(change), boxes = std::move(boxes),
         choice = std::move(choice), index = std::move(index), done = std::move(done)] {
        auto changed = change_now(*world, change, boxes, *choice, index.get());
        loop_.post([done, changed = std::move(changed)]() mutable { done(std::move(changed)); });
    });
}

Result<ChangedLand> LandWorker::change_and_wait(std::shared_ptr<const WorldState> world,
                                                const ChangeLand& change, std::vector<BoxId> boxes,
                                                std::shared_ptr<const TerrainChoice> choice) {
    std::promise<Result<ChangedLand>> changed;
    ask([&] { changed.set_value(change_now(*world, change, boxes, *choice, nullptr)); });
    return changed.get_future().get();
}

uint64_t LandWorker::key_of(const WaveTrainBox& box) const { return land_key(box, ground_.hash, settings_); }

}  // namespace trochoid
