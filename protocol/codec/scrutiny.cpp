#include "protocol/codec/scrutiny.hpp"

#include <string_view>

namespace trochoid {

namespace {

bool continuation(uint8_t byte) { return (byte & 0xc0U) == 0x80U; }

bool control(uint32_t code_point) { return code_point < 0x20 || (code_point >= 0x7f && code_point < 0xa0); }

/// Length of the well-formed UTF-8 character at the start (Unicode 15, table 3-7), 0 where there is none or where it is
/// a control character.
size_t character_length(std::string_view text) {
    const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
    const uint8_t first = byte(0);
    if (first < 0x80) return control(first) ? 0 : 1;
    const size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
    uint32_t code_point = first & (0x7fU >> length);
    for (size_t i = 1; i < length; ++i) {
        if (!continuation(byte(i))) return 0;
        code_point = (code_point << 6) | (byte(i) & 0x3fU);
    }
    constexpr uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code_point >= 0xd800 && code_point < 0xe000;
    return code_point < least[length] || code_point > 0x10ffff || surrogate || control(code_point) ? 0
                                                                                                   : length;
}

}  // namespace

std::string Scrutiny::text(const char* name, const flatbuffers::String* value, size_t most) {
    if (present(name, value) == nullptr) return {};
    if (value->size() > most) {
        refuse(ErrorCode::value_out_of_range,
               fmt::format("{} has {} bytes, more than {}", name, value->size(), most));
        return {};
    }
    std::string text = value->str();
    for (std::string_view rest = text; !rest.empty();) {
        const size_t length = character_length(rest);
        if (length == 0) {
            refuse(ErrorCode::value_out_of_range,
                   fmt::format("{} is not UTF-8 without control characters", name));
            return {};
        }
        rest.remove_prefix(length);
    }
    return text;
}

std::string sentence_for_wire(std::string_view sentence) {
    std::string out;
    while (!sentence.empty()) {
        const size_t length = character_length(sentence);
        if (out.size() + std::max(length, size_t{1}) > longest_sentence) break;
        out.append(length == 0 ? " " : sentence.substr(0, length));
        sentence.remove_prefix(std::max(length, size_t{1}));
    }
    return out;
}

}  // namespace trochoid
