#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/units/error_code.hpp"
#include "tests/fuzz/wire_walk.hpp"

namespace trochoid {

/// What the standard says of a field, as field_rules.txt has it.
struct FieldRule {
    enum class Kind : uint8_t { any, flag, codes, range, size, presence, list, text };
    Kind kind = Kind::any;
    bool required = false;
    uint32_t most_entries = 0;  ///< of a list; bytes of a text
    double least = 0.0;         ///< legal numbers; exact for integers up to 2^61
    double most = 0.0;
    ErrorCode below = ErrorCode::value_out_of_range;
    ErrorCode above = ErrorCode::value_out_of_range;  ///< also of a list that is too long
};

class FieldRules {
public:
    /// Throws std::runtime_error for a line that makes no sense.
    explicit FieldRules(const std::string& file);
    /// The rule of a slot; throws where no line fits: every field of the schema has one.
    const FieldRule& of(const WireSlot& slot) const;

private:
    struct Line {
        std::string field;
        bool ends_path = false;
        FieldRule rule;
    };
    std::vector<Line> lines_;
};

}  // namespace trochoid
