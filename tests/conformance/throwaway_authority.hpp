#pragma once
#include <memory>
#include <string>

namespace trochoid::conformance {

/// Where the kit serves, as certificates have it.
inline constexpr const char* certified_host = "IP:127.0.0.1";

/// A server's certificate and its private key, PEM.
struct CertifiedKey {
    std::string certificate;
    std::string key;
};

/// An issuer of certificates (P-256, good for a day), made anew each time: no key outlives the program. OperatorError where OpenSSL
/// cannot make one.
class ThrowawayAuthority {
public:
    ThrowawayAuthority();
    ThrowawayAuthority(const ThrowawayAuthority&) = delete;
    ThrowawayAuthority& operator=(const ThrowawayAuthority&) = delete;
    ~ThrowawayAuthority();

    /// Made out to a name ("DNS:sea.example") or an address ("IP:127.0.0.1").
    CertifiedKey certify(const std::string& subject) const;
    /// PEM, for those who shall believe it; gone with this object. OperatorError where it cannot be written.
    const std::string& file() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid::conformance
