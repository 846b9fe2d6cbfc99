#include "tests/conformance/throwaway_authority.hpp"

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "protocol/units/operator_error.hpp"

namespace trochoid::conformance {

namespace {

template <class T, void (*release)(T*)>
struct Release {
    void operator()(T* thing) const { release(thing); }
};
using Key = std::unique_ptr<EVP_PKEY, Release<EVP_PKEY, EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Release<X509, X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Release<X509_EXTENSION, X509_EXTENSION_free>>;
using Memory = std::unique_ptr<BIO, Release<BIO, BIO_free_all>>;

void require(bool holds, const char* what) {
    if (!holds) throw OperatorError(fmt::format("OpenSSL makes no certificate for the kit: {}", what));
}

Key new_key() {
    Key key(EVP_EC_gen("P-256"));
    require(key != nullptr, "no key on P-256");
    return key;
}

void extend(X509* certificate, X509* issuer, int kind, const char* value) {
    X509V3_CTX context;
    X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
    const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value));
    require(extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1, value);
}

/// Not signed yet.
Certificate blank(EVP_PKEY* key, const char* name, const X509_NAME* issuer) {
    constexpr long hour_s = 3600;
    constexpr long day_s = 24 * hour_s;
    Certificate made(X509_new());
    X509_set_version(made.get(), X509_VERSION_3);
    uint32_t serial = 0;
    RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial);
    ASN1_INTEGER_set_uint64(X509_get_serialNumber(made.get()), uint64_t{serial} + 1);
    X509_gmtime_adj(X509_getm_notBefore(made.get()), -hour_s);
    X509_gmtime_adj(X509_getm_notAfter(made.get()), day_s);
    X509_NAME_add_entry_by_txt(X509_get_subject_name(made.get()), "CN", MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(name), -1, -1, 0);
    X509_set_issuer_name(made.get(), issuer == nullptr ? X509_get_subject_name(made.get()) : issuer);
    X509_set_pubkey(made.get(), key);
    return made;
}

template <class Write>
std::string pem_of(Write write) {
    const Memory out(BIO_new(BIO_s_mem()));
    require(write(out.get()) == 1, "no PEM");
    char* text = nullptr;
    const long length = BIO_get_mem_data(out.get(), &text);
    return {text, static_cast<size_t>(length)};
}
std::string pem_of(X509* certificate) {
    return pem_of([&](BIO* out) { return PEM_write_bio_X509(out, certificate); });
}

std::string write_where_nobody_else_does(const std::string& text) {
    uint64_t number = 0;
    RAND_bytes(reinterpret_cast<unsigned char*>(&number), sizeof number);
    std::string path =
        (std::filesystem::temp_directory_path() / fmt::format("trochoid-conformance-{:016x}.pem", number))
            .string();
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw OperatorError(fmt::format("cannot write {}: check TMPDIR", path));
    return path;
}

}  // namespace

struct ThrowawayAuthority::Impl {
    Key key = new_key();
    Certificate own = blank(key.get(), "trochoid-conformance", nullptr);
    std::string path;
};

ThrowawayAuthority::ThrowawayAuthority() : impl_(std::make_unique<Impl>()) {
    extend(impl_->own.get(), impl_->own.get(), NID_basic_constraints, "critical,CA:TRUE");
    extend(impl_->own.get(), impl_->own.get(), NID_key_usage, "critical,keyCertSign");
    extend(impl_->own.get(), impl_->own.get(), NID_subject_key_identifier, "hash");
    require(X509_sign(impl_->own.get(), impl_->key.get(), EVP_sha256()) > 0, "no signature");
    impl_->path = write_where_nobody_else_does(pem_of(impl_->own.get()));
}

ThrowawayAuthority::~ThrowawayAuthority() {
    std::error_code ignored;
    std::filesystem::remove(impl_->path, ignored);
}

CertifiedKey ThrowawayAuthority::certify(const std::string& subject) const {
    const Key key = new_key();
    const Certificate made =
        blank(key.get(), "a server of the kit's", X509_get_subject_name(impl_->own.get()));
    X509* const issuer = impl_->own.get();
    extend(made.get(), issuer, NID_basic_constraints, "critical,CA:FALSE");
    extend(made.get(), issuer, NID_ext_key_usage, "serverAuth");
    extend(made.get(), issuer, NID_authority_key_identifier, "keyid");
    extend(made.get(), issuer, NID_subject_alt_name, subject.c_str());
    require(X509_sign(made.get(), impl_->key.get(), EVP_sha256()) > 0, "no signature");
    return {pem_of(made.get()), pem_of([&](BIO* out) {
                return PEM_write_bio_PrivateKey(out, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
            })};
}

const std::string& ThrowawayAuthority::file() const { return impl_->path; }

}  // namespace trochoid::conformance
