#include "tests/support/net/byte_peer.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

namespace trochoid {

namespace {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using Failed = boost::system::error_code;

}  // namespace

struct BytePeer::Impl {
    asio::io_context context;
    Tcp::acceptor acceptor{context};
    Tcp::socket socket{context};
    Stream stream = Stream::open;
};

BytePeer::BytePeer() : impl_(std::make_unique<Impl>()) {
    const Tcp::endpoint here(asio::ip::address_v4::loopback(), 0);
    impl_->acceptor.open(here.protocol());
    impl_->acceptor.bind(here);
    impl_->acceptor.listen();
}

BytePeer::BytePeer(uint16_t port) : impl_(std::make_unique<Impl>()) {
    impl_->socket.connect({asio::ip::address_v4::loopback(), port});
    impl_->socket.set_option(Tcp::no_delay(true));
}

BytePeer::~BytePeer() = default;

uint16_t BytePeer::port() const { return impl_->acceptor.local_endpoint().port(); }

bool BytePeer::accept(Milliseconds within) {
    bool done = false;
    impl_->stream = Stream::open;
    impl_->socket = Tcp::socket(impl_->context);
    impl_->acceptor.async_accept(impl_->socket, [&](const Failed& failed) { done = !failed; });
    impl_->context.restart();
    impl_->context.run_for(within);
    if (!done) impl_->acceptor.cancel();
    impl_->context.restart();
    impl_->context.run();
    if (done) impl_->socket.set_option(Tcp::no_delay(true));
    return done;
}

bool BytePeer::send(std::span<const uint8_t> bytes) {
    Failed failed;
    asio::write(impl_->socket, asio::buffer(bytes.data(), bytes.size()), failed);
    return !failed;
}

std::vector<uint8_t> BytePeer::receive(size_t count, Milliseconds within) {
    const auto until = std::chrono::steady_clock::now() + within;
    std::vector<uint8_t> bytes(count);
    size_t have = 0;
    while (have < count && impl_->stream == Stream::open) {
        const auto left = until - std::chrono::steady_clock::now();
        if (left <= left.zero()) break;
        impl_->socket.async_read_some(
            asio::buffer(bytes.data() + have, count - have), [&](const Failed& failed, size_t got) {
                have += got;
                if (failed && failed != asio::error::operation_aborted)
                    impl_->stream = failed == asio::error::eof ? Stream::finished : Stream::reset;
            });
        impl_->context.restart();
        impl_->context.run_for(left);
        if (!impl_->context.stopped()) impl_->socket.cancel();
        impl_->context.restart();
        impl_->context.run();
    }
    bytes.resize(have);
    return bytes;
}

BytePeer::Stream BytePeer::stream() const { return impl_->stream; }

void BytePeer::finish() {
    Failed ignored;
    impl_->socket.shutdown(Tcp::socket::shutdown_send, ignored);
}

void BytePeer::hang_up() {
    Failed ignored;
    impl_->socket.close(ignored);
}

}  // namespace trochoid
