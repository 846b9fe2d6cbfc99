#include "tests/unit/server_net/tls_by_hand.hpp"

#include <openssl/core_names.h>
#include <openssl/evp.h>
#include <openssl/kdf.h>
#include <openssl/params.h>
#include <openssl/ssl.h>

#include <array>
#include <chrono>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t tag_bytes = 16;

Bytes from_hex(const std::string& text) {
    Bytes bytes;
    for (size_t i = 0; i + 1 < text.size(); i += 2)
        bytes.push_back(static_cast<uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
    return bytes;
}

// HKDF-Expand-Label of RFC 8446 7.1, with an empty context, for the suite's SHA-256.
Bytes expanded(const Bytes& secret, const std::string& label, size_t length) {
    const std::string name = "tls13 " + label;
    Bytes info{0, static_cast<uint8_t>(length), static_cast<uint8_t>(name.size())};
    info.insert(info.end(), name.begin(), name.end());
    info.push_back(0);
    const std::unique_ptr<EVP_KDF, decltype(&EVP_KDF_free)> kdf(EVP_KDF_fetch(nullptr, "HKDF", nullptr),
                                                                EVP_KDF_free);
    const std::unique_ptr<EVP_KDF_CTX, decltype(&EVP_KDF_CTX_free)> context(EVP_KDF_CTX_new(kdf.get()),
                                                                            EVP_KDF_CTX_free);
    int mode = EVP_KDF_HKDF_MODE_EXPAND_ONLY;
    std::string digest = "SHA256";
    Bytes key = secret;
    const std::array<OSSL_PARAM, 5> wish{
        OSSL_PARAM_construct_int(OSSL_KDF_PARAM_MODE, &mode),
        OSSL_PARAM_construct_utf8_string(OSSL_KDF_PARAM_DIGEST, digest.data(), 0),
        OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_KEY, key.data(), key.size()),
        OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_INFO, info.data(), info.size()),
        OSSL_PARAM_construct_end()};
    Bytes out(length);
    TROCHOID_ASSERT(EVP_KDF_derive(context.get(), out.data(), length, wish.data()) == 1, "no key");
    return out;
}

}  // namespace

struct TlsByHand::Impl {
    std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context{SSL_CTX_new(TLS_client_method()), SSL_CTX_free};
    std::unique_ptr<SSL, decltype(&SSL_free)> ssl{nullptr, SSL_free};
    BIO* in = nullptr;   // the SSL's
    BIO* out = nullptr;  // the SSL's
    Bytes secret;        // CLIENT_TRAFFIC_SECRET_0
    uint64_t records = 0;
};

TlsByHand::TlsByHand(uint16_t port, const std::string& from)
    : pipe_(connect_tcp(port, "127.0.0.1", from)), impl_(std::make_unique<Impl>()) {
    SSL_CTX* const context = impl_->context.get();
    SSL_CTX_set_min_proto_version(context, TLS1_3_VERSION);
    SSL_CTX_set_ciphersuites(context, "TLS_AES_128_GCM_SHA256");
    SSL_CTX_set_keylog_callback(context, [](const SSL* ssl, const char* line) {
        const std::string text(line);
        if (!text.starts_with("CLIENT_TRAFFIC_SECRET_0 ")) return;
        static_cast<Impl*>(SSL_get_ex_data(ssl, 0))->secret = from_hex(text.substr(text.rfind(' ') + 1));
    });
    impl_->ssl.reset(SSL_new(context));
    impl_->in = BIO_new(BIO_s_mem());
    impl_->out = BIO_new(BIO_s_mem());
    SSL_set_bio(impl_->ssl.get(), impl_->in, impl_->out);
    SSL_set_ex_data(impl_->ssl.get(), 0, impl_.get());
    SSL_set_connect_state(impl_->ssl.get());
}

TlsByHand::~TlsByHand() = default;

