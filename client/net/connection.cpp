#include "client/net/connection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <utility>

#include "client/net/stranger.hpp"
#include "protocol/wire/frame.hpp"
#include "protocol/wire/session_rules.hpp"

namespace trochoid {

struct Connection::Impl {
    Impl(NetLoop& l, Endpoint e, std::shared_ptr<ClientStream> s, Events v)
        : loop(l), endpoint(std::move(e)), stream(std::move(s)), events(std::move(v)) {
        if (!stream->keeps_messages()) queue({stream_magic.begin(), stream_magic.end()});
    }

    NetLoop& loop;
    Endpoint endpoint;
    std::shared_ptr<ClientStream> stream;
    Events events;
    FrameReader frames{FrameReader::Opening::frames, Limits{}.frame_to_client};
    SessionPhase phase = SessionPhase::awaiting_hello;
    std::array<uint8_t, 8> first{};  // bytes that came, to tell who sends them
    size_t first_count = 0;
    std::deque<Bytes> waiting;  // magic and frames, or whole messages
    size_t waiting_bytes = 0;
    Bytes writing;
    uint64_t deadlines = 0;          // set so far: only the last one counts
    bool standing = false;           // dialled, reading and writing
    std::optional<Goodbye> parting;  // our goodbye is on its way; nothing is handed on any more
    CloseCause cause = CloseCause::closed_here;
    bool finished = false;
    std::atomic<uint64_t> bytes_received{0}, bytes_sent{0}, frames_received{0}, frames_sent{0};

