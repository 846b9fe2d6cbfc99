#include "tests/conformance/stream.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

namespace trochoid::conformance {

namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Tcp = asio::ip::tcp;

class TcpStream final : public Stream {
public:
    TcpStream(const Endpoint& server, Milliseconds within) {
        Tcp::resolver resolver(context_);
        error_code failed;
        const auto found = resolver.resolve(server.host, std::to_string(server.port), failed);
        if (failed) throw Failed{fmt::format("{}: no such host", server.host)};
        failed = asio::error::timed_out;
        asio::async_connect(socket_, found,
                            [&](const error_code& why, const Tcp::endpoint&) { failed = why; });
        run(within);
        if (failed) throw Failed{fmt::format("no connection to {} ({})", to_text(server), failed.message())};
        socket_.set_option(Tcp::no_delay(true), failed);
    }

    bool write(std::span<const uint8_t> bytes) override {
        if (state_ != State::open) return false;
        error_code failed = asio::error::timed_out;
        asio::async_write(socket_, asio::buffer(bytes.data(), bytes.size()),
                          [&](const error_code& why, size_t) { failed = why; });
        run(write_patience);
        return !failed;
    }

    size_t read(std::span<uint8_t> into, Milliseconds within) override {
        if (state_ != State::open) return 0;
        size_t count = 0;
        error_code failed = asio::error::operation_aborted;
        socket_.async_read_some(asio::buffer(into.data(), into.size()),
                                [&](const error_code& why, size_t bytes) {
                                    failed = why;
                                    count = bytes;
                                });
        run(within);
        if (failed == asio::error::eof)
            state_ = State::ended;
        else if (failed && failed != asio::error::operation_aborted)
            state_ = State::reset;
        return count;
    }

    State state() const override { return state_; }
    void finish() override {
        error_code ignored;
        socket_.shutdown(Tcp::socket::shutdown_send, ignored);
    }
    void abort() override {
        error_code ignored;
        socket_.set_option(asio::socket_base::linger(true, 0), ignored);
        socket_.close(ignored);
        state_ = State::reset;
    }

private:
    static constexpr Milliseconds write_patience{5000};

    /// Runs what was begun to its end, or takes it back after the deadline.
    void run(Milliseconds within) {
        context_.restart();
        context_.run_for(within);
        if (context_.stopped()) return;
        error_code ignored;
        socket_.cancel(ignored);
        context_.restart();
        context_.run();
    }

    asio::io_context context_{1};
    Tcp::socket socket_{context_};
    State state_ = State::open;
};

}  // namespace

std::unique_ptr<Stream> connect_tcp(const Endpoint& server, Milliseconds within) {
    return std::make_unique<TcpStream>(server, within);
}

}  // namespace trochoid::conformance
