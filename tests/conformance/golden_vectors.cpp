#include "tests/conformance/golden_vectors.hpp"

#include <charconv>
#include <sstream>

#include "golden_text_generated.h"
#include "protocol/units/assert.hpp"

namespace trochoid::conformance {

namespace {

Bytes from_hex(const std::string& digits) {
    Bytes bytes(digits.size() / 2);
    for (size_t i = 0; i < bytes.size(); ++i) {
        const char* at = digits.data() + 2 * i;
        const auto read = std::from_chars(at, at + 2, bytes[i], 16);
        TROCHOID_ASSERT(read.ptr == at + 2, "golden messages: no hexadecimal digits at {}", i);
    }
    return bytes;
}

std::vector<GoldenMessage> read_messages() {
    std::vector<GoldenMessage> messages;
    std::string text;
    for (const char* piece : golden_text::wire_messages) text += piece;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        GoldenMessage message;
        std::string digits;
        words >> message.direction >> message.name >> digits;
        message.bytes = from_hex(digits);
        messages.push_back(std::move(message));
    }
    return messages;
}

}  // namespace

const std::vector<GoldenMessage>& golden_messages() {
    static const std::vector<GoldenMessage> messages = read_messages();
    return messages;
}

}  // namespace trochoid::conformance
