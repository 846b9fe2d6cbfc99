#include "server/interest/cull.hpp"

#include <algorithm>
#include <utility>

#include "server/interest/patch_priority.hpp"

namespace trochoid {

namespace {

/// Leaves the key's number of patches, those of highest priority; returns how many went.
uint32_t limit(Selection& selection, const CullKey& key) {
    const size_t count = selection.patches.size();
    if (count <= key.patch_limit) return 0;
    const PatchPriority priority_of(key.anchor);
    std::vector<std::pair<double, SelectedPatch>> order;
    for (const SelectedPatch& p : selection.patches) order.emplace_back(priority_of(p.key), p);
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second.key < b.second.key;
    });
    order.resize(key.patch_limit);
    selection.patches.clear();
    for (const auto& [value, patch] : order) selection.patches.push_back(patch);
    return static_cast<uint32_t>(count - key.patch_limit);
}

void add_region(const InterestIndex& index, const CullKey& key, const SyncRegion& region,
                Referred& referred) {
    const int64_t around = int64_t{region.radius} + sync_margin;
    const LatticeRect rect{{region.centre.x - around, region.centre.z - around},
                           {region.centre.x + around, region.centre.z + around}};
    const SquareOnSea square = square_on_sea(rect, region.centre, 0.0);
    for (size_t i = 0; i < index.boxes().size(); ++i) {
        const IndexedBox& box = *index.boxes()[i];
        const WaveTrainBox& record = box.sea->record;
        if (record.end + record.decay_us + sync_history_us <= key.from) continue;
        if (!touches(whole_footprint(box, region.centre, key.from - sync_history_us), square)) continue;
        referred.box(i);
        for (size_t f = 0; f < box.fields.size(); ++f) referred.blocks(i, f, rect);
    }
}

}  // namespace

CullResult cull(const InterestIndex& index, const CullKey& key) {
    CullResult out;
    Selection selection = select_patches(index, key);
    out.report.over_limit = limit(selection, key);

    const PatchLod lod(key);
    Referred referred(index);
    for (const SelectedPatch& patch : selection.patches) {
        PatchDescriptor d =
            describe(selection, patch, lod.spacing(patch.distance), referred, out.report.left_out);
        for (const PatchBox& box : d.boxes) out.report.trains_kept += box.train_count;
        out.report.largest_error = std::max(out.report.largest_error, d.height_error);
        out.state.patches.emplace(d.key, std::move(d));
    }
    for (const SyncRegion& region : key.regions) add_region(index, key, region, referred);
    referred.collect(out.state);

    out.report.selection = selection.counts;
    out.report.delivered = static_cast<uint32_t>(out.state.patches.size());
    for (const BoxFootprint& f : selection.footprints) out.report.boxes_alive += f.share > 0.0 ? 1 : 0;
    out.report.blocks = static_cast<uint32_t>(out.state.blocks.size());
    out.report.visibility = selection.visibility;
    return out;
}

CullResult cull(const WorldState& world, const CullKey& key) { return cull(InterestIndex(world), key); }

}  // namespace trochoid
