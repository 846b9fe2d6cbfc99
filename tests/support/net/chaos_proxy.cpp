#include "tests/support/net/chaos_proxy.hpp"

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <functional>
#include <future>
#include <thread>
#include <utility>

#include "protocol/units/hash.hpp"
#include "tests/support/net/chaos_link.hpp"

namespace trochoid {

namespace {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using Failed = boost::system::error_code;

constexpr size_t largest_write = 16384;

/// As on an Ethernet; loopback's own segments hold 64 KiB. Before a connection stands.
template <class Socket>
void limit_segments(Socket& socket) {
#ifdef TCP_MAXSEG
    using LargestSegment = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_MAXSEG>;
    Failed ignored;
    socket.set_option(LargestSegment(1460), ignored);
#endif
}

int64_t now_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// One direction: reads from a socket, and writes to the other what comes out of the link.
struct Way {
    Way(asio::io_context& io, const LinkFaults& faults, uint64_t seed, int64_t back_us, Tcp::socket& a,
        Tcp::socket& b)
        : link(faults, seed, back_us), from(a), to(b), timer(io) {}
    ChaosLink link;
    Tcp::socket& from;
    Tcp::socket& to;
    asio::steady_timer timer;
    std::array<uint8_t, 16384> chunk{};
    std::vector<uint8_t> writing;
    bool reading = false;
    bool busy = false;  // a write is going on
    bool source_ended = false;
    bool broken = false;  // the source was reset: that is handed on, too
    bool ended = false;   // the end has been handed on
};

/// One proxied connection; lives as long as its handlers.
class Passage : public std::enable_shared_from_this<Passage> {
public:
    Passage(asio::io_context& io, Tcp::socket client, ProxiedConnection record, uint64_t seed)
        : client_(std::move(client)),
          server_(io),
          record_(std::move(record)),
          up_(io, record_.faults.up, splitmix64(seed), record_.faults.down.delay_us, client_, server_),
          down_(io, record_.faults.down, splitmix64(seed + 1), record_.faults.up.delay_us, server_, client_) {
    }
    Passage(const Passage&) = delete;
    Passage& operator=(const Passage&) = delete;

    void start(uint16_t port) {
        Failed ignored;
        client_.set_option(Tcp::no_delay(true), ignored);
        server_.open(Tcp::v4(), ignored);
        limit_segments(server_);
        server_.async_connect({asio::ip::address_v4::loopback(), port},
                              [self = shared_from_this()](Failed failed) {
                                  if (self->record_.over) return;
                                  if (failed) return self->close(CutKind::reset);
                                  Failed unneeded;
                                  self->server_.set_option(Tcp::no_delay(true), unneeded);
                                  self->pump(self->up_);
                                  if (!self->record_.over) self->pump(self->down_);
                              });
    }

    void cut(CutKind kind) {
        if (record_.over) return;
        record_.cut = kind;
        close(kind);
    }

    ProxiedConnection record() const {
        ProxiedConnection now = record_;
        now.bytes_up = up_.link.delivered();
        now.bytes_down = down_.link.delivered();
        return now;
    }

private:
    void read(Way& way) {
        if (way.reading || way.source_ended || silent_ || !way.link.takes_more()) return;
        way.reading = true;
        way.from.async_read_some(asio::buffer(way.chunk),
                                 [self = shared_from_this(), &way](Failed failed, size_t count) {
                                     way.reading = false;
                                     if (self->record_.over) return;
                                     if (failed) {
                                         way.source_ended = true;
                                         way.broken = failed != asio::error::eof;
                                         way.link.end(now_us());
                                     } else {
                                         way.link.put(std::span(way.chunk).first(count), now_us());
                                     }
                                     self->pump(way);
                                 });
    }

    void pump(Way& way) {
        read(way);
        if (way.busy || way.ended || silent_) return;
        ChaosLink::Out out = way.link.take(now_us(), largest_write);
        if (out.bytes.empty()) return after_bytes(way, out);
        way.writing = std::move(out.bytes);
        out.bytes = {};
        way.busy = true;
        asio::async_write(way.to, asio::buffer(way.writing),
                          [self = shared_from_this(), &way, out = std::move(out)](Failed failed, size_t) {
                              way.busy = false;
                              if (self->record_.over) return;
                              if (failed) return self->close(CutKind::reset);
                              self->after_bytes(way, out);
                              if (!self->record_.over) self->pump(way);
                          });
    }

