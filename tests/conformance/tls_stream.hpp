#pragma once
#include <memory>
#include <string>
#include <vector>

#include "tests/conformance/stream.hpp"

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

/// TLS as a client over any stream of bytes. `ended`: by close_notify; a stream that just stops counts as reset.
class TlsStream : public Stream {
public:
    virtual TlsAgreement agreement() const = 0;
};
/// Shakes hands. Failed, with the reason, where that comes to nothing.
std::unique_ptr<TlsStream> begin_tls(std::unique_ptr<Stream> inner, const TlsOffer& offer,
                                     Milliseconds within);

}  // namespace trochoid::conformance
