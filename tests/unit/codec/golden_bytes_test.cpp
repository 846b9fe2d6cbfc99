#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/unit/codec/fixed_messages.hpp"

// The bytes of fixed messages, as every version, compiler and byte order must write and read them. To write the file anew
// after a deliberate change: TROCHOID_WRITE_GOLDENS=1 test_codec --gtest_filter='GoldenBytes.*'
namespace trochoid {
namespace {

constexpr const char* file_name = TROCHOID_SOURCE_DIR "/tests/golden/wire_messages.txt";
constexpr const char* head =
    "# Trochoid golden messages, protocol version 3: one FlatBuffer a line, as encode() writes it.\n"
    "# DIRECTION NAME BYTES          client (TRCC), server (TRCS) or event (TRLE); bytes as hex\n"
    "# Another encoder may lay a buffer out otherwise; every decoder must read these.\n";

std::string hex(const Bytes& bytes) {
    std::string text;
    for (const uint8_t b : bytes) text += fmt::format("{:02x}", b);
    return text;
}

Bytes from_hex(const std::string& text) {
    Bytes bytes;
    for (size_t i = 0; i + 1 < text.size(); i += 2)
        bytes.push_back(static_cast<uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
    return bytes;
}

std::vector<FixedMessage> read_file() {
    std::vector<FixedMessage> all;
    std::ifstream in(file_name);
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        FixedMessage message;
        std::string bytes;
        std::istringstream(line) >> message.direction >> message.name >> bytes;
        message.bytes = from_hex(bytes);
        all.push_back(message);
    }
    return all;
}

TEST(GoldenBytes, FixedMessagesEncodeToTheFile) {
    const auto messages = fixed_messages();
    if (std::getenv("TROCHOID_WRITE_GOLDENS") != nullptr) {
        std::ofstream out(file_name);
        out << head;
        for (const FixedMessage& m : messages)
            out << m.direction << ' ' << m.name << ' ' << hex(m.bytes) << '\n';
    }
    const auto golden = read_file();
    ASSERT_EQ(golden.size(), messages.size()) << file_name;
    for (size_t i = 0; i < golden.size(); ++i) {
        EXPECT_EQ(golden[i].name, messages[i].name);
        EXPECT_EQ(hex(golden[i].bytes), hex(messages[i].bytes))
            << messages[i].direction << ' ' << messages[i].name;
    }
}

TEST(GoldenBytes, TheFilesMessagesDecodeAndEncodeToThemselves) {
    for (const FixedMessage& m : read_file())
        EXPECT_EQ(hex(encoded_again(m)), hex(m.bytes)) << m.direction << ' ' << m.name;
}

}  // namespace
}  // namespace trochoid
