#pragma once
#include <cstdint>
#include <iosfwd>
#include <string>

namespace trochoid {

/// What a check of one file found.
struct GoldenReport {
    uint32_t checked = 0;
    uint32_t wrong = 0;
    std::string first_wrong;  ///< "line N: …" of the first wrong or unreadable line
    uint64_t hash = 0;        ///< over everything computed: equal on every machine
};

/// Writes the golden vectors of the reference sea.
void write_goldens(std::ostream& out);

/// Reads a golden file, rebuilds the sea from its records alone and compares every line with what this build computes.
GoldenReport check_goldens(std::istream& in);

}  // namespace trochoid
