#include "client/net/connection.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <span>
#include <utility>

#include "client/net/net_loop_asio.hpp"
#include "protocol/wire/frame.hpp"
#include "protocol/wire/session_rules.hpp"

namespace trochoid {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorOfSystem = boost::system::error_code;

struct Connection::Impl {
    Impl(NetLoop& l, Endpoint e, Events v)
        : loop(l),
          endpoint(std::move(e)),
          events(std::move(v)),
          resolver(l.impl().io),
          socket(l.impl().io),
          deadline(l.impl().io) {}

    NetLoop& loop;
    Endpoint endpoint;
    Events events;
    tcp::resolver resolver;
    tcp::socket socket;
    asio::steady_timer deadline;
    FrameReader frames{FrameReader::Opening::frames, Limits{}.frame_to_client};
    SessionPhase phase = SessionPhase::awaiting_hello;
    std::array<uint8_t, 16384> chunk{};
    Bytes waiting{stream_magic.begin(), stream_magic.end()};  // what the next write takes
    Bytes writing;
    bool standing = false;           // connected, reading and writing
    std::optional<Goodbye> parting;  // our goodbye is on its way; nothing is handed on any more
    CloseCause cause = CloseCause::closed_here;
    bool finished = false;
    std::atomic<uint64_t> bytes_received{0}, bytes_sent{0}, frames_received{0}, frames_sent{0};

