#include "server/net/tcp_transport.hpp"

#include <fmt/format.h>

#include <boost/asio/buffer.hpp>
#include <utility>

namespace trochoid {

namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Tcp = asio::ip::tcp;

constexpr int most_unsent_bytes = 16 * 1024;

void limit_unsent(Tcp::socket& socket) {
#ifdef TCP_NOTSENT_LOWAT
    using NotSentLowWater = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_NOTSENT_LOWAT>;
    error_code ignored;  // a kernel without it only buffers more
    socket.set_option(NotSentLowWater(most_unsent_bytes), ignored);
#else
    error_code ignored;
    socket.set_option(asio::socket_base::send_buffer_size(most_unsent_bytes), ignored);
#endif
}

std::string text_of(const Tcp::endpoint& endpoint) {
    const std::string address = endpoint.address().to_string();
    return endpoint.address().is_v6() ? fmt::format("[{}]:{}", address, endpoint.port())
                                      : fmt::format("{}:{}", address, endpoint.port());
}

class TcpTransport final : public Transport {
public:
    TcpTransport(Tcp::socket socket, std::string peer) : socket_(std::move(socket)), peer_(std::move(peer)) {}

    const std::string& peer() const override { return peer_; }

    void when_readable(std::function<void()> ready) override {
        wait(Tcp::socket::wait_read, std::move(ready));
    }
    void when_writable(std::function<void()> ready) override {
        wait(Tcp::socket::wait_write, std::move(ready));
    }

    Moved read(std::span<uint8_t> into) override {
        error_code failed;
        const size_t bytes = socket_.read_some(asio::buffer(into.data(), into.size()), failed);
        return moved(bytes, failed);
    }
    Moved write(std::span<const uint8_t> bytes) override {
        error_code failed;
        const size_t taken = socket_.write_some(asio::buffer(bytes.data(), bytes.size()), failed);
        return moved(taken, failed);
    }
    void finish(ErrorCode) override {
        error_code ignored;
        socket_.shutdown(Tcp::socket::shutdown_send, ignored);
    }
    void close() override {
        error_code ignored;
        socket_.close(ignored);
    }

private:
    static Moved moved(size_t bytes, const error_code& failed) {
        if (!failed) return {bytes, false};
        return {0, failed != asio::error::would_block && failed != asio::error::try_again};
    }
    void wait(Tcp::socket::wait_type what, std::function<void()> ready) {
        // An error means either that we closed, or one that the next read or write reports itself.
        socket_.async_wait(what, [ready = std::move(ready)](const error_code& failed) {
            if (failed != asio::error::operation_aborted) ready();
        });
    }

    Tcp::socket socket_;
    std::string peer_;
};

}  // namespace

std::unique_ptr<Transport> make_tcp_transport(Tcp::socket socket) {
    error_code failed;
    const Tcp::endpoint remote = socket.remote_endpoint(failed);
    if (!failed) socket.set_option(Tcp::no_delay(true), failed);
    if (!failed) socket.non_blocking(true, failed);
    if (failed) return nullptr;
    limit_unsent(socket);
    return std::make_unique<TcpTransport>(std::move(socket), text_of(remote));
}

}  // namespace trochoid
