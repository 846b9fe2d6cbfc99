#include "client/net/tcp_dial.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ssl/error.hpp>
#include <utility>

#include "client/net/net_loop_asio.hpp"

namespace trochoid {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorOfSystem = boost::system::error_code;

namespace {

Error no_such_host(const Endpoint& endpoint, const ErrorOfSystem& error) {
    return {ErrorCode::none,
            fmt::format("there is no host '{}' ({}): check --connect", endpoint.host, error.message())};
}

Error not_connected(const Endpoint& endpoint, const ErrorOfSystem& error) {
    if (error == asio::error::connection_refused)
        return {ErrorCode::none,
                fmt::format("nothing listens at {}: start trochoid-server or check --connect",
                            to_text(endpoint))};
    return {ErrorCode::none,
            fmt::format("cannot connect to {} ({}): check --connect", to_text(endpoint), error.message())};
}

}  // namespace

TcpDial::TcpDial(NetLoop& loop) : resolver_(loop.impl().io) {}

void TcpDial::give_up() {
    given_up_ = true;
    resolver_.cancel();
}

void TcpDial::connect(tcp::socket& socket, const Endpoint& endpoint, ClientStream::Dialled done) {
    resolver_.async_resolve(endpoint.host, std::to_string(endpoint.port), tcp::resolver::numeric_service,
                            [this, &socket, endpoint, done = std::move(done)](
                                const ErrorOfSystem& error, const tcp::resolver::results_type& found) {
                                if (given_up_) return;
                                if (error) return done(no_such_host(endpoint, error));
                                asio::async_connect(socket, found,
                                                    [this, &socket, endpoint, done](
                                                        const ErrorOfSystem& failed, const tcp::endpoint&) {
                                                        if (given_up_) return;
                                                        if (failed)
                                                            return done(not_connected(endpoint, failed));
                                                        ErrorOfSystem ignored;
                                                        socket.set_option(tcp::no_delay(true), ignored);
                                                        done(Done{});
                                                    });
                            });
}

bool is_end_of_stream(const ErrorOfSystem& error) {
    return error == asio::error::eof || error == asio::ssl::error::stream_truncated;
}

Error end_of_connection(const ErrorOfSystem& error, const Endpoint& endpoint) {
    if (is_end_of_stream(error))
        return {ErrorCode::none,
                fmt::format("the server at {} closed the connection without a word", to_text(endpoint))};
    return {ErrorCode::none,
            fmt::format("the connection to {} broke ({})", to_text(endpoint), error.message())};
}

}  // namespace trochoid
