#pragma once
#include <string>
#include <vector>

namespace trochoid {

/// Columns side by side, two blanks apart: numbers to the right, text to the left. UTF-8, one column a code point.
class TextTable {
public:
    enum class Align { left, right };
    struct Column {
        std::string title;
        Align align = Align::right;
    };
    explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

    /// As many cells as columns.
    void add(std::vector<std::string> cells);
    /// Title line and rows, each ended by a newline, no blanks at their ends.
    std::string text() const;

private:
    std::vector<Column> columns_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace trochoid
