#include "tests/conformance/golden_vectors.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>

#include "golden_text_generated.h"
#include "protocol/units/assert.hpp"

namespace trochoid::conformance {

namespace {

std::string joined(std::span<const char* const> pieces) {
    std::string text;
    for (const char* piece : pieces) text += piece;
    return text;
}

std::vector<GoldenMessage> read_messages() {
    std::vector<GoldenMessage> messages;
    std::istringstream lines(joined(golden_text::wire_messages));
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        GoldenMessage message;
        std::string digits;
        words >> message.direction >> message.name >> digits;
        auto bytes = from_hex(digits);
        TROCHOID_ASSERT(bytes.has_value(), "golden message {}: no hexadecimal digits", message.name);
        message.bytes = std::move(*bytes);
        messages.push_back(std::move(message));
    }
    return messages;
}

/// Words of a line that ask, with its kind. What is not here is a record. Of a message all of it asks: it is to be read, and written again.
size_t words_of_question(const VectorSet& set, const std::string& kind) {
    if (set.name == "messages") return 3;
    static const std::map<std::string, size_t, std::less<>> words{
        {"sincos", 2},  {"wakenode", 3}, {"wakeroot", 2}, {"constants", 8}, {"phase", 8},
        {"land", 5},    {"sample", 4},   {"layers", 5},   {"water", 4},     {"hash", 3},
        {"seatime", 2}, {"hello", 4},    {"exchange", 5}, {"reading", 2}};
    const auto found = words.find(kind);
    return found == words.end() ? 0 : found->second;
}

}  // namespace

std::optional<Bytes> from_hex(std::string_view digits) {
    if (digits.size() % 2 != 0) return std::nullopt;
    Bytes bytes(digits.size() / 2);
    for (size_t i = 0; i < bytes.size(); ++i) {
        const char* at = digits.data() + 2 * i;
        if (std::from_chars(at, at + 2, bytes[i], 16).ptr != at + 2) return std::nullopt;
    }
    return bytes;
}

const std::vector<GoldenMessage>& golden_messages() {
    static const std::vector<GoldenMessage> messages = read_messages();
    return messages;
}

std::span<const VectorSet> vector_sets() {
    static const std::vector<VectorSet> sets{{"messages", "encoding", joined(golden_text::wire_messages)},
                                             {"sea", "evaluation", joined(golden_text::sea)},
                                             {"edges", "evaluation", joined(golden_text::edges)},
                                             {"fields", "fields", joined(golden_text::fields)},
                                             {"clock", "clock", joined(golden_text::wire_clock)}};
    return sets;
}

std::vector<std::string> vector_groups() {
    std::vector<std::string> groups;
    for (const VectorSet& set : vector_sets())
        if (groups.empty() || groups.back() != set.group) groups.push_back(set.group);
    return groups;
}

std::optional<VectorLine> vector_line(const VectorSet& set, std::string_view line) {
    VectorLine apart;
    apart.kind = line.substr(0, line.find(' '));
    const size_t words = words_of_question(set, apart.kind);
    size_t end = 0;
    for (size_t i = 0; i < words; ++i) {
        if (i > 0 && end >= line.size()) return std::nullopt;
        end = std::min(line.find(' ', i == 0 ? 0 : end + 1), line.size());
    }
    apart.question = line.substr(0, words == 0 ? line.size() : end);
    if (words > 0 && end < line.size()) apart.answer = line.substr(end + 1);
    if (set.name == "messages") {
        // The name is what it is asked by; the answer is what it is written as.
        const size_t digits = apart.question.rfind(' ');
        apart.answer = apart.question.substr(digits + 1);
        apart.question.resize(digits);
    }
    return apart;
}

std::string vectors_text(const std::vector<std::string>& groups, bool questions) {
    std::string text;
    for (const VectorSet& set : vector_sets()) {
        if (!groups.empty() && std::find(groups.begin(), groups.end(), set.group) == groups.end()) continue;
        text += "vectors " + set.name + "\n";
        if (!questions || set.name == "messages") {
            text += set.text;
            continue;
        }
        std::istringstream lines(set.text);
        for (std::string line; std::getline(lines, line);) {
            const auto apart = line.starts_with('#') ? std::nullopt : vector_line(set, line);
            text += (apart ? apart->question : line) + "\n";
        }
    }
    return text;
}

}  // namespace trochoid::conformance
