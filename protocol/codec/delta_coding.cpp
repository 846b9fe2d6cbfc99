#include "protocol/codec/delta_coding.hpp"

#include <map>

#include "protocol/codec/patch_coding.hpp"
#include "protocol/codec/plane_coding.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

/// An empty list is left out.
template <class T>
flatbuffers::Offset<flatbuffers::Vector<const T*>> structs(Builder& b, const std::vector<T>& list) {
    return list.empty() ? 0 : b.CreateVectorOfStructs(list);
}
template <class T>
flatbuffers::Offset<flatbuffers::Vector<T>> scalars(Builder& b, const std::vector<T>& list) {
    return list.empty() ? 0 : b.CreateVector(list);
}

/// The parallel lists that blocks and patches travel as; the patches' are empty where they are planes.
struct FlatLists {
    std::vector<wire_fb::BlockHead> blocks;
    Bytes nodes;
    std::vector<uint32_t> box_ids;
    std::vector<wire_fb::Patch> patches;
    std::vector<wire_fb::PatchBox> patch_boxes;
    std::vector<wire_fb::PatchName> removed_patches;
    Bytes patch_planes;
};

void flatten_blocks(const InterestDelta& change, FlatLists& lists) {
    for (const FieldBlock& block : change.blocks) {
        const Bytes nodes = code_nodes(*block.block);
        lists.blocks.emplace_back(block.field.value, block.block->key.x, block.block->key.z,
                                  static_cast<uint16_t>(nodes.size()), block.step_log2);
        lists.nodes.insert(lists.nodes.end(), nodes.begin(), nodes.end());
    }
}

void flatten_patches(const InterestDelta& change, FlatLists& lists) {
    std::map<BoxId, uint16_t> index_of;
    for (const PatchDescriptor& patch : change.patches) {
        lists.patches.emplace_back(patch.key.x, patch.key.z, patch.left_out, patch.height_error,
                                   static_cast<uint16_t>(patch.boxes.size()), patch.key.level);
        for (const PatchBox& box : patch.boxes) {
            TROCHOID_ASSERT(lists.box_ids.size() <= UINT16_MAX, "{} boxes in one delta",
                            lists.box_ids.size());
            const auto [known, is_new] =
                index_of.try_emplace(box.box, static_cast<uint16_t>(lists.box_ids.size()));
            if (is_new) lists.box_ids.push_back(box.box.value);
            lists.patch_boxes.emplace_back(known->second, box.train_count);
        }
    }
    for (const PatchKey& k : change.removed_patches) lists.removed_patches.emplace_back(k.x, k.z, k.level);
}

void flatten_to_planes(const InterestDelta& change, FlatLists& lists) {
    if (change.patches.empty() && change.removed_patches.empty()) return;
    lists.box_ids = boxes_named(change.patches);
    lists.patch_planes = code_patches(change, lists.box_ids);
}

FlatLists flatten(const Delta& d) {
    FlatLists lists;
    flatten_blocks(d.change, lists);
    if (d.patch_form == PatchForm::planes)
        flatten_to_planes(d.change, lists);
    else
        flatten_patches(d.change, lists);
    return lists;
}

std::vector<flatbuffers::Offset<wire_fb::Box>> pack_boxes(Builder& b, const InterestDelta& change) {
    std::vector<flatbuffers::Offset<wire_fb::Box>> boxes;
    boxes.reserve(change.boxes.size());
    for (const auto& box : change.boxes) boxes.push_back(trochoid::pack(b, *box));
    return boxes;
}

}  // namespace

