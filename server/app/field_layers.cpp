#include "server/app/field_layers.hpp"

#include <map>
#include <set>
#include <span>
#include <utility>

#include "server/land/land_memory.hpp"
#include "server/land/land_trace.hpp"

namespace trochoid {

namespace {

using FieldPtr = std::shared_ptr<const LandField>;

struct ByRow {
    bool operator()(const BlockKey& a, const BlockKey& b) const { return a.z != b.z ? a.z < b.z : a.x < b.x; }
};
using CountingBlocks = std::map<BlockKey, std::shared_ptr<const LandBlock>, ByRow>;

/// What counts at each place where any layer has a block.
CountingBlocks counting_blocks(const FieldPtr& top) {
    CountingBlocks counts;
    for (FieldPtr layer = top; layer; layer = layer->base())
        for (auto& block : layer->blocks()) counts.try_emplace(block->key, std::move(block));
    return counts;
}

/// Blocks of all layers, and least number of those that can count.
struct LayerSums {
    size_t blocks = 0;
    size_t largest = 0;
};

LayerSums layers_of(const std::vector<FieldPtr>& tops) {
    LayerSums sum;
    for (const FieldPtr& top : tops) {
        size_t largest = 0;
        for (FieldPtr layer = top; layer; layer = layer->base()) {
            sum.blocks += layer->block_count();
            largest = std::max(largest, layer->block_count());
        }
        sum.largest += largest;
    }
    return sum;
}

FieldPtr flat_field(const CountingBlocks& counts, FieldId id, uint8_t step_log2) {
    std::vector<std::shared_ptr<const LandBlock>> blocks;
    for (const auto& [key, block] : counts)
        if (!trivial(*block)) blocks.push_back(block);
    return blocks.empty() ? nullptr : make_land_field(id, step_log2, blocks);
}

}  // namespace

TracedLand without_hidden_blocks(TracedLand land, FieldId first_field, LayerLimit limit) {
    if (!land.memory || land.overlays.empty()) return land;
    const std::vector<FieldPtr>& tops = land.memory->fields;
    const LayerSums layers = layers_of(tops);
    const auto within = [&](size_t counting) {
        return layers.blocks * limit.counting <= limit.blocks * counting;
    };
    if (within(layers.largest)) return land;
    std::vector<CountingBlocks> counts;
    size_t counting = 0;
    for (const FieldPtr& top : tops) counting += counts.emplace_back(counting_blocks(top)).size();
    if (within(counting)) return land;

    auto memory = std::make_shared<LandMemory>(*land.memory);
    land.fields.clear();
    land.overlays.clear();
    bool any = false;
    for (size_t band = 0; band < tops.size(); ++band) {
        const FieldPtr& top = tops[band];
        const bool as_it_is = !top || (!top->base() && top->id() < first_field);
        FieldPtr field = top;
        if (!as_it_is) {
            const FieldId id{first_field.value + static_cast<uint32_t>(land.fields.size())};
            field = flat_field(counts[band], id, top->step_log2());
            if (field) land.fields.push_back(field);
        }
        memory->fields[band] = field;
        any = any || field;
        for (const size_t train : memory->bands[band].trains)
            if (!land.field_of_train.empty()) land.field_of_train[train] = field ? field->id() : FieldId{};
    }
    if (!any) land.field_of_train.clear();
    land.memory = std::move(memory);
    return land;
}

}  // namespace trochoid
