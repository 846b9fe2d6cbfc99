#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace trochoid {

/// What a certificate shall say.
struct CertificateWish {
    std::vector<std::string> hosts{"localhost", "127.0.0.1"};  ///< names, and addresses as addresses
    int64_t begins_s = -3600;                                  ///< from now
    int64_t ends_s = 86400;
};

/// PEM texts that belong together.
struct CertificateAndKey {
    std::string certificate;
    std::string key;
};

/// An issuer of certificates (P-256), made anew each time: no key outlives a test.
class TestAuthority {
public:
    explicit TestAuthority(const std::string& name = "Trochoid test authority");
    /// Its own certificate, PEM: what a client is given to trust.
    const std::string& certificate() const { return own_.certificate; }
    CertificateAndKey issue(const CertificateWish& wish = {}) const;

private:
    CertificateAndKey own_;
};

/// A file with this text for as long as the object lives.
class PemFile {
public:
    explicit PemFile(const std::string& text);
    PemFile(const PemFile&) = delete;
    PemFile& operator=(const PemFile&) = delete;
    ~PemFile();
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

CertificateAndKey self_signed(const CertificateWish& wish = {});

}  // namespace trochoid
