#include "tests/fuzz/wire_surgery.hpp"

#include "flatbuffers/flatbuffers.h"

namespace trochoid {

namespace {

void pad(Bytes& bytes, size_t to, size_t rest = 0) {
    while (bytes.size() % to != rest) bytes.push_back(0);
}

}  // namespace

void set_scalar(Bytes& bytes, const WireSlot& slot, uint64_t bits) {
    uint8_t* at = bytes.data() + slot.at;
    switch (scalar_bytes(slot.type)) {
        case 1: *at = static_cast<uint8_t>(bits); break;
        case 2: flatbuffers::WriteScalar(at, static_cast<uint16_t>(bits)); break;
        case 4: flatbuffers::WriteScalar(at, static_cast<uint32_t>(bits)); break;
        default: flatbuffers::WriteScalar(at, bits);
    }
}

void set_size_field(Bytes& bytes) {
    // Step by step: a buffer whose parts lie one over the other may be well formed no longer.
    const auto within = [&](int64_t at, int64_t size) {
        return at >= 0 && at + size <= static_cast<int64_t>(bytes.size());
    };
    if (!within(0, 4)) return;
    const int64_t root = flatbuffers::ReadScalar<uint32_t>(bytes.data());
    if (!within(root, 4)) return;
    const int64_t vtable = root - flatbuffers::ReadScalar<int32_t>(bytes.data() + root);
    if (!within(vtable, 6) || flatbuffers::ReadScalar<uint16_t>(bytes.data() + vtable) < 6) return;
    // Field 0 of every envelope.
    const int64_t inside = flatbuffers::ReadScalar<uint16_t>(bytes.data() + vtable + 4);
    if (inside == 0 || !within(root + inside, 4)) return;
    flatbuffers::WriteScalar(bytes.data() + root + inside, static_cast<uint32_t>(bytes.size()));
}

void drop_field(Bytes& bytes, const WireSlot& slot) {
    const auto vtable = static_cast<std::ptrdiff_t>(slot.holder) -
                        std::ptrdiff_t{flatbuffers::ReadScalar<int32_t>(bytes.data() + slot.holder)};
    const auto size = flatbuffers::ReadScalar<uint16_t>(bytes.data() + vtable);
    pad(bytes, 8);
    const size_t fresh = bytes.size();
    const Bytes copy(bytes.begin() + vtable, bytes.begin() + vtable + size);
    bytes.insert(bytes.end(), copy.begin(), copy.end());
    pad(bytes, 8);
    flatbuffers::WriteScalar<uint16_t>(bytes.data() + fresh + slot.field_entry, 0);
    flatbuffers::WriteScalar<int32_t>(bytes.data() + slot.holder,
                                      static_cast<int32_t>(slot.holder) - static_cast<int32_t>(fresh));
    set_size_field(bytes);
}

void replace_list(Bytes& bytes, const WireSlot& slot, uint32_t count, std::span<const uint8_t> entries,
                  size_t skew) {
    pad(bytes, 8, (4 + skew) % 8);
    const size_t fresh = bytes.size();
    bytes.resize(fresh + 4);
    flatbuffers::WriteScalar(bytes.data() + fresh, count);
    bytes.insert(bytes.end(), entries.begin(), entries.end());
    bytes.push_back(0);  // a text's end
    pad(bytes, 8);
    flatbuffers::WriteScalar(bytes.data() + slot.reference, static_cast<uint32_t>(fresh - slot.reference));
    set_size_field(bytes);
}

bool resize_list(Bytes& bytes, const WireSlot& slot, uint32_t count, size_t skew) {
    if (slot.of_tables) return false;
    Bytes entries(size_t{count} * slot.entry_bytes);
    const Bytes old(bytes.begin() + static_cast<std::ptrdiff_t>(slot.at + 4),
                    bytes.begin() + static_cast<std::ptrdiff_t>(slot.at + 4 + slot.count * slot.entry_bytes));
    if (!old.empty())
        for (size_t i = 0; i < entries.size(); ++i) entries[i] = old[i % old.size()];
    replace_list(bytes, slot, count, entries, skew);
    return true;
}

}  // namespace trochoid
