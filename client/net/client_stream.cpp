#include "client/net/client_stream.hpp"

#include "client/net/socket_stream.hpp"
#include "client/net/web_stream.hpp"

namespace trochoid {

std::shared_ptr<ClientStream> stream_to(NetLoop& loop, const Endpoint& endpoint) {
    switch (endpoint.transport) {
        case Transport::tcp: return make_tcp_stream(loop, endpoint);
        case Transport::tls: return make_tls_stream(loop, endpoint);
        case Transport::ws:
        case Transport::wss: break;
    }
    return make_web_stream(loop, endpoint);
}

}  // namespace trochoid
