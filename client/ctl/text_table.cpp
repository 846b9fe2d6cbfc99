#include "client/ctl/text_table.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

/// Code points of well-formed UTF-8 (names on the wire are checked to be that).
size_t width_of(const std::string& text) {
    return static_cast<size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

}  // namespace

void TextTable::add(std::vector<std::string> cells) {
    TROCHOID_ASSERT(cells.size() == columns_.size(), "{} cells for {} columns", cells.size(),
                    columns_.size());
    rows_.push_back(std::move(cells));
}

std::string TextTable::text() const {
    std::vector<size_t> widths;
    for (size_t i = 0; i < columns_.size(); ++i) {
        widths.push_back(width_of(columns_[i].title));
        for (const auto& row : rows_) widths[i] = std::max(widths[i], width_of(row[i]));
    }
    std::string out;
    const auto add_line = [&](const auto& cell_of) {
        std::string line;
        for (size_t i = 0; i < columns_.size(); ++i) {
            const std::string& cell = cell_of(i);
            const std::string blanks(widths[i] - width_of(cell), ' ');
            if (i > 0) line += "  ";
            line += columns_[i].align == Align::right ? blanks + cell : cell + blanks;
        }
        line.erase(line.find_last_not_of(' ') + 1);
        out += line + '\n';
    };
    add_line([this](size_t i) -> const std::string& { return columns_[i].title; });
    for (const auto& row : rows_) add_line([&row](size_t i) -> const std::string& { return row[i]; });
    return out;
}

}  // namespace trochoid
