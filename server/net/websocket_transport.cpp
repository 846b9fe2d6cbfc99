#include "server/net/websocket_transport.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/error.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"
#include "protocol/wire/rate_limit.hpp"
#include "protocol/wire/requirements.hpp"
#include "server/net/io_loop_asio.hpp"
#include "server/net/message_room.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/soon.hpp"
#include "server/net/web_frame_count.hpp"

// The one place where Beast's WebSocket is compiled: it takes the better part of a minute.
namespace trochoid {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;

// Pings, pongs and fragments: each costs about as much as a message, and the standard lets messages come in any number of them.
constexpr uint32_t odd_frames_per_second = 128;
constexpr uint32_t odd_frames_at_once = 256;

// A Transport that two can wait on for room: Beast, and the session above it.
class SharedStream : public std::enable_shared_from_this<SharedStream> {
public:
    SharedStream(IoLoop& on, std::unique_ptr<Transport> inner) : transport(std::move(inner)), loop(on) {}

    void when_writable_for_beast(std::function<void()> ready) {
        beast_ = std::move(ready);
        arm();
    }
    void when_writable_for_session(std::function<void()> ready) {
        session_ = std::move(ready);
        arm();
    }
    void close() {
        closed_ = true;
        beast_ = session_ = flooded = nullptr;
        transport->close();
    }
    /// Nothing is read or written any more, whatever Beast still has under way.
    bool closed() const { return closed_; }
    /// What Beast is given to read.
    void came(std::span<const uint8_t> bytes) {
        if (dropping_) dropped_ += bytes.size();
        const int64_t now_us = monotonic_us();
        for (uint32_t i = frames_.take(bytes); i > 0; --i) flood_ = flood_ || !odd_frames_.take(now_us);
        if (flood_ && flooded) std::exchange(flooded, nullptr)();
    }

    std::unique_ptr<Transport> transport;
    IoLoop& loop;
    std::function<void()> flooded;  ///< called once, when too many pings and fragments have come
    /// The last word is said: Beast reads on for the peer's close frame, and drops the rest.
    void last_word_said() { dropping_ = true; }
    /// More has come since than may: nothing is read any more.
    bool read_enough() const { return dropped_ >= most_dropped_bytes; }

private:
    void arm() {
        if (std::exchange(armed_, true)) return;
        transport->when_writable([weak = weak_from_this()] {
            const auto self = weak.lock();
            if (!self) return;
            self->armed_ = false;
            if (const auto ready = std::exchange(self->beast_, nullptr)) ready();
            if (const auto ready = std::exchange(self->session_, nullptr)) ready();
        });
    }
    std::function<void()> beast_;
    std::function<void()> session_;
    bool armed_ = false;
    bool closed_ = false;
    WebFrameCount frames_;
    RateLimit odd_frames_{odd_frames_per_second, odd_frames_at_once};
    bool flood_ = false;
    bool dropping_ = false;
    size_t dropped_ = 0;
};

// Beast's AsyncStream over it. Handlers are never called from inside the asking call.
class BeastStream {
public:
    using executor_type = asio::io_context::executor_type;
    explicit BeastStream(std::shared_ptr<SharedStream> shared) : shared_(std::move(shared)) {}

    executor_type get_executor() noexcept { return shared_->loop.impl().context.get_executor(); }
    SharedStream& shared() const { return *shared_; }

    template <class Buffers, class Handler>
    auto async_read_some(const Buffers& buffers, Handler&& handler) {
        return asio::async_initiate<Handler, void(error_code, size_t)>(
            [this](auto&& done, asio::mutable_buffer into) {
                read(into, keep(std::forward<decltype(done)>(done)), true);
            },
            handler, first_of<asio::mutable_buffer>(buffers));
    }
    template <class Buffers, class Handler>
    auto async_write_some(const Buffers& buffers, Handler&& handler) {
        return asio::async_initiate<Handler, void(error_code, size_t)>(
            [this](auto&& done, asio::const_buffer from) {
                write(from, keep(std::forward<decltype(done)>(done)), true);
            },
            handler, first_of<asio::const_buffer>(buffers));
    }

private:
    using Done = std::function<void(error_code, size_t)>;

    template <class Buffer, class Buffers>
    static Buffer first_of(const Buffers& buffers) {
        for (auto at = asio::buffer_sequence_begin(buffers); at != asio::buffer_sequence_end(buffers); ++at)
            if (Buffer(*at).size() > 0) return Buffer(*at);
        return {};
    }
    // Beast's handlers can be moved only, our callbacks are copied.
    template <class Handler>
    static Done keep(Handler&& handler) {
        auto kept = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
        return [kept](error_code failed, size_t bytes) { (*kept)(failed, bytes); };
    }
    void complete(Done done, error_code failed, size_t bytes, bool inside) {
        if (!inside) {
            done(failed, bytes);
            return;
        }
        asio::post(get_executor(), [done = std::move(done), failed, bytes] { done(failed, bytes); });
    }
    void read(asio::mutable_buffer into, Done done, bool inside);
    void write(asio::const_buffer from, Done done, bool inside);

