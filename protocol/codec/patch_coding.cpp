#include "protocol/codec/patch_coding.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "protocol/codec/plane_coding.hpp"
#include "protocol/codec/value_coding.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

template <class T>
void append_column(Bytes& out, const std::vector<T>& values) {
    append_plane(out, std::span<const T>(values), 1);
}

/// Level, x and z of patches, a column each.
struct KeyColumns {
    std::vector<uint16_t> level;
    std::vector<int32_t> x;
    std::vector<int32_t> z;

    void add(const PatchKey& key) {
        level.push_back(key.level);
        x.push_back(key.x);
        z.push_back(key.z);
    }
    void append_to(Bytes& out) const {
        append_column(out, level);
        append_column(out, x);
        append_column(out, z);
    }
};

/// Columns from the front of what is left; what cannot be read is refused and reads as zeros.
class Columns {
public:
    Columns(Scrutiny& check, std::span<const uint8_t> bytes) : check_(check), rest_(bytes) {}

    template <class T>
    std::vector<T> next(size_t count) {
        std::vector<T> values(count);
        const bool read = !check_.refused() && read_plane(rest_, std::span<T>(values), 1);
        check_.require(read, "patch_planes are not the planes of their patches");
        return values;
    }
    KeyColumns next_keys(size_t count) {
        KeyColumns keys;
        keys.level = next<uint16_t>(count);
        keys.x = next<int32_t>(count);
        keys.z = next<int32_t>(count);
        return keys;
    }
    size_t left() const { return rest_.size(); }

private:
    Scrutiny& check_;
    std::span<const uint8_t> rest_;
};

/// In range, each above the one before.
std::vector<PatchKey> unpack_keys(Scrutiny& check, const KeyColumns& columns) {
    std::vector<PatchKey> keys;
    for (size_t i = 0; i < columns.level.size() && !check.refused(); ++i) {
        const uint16_t level = check.within("a patch's level", columns.level[i], uint16_t{finest_patch_level},
                                            uint16_t{coarsest_patch_level});
        const PatchKey key = unpack_patch_key(check, static_cast<uint8_t>(level), columns.x[i], columns.z[i]);
        check.require(keys.empty() || keys.back() < key, "patches do not ascend by level, x and z");
        keys.push_back(key);
    }
    return keys;
}

/// A bound travels as its bits: 0 has one form.
float unpack_bound(Scrutiny& check, const char* name, int32_t bits) {
    const auto bound =
        check.within(name, std::bit_cast<float>(bits), 0.0F, std::numeric_limits<float>::max());
    check.require(bits >= 0, "a patch's bound is -0");
    return bound;
}

void unpack_boxes(Scrutiny& check, Columns& columns, std::span<const uint32_t> box_ids,
                  std::vector<PatchDescriptor>& patches) {
    size_t entries = 0;
    for (const uint32_t id : box_ids) {
        const auto counts = columns.next<uint16_t>(patches.size());
        for (size_t i = 0; i < patches.size() && !check.refused(); ++i) {
            if (counts[i] == 0) continue;
            check.require(counts[i] <= most_trains_in_a_box + 1, "a patch's train_count is above 256");
            check.require(++entries <= most_patch_boxes, "the patches have more than 65,536 boxes together");
            if (!check.refused()) patches[i].boxes.push_back({{id}, static_cast<uint16_t>(counts[i] - 1)});
        }
        if (check.refused()) return;
    }
}

}  // namespace

std::vector<uint32_t> boxes_named(std::span<const PatchDescriptor> patches) {
    std::vector<uint32_t> ids;
    for (const PatchDescriptor& patch : patches)
        for (const PatchBox& box : patch.boxes) {
            const auto place = std::lower_bound(ids.begin(), ids.end(), box.box.value);
            if (place == ids.end() || *place != box.box.value) ids.insert(place, box.box.value);
        }
    return ids;
}

Bytes code_patches(const InterestDelta& change, std::span<const uint32_t> box_ids) {
    const size_t count = change.patches.size();
    KeyColumns keys;
    KeyColumns removed;
    std::vector<int32_t> left_out;
    std::vector<int32_t> height_error;
    std::vector<std::vector<uint16_t>> counts(box_ids.size(), std::vector<uint16_t>(count));
    for (size_t i = 0; i < count; ++i) {
        const PatchDescriptor& patch = change.patches[i];
        keys.add(patch.key);
        left_out.push_back(std::bit_cast<int32_t>(patch.left_out));
        height_error.push_back(std::bit_cast<int32_t>(patch.height_error));
        for (const PatchBox& box : patch.boxes) {
            const auto column = std::lower_bound(box_ids.begin(), box_ids.end(), box.box.value);
            TROCHOID_ASSERT(column != box_ids.end() && *column == box.box.value, "box {} is not in the list",
                            box.box.value);
            counts[static_cast<size_t>(column - box_ids.begin())][i] =
                static_cast<uint16_t>(box.train_count + 1);
        }
    }
    for (const PatchKey& key : change.removed_patches) removed.add(key);

    Bytes out;
    append_column(
        out, std::vector{static_cast<int32_t>(count), static_cast<int32_t>(change.removed_patches.size())});
    keys.append_to(out);
    append_column(out, left_out);
    append_column(out, height_error);
    for (const std::vector<uint16_t>& column : counts) append_column(out, column);
    removed.append_to(out);
    return out;
}

void unpack_patches(Scrutiny& check, std::span<const uint8_t> planes, std::span<const uint32_t> box_ids,
                    InterestDelta& change) {
    for (size_t i = 1; i < box_ids.size(); ++i)
        check.require(box_ids[i - 1] < box_ids[i], "box_ids do not ascend");
    Columns columns(check, planes);
    const auto counts = columns.next<int32_t>(2);
    const int32_t set = check.within("patch_planes' patches", counts[0], 0, int32_t{Limits{}.patches});
    const int32_t removed = check.within("patch_planes' removed patches", counts[1], 0, most_removed_patches);
    if (check.refused()) return;
    check.require(set + removed > 0, "patch_planes without patches");
    // Ascending keys take a byte each at least: what is made room for is no larger than what came.
    check.require(static_cast<size_t>(set) + static_cast<size_t>(removed) <= columns.left(),
                  "patch_planes are shorter than their patches");
    if (check.refused()) return;

    const auto keys = unpack_keys(check, columns.next_keys(static_cast<size_t>(set)));
    const auto left_out = columns.next<int32_t>(static_cast<size_t>(set));
    const auto height_error = columns.next<int32_t>(static_cast<size_t>(set));
    if (check.refused()) return;
    std::vector<PatchDescriptor> patches;
    patches.reserve(keys.size());
    for (size_t i = 0; i < keys.size(); ++i)
        patches.push_back({keys[i],
                           {},
                           unpack_bound(check, "a patch's left_out", left_out[i]),
                           unpack_bound(check, "a patch's height_error", height_error[i])});
    unpack_boxes(check, columns, box_ids, patches);
    change.removed_patches = unpack_keys(check, columns.next_keys(static_cast<size_t>(removed)));
    check.require(columns.left() == 0, "patch_planes hold more than their patches");
    change.patches = std::move(patches);
}

}  // namespace trochoid
