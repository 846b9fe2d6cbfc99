#include "tests/support/net/test_certificate.hpp"

#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <random>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

template <class T, void (*release)(T*)>
struct Release {
    void operator()(T* thing) const { release(thing); }
};
using Key = std::unique_ptr<EVP_PKEY, Release<EVP_PKEY, EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Release<X509, X509_free>>;
using Memory = std::unique_ptr<BIO, Release<BIO, BIO_free_all>>;

Memory memory_of(const std::string& text) {
    return Memory(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

template <class Write>
std::string pem_of(Write write) {
    const Memory out(BIO_new(BIO_s_mem()));
    TROCHOID_ASSERT(write(out.get()) == 1, "OpenSSL could not write PEM");
    char* text = nullptr;
    const long length = BIO_get_mem_data(out.get(), &text);
    return {text, static_cast<size_t>(length)};
}

void extend(X509* certificate, int kind, const std::string& value) {
    X509V3_CTX context;
    X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
    const std::unique_ptr<X509_EXTENSION, Release<X509_EXTENSION, X509_EXTENSION_free>> extension(
        X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
    TROCHOID_ASSERT(extension, "OpenSSL takes no extension '{}'", value);
    X509_add_ext(certificate, extension.get(), -1);
}

/// "DNS:localhost,IP:127.0.0.1"
std::string alternative_names(const std::vector<std::string>& hosts) {
    std::string all;
    for (const std::string& host : hosts) {
        const bool address =
            host.find_first_not_of("0123456789.") == std::string::npos || host.find(':') != std::string::npos;
        if (!all.empty()) all += ',';
        all += (address ? "IP:" : "DNS:") + host;
    }
    return all;
}

Certificate blank(EVP_PKEY* key, const std::string& subject, const CertificateWish& wish) {
    static long serial = 1;
    Certificate made(X509_new());
    X509_set_version(made.get(), X509_VERSION_3);
    ASN1_INTEGER_set(X509_get_serialNumber(made.get()), ++serial);
    X509_gmtime_adj(X509_getm_notBefore(made.get()), wish.begins_s);
    X509_gmtime_adj(X509_getm_notAfter(made.get()), wish.ends_s);
    X509_NAME_add_entry_by_txt(X509_get_subject_name(made.get()), "CN", MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(subject.c_str()), -1, -1, 0);
    X509_set_pubkey(made.get(), key);
    return made;
}

CertificateAndKey signed_by(X509* issuer, EVP_PKEY* issuers_key, Certificate made, const Key& key) {
    X509_set_issuer_name(made.get(), X509_get_subject_name(issuer == nullptr ? made.get() : issuer));
    TROCHOID_ASSERT(X509_sign(made.get(), issuer == nullptr ? key.get() : issuers_key, EVP_sha256()) > 0,
                    "OpenSSL could not sign");
    return {pem_of([&](BIO* out) { return PEM_write_bio_X509(out, made.get()); }), pem_of([&](BIO* out) {
                return PEM_write_bio_PrivateKey(out, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
            })};
}

Key new_key() { return Key(EVP_EC_gen("P-256")); }

Certificate server_certificate(EVP_PKEY* key, const CertificateWish& wish) {
    Certificate made = blank(key, "Trochoid test server", wish);
    extend(made.get(), NID_basic_constraints, "critical,CA:FALSE");
    extend(made.get(), NID_ext_key_usage, "serverAuth");
    if (!wish.hosts.empty()) extend(made.get(), NID_subject_alt_name, alternative_names(wish.hosts));
    return made;
}

}  // namespace

TestAuthority::TestAuthority(const std::string& name) {
    const Key key = new_key();
    Certificate made = blank(key.get(), name, {});
    extend(made.get(), NID_basic_constraints, "critical,CA:TRUE");
    extend(made.get(), NID_key_usage, "critical,keyCertSign");
    own_ = signed_by(nullptr, nullptr, std::move(made), key);
}

CertificateAndKey TestAuthority::issue(const CertificateWish& wish) const {
    const Memory certificate = memory_of(own_.certificate);
    const Memory secret = memory_of(own_.key);
    const Certificate issuer(PEM_read_bio_X509(certificate.get(), nullptr, nullptr, nullptr));
    const Key issuers_key(PEM_read_bio_PrivateKey(secret.get(), nullptr, nullptr, nullptr));
    const Key key = new_key();
    return signed_by(issuer.get(), issuers_key.get(), server_certificate(key.get(), wish), key);
}

PemFile::PemFile(const std::string& text)
    : path_((std::filesystem::temp_directory_path() /
             ("trochoid-test-" + std::to_string(std::random_device()()) + ".pem"))
                .string()) {
    std::ofstream(path_, std::ios::binary) << text;
}

PemFile::~PemFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
}

CertificateAndKey self_signed(const CertificateWish& wish) {
    const Key key = new_key();
    return signed_by(nullptr, nullptr, server_certificate(key.get(), wish), key);
}

}  // namespace trochoid
