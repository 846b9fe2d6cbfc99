#pragma once
#include "client/net/client_stream.hpp"

namespace trochoid {

std::shared_ptr<ClientStream> make_tcp_stream(NetLoop& loop, const Endpoint& endpoint);
/// TLS 1.3 with the server's certificate and name verified, SNI, and ALPN "trochoid".
std::shared_ptr<ClientStream> make_tls_stream(NetLoop& loop, const Endpoint& endpoint);

}  // namespace trochoid
