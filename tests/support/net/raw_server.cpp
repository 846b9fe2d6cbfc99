#include "tests/support/net/raw_server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <functional>
#include <utility>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/frame.hpp"

namespace trochoid {

namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Tcp = asio::ip::tcp;

}  // namespace

struct RawServer::Impl {
    asio::io_context context;
    Tcp::acceptor acceptor{context, {asio::ip::address_v4::loopback(), 0}};
    Tcp::socket socket{context};
    uint16_t port = acceptor.local_endpoint().port();
    std::optional<FrameReader> frames;
    std::vector<uint8_t> buffer = std::vector<uint8_t>(65536);
    std::vector<uint8_t> arrived;
    bool closed = true;

    /// Runs what has been started until it is done or time is up.
    void run(Milliseconds within, const bool& done, const std::function<void()>& cancel) {
        context.restart();
        context.run_for(within);
        if (done) return;
        cancel();
        context.restart();
        context.run();
    }
};

RawServer::RawServer() : impl_(std::make_unique<Impl>()) {}
RawServer::~RawServer() = default;

uint16_t RawServer::port() const { return impl_->port; }

bool RawServer::accept(Milliseconds within) {
    Impl& my = *impl_;
    hang_up();
    bool done = false;
    my.acceptor.async_accept(my.socket, [&](const error_code& failed) {
        if (failed == asio::error::operation_aborted) return;
        done = true;
        my.closed = bool(failed);
    });
    my.run(within, done, [&my] { my.acceptor.cancel(); });
    if (my.closed) return false;
    my.socket.set_option(Tcp::no_delay(true));
    my.frames.emplace(FrameReader::Opening::magic, 1U << 20);
    my.arrived.clear();
    return true;
}

std::optional<ClientHello> RawServer::log_in(const ServerHello& hello) {
    if (!accept()) return std::nullopt;
    const auto first = receive();
    if (!first || !std::holds_alternative<ClientHello>(*first)) return std::nullopt;
    const auto& theirs = std::get<ClientHello>(*first);
    ServerHello ours = hello;
    ours.client_stamp_us = theirs.clock_stamp_us;
    if (!send(ours)) return std::nullopt;
    return theirs;
}

ServerHello RawServer::usual_hello() {
    ServerHello hello;
    hello.protocol = protocol_version_max;
    hello.model = model_version;
    hello.software = "raw server";
    hello.session = 1;
    hello.world = "test";
    hello.instance.bytes[0] = 7;
    hello.challenge_seed = 11;
    hello.challenge_count = 64;
    return hello;
}

bool RawServer::send_bytes(std::span<const uint8_t> bytes) {
    error_code failed;
    asio::write(impl_->socket, asio::buffer(bytes.data(), bytes.size()), failed);
    return !failed;
}

bool RawServer::send(const ServerMessage& message) { return send_bytes(frame(encode(message))); }

RawServer::Milliseconds RawServer::left(std::chrono::steady_clock::time_point until) {
    const auto now = std::chrono::steady_clock::now();
    return now >= until ? Milliseconds(0) : std::chrono::duration_cast<Milliseconds>(until - now);
}

bool RawServer::read_more(Milliseconds within) {
    Impl& my = *impl_;
    if (my.closed) return false;
    bool done = false;
    my.socket.async_read_some(asio::buffer(my.buffer), [&](const error_code& failed, size_t bytes) {
        if (failed == asio::error::operation_aborted) return;
        done = true;
        my.closed = bool(failed);
        my.arrived.insert(my.arrived.end(), my.buffer.begin(),
                          my.buffer.begin() + static_cast<std::ptrdiff_t>(bytes));
    });
    my.run(within, done, [&my] { my.socket.cancel(); });
    return done && !my.closed;
}

std::optional<ClientMessage> RawServer::receive(Milliseconds within) {
    Impl& my = *impl_;
    const auto until = std::chrono::steady_clock::now() + within;
    while (my.frames) {
        std::span<const uint8_t> input(my.arrived);
        const auto payload = my.frames->next(input);
        my.arrived.erase(my.arrived.begin(), my.arrived.end() - static_cast<std::ptrdiff_t>(input.size()));
        TROCHOID_ASSERT(payload.has_value(), "the client's stream is broken: {}", payload.error().message);
        if (payload->has_value()) {
            Result<ClientMessage> message = decode_client(**payload);
            TROCHOID_ASSERT(message.has_value(), "the client sent: {}", message.error().message);
            return std::move(*message);
        }
        if (!read_more(left(until))) return std::nullopt;
    }
    return std::nullopt;
}

bool RawServer::ends(Milliseconds within) {
    const auto until = std::chrono::steady_clock::now() + within;
    while (read_more(left(until))) impl_->arrived.clear();
    return impl_->closed;
}

void RawServer::hang_up() {
    error_code ignored;
    impl_->socket.close(ignored);
    impl_->closed = true;
}

void RawServer::stop_listening() {
    error_code ignored;
    impl_->acceptor.close(ignored);
}

}  // namespace trochoid
