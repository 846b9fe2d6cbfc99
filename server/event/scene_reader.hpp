#pragma once
#include <toml++/toml.h>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/units/lattice.hpp"

namespace trochoid {

/// Closed range of a number in a scene file.
struct NumberRange {
    double least = 0.0;
    double most = 0.0;
};

/// Reads one table of a scene file by key. Every complaint is an OperatorError with file, line, key, range and what to do.
/// `finish` refuses keys that were never asked for.
class SceneReader {
public:
    /// `path` names the table in messages ("wind 'swell'"); empty for the file's top level.
    SceneReader(std::string file, std::string path, const toml::table& table);

    bool has(std::string_view key) const { return table_.contains(key); }
    /// A number (integer or float) in the range; without a fallback the key must be there. `unit` for messages: "m/s", "".
    double number(std::string_view key, NumberRange range, std::string_view unit,
                  std::optional<double> fallback = {});
    int64_t integer(std::string_view key, int64_t least, int64_t most, std::optional<int64_t> fallback = {});
    /// Text of 1 to `longest` bytes; without a fallback the key must be there.
    std::string text(std::string_view key, size_t longest, std::optional<std::string> fallback = {});
    /// One of the words, as its index.
    size_t choice(std::string_view key, const std::vector<std::string_view>& words, size_t fallback);
    bool boolean(std::string_view key, bool fallback);
    /// [x_m, z_m]: metres east and south of the world's origin.
    LatticePoint place(std::string_view key);
    /// [[x_m, z_m], …] with `least` to `most` places.
    std::vector<LatticePoint> places(std::string_view key, size_t least, size_t most);
    /// A sub-table; nullptr where it is missing.
    const toml::table* table(std::string_view key);
    /// The tables of an array of tables ([[key]]); empty where it is missing.
    std::vector<const toml::table*> tables(std::string_view key);
    /// Refuses every key that none of the calls above asked for.
    void finish() const;
    /// Refuses the key's value: "FILE:LINE: PATH.KEY <complaint>".
    [[noreturn]] void refuse(std::string_view key, std::string_view complaint) const;

    const std::string& file() const { return file_; }
    const std::string& path() const { return path_; }

private:
    const toml::node* find(std::string_view key);
    std::string name_of(std::string_view key) const;
    std::optional<LatticePoint> place_in(const toml::node& node) const;
    [[noreturn]] void missing(std::string_view key, std::string_view what) const;

    std::string file_;
    std::string path_;
    const toml::table& table_;
    std::set<std::string, std::less<>> known_;
};

}  // namespace trochoid
