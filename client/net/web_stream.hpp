#pragma once
#include "client/net/client_stream.hpp"

namespace trochoid {

/// A WebSocket with the subprotocol "trochoid", without compression; inside TLS where the endpoint says wss (verified like a
/// TLS stream). One binary message is one message of the protocol; text ones are malformed_frame.
std::shared_ptr<ClientStream> make_web_stream(NetLoop& loop, const Endpoint& endpoint);

}  // namespace trochoid
