#include "tests/fuzz/wire_walk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "flatbuffers/flatbuffers.h"

namespace trochoid {

namespace {

using reflection::BaseType;

template <class T>
T read_at(std::span<const uint8_t> buffer, size_t at) {
    return flatbuffers::ReadScalar<T>(buffer.data() + at);
}

/// The last word of "trochoid.wire_fb.View".
std::string short_name(const flatbuffers::String* name) {
    const std::string whole = name->str();
    return whole.substr(whole.rfind('.') + 1);
}

class Walker {
public:
    using Take = std::function<void(WireSlot&&)>;
    Walker(const reflection::Schema& schema, std::span<const uint8_t> buffer, bool every_entry, size_t most,
           Take take)
        : schema_(schema), buffer_(buffer), every_entry_(every_entry), left_(most), take_(std::move(take)) {}

    void root() {
        const size_t at = read_at<uint32_t>(buffer_, 0);
        table(*schema_.root_table(), at, "");
    }
    /// Called for fields that a table is without.
    std::function<void(const std::string& path)> absent = [](const std::string&) {};

private:
    void give(WireSlot&& slot) {
        if (left_ == 0) return;
        --left_;
        take_(std::move(slot));
    }

    static std::vector<const reflection::Field*> by_id(const reflection::Object& object) {
        std::vector<const reflection::Field*> fields(object.fields()->begin(), object.fields()->end());
        std::sort(fields.begin(), fields.end(), [](auto* a, auto* b) { return a->id() < b->id(); });
        return fields;
    }

    void table(const reflection::Object& object, size_t at, const std::string& path) {
        if (left_ == 0) return;
        const size_t vtable = at - static_cast<size_t>(int64_t{read_at<int32_t>(buffer_, at)});
        const uint16_t entries = read_at<uint16_t>(buffer_, vtable);
        uint8_t tag = 0;
        for (const reflection::Field* field : by_id(object)) {
            const uint16_t entry = field->offset();
            const uint16_t inside =
                entry < entries ? read_at<uint16_t>(buffer_, vtable + entry) : uint16_t{0};
            const std::string here = path.empty() ? field->name()->str() : path + "." + field->name()->str();
            WireSlot slot;
            slot.path = here;
            slot.name = short_name(object.name()) + "." + field->name()->str();
            slot.holder = at;
            slot.field_entry = entry;
            slot.at = at + inside;
            slot.type = field->type()->base_type();
            if (inside == 0) {
                if (slot.type == BaseType::UType) tag = 0;
                absent_field(*field, here);
                continue;
            }
            if (slot.type == BaseType::UType) tag = buffer_[slot.at];
            value(*field->type(), std::move(slot), tag);
        }
    }

    /// An absent number is its default: a reader sees no difference.
    void absent_field(const reflection::Field& field, const std::string& path) const {
        const BaseType type = field.type()->base_type();
        if (type == BaseType::Float || type == BaseType::Double)
            absent(fmt::format("{} = {:016x}", path, std::bit_cast<uint64_t>(field.default_real())));
        else if (type < BaseType::String)
            absent(fmt::format("{} = {:016x}", path, static_cast<uint64_t>(field.default_integer())));
        else
            absent(path + " absent");
    }

    void value(const reflection::Type& type, WireSlot slot, uint8_t tag) {
        switch (type.base_type()) {
            case BaseType::UType:
                slot.kind = WireSlot::Kind::union_tag;
                slot.count = schema_.enums()->Get(static_cast<uint32_t>(type.index()))->values()->size();
                return give(std::move(slot));
            case BaseType::Union: {
                const auto& members = *schema_.enums()->Get(static_cast<uint32_t>(type.index()))->values();
                if (tag == 0 || tag >= members.size()) return;
                follow(slot);
                const auto* object =
                    schema_.objects()->Get(static_cast<uint32_t>(members.Get(tag)->union_type()->index()));
                slot.count = object->fields()->size();
                const std::string path = slot.path;
                const size_t at = slot.at;
                give(std::move(slot));
                return table(*object, at, path);
            }
            case BaseType::Obj: {
                const auto* object = schema_.objects()->Get(static_cast<uint32_t>(type.index()));
                slot.kind = WireSlot::Kind::table;
                if (!object->is_struct()) {
                    follow(slot);
                    slot.count = object->fields()->size();
                }
                const std::string path = slot.path;
                const size_t at = slot.at;
                give(std::move(slot));
                return object->is_struct() ? structure(*object, at, path) : table(*object, at, path);
            }
            case BaseType::String:
                follow(slot);
                slot.kind = WireSlot::Kind::text;
                slot.count = read_at<uint32_t>(buffer_, slot.at);
                return give(std::move(slot));
            case BaseType::Vector: return list(type, std::move(slot));
            default: return give(std::move(slot));
        }
    }

    void follow(WireSlot& slot) const {
        slot.reference = slot.at;
        slot.at += read_at<uint32_t>(buffer_, slot.at);
        slot.kind = WireSlot::Kind::table;
    }

