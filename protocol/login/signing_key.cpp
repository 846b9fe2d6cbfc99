#include "protocol/login/signing_key.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <algorithm>
#include <utility>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

using Key = std::shared_ptr<EVP_PKEY>;
using Bio = std::unique_ptr<BIO, decltype(&BIO_free_all)>;
using Digest = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

Key owned(EVP_PKEY* key) { return {key, EVP_PKEY_free}; }

// What was refused is told by our own results: nothing may stay for whoever asks OpenSSL next on this thread.
Key ed25519_or_none(EVP_PKEY* found) {
    ERR_clear_error();
    if (found == nullptr) return nullptr;
    Key key = owned(found);
    return EVP_PKEY_get_id(found) == EVP_PKEY_ED25519 ? key : nullptr;
}

Bio reader_of(std::string_view text) {
    constexpr size_t longest_pem = 16384;
    const size_t size = text.size() > longest_pem ? 0 : text.size();
    return {BIO_new_mem_buf(text.data(), static_cast<int>(size)), BIO_free_all};
}

std::span<const uint8_t> content(BIO* memory) {
    char* data = nullptr;
    const long size = BIO_get_mem_data(memory, &data);
    return {reinterpret_cast<const uint8_t*>(data), static_cast<size_t>(size)};
}

// Without it OpenSSL asks for the password at the terminal.
int no_password(char* /*into*/, int /*size*/, int /*writing*/, void* /*user*/) { return -1; }

}  // namespace

TokenKey::TokenKey(std::shared_ptr<evp_pkey_st> key) : key_(std::move(key)) {
    const std::array<uint8_t, bytes> public_bytes = raw();
    std::array<uint8_t, EVP_MAX_MD_SIZE> digest{};
    const int done =
        EVP_Digest(public_bytes.data(), public_bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr);
    TROCHOID_ASSERT(done == 1, "SHA-256 failed ({})", done);
    std::copy_n(digest.begin(), id_.size(), id_.begin());
}

std::optional<TokenKey> TokenKey::from_bytes(std::span<const uint8_t, bytes> raw) {
    Key key = ed25519_or_none(EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, raw.data(), raw.size()));
    if (!key) return std::nullopt;
    return TokenKey(std::move(key));
}

std::optional<TokenKey> TokenKey::from_pem(std::string_view pem) {
    const Bio bio = reader_of(pem);
    Key key = ed25519_or_none(PEM_read_bio_PUBKEY(bio.get(), nullptr, no_password, nullptr));
    if (!key) return std::nullopt;
    return TokenKey(std::move(key));
}

std::array<uint8_t, TokenKey::bytes> TokenKey::raw() const {
    std::array<uint8_t, bytes> raw{};
    size_t size = raw.size();
    const int done = EVP_PKEY_get_raw_public_key(key_.get(), raw.data(), &size);
    TROCHOID_ASSERT(done == 1 && size == raw.size(), "a public key of {} bytes ({})", size, done);
    return raw;
}

std::string TokenKey::pem() const {
    const Bio bio(BIO_new(BIO_s_mem()), BIO_free_all);
    const int done = PEM_write_bio_PUBKEY(bio.get(), key_.get());
    TROCHOID_ASSERT(done == 1, "a public key was not written ({})", done);
    const std::span<const uint8_t> text = content(bio.get());
    return {text.begin(), text.end()};
}

bool TokenKey::signed_this(std::span<const uint8_t> message, const Signature& signature) const {
    const Digest digest(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    const bool good =
        digest && EVP_DigestVerifyInit(digest.get(), nullptr, nullptr, nullptr, key_.get()) == 1 &&
        EVP_DigestVerify(digest.get(), signature.data(), signature.size(), message.data(), message.size()) ==
            1;
    ERR_clear_error();
    return good;
}

SigningKey::SigningKey(std::shared_ptr<evp_pkey_st> key) : key_(std::move(key)) {}

SigningKey SigningKey::generate() {
    Key key = ed25519_or_none(EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519"));
    TROCHOID_ASSERT(key != nullptr, "OpenSSL made no Ed25519 key of {} bytes", bytes);
    return SigningKey(std::move(key));
}

SigningKey SigningKey::from_seed(std::span<const uint8_t, bytes> seed) {
    Key key =
        ed25519_or_none(EVP_PKEY_new_raw_private_key(EVP_PKEY_ED25519, nullptr, seed.data(), seed.size()));
    TROCHOID_ASSERT(key != nullptr, "OpenSSL took no seed of {} bytes", seed.size());
    return SigningKey(std::move(key));
}

std::optional<SigningKey> SigningKey::from_pem(std::string_view pem) {
    const Bio bio = reader_of(pem);
    Key key = ed25519_or_none(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr));
    if (!key) return std::nullopt;
    return SigningKey(std::move(key));
}

Secret SigningKey::pem() const {
    // Wiped when it is freed, as BIO_s_mem is not.
    const Bio bio(BIO_new(BIO_s_secmem()), BIO_free_all);
    const int done =
        PEM_write_bio_PKCS8PrivateKey(bio.get(), key_.get(), nullptr, nullptr, 0, nullptr, nullptr);
    TROCHOID_ASSERT(done == 1, "a private key was not written ({})", done);
    return Secret(content(bio.get()));
}

TokenKey SigningKey::public_key() const {
    std::array<uint8_t, TokenKey::bytes> raw{};
    size_t size = raw.size();
    const int done = EVP_PKEY_get_raw_public_key(key_.get(), raw.data(), &size);
    TROCHOID_ASSERT(done == 1 && size == raw.size(), "a public key of {} bytes ({})", size, done);
    return *TokenKey::from_bytes(raw);
}

Signature SigningKey::sign(std::span<const uint8_t> message) const {
    Signature signature{};
    size_t size = signature.size();
    const Digest digest(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    const bool done =
        digest && EVP_DigestSignInit(digest.get(), nullptr, nullptr, nullptr, key_.get()) == 1 &&
        EVP_DigestSign(digest.get(), signature.data(), &size, message.data(), message.size()) == 1;
    TROCHOID_ASSERT(done && size == signature.size(), "OpenSSL did not sign: {} bytes", size);
    return signature;
}

}  // namespace trochoid
