#include "server/world/land_room.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "server/world/world.hpp"
#include "server/world/world_fold.hpp"

namespace trochoid {

namespace {

SeaTime still_from(const WorldBox& box) { return box.sea->record.end + box.sea->record.decay_us; }

/// The fields that boxes hold, each with how many boxes do.
class HeldFields {
public:
    using Fields = std::vector<std::shared_ptr<const LandField>>;

    void add(const WorldBox& box) { add(fields_with_bases(*box.sea)); }
    /// No field twice.
    void add(const Fields& fields) {
        for (const auto& field : fields) {
            Use& use = uses_[field->id()];
            if (use.boxes++ == 0) blocks_ += use.blocks = field->block_count();
        }
    }
    void remove(const WorldBox& box) {
        for (const auto& field : fields_with_bases(*box.sea)) {
            Use& use = uses_.at(field->id());
            if (--use.boxes == 0) blocks_ -= use.blocks;
        }
    }
    size_t blocks() const { return blocks_; }

private:
    struct Use {
        size_t blocks = 0;
        size_t boxes = 0;
    };
    std::map<FieldId, Use> uses_;
    size_t blocks_ = 0;
};

/// Of boxes that `counts` says count.
template <class Counts>
HeldFields held_by(const WorldState& state, Counts counts) {
    HeldFields held;
    for (const auto& [id, box] : state.boxes)
        if (counts(*box)) held.add(*box);
    return held;
}

bool goes_on(const WorldBox& box, SeaTime by) { return box.successor.value == 0 && still_from(box) > by; }

/// Fields of the box that goes on over new land, with those below.
HeldFields::Fields fields_after(const WorldBox& box, const TracedLand& land) {
    const HeldFields::Fields old = fields_with_bases(*box.sea);
    HeldFields::Fields all;
    const auto take = [&](std::shared_ptr<const LandField> field) {
        for (; field; field = field->base())
            if (std::find(all.begin(), all.end(), field) == all.end()) all.push_back(field);
    };
    for (const auto& field : land.fields) take(field);
    for (const auto& field : old)
        if (std::find(land.field_of_train.begin(), land.field_of_train.end(), field->id()) !=
            land.field_of_train.end())
            take(field);
    return all;
}

/// With land, the first to have fallen still first.
std::vector<std::shared_ptr<const WorldBox>> still_with_land(const WorldState& state, SeaTime by) {
    std::vector<std::shared_ptr<const WorldBox>> list;
    for (const auto& [id, box] : state.boxes)
        if (!box->sea->fields.empty() && still_from(*box) <= by) list.push_back(box);
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
        const SeaTime first = still_from(*a), second = still_from(*b);
        return first != second ? first < second : a->sea->record.id < b->sea->record.id;
    });
    return list;
}

size_t mebibytes(size_t blocks) { return (blocks * land_block_bytes + (size_t{1} << 20) - 1) >> 20; }

}  // namespace

LandRoom land_room(const WorldState& state, SeaTime by) {
    return {held_by(state, [](const WorldBox&) { return true; }).blocks(),
            held_by(state, [by](const WorldBox& box) { return goes_on(box, by); }).blocks(),
            state.most_land_blocks,
            held_by(state, [by](const WorldBox& box) { return still_from(box) > by; }).blocks()};
}

LandRoom room_after(const WorldState& state, std::span<const Retraced> touched, SeaTime by) {
    std::map<BoxId, const TracedLand*> next;
    for (const Retraced& box : touched) next.emplace(box.box, &box.land);
    HeldFields held = held_by(state, [](const WorldBox&) { return true; });
    HeldFields kept = held_by(
        state, [&](const WorldBox& box) { return goes_on(box, by) && !next.contains(box.sea->record.id); });
    HeldFields moving = held_by(state, [by](const WorldBox& box) { return still_from(box) > by; });
    for (const auto& [id, land] : next) {
        const HeldFields::Fields fields = fields_after(*state.boxes.at(id), *land);
        for (HeldFields* count : {&held, &kept, &moving}) count->add(fields);
    }
    return {held.blocks(), kept.blocks(), state.most_land_blocks, moving.blocks()};
}

bool land_is_tight(const WorldState& state) {
    const HeldFields held = held_by(state, [](const WorldBox& box) { return box.successor.value == 0; });
    return held.blocks() > state.most_land_blocks / 2;
}

Error too_much_land(const LandRoom& room) {
    return {
        ErrorCode::too_much_land,
        fmt::format(
            "what land does to this world's waves takes {} of the {} MiB that the server has for it, and this would "
            "go beyond: try again when what the last changes of the land began has cross-faded, stop winds "
            "over land, change less of the land at once, or have the server started with a larger --land-mib",
            mebibytes(room.kept), mebibytes(room.most))};
}

void make_room_for_land(WorldState& state, size_t coming, SeaTime now) {
    if (coming == 0) return;
    HeldFields held = held_by(state, [](const WorldBox&) { return true; });
    for (const auto& box : still_with_land(state, now)) {
        if (held.blocks() + coming <= state.most_land_blocks) return;
        held.remove(*box);
        state.boxes.erase(box->sea->record.id);
    }
}

void let_go_of_old_land(WorldState& state, SeaTime now) {
    for (const auto& box : still_with_land(state, now - land_kept_us)) state.boxes.erase(box->sea->record.id);
    // A change takes up only what goes on beyond its cross-fade.
    for (auto& [id, box] : state.boxes) {
        if (!box->land_memory || box->sea->record.end > now + land_fade_us) continue;
        auto forgetful = std::make_shared<WorldBox>(*box);
        forgetful->land_memory = nullptr;
        box = std::move(forgetful);
    }
}

}  // namespace trochoid
