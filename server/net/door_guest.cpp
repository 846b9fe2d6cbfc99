#include "server/net/door_guest.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "protocol/wire/session_rules.hpp"
#include "server/net/admitted_transport.hpp"
#include "server/net/farewell.hpp"
#include "server/net/http_rules.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/websocket_transport.hpp"

namespace trochoid {

namespace {

// Who has been answered, or refused, gets this long to take it and close.
constexpr int64_t linger_us = 2 * microseconds_per_second;
// Who is beyond its address's limit gets this long to show what it is.
constexpr int64_t beyond_limit_us = microseconds_per_second;
// Reads in one go before others get their turn.
constexpr int reads_in_a_row = 4;
// Bytes of a head taken at once.
constexpr size_t head_step = 1024;

// TLS alert records: fatal, handshake_failure and decode_error. Whoever comes with TLS understands those, and nothing else.
constexpr std::string_view no_tls_here("\x15\x03\x03\x00\x02\x02\x28", 7);
constexpr std::string_view no_tls_hello("\x15\x03\x03\x00\x02\x02\x32", 7);

std::span<const uint8_t> bytes_of(std::string_view text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

std::string text_of(std::span<const uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Guest::Guest(DoorSurroundings& around, uint64_t id, std::unique_ptr<Transport> transport,
             std::shared_ptr<void> place, bool beyond_limit)
    : around_(around),
      id_(id),
      transport_(std::move(transport)),
      place_(std::move(place)),
      address_(peer_address(transport_->peer())),
      beyond_limit_(beyond_limit),
      started_us_(monotonic_us()),
      until_us_(started_us_ +
                (beyond_limit ? beyond_limit_us : int64_t{around.limits.hello_deadline_ms} * 1000)),
      frames_(FrameReader::Opening::magic, around.limits.frame_before_login) {}

void Guest::start() { arm_reading(); }

void Guest::arm_reading() {
    transport_->when_readable([weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->on_readable();
    });
}

void Guest::on_readable() {
    bool more = true;
    for (int i = 0; i < reads_in_a_row && more; ++i) {
        more = false;
        switch (stage_) {
            case Stage::first_bytes: more = take_first_bytes(); break;
            case Stage::tls_hello: more = take_tls_hello(); break;
            case Stage::head: more = take_head(); break;
            case Stage::first_frame: more = take_first_frame(); break;
            case Stage::answering:
            case Stage::lingering: drop_bytes(); break;
            case Stage::tls_turn:
            case Stage::gone: break;
        }
    }
    const bool reads_on = stage_ != Stage::gone && stage_ != Stage::tls_turn && !peer_done_;
    if (reads_on && dropped_bytes_ < most_dropped_bytes) arm_reading();
}

// Bytes of the stream, which may be at its end or broken: then none, and the guest has been dealt with.
Transport::Moved Guest::read(std::span<uint8_t> into) {
    // A WebSocket's fault first: whoever asks for it has been told.
    if (const auto fault = transport_->fault()) {
        on_fault(*fault);
        return {};
    }
    const bool shaking = handshaking_;
    const int64_t begun_us = shaking ? monotonic_us() : 0;
    const Transport::Moved moved = transport_->read(into);
    watch_handshake();
    if (shaking) around_.handshake_us += monotonic_us() - begun_us + 1;
    if (moved.closed) {
        leave(ErrorCode::client_closed);
    } else if (moved.bytes == 0) {
        if (const auto fault = transport_->fault()) on_fault(*fault);
    }
    return moved;
}

// Where the stream can still carry it (a WebSocket), the goodbye says what was wrong.
void Guest::on_fault(const StreamFault& fault) {
    if (web_) {
        Goodbye goodbye = goodbye_for(fault.error);
        if (fault.requirement != 0) goodbye.requirement = fault.requirement;
        part(std::move(goodbye));
        return;
    }
    spdlog::debug("connection from {}: {}", transport_->peer(), fault.error.message);
    transport_->finish(fault.error.code);
    linger(fault.error.code);
}

// True, here and below: something was read, there may be more.
bool Guest::take_first_bytes() {
    const Transport::Moved moved = read(std::span(first_).subspan(first_count_));
    if (moved.bytes == 0) return false;
    first_count_ += moved.bytes;
    const auto first = std::span(first_).first(first_count_);
    switch (form_of(first)) {
        case StreamForm::undecided: break;
        case StreamForm::tls:
            if (tls_ != nullptr) {
                begin_frame();  // TLS inside TLS is no magic
            } else if (around_.tls == nullptr) {
                spdlog::debug("connection from {}: TLS, but this server has no certificate",
                              transport_->peer());
                refuse_tls(ErrorCode::wrong_magic);
            } else if (beyond_limit_) {
                leave(ErrorCode::too_many_connections);
            } else {
                stage_ = Stage::tls_hello;
                head_ = text_of(first);
            }
            break;
        case StreamForm::raw: begin_frame(); break;
        case StreamForm::http:
            stage_ = Stage::head;
            head_.reserve(longest_http_head);
            head_ += text_of(first);
            break;
    }
    return stage_ != Stage::gone;
}

bool Guest::take_tls_hello() {
    for (int reads = 0;; ++reads) {
        const bool known = head_.size() >= tls_hello_begin;
        const size_t wanted =
            known ? tls_hello_bytes(bytes_of(head_).first<tls_hello_begin>()) : tls_hello_begin;
        if (wanted == 0) {
            refuse_tls(ErrorCode::malformed_frame);
            return false;
        }
        // As soon as it is whole: nothing more comes before an answer.
        if (known && head_.size() == wanted) {
            stage_ = Stage::tls_turn;
            around_.wants_handshake(id_);
            return false;
        }
        if (reads == reads_in_a_row) return false;
        head_.reserve(wanted);
        const auto buffer = around_.read_buffer.first(std::min(wanted - head_.size(), head_step));
        const Transport::Moved moved = read(buffer);
        if (moved.bytes == 0) return false;
        head_.append(text_of(buffer.first(moved.bytes)));
    }
}

void Guest::begin_tls() {
    if (stage_ != Stage::tls_turn) return;
    const std::string hello = std::exchange(head_, {});
    auto plain = give_back(around_.loop, std::move(transport_), bytes_of(hello), std::move(place_));
    auto tls = make_tls_transport(around_.loop, *around_.tls, std::move(plain));
    tls_ = tls.get();
    transport_ = std::move(tls);
    first_count_ = 0;
    stage_ = Stage::first_bytes;
    handshaking_ = true;
    ++around_.stats.handshakes_now;
    on_readable();
}

void Guest::refuse_tls(ErrorCode code) {
    around_.sessions.count_end(code);
    say(std::string(code == ErrorCode::wrong_magic ? no_tls_here : no_tls_hello), code);
}

void Guest::watch_handshake() {
    if (handshaking_ && tls_->established()) end_handshake(true);
}

void Guest::end_handshake(bool done) {
    if (!std::exchange(handshaking_, false)) return;
    --around_.stats.handshakes_now;
    ++(done ? around_.stats.handshakes : around_.stats.handshakes_failed);
    around_.handshake_over(id_);
}

// The stream is raw, whatever follows: it is a session's with its first frame.
void Guest::begin_frame() {
    stage_ = Stage::first_frame;
    if (beyond_limit_) {
        part(Error{ErrorCode::too_many_connections,
                   "too many connections from this address: close some, or connect again later"});
    } else if (around_.policy.needs_encryption(address_, tls_ != nullptr)) {
        part(Error{ErrorCode::encryption_required,
                   web_ ? "this server wants TLS from other machines: connect with wss://HOST:PORT"
                        : "this server wants TLS from other machines: connect with tls://HOST:PORT"});
    } else {
        judge_frame(std::span(first_).first(first_count_));
    }
}

bool Guest::take_first_frame() {
    const auto buffer = around_.read_buffer.first(head_step);
    const Transport::Moved moved = read(buffer);
    if (moved.bytes == 0) return false;
    return judge_frame(buffer.first(moved.bytes));
}

// True: more is needed.
bool Guest::judge_frame(std::span<const uint8_t> bytes) {
    const Result<std::optional<Bytes>> payload = frames_.next(bytes);
    if (!payload) {
        part(payload.error());
        return false;
    }
    if (!payload->has_value()) return true;
    hand_over(**payload, bytes);
    return false;
}

void Guest::hand_over(const Bytes& payload, std::span<const uint8_t> rest) {
    Bytes begin(stream_magic.begin(), stream_magic.end());
    const Bytes framed = frame(payload);
    begin.insert(begin.end(), framed.begin(), framed.end());
    begin.insert(begin.end(), rest.begin(), rest.end());
    const bool encrypted = tls_ != nullptr;
    DoorStats& stats = around_.stats;
    ++(web_ ? (encrypted ? stats.websocket_over_tls : stats.websocket)
            : (encrypted ? stats.raw_over_tls : stats.raw));
    around_.sessions.accept(give_back(around_.loop, std::move(transport_), begin, std::move(place_)),
                            started_us_);
    out();
}

void Guest::part(const Error& why) {
    const bool later = why.code == ErrorCode::too_many_connections || why.code == ErrorCode::shutting_down;
    part(later ? farewell(why, id_) : goodbye_for(why));
}

void Guest::part(Goodbye goodbye) {
    spdlog::debug("connection from {}: {} {}", transport_->peer(), static_cast<unsigned>(goodbye.code),
                  goodbye.message);
    around_.sessions.count_end(goodbye.code);
    const ErrorCode code = goodbye.code;
    say(text_of(frame(encode(ServerMessage{std::move(goodbye)}))), code);
}

bool Guest::take_head() {
    const auto buffer = around_.read_buffer.first(head_step);
    const Transport::Moved moved = read(buffer);
    if (stage_ != Stage::head) return false;
    head_.append(text_of(buffer.first(moved.bytes)));
    const size_t end = head_.find("\r\n\r\n", head_searched_);
    head_searched_ = head_.size() < 3 ? 0 : head_.size() - 3;
    if (end == std::string::npos) {
        if (head_.size() > longest_http_head) {
            answer(sentence(431, fmt::format("A head may have {} bytes.", longest_http_head)), false);
            return false;
        }
        return moved.bytes > 0;
    }
    const std::string whole = std::exchange(head_, {});
    const size_t length = end + 4;
    const auto head = read_http_head(std::string_view(whole).substr(0, length));
    if (const auto* refusal = std::get_if<HttpRefusal>(&head))
        answer(sentence(refusal->status, refusal->message), false);
    else
        on_request(std::get<HttpRequest>(head), bytes_of(std::string_view(whole).substr(length)));
    return false;
}

void Guest::on_request(const HttpRequest& request, std::span<const uint8_t> rest) {
    const bool encrypt = around_.policy.needs_encryption(address_, tls_ != nullptr);
    const HttpSituation situation{around_.policy, around_.ready, around_.draining, encrypt, beyond_limit_};
    if (const auto what = http_answer_to(request, situation)) {
        answer(*what, request.method == "HEAD");
    } else if (asks_for_metrics(request)) {
        HttpAnswer metrics{200, around_.metrics(), {}, "text/plain; version=0.0.4; charset=utf-8"};
        answer(metrics, request.method == "HEAD");
    } else {
        upgrade(request, rest);
    }
}

// From here on it looks like a raw stream.
void Guest::upgrade(const HttpRequest& request, std::span<const uint8_t> rest) {
    transport_ = make_websocket_transport(
        around_.loop, request, give_back(around_.loop, std::move(transport_), rest, std::move(place_)),
        around_.limits.frame_before_login);
    web_ = true;
    first_count_ = 0;
    begin_frame();
}

void Guest::answer(const HttpAnswer& what, bool head_only) {
    ++around_.stats.http_answers[what.status];
    if (beyond_limit_) around_.sessions.count_end(ErrorCode::too_many_connections);
    say(text_of(what, head_only), ErrorCode::none);
}

// The last that it is told; what still comes is dropped.
void Guest::say(std::string bytes, ErrorCode finish_with) {
    end_handshake(false);
    head_ = {};
    answer_ = std::move(bytes);
    finish_with_ = finish_with;
    stage_ = Stage::answering;
    until_us_ = monotonic_us() + linger_us;
    on_writable();
}

void Guest::on_writable() {
    while (stage_ == Stage::answering && answer_taken_ < answer_.size()) {
        const Transport::Moved moved = transport_->write(bytes_of(answer_).subspan(answer_taken_));
        if (moved.closed) {
            out();
            return;
        }
        if (moved.bytes == 0) {
            transport_->when_writable([weak = weak_from_this()] {
                if (const auto self = weak.lock()) self->on_writable();
            });
            return;
        }
        answer_taken_ += moved.bytes;
    }
    if (stage_ != Stage::answering) return;
    answer_ = {};
    stage_ = Stage::lingering;
    transport_->finish(finish_with_);
    if (peer_done_) out();
}

// Refused by code; what was written goes out before the connection is closed, and what still comes is dropped.
void Guest::linger(ErrorCode code) {
    around_.sessions.count_end(code);
    end_handshake(false);
    stage_ = Stage::lingering;
    until_us_ = monotonic_us() + linger_us;
}

// Who says no more (a half-closed stream) still gets the answer whole: it only reads no further.
void Guest::drop_bytes() {
    const Transport::Moved moved = transport_->read(around_.read_buffer);
    // What a form swallows counts as a whole read.
    dropped_bytes_ += moved.bytes > 0 ? moved.bytes : around_.read_buffer.size();
    if (!moved.closed) return;
    if (stage_ == Stage::answering)
        peer_done_ = true;
    else
        out();
}

void Guest::leave(ErrorCode code) {
    if (stage_ == Stage::gone) return;
    const bool counted = stage_ == Stage::answering || stage_ == Stage::lingering;
    if (!counted) around_.sessions.count_end(code);
    out();
}

void Guest::shut_out() {
    if (stage_ == Stage::first_frame)
        part(shutting_down());
    else
        leave(ErrorCode::shutting_down);
}

void Guest::sweep(int64_t now_us) {
    if (stage_ == Stage::gone || now_us < until_us_) return;
    const bool can_be_told = stage_ == Stage::first_frame || (stage_ == Stage::first_bytes && !handshaking_);
    if (can_be_told && !beyond_limit_)
        part(hello_came_late(around_.limits));
    else if (stage_ == Stage::head && !beyond_limit_)
        answer(sentence(408, "The request did not come in time."), false);
    else
        leave(beyond_limit_ ? ErrorCode::too_many_connections : ErrorCode::hello_deadline);
}

void Guest::out() {
    if (stage_ == Stage::gone) return;
    stage_ = Stage::gone;
    end_handshake(false);
    if (transport_) transport_->close();
    around_.left(id_);
}

}  // namespace trochoid