    std::shared_ptr<SharedStream> shared_;
};

void BeastStream::read(asio::mutable_buffer into, Done done, bool inside) {
    if (shared_->closed()) return complete(std::move(done), asio::error::operation_aborted, 0, inside);
    if (shared_->read_enough()) return;
    Transport& transport = *shared_->transport;
    const Transport::Moved moved = transport.read({static_cast<uint8_t*>(into.data()), into.size()});
    if (moved.closed || transport.fault()) {
        complete(std::move(done), asio::error::eof, 0, inside);
    } else if (moved.bytes > 0 || into.size() == 0) {
        shared_->came({static_cast<const uint8_t*>(into.data()), moved.bytes});
        complete(std::move(done), {}, moved.bytes, inside);
    } else {
        transport.when_readable([self = *this, into, done = std::move(done)]() mutable {
            self.read(into, std::move(done), false);
        });
    }
}

void BeastStream::write(asio::const_buffer from, Done done, bool inside) {
    if (shared_->closed()) return complete(std::move(done), asio::error::operation_aborted, 0, inside);
    const Transport::Moved moved =
        shared_->transport->write({static_cast<const uint8_t*>(from.data()), from.size()});
    if (moved.closed) {
        complete(std::move(done), asio::error::broken_pipe, 0, inside);
    } else if (moved.bytes > 0 || from.size() == 0) {
        complete(std::move(done), {}, moved.bytes, inside);
    } else {
        shared_->when_writable_for_beast([self = *this, from, done = std::move(done)]() mutable {
            self.write(from, std::move(done), false);
        });
    }
}

// Found by Beast where it ends a connection.
template <class Handler>
void async_teardown(beast::role_type, BeastStream& stream, Handler&& handler) {
    stream.shared().transport->finish(ErrorCode::none);
    asio::post(stream.get_executor(),
               [done = std::forward<Handler>(handler)]() mutable { done(error_code{}); });
}
[[maybe_unused]] void beast_close_socket(BeastStream& stream) { stream.shared().transport->close(); }

// RFC 6455's codes where one fits; else 4000 + ours (private use), so that who sees only the close frame knows as well.
websocket::close_reason reason_for(ErrorCode why, bool text) {
    const auto close_code = [&]() -> unsigned {
        if (text) return websocket::close_code::unknown_data;
        switch (why) {
            case ErrorCode::none:
            case ErrorCode::client_closed: return websocket::close_code::normal;
            case ErrorCode::frame_too_long: return websocket::close_code::too_big;
            case ErrorCode::shutting_down: return websocket::close_code::going_away;
            case ErrorCode::internal_error: return websocket::close_code::internal_error;
            default: return 4000U + static_cast<unsigned>(why);
        }
    }();
    websocket::close_reason reason;
    reason.code = static_cast<uint16_t>(close_code);
    reason.reason = fmt::format("trochoid {} {}", static_cast<unsigned>(why), error_class(why));
    return reason;
}

// What a WebSocket needs. Only the transport holds it: Beast keeps calls that wait for one another in the stream itself, and where the
// peer says no more they would hold it for ever.
class Socket : public std::enable_shared_from_this<Socket> {
public:
    Socket(IoLoop& loop, std::unique_ptr<Transport> inner, uint32_t longest)
        : stream_(std::make_shared<SharedStream>(loop, std::move(inner))),
          websocket_(BeastStream(stream_)),
          soon_(loop),
          longest_(longest),
          arrived_(stream_magic.begin(), stream_magic.end()) {}

    void accept(const HttpRequest& upgrade);
    void when_readable(std::function<void()> ready);
    void when_writable(std::function<void()> ready);
    Transport::Moved read(std::span<uint8_t> into);
    Transport::Moved write(std::span<const uint8_t> bytes);
    void finish(ErrorCode why);
    void close();

    const std::string& peer() const { return stream_->transport->peer(); }
    const std::optional<StreamFault>& fault() const { return fault_; }
    void set_longest(uint32_t payload) { longest_ = payload; }

private:
    void read_message();
    void took(const error_code& failed);
    void send_message();
    void idle_again();
    void say_close();
    void stop_reading(Error error);
    void tell_reader();

    std::shared_ptr<SharedStream> stream_;
    websocket::stream<BeastStream, false> websocket_;
    Soon soon_;
    uint32_t longest_;
    std::function<void()> readable_;
    std::function<void()> writable_;