flatbuffers::Offset<wire_fb::Delta> pack(Builder& b, const Delta& d) {
    const FlatLists lists = flatten(d);
    const auto key = pack(b, d.key);
    const auto boxes = scalars(b, pack_boxes(b, d.change));
    std::vector<uint32_t> gone_boxes;
    std::vector<wire_fb::BlockName> gone_blocks;
    for (const BoxId id : d.change.removed_boxes) gone_boxes.push_back(id.value);
    for (const FieldBlockKey& k : d.change.removed_blocks)
        gone_blocks.emplace_back(k.field.value, k.block.x, k.block.z);
    const auto removed_boxes = scalars(b, gone_boxes);
    const auto blocks = structs(b, lists.blocks);
    const auto nodes = scalars(b, lists.nodes);
    const auto removed_blocks = structs(b, gone_blocks);
    const auto box_ids = scalars(b, lists.box_ids);
    const auto patches = structs(b, lists.patches);
    const auto patch_boxes = structs(b, lists.patch_boxes);
    const auto removed_patches = structs(b, lists.removed_patches);
    const auto patch_planes = scalars(b, lists.patch_planes);
    return wire_fb::CreateDelta(b, d.result, d.piece, d.last, d.base, d.base_hash, d.state_hash, key,
                                d.watermark.us, boxes, removed_boxes, blocks, nodes, removed_blocks, box_ids,
                                patches, patch_boxes, removed_patches, patch_planes);
}