    std::string server() const { return to_text(endpoint); }
};

Connection::Connection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Connection::~Connection() = default;

std::shared_ptr<Connection> Connection::open(NetLoop& loop, Endpoint endpoint, Events events) {
    std::shared_ptr<Connection> made(
        new Connection(std::make_unique<Impl>(loop, std::move(endpoint), std::move(events))));
    loop.post([made] { made->dial(); });
    return made;
}

void Connection::expect_within_patience(const char* what) {
    impl_->deadline.expires_after(patience);
    impl_->deadline.async_wait([weak = weak_from_this(), what](const ErrorOfSystem& error) {
        const auto self = weak.lock();
        if (error || !self) return;
        self->lose(fmt::format("{} at {} within {} s: check --connect and whether trochoid-server runs there",
                               what, self->impl_->server(), patience.count()));
    });
}

void Connection::dial() {
    Impl& my = *impl_;
    my.loop.assert_here();
    if (my.finished) return;
    expect_within_patience("nothing answered");
    my.resolver.async_resolve(
        my.endpoint.host, std::to_string(my.endpoint.port), tcp::resolver::numeric_service,
        [self = shared_from_this()](const ErrorOfSystem& error, const tcp::resolver::results_type& found) {
            Impl& its = *self->impl_;
            if (its.finished) return;
            if (error) {
                self->lose(fmt::format("there is no host '{}' ({}): check --connect", its.endpoint.host,
                                       error.message()));
                return;
            }
            asio::async_connect(its.socket, found, [self](const ErrorOfSystem& failed, const tcp::endpoint&) {
                if (self->impl_->finished) return;
                if (failed)
                    self->lose(
                        failed == asio::error::connection_refused
                            ? fmt::format("nothing listens at {}: start trochoid-server or check --connect",
                                          self->impl_->server())
                            : fmt::format("cannot connect to {} ({}): check --connect", self->impl_->server(),
                                          failed.message()));
                else
                    self->start();
            });
        });
}

void Connection::start() {
    Impl& my = *impl_;
    ErrorOfSystem ignored;
    my.socket.set_option(tcp::no_delay(true), ignored);
    my.standing = true;
    expect_within_patience("no server's hello came from what listens");
    if (my.events.connected) my.events.connected();
    read_some();
    write_some();
}

void Connection::read_some() {
    Impl& my = *impl_;
    my.socket.async_read_some(asio::buffer(my.chunk), [self = shared_from_this()](const ErrorOfSystem& error,
                                                                                  size_t count) {
        Impl& its = *self->impl_;
        if (its.finished) return;
        its.bytes_received.fetch_add(count, std::memory_order_relaxed);
        if (!error) {
            // While parting we read on, so that unread bytes do not reset the stream and lose our goodbye.
            if (!its.parting) self->take(count);
            if (!its.finished) self->read_some();
        } else if (its.parting) {
            self->finish(*its.parting, its.cause);
        } else if (error == asio::error::eof) {
            self->lose(fmt::format("the server at {} closed the connection without a word", its.server()));
        } else {
            self->lose(fmt::format("the connection to {} broke ({})", its.server(), error.message()));
        }
    });
}

void Connection::take(size_t count) {
    Impl& my = *impl_;
    const int64_t now_us = client_monotonic_us();
    std::span<const uint8_t> input(my.chunk.data(), count);
    while (!my.finished && !my.parting) {
        const Result<std::optional<Bytes>> payload = my.frames.next(input);
        if (!payload) return refuse(payload.error());
        if (!*payload) return;
        my.frames_received.fetch_add(1, std::memory_order_relaxed);
        Result<ServerMessage> message = decode_server(**payload);
        if (!message) return refuse(message.error());
        if (const auto may = expected(my.phase, *message); !may) return refuse(may.error());
        my.phase = phase_after(my.phase, *message);
        if (const auto* goodbye = std::get_if<Goodbye>(&*message))
            return finish(*goodbye, CloseCause::server_goodbye);
        if (const auto* hello = std::get_if<ServerHello>(&*message)) {
            my.deadline.cancel();
            my.frames.set_longest(hello->limits.frame_to_client);
        }
        if (my.events.message) my.events.message(std::move(*message), now_us);
    }
}

void Connection::send(const ClientMessage& message) {
    Impl& my = *impl_;
    my.loop.assert_here();
    if (my.finished || my.parting) return;
    const Bytes framed = frame(encode(message));
    if (my.waiting.size() + framed.size() > most_waiting) {
        lose(fmt::format("the server at {} takes nothing more ({} bytes wait for it)", my.server(),
                         my.waiting.size()));
        return;
    }
    my.waiting.insert(my.waiting.end(), framed.begin(), framed.end());
    my.frames_sent.fetch_add(1, std::memory_order_relaxed);
    write_some();
}

void Connection::write_some() {
    Impl& my = *impl_;
    if (!my.standing || my.finished || !my.writing.empty()) return;
    if (my.waiting.empty()) {
        // Our goodbye has left: the server closes its side next.
        ErrorOfSystem ignored;
        if (my.parting) my.socket.shutdown(tcp::socket::shutdown_send, ignored);
        return;
    }
    my.writing = std::exchange(my.waiting, {});
    asio::async_write(my.socket, asio::buffer(my.writing),
                      [self = shared_from_this()](const ErrorOfSystem& error, size_t count) {
                          Impl& its = *self->impl_;
                          its.bytes_sent.fetch_add(count, std::memory_order_relaxed);
                          its.writing.clear();
                          // A failed write is reported by the read, which may still hold the server's goodbye.
                          if (!error && !its.finished) self->write_some();
                      });
}

void Connection::close(const Goodbye& goodbye) { part(goodbye, CloseCause::closed_here); }

void Connection::refuse(const Error& error) {
    Goodbye goodbye = goodbye_for(error);
    if (impl_->phase == SessionPhase::awaiting_hello)
        goodbye.message =
            fmt::format("what listens at {} does not speak Trochoid's protocol ({}): check --connect",
                        impl_->server(), error.message);
    part(goodbye,
         error.code == ErrorCode::too_much_land ? CloseCause::over_our_limit : CloseCause::refused_server);
}

void Connection::part(const Goodbye& goodbye, CloseCause cause) {
    Impl& my = *impl_;
    my.loop.assert_here();
    if (my.finished || my.parting) return;
    if (!my.standing) return finish(goodbye, cause);
    send(goodbye);
    if (my.finished) return;
    my.parting = goodbye;
    my.cause = cause;
    write_some();
    my.deadline.expires_after(std::chrono::seconds(1));
    my.deadline.async_wait([weak = weak_from_this()](const ErrorOfSystem& error) {
        const auto self = weak.lock();
        if (!error && self && self->impl_->parting) self->finish(*self->impl_->parting, self->impl_->cause);
    });
}

void Connection::lose(std::string message) {
    Goodbye goodbye;
    goodbye.message = std::move(message);
    goodbye.retry = true;
    finish(goodbye, CloseCause::lost);
}

void Connection::finish(const Goodbye& goodbye, CloseCause cause) {
    Impl& my = *impl_;
    if (std::exchange(my.finished, true)) return;
    ErrorOfSystem ignored;
    my.resolver.cancel();
    my.deadline.cancel();
    my.socket.close(ignored);
    // Whoever listens may own this connection: the callbacks go before they are called for the last time.
    const Events events = std::exchange(my.events, {});
    if (events.closed) events.closed(goodbye, cause);
}

Traffic Connection::traffic() const {
    const auto read = [](const std::atomic<uint64_t>& counter) {
        return counter.load(std::memory_order_relaxed);
    };
    return {read(impl_->bytes_received), read(impl_->bytes_sent), read(impl_->frames_received),
            read(impl_->frames_sent)};
}

}  // namespace trochoid
