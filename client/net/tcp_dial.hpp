#pragma once
#include <boost/asio/ip/tcp.hpp>

#include "client/net/client_stream.hpp"

// For this folder's sources only.
namespace trochoid {

/// Finds an endpoint's host and connects a socket to it, with TCP_NODELAY.
class TcpDial {
public:
    explicit TcpDial(NetLoop& loop);
    TcpDial(const TcpDial&) = delete;
    TcpDial& operator=(const TcpDial&) = delete;
    /// Whoever owns this and the socket lives as long as `done` does.
    void connect(boost::asio::ip::tcp::socket& socket, const Endpoint& endpoint, ClientStream::Dialled done);
    /// `done` is not called any more. The socket is closed by its owner.
    void give_up();

private:
    boost::asio::ip::tcp::resolver resolver_;
    bool given_up_ = false;
};

/// Whether the peer has ended its side, properly or not.
bool is_end_of_stream(const boost::system::error_code& error);
/// Why a connection that stood has ended.
Error end_of_connection(const boost::system::error_code& error, const Endpoint& endpoint);

}  // namespace trochoid
