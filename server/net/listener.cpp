#include "server/net/listener.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "protocol/units/operator_error.hpp"
#include "server/net/io_loop_asio.hpp"
#include "server/net/tcp_transport.hpp"

namespace trochoid {

namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Tcp = asio::ip::tcp;

asio::ip::address address_of(const std::string& text, bool off_loopback) {
    error_code failed;
    asio::ip::address address = text == "localhost" ? asio::ip::address(asio::ip::address_v4::loopback())
                                                    : asio::ip::make_address(text, failed);
    if (failed)
        throw OperatorError(
            fmt::format("--bind {}: give a numeric address, as in 127.0.0.1, ::1, or 0.0.0.0 for all", text));
    if (!address.is_loopback() && !off_loopback)
        throw OperatorError(fmt::format(
            "--bind {}: other machines need TLS: give --tls-cert and --tls-key, or --allow-plaintext on a "
            "network where everybody may read along; leave --bind out for this machine only",
            text));
    return address;
}

// Why an address could not be bound; empty: it was.
error_code open(Tcp::acceptor& acceptor, const Tcp::endpoint& endpoint) {
    error_code failed;
    acceptor.open(endpoint.protocol(), failed);
    if (!failed && endpoint.address().is_v6()) acceptor.set_option(asio::ip::v6_only(true), failed);
    if (!failed) acceptor.set_option(Tcp::acceptor::reuse_address(true), failed);
    if (!failed) acceptor.bind(endpoint, failed);
    if (!failed) acceptor.listen(asio::socket_base::max_listen_connections, failed);
    if (failed) {
        error_code ignored;
        acceptor.close(ignored);
    }
    return failed;
}

// The machine has no such address (no IPv6), which is nobody's mistake.
bool not_on_this_machine(const error_code& failed) {
    return failed == asio::error::address_family_not_supported || failed.value() == EADDRNOTAVAIL;
}

}  // namespace

struct Listener::Impl : std::enable_shared_from_this<Impl> {
    struct Door {
        Tcp::acceptor acceptor;
        asio::steady_timer pause;
    };
    Impl(IoLoop& on, Accepted callback) : loop(on), accepted(std::move(callback)) {}

    bool bind_all(const std::vector<asio::ip::address>& addresses, uint16_t wanted, bool last_try);
    void accept(size_t index);

    IoLoop& loop;
    Accepted accepted;
    std::vector<Door> doors;
    uint16_t port = 0;
};

// False: the free port that the first address got is taken on another; worth another try.
bool Listener::Impl::bind_all(const std::vector<asio::ip::address>& addresses, uint16_t wanted,
                              bool last_try) {
    doors.clear();
    port = wanted;
    for (const asio::ip::address& address : addresses) {
        Tcp::acceptor acceptor(loop.impl().context);
        const error_code failed = open(acceptor, {address, port});
        if (failed && not_on_this_machine(failed)) {
            spdlog::warn("not listening on {}: {}", address.to_string(), failed.message());
            continue;
        }
        if (failed && wanted == 0 && !last_try) return false;
        if (failed)
            throw OperatorError(
                fmt::format("cannot listen on {} port {}: {}; choose another with --port, or 0 for any "
                            "free one",
                            address.to_string(), port, failed.message()));
        port = acceptor.local_endpoint().port();
        doors.push_back({std::move(acceptor), asio::steady_timer(loop.impl().context)});
    }
    if (doors.empty())
        throw OperatorError(
            "this machine has none of the addresses given with --bind; leave it out for loopback");
    return true;
}

void Listener::Impl::accept(size_t index) {
    Door& door = doors[index];
    door.acceptor.async_accept(
        [self = shared_from_this(), index](const error_code& failed, Tcp::socket socket) {
            Door& at = self->doors[index];
            if (failed == asio::error::operation_aborted || !at.acceptor.is_open()) return;
            if (failed) {
                // Out of descriptors, mostly: what is there goes on; new ones wait a little rather than spin.
                spdlog::warn("accepting a connection failed: {}", failed.message());
                at.pause.expires_after(std::chrono::milliseconds(100));
                at.pause.async_wait([self, index](const error_code& stopped) {
                    if (!stopped) self->accept(index);
                });
                return;
            }
            if (auto transport = make_tcp_transport(std::move(socket))) self->accepted(std::move(transport));
            if (at.acceptor.is_open()) self->accept(index);
        });
}

Listener::Listener(IoLoop& loop, const ListenAddresses& where, Accepted accepted)
    : impl_(std::make_shared<Impl>(loop, std::move(accepted))) {
    std::vector<asio::ip::address> addresses;
    for (const std::string& text : where.addresses) addresses.push_back(address_of(text, where.off_loopback));
    constexpr int tries = 8;
    for (int i = 0; i < tries; ++i)
        if (impl_->bind_all(addresses, where.port, i + 1 == tries)) break;
    for (size_t i = 0; i < impl_->doors.size(); ++i) impl_->accept(i);
}

Listener::~Listener() { close(); }

uint16_t Listener::port() const { return impl_->port; }

std::string Listener::text() const {
    std::string text;
    for (const Impl::Door& door : impl_->doors) {
        error_code failed;
        const Tcp::endpoint at = door.acceptor.local_endpoint(failed);
        if (failed) continue;
        if (!text.empty()) text += ", ";
        text += at.address().is_v6() ? fmt::format("[{}]:{}", at.address().to_string(), at.port())
                                     : fmt::format("{}:{}", at.address().to_string(), at.port());
    }
    return text;
}

void Listener::close() {
    error_code ignored;
    for (Impl::Door& door : impl_->doors) {
        door.pause.cancel();
        door.acceptor.close(ignored);
    }
}

}  // namespace trochoid
