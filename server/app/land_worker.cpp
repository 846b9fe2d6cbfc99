#include "server/app/land_worker.hpp"

#include <spdlog/spdlog.h>

#include <future>
#include <utility>

#include "protocol/model/terrain_file.hpp"
#include "server/net/monotonic.hpp"

namespace trochoid {

LandWorker::LandWorker(IoLoop& loop, std::shared_ptr<const TerrainGrid> terrain, const LandSettings& settings)
    : loop_(loop), terrain_(std::move(terrain)), settings_(settings) {
    if (terrain_) terrain_hash_ = terrain_hash(*terrain_);
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

TracedLand LandWorker::trace_now(const WaveTrainBox& box, FieldId first_field) {
    if (!terrain_) return {};
    const int64_t begun_us = monotonic_us();
    TracedLand land = cache_.trace(box, *terrain_, terrain_hash_, first_field, settings_);
    size_t blocks = 0;
    for (const auto& field : land.fields) blocks += field->block_count();
    spdlog::info("traced the land of box {}: {} fields, {} blocks, {} rays in {} ms", box.id.value,
                 land.fields.size(), blocks, land.rays.size(), (monotonic_us() - begun_us) / 1000);
    return land;
}

void LandWorker::trace(WaveTrainBox box, FieldId first_field, std::function<void(TracedLand)> done) {
    loop_.assert_here();
    {
        const std::lock_guard lock(mutex_);
        jobs_.emplace_back([this, box = std::move(box), first_field, done = std::move(done)] {
            TracedLand land = trace_now(box, first_field);
            loop_.post([done, land = std::move(land)]() mutable { done(std::move(land)); });
        });
    }
    wake_.notify_one();
}

TracedLand LandWorker::trace_and_wait(const WaveTrainBox& box, FieldId first_field) {
    std::promise<TracedLand> traced;
    {
        const std::lock_guard lock(mutex_);
        jobs_.emplace_back([&] { traced.set_value(trace_now(box, first_field)); });
    }
    wake_.notify_one();
    return traced.get_future().get();
}

uint64_t LandWorker::key_of(const WaveTrainBox& box) const { return land_key(box, terrain_hash_, settings_); }

}  // namespace trochoid
