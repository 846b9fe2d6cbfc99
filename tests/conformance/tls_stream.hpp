#pragma once
#include <memory>
#include <string>
#include <vector>

#include "tests/conformance/stream.hpp"
#include "tests/conformance/throwaway_authority.hpp"
#include "tests/conformance/tls_hello.hpp"

namespace trochoid::conformance {

/// What our side of a TLS handshake offers, and whom it believes.
struct TlsOffer {
    std::string host;                                ///< whom the certificate has to be made out to
    std::string ca_file;                             ///< PEM, whom to trust; empty: the system's
    std::vector<std::string> protocols{"trochoid"};  ///< by ALPN; empty: none
    bool at_most_1_2 = false;
};

/// What the handshake agreed on.
struct TlsAgreement {
    std::string version;       ///< "TLSv1.3"
    std::string protocol;      ///< by ALPN; empty: none
    uint32_t early_bytes = 0;  ///< early data that the server's tickets, as far as they have come, allow
};

/// TLS over any stream of bytes. `ended`: by close_notify; a stream that just stops counts as reset.
class TlsStream : public Stream {
public:
    virtual TlsAgreement agreement() const = 0;
};
/// Shakes hands as a client. Failed, with the reason, where that comes to nothing.
std::unique_ptr<TlsStream> begin_tls(std::unique_ptr<Stream> inner, const TlsOffer& offer,
                                     Milliseconds within);

/// What our side of a TLS handshake answers a client. As it is here, what a server may.
struct TlsAnswer {
    CertifiedKey identity;
    bool at_most_1_2 = false;
    bool names_no_protocol = false;  ///< by ALPN, whatever is offered
    std::string groups;              ///< that keys may be agreed with, "X25519:P-256"; empty: any
};

/// TLS as a server. One for many connections: what it gives away for a quick return (tickets, which allow early data) is good at it alone.
class TlsGate {
public:
    /// OperatorError where OpenSSL cannot do that.
    explicit TlsGate(const TlsAnswer& answer);
    TlsGate(const TlsGate&) = delete;
    TlsGate& operator=(const TlsGate&) = delete;
    ~TlsGate();

    /// Judges the client's first record, then shakes hands. Failed, with the reason, where that comes to nothing; it begins with
    /// `no_handshake` where the first record was right. `hello`: where to put what that said.
    std::unique_ptr<TlsStream> accept(std::unique_ptr<Stream> inner, Milliseconds within,
                                      TlsHello* hello = nullptr) const;

    static constexpr std::string_view no_handshake = "R-106: no TLS handshake";

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid::conformance
