#include "server/app/land_worker.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <future>
#include <utility>

#include "protocol/model/terrain_file.hpp"
#include "server/land/land_area.hpp"
#include "server/land/land_trace.hpp"
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

/// The terrain with all changes that can be, and what follows from it alone; null where none can be.
std::shared_ptr<ChangedLand> LandWorker::ground_of(const LandTask& task, LandAnswer& answer) const {
    auto changed = std::make_shared<ChangedLand>();
    if (task.earlier && task.earlier->outcome.world->terrain == task.world->terrain) {
        changed->outcome.edit = task.earlier->outcome.edit;
        changed->refused = task.earlier->refused;
        changed->terrain_hash = task.earlier->terrain_hash;
        changed->choice = task.earlier->choice;
        changed->indexed.terrain = task.earlier->indexed.terrain;
        return changed;
    }
    std::optional<TerrainEdit> sum;
    for (size_t i = 0; i < task.changes.size(); ++i) {
        auto next = edited(sum ? *sum->terrain : *task.world->terrain, task.changes[i]);
        if (!next)
            answer.refused[i] = next.error();
        else
            sum = sum ? followed_by(*sum, std::move(next).value()) : std::move(next).value();
    }
    if (!sum) return nullptr;
    changed->refused = answer.refused;
    changed->outcome.edit = std::move(*sum);
    const TerrainEdit& edit = changed->outcome.edit;
    changed->terrain_hash = terrain_hash(*edit.terrain);
    changed->choice = std::make_shared<const TerrainChoice>(*task.choice, edit.terrain, edit.touched);
    changed->indexed.terrain = std::make_shared<const TerrainMinima>(edit.terrain);
    return changed;
}

void LandWorker::index_fields(const LandTask& task, ChangedLand& changed) {
    for (const Retraced& next : changed.outcome.touched)
        for (const auto& field : next.land.fields) {
            const auto same = [&](const auto& known) { return known->field == field; };
            if (task.earlier) {
                const auto& known = task.earlier->indexed.fields;
                const auto place = std::find_if(known.begin(), known.end(), same);
                if (place != known.end()) {
                    changed.indexed.fields.push_back(*place);
                    continue;
                }
            }
            changed.indexed.fields.push_back(
                index_blocks(field, task.index == nullptr ? nullptr : task.index->find(next.box)));
        }
}

LandAnswer LandWorker::change_now(const LandTask& task) const {
    const int64_t begun_us = monotonic_us();
    LandAnswer answer;
    answer.refused.resize(task.changes.size());
    const auto changed = ground_of(task, answer);
    if (!changed) return answer;
    auto outcome = trace_edit(task.world, std::move(changed->outcome.edit), task.boxes, settings_,
                              task.most_blocks, task.earlier ? &task.earlier->outcome : nullptr);
    if (!outcome) {
        answer.error = outcome.error();
        return answer;
    }
    changed->outcome = std::move(outcome).value();
    index_fields(task, *changed);
    size_t blocks = 0;
    for (const Retraced& next : changed->outcome.touched) blocks += blocks_of(next.land);
    spdlog::info("{} changes of {} samples of the terrain; of {} boxes {} are touched: {} blocks in {} ms",
                 task.changes.size(), changed->outcome.edit.samples, task.boxes.size(),
                 changed->outcome.touched.size(), blocks, (monotonic_us() - begun_us) / 1000);
    answer.changed = changed;
    return answer;
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

void LandWorker::change(LandTask task, std::function<void(LandAnswer)> done) {
    loop_.assert_here();
    ask([this, task = std::move(task), done = std::move(done)]() mutable {
        LandAnswer answer = change_now(task);
        // What the task holds on to may be the last of an old world: it goes here, not on the io thread.
        task = {};
        loop_.post([done, answer = std::move(answer)]() mutable { done(std::move(answer)); });
    });
}

LandAnswer LandWorker::change_and_wait(LandTask task) {
    std::promise<LandAnswer> changed;
    ask([&] { changed.set_value(change_now(task)); });
    return changed.get_future().get();
}

bool LandWorker::still_holds(const LandOutcome& outcome, const WorldState& world,
                             std::span<const BoxId> boxes) const {
    return trochoid::still_holds(outcome, world, boxes, settings_);
}

std::optional<TracedLand> LandWorker::open_water(const WaveTrainBox& box, FieldId first_field) const {
    loop_.assert_here();
    if (!ground_.terrain || box.trains.empty()) return TracedLand{};
    if (!land_area(box, *ground_.terrain, settings_).empty()) return std::nullopt;
    return trace_land(box, *ground_.terrain, first_field, settings_);
}

uint64_t LandWorker::key_of(const WaveTrainBox& box) const { return land_key(box, ground_.hash, settings_); }

}  // namespace trochoid
