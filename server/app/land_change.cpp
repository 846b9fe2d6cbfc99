#include "server/app/land_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "protocol/units/assert.hpp"
#include "server/app/field_layers.hpp"
#include "server/land/land_cache.hpp"
#include "server/land/land_retrace.hpp"
#include "server/land/land_trace.hpp"

namespace trochoid {

namespace {

/// Whether two lists of fields, of a whole trace each, hold the same blocks.
bool same_fields(const std::vector<std::shared_ptr<const LandField>>& before,
                 const std::vector<std::shared_ptr<const LandField>>& after) {
    const auto same = [](const auto& a, const auto& b) {
        if (a->base() || b->base() || a->block_count() != b->block_count()) return false;
        const auto blocks_a = a->blocks();
        const auto blocks_b = b->blocks();
        return std::equal(blocks_a.begin(), blocks_a.end(), blocks_b.begin(),
                          [](const auto& x, const auto& y) { return *x == *y; });
    };
    return before.size() == after.size() && std::equal(before.begin(), before.end(), after.begin(), same);
}

struct Again {
    TracedLand land;
    bool touched = false;
    bool whole = false;  ///< traced anew: the old trace was of no use
    size_t blocks = 0;   ///< that were made for it
};

/// The box's land over the changed terrain, and whether any of its fields is another.
Again trace_again(const WorldBox& box, const TerrainGrid& before, const TerrainEdit& edit,
                  FieldId first_field, const LandSettings& settings, LayerLimit layers) {
    TracedLand old;
    old.rays = box.rays;
    old.memory = box.land_memory;
    const WaveTrainBox& record = box.sea->record;
    RetraceStats stats;
    // A chain of overlays that is long enough ends: all is traced anew.
    if (record.overlays.size() + box.sea->fields.size() > most_overlays) old.memory = nullptr;
    TracedLand land =
        retrace_land(record, old, before, *edit.terrain, edit.touched, first_field, settings, &stats);
    const bool same = stats.whole ? same_fields(box.sea->fields, land.fields) : land.fields.empty();
    const size_t blocks = blocks_of(land);
    if (!same && !stats.whole) land = without_hidden_blocks(std::move(land), first_field, layers);
    return {std::move(land), !same, stats.whole, blocks};
}

/// Whether a trace of one is a trace of the other: steering a box, or ending it later, changes nothing of it.
bool traces_alike(const WorldBox& a, const WorldBox& b, const LandSettings& settings) {
    if (&a == &b) return true;
    return a.land_memory && a.land_memory == b.land_memory &&
           land_key(a.sea->record, 0, settings) == land_key(b.sea->record, 0, settings);
}

const Retraced* find(const std::vector<Retraced>& list, BoxId box) {
    const auto place = std::lower_bound(list.begin(), list.end(), box,
                                        [](const Retraced& next, BoxId id) { return next.box < id; });
    return place != list.end() && place->box == box ? &*place : nullptr;
}

/// What an earlier outcome has of the box, where it counts still.
std::optional<Again> known(const LandOutcome* earlier, BoxId id, const WorldState& world, FieldId first_field,
                           const LandSettings& settings) {
    if (earlier == nullptr) return std::nullopt;
    const auto before = earlier->world->boxes.find(id);
    if (before == earlier->world->boxes.end() ||
        !traces_alike(*before->second, *world.boxes.at(id), settings))
        return std::nullopt;
    if (const Retraced* touched = find(earlier->touched, id))
        return Again{with_first_field(touched->land, first_field), true, false, blocks_of(touched->land)};
    if (const Retraced* untouched = find(earlier->untouched, id))
        return Again{untouched->land, false, false, 0};
    return std::nullopt;
}

}  // namespace

Result<LandOutcome> trace_edit(const std::shared_ptr<const WorldState>& world, TerrainEdit edit,
                               std::span<const BoxId> boxes, const LandSettings& settings, size_t most_blocks,
                               const LandOutcome* earlier) {
    LandOutcome outcome{std::move(edit), {}, {}, world, land_is_tight(*world)};
    const LayerLimit layers = outcome.tight ? tight_layers : usual_layers;
    if (earlier != nullptr && (earlier->world->terrain != world->terrain || earlier->tight != outcome.tight))
        earlier = nullptr;
    FieldId next{world->next_field};
    size_t blocks = 0;
    for (const BoxId id : boxes) {
        std::optional<Again> again = known(earlier, id, *world, next, settings);
        if (!again)
            again = trace_again(*world->boxes.at(id), *world->terrain, outcome.edit, next, settings, layers);
        if (again->touched) {
            next.value += static_cast<uint32_t>(again->land.fields.size());
            blocks += again->blocks;
            outcome.touched.push_back({id, std::move(again->land)});
            if (blocks > most_blocks)
                return Error{ErrorCode::too_much_land,
                             fmt::format("{} blocks of land have come up where there is room for {}", blocks,
                                         most_blocks)};
        } else {
            // A trace made anew speaks of fields that nobody will have.
            if (again->whole) again->land.memory = nullptr;
            outcome.untouched.push_back({id, std::move(again->land)});
        }
    }
    return outcome;
}

bool still_holds(const LandOutcome& outcome, const WorldState& world, std::span<const BoxId> boxes,
                 const LandSettings& settings) {
    if (outcome.world->terrain != world.terrain || outcome.world->next_field != world.next_field ||
        outcome.tight != land_is_tight(world))
        return false;
    if (boxes.size() != outcome.touched.size() + outcome.untouched.size()) return false;
    return std::all_of(boxes.begin(), boxes.end(), [&](BoxId id) {
        return (find(outcome.touched, id) != nullptr || find(outcome.untouched, id) != nullptr) &&
               traces_alike(*outcome.world->boxes.at(id), *world.boxes.at(id), settings);
    });
}

Derived derived_from(const LandOutcome& outcome) {
    Derived derived;
    for (const Retraced& next : outcome.touched) derived.lands.push_back(next.land);
    derived.terrain = outcome.edit.terrain;
    derived.untouched = outcome.untouched;
    return derived;
}

Derived derive(const std::shared_ptr<const WorldState>& world, const LogEvent& event,
               const LandSettings& settings) {
    Derived derived;
    if (!world->terrain) return derived;
    if (const auto* started = std::get_if<BoxStarted>(&event.what)) {
        // No land acts on wakes, nor on ships that lie still.
        if (is_ship(started->box)) return derived;
        derived.lands.push_back(trace_land(started->box, *world->terrain, {world->next_field}, settings));
    } else if (const auto* changed = std::get_if<LandChanged>(&event.what)) {
        const std::vector<BoxId> boxes = boxes_on_land(*world, event.effective);
        auto edit = edited(*world->terrain, changes_of(*changed));
        TROCHOID_ASSERT(edit.has_value(), "the log's change of the land: {}", edit.error().message);
        const auto outcome = trace_edit(world, std::move(edit).value(), boxes, settings);
        TROCHOID_ASSERT(outcome.has_value(), "the log's change of the land: {}", outcome.error().message);
        const auto same = [](const Retraced& a, const BoxSucceeded& b) { return a.box == b.predecessor; };
        TROCHOID_ASSERT(std::equal(outcome->touched.begin(), outcome->touched.end(), changed->boxes.begin(),
                                   changed->boxes.end(), same),
                        "{} boxes go on, but the land changes under {}", changed->boxes.size(),
                        outcome->touched.size());
        derived = derived_from(*outcome);
    }
    return derived;
}

}  // namespace trochoid