    void list(const reflection::Type& type, WireSlot slot) {
        follow(slot);
        slot.kind = WireSlot::Kind::list;
        slot.count = read_at<uint32_t>(buffer_, slot.at);
        slot.type = type.element();
        const reflection::Object* object = type.element() == BaseType::Obj
                                               ? schema_.objects()->Get(static_cast<uint32_t>(type.index()))
                                               : nullptr;
        const bool structs = object != nullptr && object->is_struct();
        slot.entry_bytes = structs ? static_cast<size_t>(object->bytesize()) : scalar_bytes(type.element());
        slot.entry_align = structs ? static_cast<size_t>(object->minalign()) : slot.entry_bytes;
        slot.of_tables = object != nullptr && !structs;
        const WireSlot copy = slot;
        give(std::move(slot));
        for (uint32_t i = 0; i < copy.count && left_ > 0; ++i) {
            if (!every_entry_ && i >= 8 && i + 1 < copy.count) continue;
            const size_t at = copy.at + 4 + i * copy.entry_bytes;
            const std::string path = fmt::format("{}[{}]", copy.path, i);
            if (structs)
                structure(*object, at, path);
            else if (object != nullptr) {
                WireSlot entry;
                entry.kind = WireSlot::Kind::table;
                entry.path = path;
                entry.name = copy.name + "[]";
                entry.reference = at;
                entry.at = at + read_at<uint32_t>(buffer_, at);
                entry.count = object->fields()->size();
                const size_t begin = entry.at;
                give(std::move(entry));
                table(*object, begin, path);
            } else {
                WireSlot entry;
                entry.path = path;
                entry.name = copy.name + "[]";
                entry.type = type.element();
                entry.at = at;
                give(std::move(entry));
            }
        }
    }

    void structure(const reflection::Object& object, size_t at, const std::string& path) {
        for (const reflection::Field* field : by_id(object)) {
            WireSlot slot;
            slot.path = path + "." + field->name()->str();
            slot.name = short_name(object.name()) + "." + field->name()->str();
            slot.at = at + field->offset();
            slot.type = field->type()->base_type();
            if (slot.type == BaseType::Obj)
                structure(*schema_.objects()->Get(static_cast<uint32_t>(field->type()->index())), slot.at,
                          slot.path);
            else
                give(std::move(slot));
        }
    }

    const reflection::Schema& schema_;
    std::span<const uint8_t> buffer_;
    bool every_entry_;
    size_t left_;
    Take take_;
};

}  // namespace

size_t scalar_bytes(reflection::BaseType type) {
    switch (type) {
        case BaseType::UType:
        case BaseType::Bool:
        case BaseType::Byte:
        case BaseType::UByte: return 1;
        case BaseType::Short:
        case BaseType::UShort: return 2;
        case BaseType::Long:
        case BaseType::ULong:
        case BaseType::Double: return 8;
        default: return 4;
    }
}

uint64_t bits_of(const WireSlot& slot, std::span<const uint8_t> buffer) {
    switch (slot.type) {
        case BaseType::Byte: return static_cast<uint64_t>(int64_t{read_at<int8_t>(buffer, slot.at)});
        case BaseType::Short: return static_cast<uint64_t>(int64_t{read_at<int16_t>(buffer, slot.at)});
        case BaseType::UShort: return read_at<uint16_t>(buffer, slot.at);
        case BaseType::Int: return static_cast<uint64_t>(int64_t{read_at<int32_t>(buffer, slot.at)});
        case BaseType::UInt: return read_at<uint32_t>(buffer, slot.at);
        case BaseType::Long:
        case BaseType::ULong:
        case BaseType::Double: return read_at<uint64_t>(buffer, slot.at);
        case BaseType::Float:
            return std::bit_cast<uint64_t>(static_cast<double>(read_at<float>(buffer, slot.at)));
        default: return buffer[slot.at];
    }
}

std::vector<WireSlot> walk(const reflection::Schema& schema, std::span<const uint8_t> buffer, size_t most) {
    std::vector<WireSlot> slots;
    Walker(schema, buffer, false, most, [&](WireSlot&& slot) { slots.push_back(std::move(slot)); }).root();
    return slots;
}

std::string seen_by(const reflection::Schema& schema, std::span<const uint8_t> buffer) {
    std::string out;
    Walker walker(schema, buffer, true, SIZE_MAX, [&](WireSlot&& slot) {
        switch (slot.kind) {
            case WireSlot::Kind::scalar:
            case WireSlot::Kind::union_tag:
                out += fmt::format("{} = {:016x}\n", slot.path, bits_of(slot, buffer));
                break;
            case WireSlot::Kind::list: out += fmt::format("{} has {}\n", slot.path, slot.count); break;
            case WireSlot::Kind::text:
                out += fmt::format(
                    "{} '{}'\n", slot.path,
                    std::string_view(reinterpret_cast<const char*>(buffer.data()) + slot.at + 4, slot.count));
                break;
            case WireSlot::Kind::table: out += slot.path + " there\n"; break;
        }
    });
    walker.absent = [&](const std::string& line) { out += line + "\n"; };
    walker.root();
    return out;
}

}  // namespace trochoid