    std::string server() const { return to_text(endpoint); }
    /// What to add where a connection ends.
    std::string before_the_hello() const {
        if (phase != SessionPhase::awaiting_hello) return {};
        if (is_encrypted(endpoint.transport)) return " before its hello: check --connect";
        return fmt::format(" before its hello: check --connect (where TLS is wanted: {})",
                           to_text(with_encryption(endpoint, true)));
    }
    void queue(Bytes piece) {
        waiting_bytes += piece.size();
        waiting.push_back(std::move(piece));
    }
    /// What the next write takes: one message, or all that waits as one stretch of the stream.
    Bytes next_to_write() {
        Bytes out = std::move(waiting.front());
        waiting.pop_front();
        for (; !stream->keeps_messages() && !waiting.empty(); waiting.pop_front())
            out.insert(out.end(), waiting.front().begin(), waiting.front().end());
        waiting_bytes -= out.size();
        return out;
    }
};

Connection::Connection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Connection::~Connection() = default;

std::shared_ptr<Connection> Connection::open(NetLoop& loop, const Endpoint& endpoint, Events events) {
    return open(loop, endpoint, stream_to(loop, endpoint), std::move(events));
}

std::shared_ptr<Connection> Connection::open(NetLoop& loop, const Endpoint& endpoint,
                                             std::shared_ptr<ClientStream> stream, Events events) {
    std::shared_ptr<Connection> made(
        new Connection(std::make_unique<Impl>(loop, endpoint, std::move(stream), std::move(events))));
    loop.post([made] { made->dial(); });
    return made;
}

/// In place of any deadline set before.
void Connection::after(std::chrono::milliseconds delay, void (Connection::*overdue)()) {
    const uint64_t number = ++impl_->deadlines;
    impl_->loop.after(delay, [weak = weak_from_this(), number, overdue] {
        const auto self = weak.lock();
        if (self && self->impl_->deadlines == number && !self->impl_->finished) (*self.*overdue)();
    });
}

void Connection::no_answer() {
    const Impl& my = *impl_;
    lose(fmt::format("{} at {} within {} s: check --connect and whether trochoid-server runs there",
                     my.standing ? "no server's hello came from what listens" : my.stream->awaits(),
                     my.server(), patience.count()));
}

void Connection::dial() {
    Impl& my = *impl_;
    my.loop.assert_here();
    if (my.finished) return;
    after(patience, &Connection::no_answer);
    my.stream->dial([self = shared_from_this()](const Result<Done>& outcome) {
        if (self->impl_->finished) return;
        if (outcome)
            self->start();
        else
            self->lose(outcome.error().message);
    });
}

void Connection::start() {
    Impl& my = *impl_;
    my.standing = true;
    after(patience, &Connection::no_answer);
    if (my.events.connected) my.events.connected();
    if (my.finished) return;
    read_some();
    write_some();
}

void Connection::read_some() {
    impl_->stream->read([self = shared_from_this()](const Result<std::span<const uint8_t>>& bytes) {
        Impl& its = *self->impl_;
        if (its.finished) return;
        // While parting we read on, so that unread bytes do not reset the stream and lose our goodbye.
        const bool reading = !its.parting;
        if (bytes) {
            its.bytes_received.fetch_add((*bytes).size(), std::memory_order_relaxed);
            if (reading) self->take(*bytes);
        } else if (bytes.error().code != ErrorCode::none) {
            if (reading) self->refuse(bytes.error());
        } else if (reading) {
            self->lose(bytes.error().message + its.before_the_hello());
        } else {
            self->finish(*its.parting, its.cause);
        }
        if (!its.finished) self->read_some();
    });
}

void Connection::take(std::span<const uint8_t> bytes) {
    Impl& my = *impl_;
    const int64_t now_us = client_monotonic_us();
    const size_t more = std::min(my.first.size() - my.first_count, bytes.size());
    std::copy_n(bytes.begin(), more, my.first.begin() + static_cast<std::ptrdiff_t>(my.first_count));
    my.first_count += more;
    if (my.stream->keeps_messages()) return take_message(bytes, now_us);
    while (!my.finished && !my.parting) {
        const Result<std::optional<Bytes>> payload = my.frames.next(bytes);
        if (!payload) return refuse(payload.error());
        if (!*payload) return;
        take_message(**payload, now_us);
    }
}

void Connection::take_message(std::span<const uint8_t> payload, int64_t now_us) {
    Impl& my = *impl_;
    my.frames_received.fetch_add(1, std::memory_order_relaxed);
    Result<ServerMessage> message = decode_server(payload);
    if (!message)
        return refuse(message.error(), goodbye_for_payload(message.error(), payload, server_identifier));
    if (const auto may = expected(my.phase, *message); !may) return refuse(may.error());
    my.phase = phase_after(my.phase, *message);
    if (auto* goodbye = std::get_if<Goodbye>(&*message)) {
        if (goodbye->code == ErrorCode::encryption_required && !is_encrypted(my.endpoint.transport))
            goodbye->message += fmt::format(" (--connect {})", to_text(with_encryption(my.endpoint, true)));
        return finish(*goodbye, CloseCause::server_goodbye);
    }
    if (const auto* hello = std::get_if<ServerHello>(&*message)) {
        if (const auto good = acceptable(*hello); !good) return refuse(good.error());
        ++my.deadlines;
        my.frames.set_longest(hello->limits.frame_to_client);
        my.stream->set_longest(hello->limits.frame_to_client);
    }
    if (my.events.message) my.events.message(std::move(*message), now_us);
}

void Connection::send(const ClientMessage& message) {
    Impl& my = *impl_;
    my.loop.assert_here();
    if (my.finished || my.parting) return;
    Bytes piece = encode(message);
    if (!my.stream->keeps_messages()) piece = frame(piece);
    if (my.waiting_bytes + piece.size() > most_waiting) {
        lose(fmt::format("the server at {} takes nothing more ({} bytes wait for it)", my.server(),
                         my.waiting_bytes));
        return;
    }
    my.queue(std::move(piece));
    my.frames_sent.fetch_add(1, std::memory_order_relaxed);
    write_some();
}

void Connection::write_some() {
    Impl& my = *impl_;
    if (!my.standing || my.finished || !my.writing.empty()) return;
    if (my.waiting.empty()) {
        // Our goodbye has left: the server closes its side next.
        if (my.parting) my.stream->shut();
        return;
    }
    my.writing = my.next_to_write();
    my.stream->write(my.writing, [self = shared_from_this()](size_t count) {
        Impl& its = *self->impl_;
        its.bytes_sent.fetch_add(count, std::memory_order_relaxed);
        const bool whole = count == its.writing.size();
        its.writing.clear();
        // A failed write is reported by the read, which may still hold the server's goodbye.
        if (whole && !its.finished) self->write_some();
    });
}

void Connection::close(const Goodbye& goodbye) { part(goodbye, CloseCause::closed_here); }

void Connection::refuse(const Error& error) { refuse(error, goodbye_for(error)); }

void Connection::refuse(const Error& error, uint16_t requirement) {
    Goodbye goodbye = goodbye_for(error);
    goodbye.requirement = requirement;
    refuse(error, std::move(goodbye));
}

void Connection::refuse(const Error& error, Goodbye goodbye) {
    const Impl& my = *impl_;
    if (my.phase == SessionPhase::awaiting_hello)
        goodbye.message = fmt::format(
            "{} ({})", who_listens(std::span(my.first).first(my.first_count), my.endpoint), error.message);
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
    after(std::chrono::seconds(1), &Connection::part_overdue);
}

void Connection::part_overdue() { finish(*impl_->parting, impl_->cause); }

void Connection::lose(std::string message) {
    Goodbye goodbye;
    goodbye.message = std::move(message);
    goodbye.retry = true;
    finish(goodbye, CloseCause::lost);
}

void Connection::finish(const Goodbye& goodbye, CloseCause cause) {
    Impl& my = *impl_;
    if (std::exchange(my.finished, true)) return;
    my.stream->close();
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