Bytes TlsByHand::pending() {
    Bytes bytes(BIO_ctrl_pending(impl_->out));
    if (!bytes.empty()) BIO_read(impl_->out, bytes.data(), static_cast<int>(bytes.size()));
    return bytes;
}

bool TlsByHand::send_pending() {
    const Bytes bytes = pending();
    return bytes.empty() || pipe_->write(std::span<const uint8_t>(bytes));
}

Bytes TlsByHand::hello() {
    SSL_do_handshake(impl_->ssl.get());
    return pending();
}

bool TlsByHand::shake_hands() {
    while (true) {
        const int done = SSL_do_handshake(impl_->ssl.get());
        if (!send_pending()) return false;
        if (done == 1) return true;
        std::array<uint8_t, 4096> buffer{};
        const size_t bytes = pipe_->read(buffer);
        if (bytes == 0) return false;
        BIO_write(impl_->in, buffer.data(), static_cast<int>(bytes));
    }
}

bool TlsByHand::write(std::span<const uint8_t> bytes) {
    ++impl_->records;
    return SSL_write(impl_->ssl.get(), bytes.data(), static_cast<int>(bytes.size())) > 0 && send_pending();
}

Bytes TlsByHand::read(BytePipe::Milliseconds within) {
    const auto until = Clock::now() + within;
    std::array<uint8_t, 16384> buffer{};
    while (true) {
        const int bytes = SSL_read(impl_->ssl.get(), buffer.data(), static_cast<int>(buffer.size()));
        if (bytes > 0) return {buffer.begin(), buffer.begin() + bytes};
        const auto left = std::chrono::duration_cast<BytePipe::Milliseconds>(until - Clock::now());
        if (left.count() <= 0) return {};
        const size_t more = pipe_->read(buffer, left);
        if (more == 0) return {};
        BIO_write(impl_->in, buffer.data(), static_cast<int>(more));
    }
}

Bytes TlsByHand::key_updates(int count) {
    for (int i = 0; i < count; ++i) {
        SSL_key_update(impl_->ssl.get(), SSL_KEY_UPDATE_NOT_REQUESTED);
        SSL_do_handshake(impl_->ssl.get());
    }
    return pending();
}

Bytes TlsByHand::record(uint8_t type, std::span<const uint8_t> bytes) {
    const Bytes key = expanded(impl_->secret, "key", 16);
    Bytes nonce = expanded(impl_->secret, "iv", 12);
    for (size_t i = 0; i < 8; ++i)
        nonce[nonce.size() - 1 - i] ^= static_cast<uint8_t>(impl_->records >> (8 * i));
    ++impl_->records;
    Bytes inside(bytes.begin(), bytes.end());
    inside.push_back(type);
    const size_t length = inside.size() + tag_bytes;
    Bytes all{0x17, 3, 3, static_cast<uint8_t>(length >> 8), static_cast<uint8_t>(length)};
    const std::unique_ptr<EVP_CIPHER_CTX, decltype(&EVP_CIPHER_CTX_free)> cipher(EVP_CIPHER_CTX_new(),
                                                                                 EVP_CIPHER_CTX_free);
    Bytes sealed(length);
    int done = 0;
    EVP_EncryptInit_ex(cipher.get(), EVP_aes_128_gcm(), nullptr, key.data(), nonce.data());
    EVP_EncryptUpdate(cipher.get(), nullptr, &done, all.data(), static_cast<int>(all.size()));
    EVP_EncryptUpdate(cipher.get(), sealed.data(), &done, inside.data(), static_cast<int>(inside.size()));
    EVP_EncryptFinal_ex(cipher.get(), sealed.data() + done, &done);
    EVP_CIPHER_CTX_ctrl(cipher.get(), EVP_CTRL_AEAD_GET_TAG, static_cast<int>(tag_bytes),
                        sealed.data() + inside.size());
    all.insert(all.end(), sealed.begin(), sealed.end());
    return all;
}

}  // namespace trochoid
