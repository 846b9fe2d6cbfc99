#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/codec/codec.hpp"

namespace trochoid::conformance {

/// A line of `tests/golden/wire_messages.txt`, which is compiled in.
struct GoldenMessage {
    std::string direction;  ///< client, server or event
    std::string name;
    Bytes bytes;
};
const std::vector<GoldenMessage>& golden_messages();
/// Of hexadecimal digits; nothing where they are none, or an odd number.
std::optional<Bytes> from_hex(std::string_view digits);

/// A golden file, which is compiled in.
struct VectorSet {
    std::string name;   ///< messages, sea, edges, fields, clock
    std::string group;  ///< encoding, evaluation, fields, clock
    std::string text;
};
/// In the order in which they are printed.
std::span<const VectorSet> vector_sets();
/// The groups, in that order.
std::vector<std::string> vector_groups();

/// A golden line apart: what is asked, and what has to come.
struct VectorLine {
    std::string kind;      ///< its first word
    std::string question;  ///< with the kind
    std::string answer;    ///< empty: a record, which is no question
};
/// Nothing where the line has fewer words than its kind asks with.
std::optional<VectorLine> vector_line(const VectorSet& set, std::string_view line);

/// All sets of these groups (none: all), each behind a line `vectors NAME`; with `questions` without the answers.
std::string vectors_text(const std::vector<std::string>& groups, bool questions);

}  // namespace trochoid::conformance
