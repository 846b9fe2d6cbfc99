#include "tests/support/net/raw_client.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
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

struct RawClient::Impl {
    asio::io_context context;
    Tcp::socket socket{context};
    FrameReader frames{FrameReader::Opening::frames, 1U << 20};
    std::vector<uint8_t> buffer = std::vector<uint8_t>(65536);
    std::vector<uint8_t> arrived;
    bool closed = false;
    uint64_t bytes_received = 0;
};

RawClient::RawClient(uint16_t port, int receive_buffer, const std::string& address)
    : impl_(std::make_unique<Impl>()) {
    const Tcp::endpoint server(asio::ip::make_address(address), port);
    impl_->socket.open(server.protocol());
    if (receive_buffer > 0) impl_->socket.set_option(asio::socket_base::receive_buffer_size(receive_buffer));
    impl_->socket.connect(server);
    impl_->socket.set_option(Tcp::no_delay(true));
}

RawClient::~RawClient() = default;

bool RawClient::send_bytes(std::span<const uint8_t> bytes) {
    error_code failed;
    asio::write(impl_->socket, asio::buffer(bytes.data(), bytes.size()), failed);
    return !failed;
}

bool RawClient::send_magic() { return send_bytes(stream_magic); }

bool RawClient::send(const ClientMessage& message) { return send_bytes(frame(encode(message))); }

ClientHello RawClient::usual_hello() {
    ClientHello hello;
    hello.protocol_min = protocol_version_min;
    hello.protocol_max = protocol_version_max;
    hello.model = model_version;
    hello.software = "raw client";
    hello.view.altitude = 20 * 1024;
    return hello;
}

std::optional<ServerHello> RawClient::log_in(const ClientHello& hello) {
    if (!send_magic() || !send(hello)) return std::nullopt;
    auto first = receive();
    if (!first || !std::holds_alternative<ServerHello>(*first)) return std::nullopt;
    return std::get<ServerHello>(std::move(*first));
}

RawClient::Milliseconds RawClient::left(std::chrono::steady_clock::time_point until) {
    const auto now = std::chrono::steady_clock::now();
    return now >= until ? Milliseconds(0) : std::chrono::duration_cast<Milliseconds>(until - now);
}

bool RawClient::read_more(Milliseconds within) {
    if (impl_->closed) return false;
    bool done = false;
    impl_->socket.async_read_some(asio::buffer(impl_->buffer), [&](const error_code& failed, size_t bytes) {
        if (failed == asio::error::operation_aborted) return;
        done = true;
        impl_->closed = bool(failed);
        impl_->bytes_received += bytes;
        impl_->arrived.insert(impl_->arrived.end(), impl_->buffer.begin(),
                              impl_->buffer.begin() + static_cast<std::ptrdiff_t>(bytes));
    });
    impl_->context.restart();
    impl_->context.run_for(within);
    if (!done) {
        impl_->socket.cancel();
        impl_->context.restart();
        impl_->context.run();
    }
    return done && !impl_->closed;
}

std::optional<ServerMessage> RawClient::receive(Milliseconds within) {
    const auto until = std::chrono::steady_clock::now() + within;
    while (true) {
        std::span<const uint8_t> input(impl_->arrived);
        const auto payload = impl_->frames.next(input);
        impl_->arrived.erase(impl_->arrived.begin(),
                             impl_->arrived.end() - static_cast<std::ptrdiff_t>(input.size()));
        TROCHOID_ASSERT(payload.has_value(), "the server's stream is broken");
        if (payload->has_value()) {
            Result<ServerMessage> message = decode_server(**payload);
            TROCHOID_ASSERT(message.has_value(), "the server sent: {}", message.error().message);
            if (const auto* delta = std::get_if<Delta>(&*message)) {
                if (delta->piece == 0 && delta->base == 0) state_ = {};
                apply(state_, delta->change);
            }
            return std::move(*message);
        }
        if (!read_more(left(until))) return std::nullopt;
    }
}

std::optional<Delta> RawClient::next_result(Milliseconds within) {
    const auto until = std::chrono::steady_clock::now() + within;
    while (auto piece = wait_for<Delta>(left(until)))
        if (piece->last) return piece;
    return std::nullopt;
}

bool RawClient::acknowledge(const Delta& result, std::optional<uint64_t> known_answer) {
    return send(Ack{result.result, hash_of(state_), 0, known_answer});
}

std::optional<Delta> RawClient::enter() {
    if (!log_in()) return std::nullopt;
    auto first = next_result();
    if (first && !acknowledge(*first)) return std::nullopt;
    return first;
}

bool RawClient::closed() const { return impl_->closed; }

bool RawClient::ends(Milliseconds within) {
    const auto until = std::chrono::steady_clock::now() + within;
    while (read_more(left(until))) impl_->arrived.clear();
    return impl_->closed;
}

uint64_t RawClient::bytes_received() const { return impl_->bytes_received; }

void RawClient::disconnect() {
    error_code ignored;
    impl_->socket.close(ignored);
    impl_->closed = true;
}

}  // namespace trochoid
