#include "server/net/tls_identity.hpp"

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <array>
#include <fstream>
#include <string_view>
#include <utility>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr int warn_before_seconds = 14 * 24 * 3600;

// The protocols that may be named inside TLS (ALPN), by preference, each behind its length; naming none is allowed.
constexpr std::string_view known_protocols = "\x08trochoid\x08http/1.1";

// What a client may have the keys agreed with: what every TLS 1.3 library has, and no more. The choice is the client's and the cost the
// server's: a quarter of a millisecond with these, two with P-384, two hundred with ffdhe8192, which OpenSSL would take too.
constexpr const char* cheap_groups = "X25519:P-256";

std::string last_reason() {
    const unsigned long code = ERR_peek_last_error();
    const char* reason = code == 0 ? nullptr : ERR_reason_error_string(code);
    return reason == nullptr ? "no reason is given" : reason;
}

// Nobody is there to type one in: OpenSSL would ask at the terminal.
int no_passphrase(char*, int, int, void*) { return -1; }

int choose_protocol(SSL*, const unsigned char** chosen, unsigned char* length, const unsigned char* offered,
                    unsigned offered_length, void*) {
    const auto* known = reinterpret_cast<const unsigned char*>(known_protocols.data());
    unsigned char* found = nullptr;
    if (SSL_select_next_proto(&found, length, known, static_cast<unsigned>(known_protocols.size()), offered,
                              offered_length) != OPENSSL_NPN_NEGOTIATED)
        return SSL_TLSEXT_ERR_ALERT_FATAL;
    *chosen = found;
    return SSL_TLSEXT_ERR_OK;
}

void check_readable(const char* option, const std::filesystem::path& file) {
    if (!std::ifstream(file))
        throw OperatorError(fmt::format("{} {}: cannot be read; name a PEM file that this user may read",
                                        option, file.string()));
}

std::string text_of(const ASN1_TIME* time) {
    const std::unique_ptr<BIO, decltype(&BIO_free)> out(BIO_new(BIO_s_mem()), BIO_free);
    ASN1_TIME_print(out.get(), time);
    std::array<char, 64> text{};
    const int length = BIO_read(out.get(), text.data(), static_cast<int>(text.size()));
    return {text.data(), static_cast<size_t>(length > 0 ? length : 0)};
}

}  // namespace

TlsIdentity::TlsIdentity(std::filesystem::path certificate, std::filesystem::path key)
    : certificate_(std::move(certificate)), key_(std::move(key)), context_(load()) {}

void TlsIdentity::reload() { context_ = load(); }

std::shared_ptr<SSL_CTX> TlsIdentity::load() const {
    check_readable("--tls-cert", certificate_);
    check_readable("--tls-key", key_);
    ERR_clear_error();
    std::shared_ptr<SSL_CTX> context(SSL_CTX_new(TLS_server_method()), SSL_CTX_free);
    if (!context) throw OperatorError(fmt::format("TLS cannot be started: {}", last_reason()));
    SSL_CTX* const c = context.get();
    SSL_CTX_set_min_proto_version(c, TLS1_3_VERSION);
    SSL_CTX_set_default_passwd_cb(c, no_passphrase);
    if (SSL_CTX_set1_groups_list(c, cheap_groups) != 1)
        throw OperatorError(fmt::format("TLS cannot be started: {}", last_reason()));
    if (SSL_CTX_use_certificate_chain_file(c, certificate_.c_str()) != 1)
        throw OperatorError(
            fmt::format("--tls-cert {}: holds no certificate that can be used ({}); give a PEM file with the "
                        "server's certificate first and those that vouch for it after it",
                        certificate_.string(), last_reason()));
    if (SSL_CTX_use_PrivateKey_file(c, key_.c_str(), SSL_FILETYPE_PEM) != 1) {
        const bool other = ERR_GET_REASON(ERR_peek_last_error()) == X509_R_KEY_VALUES_MISMATCH;
        throw OperatorError(
            other
                ? fmt::format("--tls-key {}: does not belong to the certificate in {}; give the key that it "
                              "was made with",
                              key_.string(), certificate_.string())
                : fmt::format("--tls-key {}: holds no private key that can be used ({}); give a PEM file "
                              "without a passphrase",
                              key_.string(), last_reason()));
    }
    if (SSL_CTX_check_private_key(c) != 1)
        throw OperatorError(fmt::format("--tls-key {}: does not belong to the certificate in {}",
                                        key_.string(), certificate_.string()));
    // An idle connection owns no record buffers; what a stalled one owns stays small.
    SSL_CTX_set_mode(
        c, SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
    // One read takes one record: a peer that sends handshake records (KeyUpdate) without end would keep a read from ever coming back.
    SSL_CTX_clear_mode(c, SSL_MODE_AUTO_RETRY);
    SSL_CTX_set_options(c, SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
    SSL_CTX_set_num_tickets(c, 0);
    SSL_CTX_set_session_cache_mode(c, SSL_SESS_CACHE_OFF);
    SSL_CTX_set_alpn_select_cb(c, choose_protocol, nullptr);
    return context;
}

std::string TlsIdentity::text() const {
    const X509* certificate = SSL_CTX_get0_certificate(context());
    std::array<char, 256> name{};
    X509_NAME_oneline(X509_get_subject_name(certificate), name.data(), static_cast<int>(name.size()));
    return fmt::format("certificate of {} until {}", name.data(), text_of(X509_get0_notAfter(certificate)));
}

std::string TlsIdentity::warning() const {
    const X509* certificate = SSL_CTX_get0_certificate(context());
    const ASN1_TIME* const begin = X509_get0_notBefore(certificate);
    const ASN1_TIME* const end = X509_get0_notAfter(certificate);
    int days = 0;
    int seconds = 0;
    if (X509_cmp_current_time(begin) > 0)
        return fmt::format("the TLS certificate holds only from {} on: clients refuse it", text_of(begin));
    if (ASN1_TIME_diff(&days, &seconds, nullptr, end) != 1)
        return "the TLS certificate's end cannot be read: clients may refuse it";
    if (days < 0 || seconds < 0)
        return fmt::format("the TLS certificate has expired on {}: clients refuse it", text_of(end));
    if (days * 24 * 3600 + seconds < warn_before_seconds)
        return fmt::format("the TLS certificate ends on {}: renew it, then send SIGHUP", text_of(end));
    return {};
}

}  // namespace trochoid
