#include "protocol/login/base64url.hpp"

#include <gtest/gtest.h>

namespace trochoid {
namespace {

std::vector<uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

// RFC 4648, chapter 10, without the padding.
TEST(Base64url, VectorsOfTheRfc) {
    const std::pair<const char*, const char*> vectors[] = {
        {"", ""},           {"f", "Zg"},          {"fo", "Zm8"},         {"foo", "Zm9v"},
        {"foob", "Zm9vYg"}, {"fooba", "Zm9vYmE"}, {"foobar", "Zm9vYmFy"}};
    for (const auto& [plain, text] : vectors) {
        EXPECT_EQ(base64url(bytes_of(plain)), text);
        EXPECT_EQ(from_base64url(text), bytes_of(plain));
    }
    EXPECT_EQ(base64url(std::vector<uint8_t>{0xfb, 0xff, 0xfe}), "-__-");
}

// One value has one text: what decodes at all encodes to itself.
TEST(Base64url, EveryShortTextIsCanonicalOrNothing) {
    const std::string some = "AQgwBZ_-+/= .\n\t\xff" + std::string(1, '\0');
    size_t taken = 0;
    for (const char a : some)
        for (const char b : some)
            for (const char c : some)
                for (const char d : some) {
                    const std::string text{a, b, c, d};
                    for (const size_t length : {1U, 2U, 3U, 4U}) {
                        const auto bytes = from_base64url(text.substr(0, length));
                        if (!bytes) continue;
                        ++taken;
                        ASSERT_EQ(base64url(*bytes), text.substr(0, length));
                    }
                }
    EXPECT_GT(taken, 4096U) << "eight of the characters are of the alphabet";
}

TEST(Base64url, EveryLengthComesBack) {
    for (size_t length = 0; length < 300; ++length) {
        std::vector<uint8_t> bytes(length);
        for (size_t i = 0; i < length; ++i) bytes[i] = static_cast<uint8_t>(i * 37 + length);
        EXPECT_EQ(from_base64url(base64url(bytes)), bytes);
    }
    EXPECT_FALSE(from_base64url(std::string(4097, 'A')));
}

}  // namespace
}  // namespace trochoid
