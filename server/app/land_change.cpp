#include "server/app/land_change.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/units/assert.hpp"
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
};

/// The box's land over the changed terrain, and whether any of its fields is another.
Again trace_again(const WorldBox& box, const TerrainGrid& before, const TerrainEdit& edit,
                  FieldId first_field, const LandSettings& settings) {
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
    return {std::move(land), !same, stats.whole};
}

}  // namespace

Result<LandOutcome> change_land(const WorldState& world, const ChangeLand& change,
                                std::span<const BoxId> boxes, const LandSettings& settings) {
    if (!world.terrain)
        return Error{ErrorCode::no_terrain,
                     "this world is open sea without a terrain: open a scene that has one to change it"};
    if (auto ok = validate(change); !ok) return ok.error();
    auto edit = edited(*world.terrain, change);
    if (!edit) return edit.error();
    LandOutcome outcome{std::move(edit).value(), {}, {}};
    FieldId next{world.next_field};
    for (const BoxId id : boxes) {
        Again again = trace_again(*world.boxes.at(id), *world.terrain, outcome.edit, next, settings);
        if (again.touched) {
            next.value += static_cast<uint32_t>(again.land.fields.size());
            outcome.touched.push_back({id, std::move(again.land)});
        } else {
            // A trace made anew speaks of fields that nobody will have.
            if (again.whole) again.land.memory = nullptr;
            outcome.untouched.push_back({id, std::move(again.land)});
        }
    }
    return outcome;
}

Derived derived_from(const LandOutcome& outcome) {
    Derived derived;
    for (const Retraced& next : outcome.touched) derived.lands.push_back(next.land);
    derived.terrain = outcome.edit.terrain;
    derived.untouched = outcome.untouched;
    return derived;
}

Derived derive(const WorldState& world, const LogEvent& event, const LandSettings& settings) {
    Derived derived;
    if (!world.terrain) return derived;
    if (const auto* started = std::get_if<BoxStarted>(&event.what)) {
        derived.lands.push_back(trace_land(started->box, *world.terrain, {world.next_field}, settings));
    } else if (const auto* changed = std::get_if<LandChanged>(&event.what)) {
        const auto outcome =
            change_land(world, changed->change, boxes_on_land(world, event.effective), settings);
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