namespace {

/// Longest lists of one piece: no frame holds more, so these only bound what a decoder allocates.
constexpr size_t most_entries = 65536;
constexpr size_t largest_node_bytes = size_t{1} << 20;
constexpr size_t largest_patch_planes = size_t{1} << 20;

void unpack_boxes(Scrutiny& check, const wire_fb::Delta& d, InterestDelta& change) {
    const auto* boxes = check.optional_list("boxes", d.boxes(), Limits{}.boxes, ErrorCode::too_many_boxes);
    if (boxes == nullptr) return;
    for (const wire_fb::Box* packed : *boxes) {
        auto box = std::make_shared<const WaveTrainBox>(trochoid::unpack(check, *packed));
        check.require(change.boxes.empty() || change.boxes.back()->id < box->id,
                      "boxes are not by ascending id");
        if (check.refused()) return;
        change.boxes.push_back(std::move(box));
    }
}

/// A block's cells must lie in the world: |x| <= 2^35 / (16 * step).
void check_block(Scrutiny& check, uint32_t field, int32_t x, int32_t z, uint8_t step_log2) {
    check.require(field != 0, "a land block's field is 0");
    const uint8_t step = check.within("a land block's step_log2", step_log2, uint8_t{12}, uint8_t{20});
    if (check.refused()) return;
    const int32_t most = int32_t{1} << (31 - step);
    check.within("a land block's x", x, -most, most);
    check.within("a land block's z", z, -most, most);
}

void unpack_blocks(Scrutiny& check, const wire_fb::Delta& d, InterestDelta& change) {
    const auto* heads = check.optional_list("blocks", d.blocks(), most_entries);
    const auto* nodes = check.optional_list("nodes", d.nodes(), largest_node_bytes);
    std::span<const uint8_t> rest;
    if (nodes != nullptr) rest = {nodes->data(), nodes->size()};
    if (heads != nullptr)
        for (const wire_fb::BlockHead* h : *heads) {
            check_block(check, h->field(), h->x(), h->z(), h->step_log2());
            check.require(nodes != nullptr, "nodes is missing", ErrorCode::missing_field);
            check.require(h->node_bytes() <= rest.size(),
                          "the blocks' node_bytes add up to more than nodes holds");
            if (check.refused()) return;
            auto block = std::make_shared<LandBlock>();
            block->key = {h->x(), h->z()};
            check.require(read_nodes(rest.first(h->node_bytes()), *block));
            rest = rest.subspan(h->node_bytes());
            change.blocks.push_back({{h->field()}, h->step_log2(), std::move(block)});
        }
    check.require(rest.empty(), "nodes holds more than the blocks' node_bytes add up to");
}

void unpack_patches(Scrutiny& check, const wire_fb::Delta& d, InterestDelta& change) {
    const auto* patches = check.optional_list("patches", d.patches(), Limits{}.patches);
    const auto* entries = check.optional_list("patch_boxes", d.patch_boxes(), most_patch_boxes);
    const auto* ids = check.optional_list("box_ids", d.box_ids(), Limits{}.boxes, ErrorCode::too_many_boxes);
    const uint32_t known = ids == nullptr ? 0 : ids->size();
    const uint32_t available = entries == nullptr ? 0 : entries->size();
    uint32_t next = 0;
    if (patches != nullptr)
        for (const wire_fb::Patch* p : *patches) {
            PatchDescriptor patch;
            patch.key = unpack_patch_key(check, p->level(), p->x(), p->z());
            patch.left_out =
                check.within("a patch's left_out", p->left_out(), 0.0F, std::numeric_limits<float>::max());
            patch.height_error = check.within("a patch's height_error", p->height_error(), 0.0F,
                                              std::numeric_limits<float>::max());
            check.require(p->box_count() == 0 || entries != nullptr, "patch_boxes is missing",
                          ErrorCode::missing_field);
            check.require(p->box_count() <= available - next,
                          "the patches' box_counts add up to more than patch_boxes holds");
            for (uint32_t i = 0; i < p->box_count() && !check.refused(); ++i) {
                const wire_fb::PatchBox* entry = entries->Get(next++);
                check.require(entry->box_index() < known, "a patch's box_index points outside box_ids");
                check.require(entry->train_count() <= most_trains_in_a_box,
                              "a patch's train_count is above 256");
                if (check.refused()) return;
                const BoxId id{ids->Get(entry->box_index())};
                check.require(patch.boxes.empty() || patch.boxes.back().box < id,
                              "a patch's boxes are not by ascending id");
                patch.boxes.push_back({id, entry->train_count()});
            }
            if (check.refused()) return;
            change.patches.push_back(std::move(patch));
        }
    check.require(next == available, "patch_boxes holds more than the patches' box_counts add up to");
}

void unpack_removals(Scrutiny& check, const wire_fb::Delta& d, InterestDelta& change) {
    if (const auto* boxes = check.optional_list("removed_boxes", d.removed_boxes(), most_entries))
        for (const uint32_t id : *boxes) change.removed_boxes.push_back({id});
    if (const auto* blocks = check.optional_list("removed_blocks", d.removed_blocks(), most_entries))
        for (const wire_fb::BlockName* k : *blocks)
            change.removed_blocks.push_back({{k->field()}, {k->x(), k->z()}});
    if (const auto* patches =
            check.optional_list("removed_patches", d.removed_patches(), most_removed_patches))
        for (const wire_fb::PatchName* k : *patches)
            change.removed_patches.push_back(unpack_patch_key(check, k->level(), k->x(), k->z()));
}

void unpack_patch_planes(Scrutiny& check, const wire_fb::Delta& d, Delta& out) {
    const auto* planes = check.optional_list("patch_planes", d.patch_planes(), largest_patch_planes);
    if (planes == nullptr) return;
    check.require(d.patches() == nullptr && d.patch_boxes() == nullptr && d.removed_patches() == nullptr,
                  "patch_planes stand in place of patches, patch_boxes and removed_patches, not beside them");
    if (check.refused()) return;
    std::vector<uint32_t> box_ids;
    if (d.box_ids() != nullptr)
        for (const uint32_t id : *d.box_ids()) box_ids.push_back(id);
    unpack_patches(check, {planes->data(), planes->size()}, box_ids, out.change);
    out.patch_form = PatchForm::planes;
}

}  // namespace

Delta unpack(Scrutiny& check, const wire_fb::Delta& d) {
    Delta out;
    out.result = check.within("result", d.result(), 1U, UINT32_MAX);
    out.piece = d.piece();
    out.last = d.last();
    out.base = d.base();
    check.require(out.base < out.result, "base is not before result");
    out.base_hash = d.base_hash();
    out.state_hash = d.state_hash();
    out.key = unpack(check, d.key());
    out.watermark = check.sea_time("watermark_us", d.watermark_us());
    unpack_boxes(check, d, out.change);
    unpack_blocks(check, d, out.change);
    unpack_patches(check, d, out.change);
    unpack_removals(check, d, out.change);
    unpack_patch_planes(check, d, out);
    return out;
}

}  // namespace trochoid