    void after_bytes(Way& way, const ChaosLink::Out& out) {
        if (out.cut) return cut(*out.cut);
        if (out.ended) {
            way.ended = true;
            if (way.broken) return close(CutKind::reset);
            Failed ignored;
            way.to.shutdown(Tcp::socket::shutdown_send, ignored);
            if (up_.ended && down_.ended) close(CutKind::finish);
            return;
        }
        const int64_t now = now_us();
        const int64_t next = way.link.next_us(now);
        if (next == INT64_MAX || way.busy) return;
        way.timer.expires_after(std::chrono::microseconds(std::max<int64_t>(next - now, 0)));
        way.timer.async_wait([weak = weak_from_this(), &way](Failed failed) {
            const auto self = weak.lock();
            if (!failed && self && !self->record_.over) self->pump(way);
        });
    }

    void close(CutKind kind) {
        Failed ignored;
        up_.timer.cancel();
        down_.timer.cancel();
        if (kind == CutKind::silence) {
            // Packets go nowhere from here on; the sockets stay until the proxy ends.
            silent_ = true;
            return;
        }
        record_.over = true;
        for (Tcp::socket* socket : {&client_, &server_}) {
            if (kind == CutKind::reset) {
                socket->set_option(asio::socket_base::linger(true, 0), ignored);
                socket->close(ignored);
            } else {
                linger(*socket);
            }
        }
    }

    // An orderly end: closing over unread bytes would reset the stream, so they are read away first.
    void linger(Tcp::socket& socket) {
        Failed ignored;
        socket.shutdown(Tcp::socket::shutdown_send, ignored);
        drain(socket);
    }
    void drain(Tcp::socket& socket) {
        socket.async_read_some(asio::buffer(rest_),
                               [self = shared_from_this(), &socket](Failed failed, size_t) {
                                   Failed ignored;
                                   if (failed)
                                       socket.close(ignored);
                                   else
                                       self->drain(socket);
                               });
    }

    Tcp::socket client_;
    Tcp::socket server_;
    ProxiedConnection record_;
    Way up_;
    Way down_;
    bool silent_ = false;
    std::array<uint8_t, 4096> rest_{};
};

}  // namespace

struct ChaosProxy::Impl : std::enable_shared_from_this<ChaosProxy::Impl> {
    Impl(uint16_t server_port, ChaosSchedule s) : target(server_port), schedule(std::move(s)), acceptor(io) {
        const Tcp::endpoint here(asio::ip::address_v4::loopback(), 0);
        acceptor.open(here.protocol());
        limit_segments(acceptor);
        acceptor.bind(here);
        acceptor.listen();
    }

    void accept() {
        acceptor.async_accept([this](Failed failed, Tcp::socket socket) {
            if (failed == asio::error::operation_aborted) return;
            if (!failed) {
                ProxiedConnection record;
                record.number = passages.size();
                record.faults = faults_of(schedule, record.number);
                record.accepted_us = now_us();
                const uint64_t seed = splitmix64(schedule.seed) + 2 * record.number;
                passages.push_back(std::make_shared<Passage>(io, std::move(socket), record, seed));
                passages.back()->start(target);
            }
            accept();
        });
    }
    /// Runs on the proxy's thread and waits for it.
    void here(std::function<void()> task) {
        std::promise<void> done;
        asio::post(io, [&] {
            task();
            done.set_value();
        });
        done.get_future().wait();
    }

    asio::io_context io{1};
    uint16_t target;
    ChaosSchedule schedule;
    Tcp::acceptor acceptor;
    std::vector<std::shared_ptr<Passage>> passages;
    std::thread thread;
};

ChaosProxy::ChaosProxy(uint16_t server_port, ChaosSchedule schedule)
    : impl_(std::make_shared<Impl>(server_port, std::move(schedule))) {
    impl_->accept();
    impl_->thread = std::thread([impl = impl_.get()] { impl->io.run(); });
}

ChaosProxy::~ChaosProxy() {
    impl_->here([this] {
        Failed ignored;
        impl_->acceptor.close(ignored);
        for (const auto& passage : impl_->passages) passage->cut(CutKind::reset);
        impl_->io.stop();
    });
    impl_->thread.join();
    // Handlers that never ran hold passages, whose sockets have to go before the loop does.
    impl_->passages.clear();
}

uint16_t ChaosProxy::port() const { return impl_->acceptor.local_endpoint().port(); }

void ChaosProxy::set(const ChaosSchedule& schedule) {
    impl_->here([&] { impl_->schedule = schedule; });
}

void ChaosProxy::lead_to(uint16_t server_port) {
    impl_->here([&] { impl_->target = server_port; });
}

void ChaosProxy::cut_all(CutKind kind) {
    impl_->here([&] {
        for (const auto& passage : impl_->passages) passage->cut(kind);
    });
}

std::vector<ProxiedConnection> ChaosProxy::connections() const {
    std::vector<ProxiedConnection> all;
    impl_->here([&] {
        for (const auto& passage : impl_->passages) all.push_back(passage->record());
    });
    return all;
}

}  // namespace trochoid
