#include "protocol/login/base64url.hpp"

#include <openssl/evp.h>

#include <algorithm>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr size_t longest_text = 4096;

}  // namespace

std::string base64url(std::span<const uint8_t> bytes) {
    TROCHOID_ASSERT(bytes.size() <= longest_text, "{} bytes to write as base64url", bytes.size());
    std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');
    const int written = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(),
                                        static_cast<int>(bytes.size()));
    text.resize(static_cast<size_t>(written));
    text.erase(std::find(text.begin(), text.end(), '='), text.end());
    std::replace(text.begin(), text.end(), '+', '-');
    std::replace(text.begin(), text.end(), '/', '_');
    return text;
}

std::optional<std::vector<uint8_t>> from_base64url(std::string_view text) {
    if (text.size() > longest_text) return std::nullopt;
    std::string padded(text);
    std::replace(padded.begin(), padded.end(), '-', '+');
    std::replace(padded.begin(), padded.end(), '_', '/');
    padded.resize((padded.size() + 3) / 4 * 4, '=');
    std::vector<uint8_t> bytes(padded.size() / 4 * 3);
    const int decoded = EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(padded.data()),
                                        static_cast<int>(padded.size()));
    if (decoded < 0) return std::nullopt;
    bytes.resize(text.size() * 3 / 4);
    // OpenSSL passes over blanks, padding and bits left over: one value has one text only.
    if (static_cast<size_t>(decoded) < bytes.size() || base64url(bytes) != text) return std::nullopt;
    return bytes;
}

}  // namespace trochoid
