#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <memory>

#include "server/net/transport.hpp"

namespace trochoid {

/// Takes over a connected socket: TCP_NODELAY, at most 16 KiB unsent where the system can limit it (TCP_NOTSENT_LOWAT),
/// non-blocking. A socket that is already broken gives nullptr.
std::unique_ptr<Transport> make_tcp_transport(boost::asio::ip::tcp::socket socket);

}  // namespace trochoid
