#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "flatbuffers/reflection_generated.h"

namespace trochoid {

/// A place in a buffer that its schema gives a meaning.
struct WireSlot {
    enum class Kind : uint8_t {
        scalar,     ///< a number at `at`
        union_tag,  ///< a union's tag, one byte at `at`
        list,       ///< a vector: its u32 length at `at`, its entries behind
        text,       ///< a string: its u32 length at `at`
        table,      ///< a table or struct that a table's field names
    };
    Kind kind = Kind::scalar;
    std::string path;  ///< from the root: "body.view.qx", entries of lists as [i]
    std::string name;  ///< the field by the type that holds it: "View.qx"
    /// Of a scalar its type; of a list its entries'.
    reflection::BaseType type = reflection::BaseType::None;
    size_t at = 0;           ///< offset in the buffer, bytes
    size_t entry_bytes = 0;  ///< a list: distance of its entries
    size_t entry_align = 1;  ///< and what their type demands
    uint32_t count = 0;  ///< a list's or string's length; members of a union; a table's fields (a struct: 0)
    bool of_tables = false;    ///< a list whose entries are references to tables
    size_t holder = 0;         ///< the table with the field, 0: inside a struct
    uint16_t field_entry = 0;  ///< its entry in the table's vtable, bytes from the vtable
    size_t reference = 0;      ///< where the uoffset to a list, string or table lies; 0: none
};

/// All slots of a buffer that the schema's verifier has accepted, in the order of the schema's fields; at most `most`
/// (a list's entries past the first eight are passed over, but for its last).
std::vector<WireSlot> walk(const reflection::Schema& schema, std::span<const uint8_t> buffer,
                           size_t most = 20'000);

/// All numbers and texts of such a buffer by path, one a line: what a reader with this schema sees. Absent tables, lists
/// and strings say so; all entries of lists count.
std::string seen_by(const reflection::Schema& schema, std::span<const uint8_t> buffer);

/// A scalar's value, raised to 64 bits; a float's as the bits of a double.
uint64_t bits_of(const WireSlot& slot, std::span<const uint8_t> buffer);

/// Bytes of a scalar.
size_t scalar_bytes(reflection::BaseType type);

}  // namespace trochoid
