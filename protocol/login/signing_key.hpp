#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "protocol/login/secret.hpp"

struct evp_pkey_st;

namespace trochoid {

using Signature = std::array<uint8_t, 64>;
/// The first 8 bytes of the SHA-256 of a public key's 32: tells which key a token asks for.
using KeyId = std::array<uint8_t, 8>;

/// An Ed25519 public key (RFC 8032): what a server checks tokens with.
class TokenKey {
public:
    static constexpr size_t bytes = 32;

    /// Nothing where these are no public key.
    static std::optional<TokenKey> from_bytes(std::span<const uint8_t, bytes> raw);
    /// From PEM (SubjectPublicKeyInfo, RFC 8410), as `openssl pkey -pubout` writes it. Nothing for anything else.
    static std::optional<TokenKey> from_pem(std::string_view pem);

    std::array<uint8_t, bytes> raw() const;
    std::string pem() const;
    const KeyId& id() const { return id_; }
    bool signed_this(std::span<const uint8_t> message, const Signature& signature) const;

private:
    friend class SigningKey;
    explicit TokenKey(std::shared_ptr<evp_pkey_st> key);
    std::shared_ptr<evp_pkey_st> key_;
    KeyId id_{};
};

/// An Ed25519 private key: whoever has it decides who may what. OpenSSL wipes it when the last copy goes.
class SigningKey {
public:
    static constexpr size_t bytes = 32;

    static SigningKey generate();
    /// From the seed of RFC 8032.
    static SigningKey from_seed(std::span<const uint8_t, bytes> seed);
    /// From PEM (PKCS #8, not encrypted), as `openssl genpkey -algorithm ed25519` writes it. Nothing for anything else.
    static std::optional<SigningKey> from_pem(std::string_view pem);

    Secret pem() const;
    TokenKey public_key() const;
    Signature sign(std::span<const uint8_t> message) const;

private:
    explicit SigningKey(std::shared_ptr<evp_pkey_st> key);
    std::shared_ptr<evp_pkey_st> key_;
};

}  // namespace trochoid
