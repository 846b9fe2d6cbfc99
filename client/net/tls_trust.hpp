#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <string>

#include "client/net/endpoint.hpp"
#include "protocol/units/result.hpp"

// For this folder's sources only.
namespace trochoid {

/// What a TLS client wants of its peer: TLS 1.3, a certificate that leads to one we trust, and that it is made out to the host
/// we asked for. Says in words what was not so. Outlives the stream that it prepares.
class TlsTrust {
public:
    using Stream = boost::asio::ssl::stream<boost::asio::ip::tcp::socket>;

    explicit TlsTrust(const Endpoint& endpoint);
    TlsTrust(const TlsTrust&) = delete;
    TlsTrust& operator=(const TlsTrust&) = delete;

    boost::asio::ssl::context& context() { return context_; }
    /// Before the handshake. `protocol`: the name offered by ALPN. Fails where the trusted certificates cannot be read.
    Result<Done> prepare(Stream& stream, const char* protocol);
    /// What went wrong in the handshake.
    Error failure(const boost::system::error_code& error) const;

private:
    bool judge(bool fine, boost::asio::ssl::verify_context& chain);
    std::string untrusted() const;

    Endpoint endpoint_;
    boost::asio::ssl::context context_;
    std::string no_trust_;     // why the trusted certificates could not be read
    int verdict_ = 0;          // X509_V_OK, or OpenSSL's first objection to the peer's certificate
    std::string made_out_to_;  // the names in the peer's certificate
};

}  // namespace trochoid