    Bytes arrived_;  // whole messages as frames, for the session
    size_t arrived_taken_ = 0;
    MessageRoom message_;
    bool reading_ = false;
    std::optional<StreamFault> fault_;
    bool fault_told_ = false;
    bool text_ = false;
    bool broken_ = false;  // WebSocket itself was broken: Beast has sent its close frame
    bool closed_ = false;

    std::array<uint8_t, frame_header_bytes> header_{};  // of the frame on its way out
    size_t header_read_ = 0;
    size_t payload_length_ = 0;
    Bytes outgoing_;
    bool busy_ = true;  // Beast is writing a message, or the answer to the upgrade
    std::optional<ErrorCode> finishing_;
    bool close_said_ = false;
};

void Socket::accept(const HttpRequest& upgrade) {
    http::request<http::empty_body> request(http::verb::get, "/", 11);
    request.set(http::field::host, upgrade.host);
    request.set(http::field::connection, "upgrade");
    request.set(http::field::upgrade, "websocket");
    request.set(http::field::sec_websocket_key, upgrade.websocket_key);
    request.set(http::field::sec_websocket_version, upgrade.websocket_version);
    websocket_.set_option(websocket::stream_base::decorator([](websocket::response_type& answer) {
        answer.set(http::field::sec_websocket_protocol,
                   beast::string_view(websocket_subprotocol.data(), websocket_subprotocol.size()));
    }));
    websocket_.read_message_max(0);  // we count ourselves, so that a goodbye can come before the close frame
    websocket_.auto_fragment(false);
    websocket_.write_buffer_bytes(8);  // a server's whole messages go out from where they are
    websocket_.binary(true);
    stream_->flooded = [weak = weak_from_this()] {
        if (const auto self = weak.lock())
            self->stop_reading({ErrorCode::rate_limited,
                                fmt::format("more than {} pings and fragments a second: send whole messages",
                                            odd_frames_per_second)});
    };
    websocket_.async_accept(request, [weak = weak_from_this()](const error_code& failed) {
        const auto self = weak.lock();
        if (!self) return;
        if (failed) {
            self->closed_ = true;
            self->tell_reader();
            return;
        }
        self->idle_again();
        if (self->readable_) self->read_message();
    });
}

void Socket::tell_reader() {
    if (readable_) soon_.call(std::exchange(readable_, nullptr));
    if (closed_ && writable_) soon_.call(std::exchange(writable_, nullptr));
}

void Socket::when_readable(std::function<void()> ready) {
    readable_ = std::move(ready);
    if (arrived_taken_ < arrived_.size() || closed_ || (fault_ && !fault_told_)) {
        tell_reader();
    } else if (broken_) {
        stream_->transport->when_readable([weak = weak_from_this()] {
            if (const auto self = weak.lock()) self->tell_reader();
        });
    } else {
        read_message();
    }
}

Transport::Moved Socket::read(std::span<uint8_t> into) {
    if (arrived_taken_ == arrived_.size()) {
        fault_told_ = fault_.has_value();
        if (broken_) return {0, stream_->transport->read(into).closed};  // dropped
        return {0, closed_};
    }
    const size_t bytes = std::min(into.size(), arrived_.size() - arrived_taken_);
    std::copy_n(arrived_.begin() + static_cast<std::ptrdiff_t>(arrived_taken_), bytes, into.begin());
    arrived_taken_ += bytes;
    if (arrived_taken_ == arrived_.size()) {
        arrived_ = {};
        arrived_taken_ = 0;
    }
    return {bytes, false};
}

// Goes on with a message, in steps that cost little while nothing comes.
void Socket::read_message() {
    if (reading_ || fault_ || closed_ || !arrived_.empty() || !websocket_.is_open()) return;
    reading_ = true;
    // One byte of room beyond the limit tells that there is more.
    const auto room = message_.room(size_t{longest_} + 1);
    websocket_.async_read_some(asio::buffer(room.data(), room.size()),
                               [weak = weak_from_this()](const error_code& failed, size_t bytes) {
                                   const auto self = weak.lock();
                                   if (!self) return;
                                   self->reading_ = false;
                                   self->message_.took(bytes);
                                   self->took(failed);
                               });
}

void Socket::took(const error_code& failed) {
    if (fault_ || failed) message_.clear();
    if (closed_) return;
    if (failed) {
        const bool gone = failed == websocket::error::closed || failed == asio::error::eof ||
                          failed == asio::error::broken_pipe || failed == asio::error::operation_aborted;
        if (gone) {
            closed_ = true;
            tell_reader();
            return;
        }
        broken_ = true;
        if (fault_) return;
        stop_reading(
            {ErrorCode::malformed_frame,
             fmt::format("WebSocket is broken ({}): send masked binary messages", failed.message())});
        return;
    }
    if (fault_) return;
    if (websocket_.got_text()) {
        text_ = true;
        stop_reading({ErrorCode::malformed_frame, "a text message came: send binary ones, one a FlatBuffer"});
        return;
    }
    if (message_.held() > longest_) {
        stop_reading({ErrorCode::frame_too_long,
                      fmt::format("a message of more than {} bytes: send shorter ones", longest_)});
        return;
    }
    if (!websocket_.is_message_done()) {
        read_message();
        return;
    }
    arrived_ = message_.take_frame();
    tell_reader();
}

void Socket::stop_reading(Error error) {
    const uint16_t broken =
        error.code == ErrorCode::frame_too_long ? requirement::frame_length : requirement::websocket;
    fault_ = StreamFault{std::move(error), broken};
    if (!reading_) message_.clear();  // else Beast is still writing into it
    tell_reader();
}

Transport::Moved Socket::write(std::span<const uint8_t> bytes) {
    if (closed_) return {0, true};
    if (broken_) return {bytes.size(), false};  // after Beast's close frame nothing may follow
    size_t taken = 0;
    while (taken < bytes.size() && !busy_) {
        if (header_read_ < frame_header_bytes) {
            header_[header_read_++] = bytes[taken++];
            if (header_read_ < frame_header_bytes) continue;
            payload_length_ = header_[0] | size_t{header_[1]} << 8 | size_t{header_[2]} << 16;
            outgoing_.reserve(payload_length_);
        } else {
            const size_t piece = std::min(bytes.size() - taken, payload_length_ - outgoing_.size());
            const auto from = bytes.subspan(taken, piece);
            outgoing_.insert(outgoing_.end(), from.begin(), from.end());
            taken += piece;
        }
        if (outgoing_.size() == payload_length_) send_message();
    }
    return {taken, false};
}

void Socket::send_message() {
    busy_ = true;
    websocket_.async_write(asio::buffer(outgoing_),
                           [weak = weak_from_this()](const error_code& failed, size_t) {
                               const auto self = weak.lock();
                               if (!self) return;
                               self->outgoing_ = {};
                               self->header_read_ = 0;
                               if (failed && !self->broken_) self->closed_ = true;
                               self->idle_again();
                           });
}

// Beast has written what it was given: on with the close frame, or with whoever waits for room.
void Socket::idle_again() {
    busy_ = false;
    if (closed_) {
        tell_reader();
    } else if (finishing_) {
        say_close();
    } else if (writable_) {
        when_writable(std::exchange(writable_, nullptr));
    }
}

void Socket::when_writable(std::function<void()> ready) {
    if (closed_ || broken_)
        soon_.call(std::move(ready));
    else if (busy_)
        writable_ = std::move(ready);
    else
        stream_->when_writable_for_session(std::move(ready));
}

void Socket::finish(ErrorCode why) {
    finishing_ = why;
    if (!busy_) say_close();
}

void Socket::say_close() {
    if (closed_ || broken_ || std::exchange(close_said_, true)) return;
    stream_->last_word_said();
    websocket_.async_close(reason_for(*finishing_, text_), [weak = weak_from_this()](const error_code&) {
        const auto self = weak.lock();
        if (!self) return;
        self->closed_ = true;
        self->tell_reader();
    });
}

void Socket::close() {
    closed_ = true;
    readable_ = writable_ = nullptr;
    soon_.forget();
    stream_->close();
}

class WebSocketTransport final : public Transport {
public:
    explicit WebSocketTransport(std::shared_ptr<Socket> socket) : socket_(std::move(socket)) {}
    ~WebSocketTransport() override { socket_->close(); }

    const std::string& peer() const override { return socket_->peer(); }
    void when_readable(std::function<void()> ready) override { socket_->when_readable(std::move(ready)); }
    void when_writable(std::function<void()> ready) override { socket_->when_writable(std::move(ready)); }
    Moved read(std::span<uint8_t> into) override { return socket_->read(into); }
    Moved write(std::span<const uint8_t> bytes) override { return socket_->write(bytes); }
    void finish(ErrorCode why) override { socket_->finish(why); }
    void close() override { socket_->close(); }
    std::optional<StreamFault> fault() const override { return socket_->fault(); }
    void set_longest(uint32_t payload) override { socket_->set_longest(payload); }

private:
    std::shared_ptr<Socket> socket_;
};

}  // namespace

std::unique_ptr<Transport> make_websocket_transport(IoLoop& loop, const HttpRequest& upgrade,
                                                    std::unique_ptr<Transport> inner, uint32_t longest) {
    const auto socket = std::make_shared<Socket>(loop, std::move(inner), longest);
    socket->accept(upgrade);
    return std::make_unique<WebSocketTransport>(socket);
}

}  // namespace trochoid
