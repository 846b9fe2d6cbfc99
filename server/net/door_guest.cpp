#include "server/net/door_guest.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "protocol/units/assert.hpp"
#include "server/net/admitted_transport.hpp"
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

// A TLS alert record: fatal, handshake_failure. Whoever comes with TLS understands that, and nothing else.
constexpr std::array<uint8_t, 7> no_tls_here{0x15, 0x03, 0x03, 0x00, 0x02, 0x02, 0x28};

std::span<const uint8_t> bytes_of(std::string_view text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
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
                (beyond_limit ? beyond_limit_us : int64_t{around.limits.hello_deadline_ms} * 1000)) {}

void Guest::start() { arm_reading(); }

void Guest::arm_reading() {
    transport_->when_readable([weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->on_readable();
    });
}

void Guest::on_readable() {
    for (int i = 0; i < reads_in_a_row && stage_ != Stage::gone; ++i) {
        bool more = false;
        switch (stage_) {
            case Stage::first_bytes: more = take_first_bytes(); break;
            case Stage::head: more = take_head(); break;
            case Stage::answering:
            case Stage::lingering: drop_bytes(); break;
            case Stage::gone: break;
        }
        if (!more) break;
    }
    if (stage_ != Stage::gone) arm_reading();
}

// True: something was read, there may be more.
bool Guest::take_first_bytes() {
    const Transport::Moved moved = transport_->read(std::span(first_).subspan(first_count_));
    if (moved.closed) {
        leave(ErrorCode::client_closed);
        return false;
    }
    watch_handshake();
    if (moved.bytes == 0) {
        if (const auto fault = transport_->fault()) {
            spdlog::debug("connection from {}: {}", transport_->peer(), fault->error.message);
            transport_->finish(fault->error.code);
            linger(fault->error.code);
        }
        return false;
    }
    first_count_ += moved.bytes;
    switch (form_of(std::span(first_).first(first_count_))) {
        case StreamForm::undecided: break;
        case StreamForm::tls:
            if (tls_ == nullptr)
                begin_tls();
            else
                hand_over();  // TLS inside TLS: the session refuses it as no magic
            break;
        case StreamForm::raw: hand_over(); break;
        case StreamForm::http:
            stage_ = Stage::head;
            head_.reserve(longest_http_head);
            head_.assign(first_.begin(), first_.begin() + static_cast<std::ptrdiff_t>(first_count_));
            break;
    }
    return stage_ != Stage::gone;
}

void Guest::begin_tls() {
    if (around_.tls == nullptr) {
        refuse_tls();
        return;
    }
    if (beyond_limit_ || around_.stats.handshakes_now >= around_.policy.handshakes) {
        leave(ErrorCode::too_many_connections);
        return;
    }
    auto plain = give_back(around_.loop, std::move(transport_), std::span(first_).first(first_count_),
                           std::move(place_));
    first_count_ = 0;
    auto tls = make_tls_transport(around_.loop, *around_.tls, std::move(plain));
    tls_ = tls.get();
    transport_ = std::move(tls);
    handshaking_ = true;
    ++around_.stats.handshakes_now;
}

void Guest::refuse_tls() {
    spdlog::debug("connection from {}: TLS, but this server has no certificate", transport_->peer());
    transport_->write(no_tls_here);
    transport_->finish(ErrorCode::wrong_magic);
    linger(ErrorCode::wrong_magic);
}

void Guest::watch_handshake() {
    if (handshaking_ && tls_->established()) end_handshake(true);
}

void Guest::end_handshake(bool done) {
    if (!std::exchange(handshaking_, false)) return;
    --around_.stats.handshakes_now;
    ++(done ? around_.stats.handshakes : around_.stats.handshakes_failed);
}

// The stream is raw, whatever follows.
void Guest::hand_over() {
    const bool encrypted = tls_ != nullptr;
    if (beyond_limit_) {
        turn_away({ErrorCode::too_many_connections,
                   "too many connections from this address: close some, or connect again later"});
    } else if (around_.policy.needs_encryption(address_, encrypted)) {
        turn_away({ErrorCode::encryption_required,
                   "this server wants TLS from other machines: connect with tls://HOST:PORT"});
    } else {
        ++(encrypted ? around_.stats.raw_over_tls : around_.stats.raw);
        around_.sessions.accept(give_back(around_.loop, std::move(transport_),
                                          std::span(first_).first(first_count_), std::move(place_)),
                                started_us_);
        out();
    }
}

void Guest::turn_away(const Error& why) {
    around_.sessions.turn_away(give_back(around_.loop, std::move(transport_),
                                         std::span(first_).first(first_count_), std::move(place_)),
                               why, started_us_);
    out();
}

bool Guest::take_head() {
    const auto buffer = around_.read_buffer.first(head_step);
    const Transport::Moved moved = transport_->read(buffer);
    if (moved.closed || transport_->fault()) {
        leave(ErrorCode::client_closed);
        return false;
    }
    head_.append(reinterpret_cast<const char*>(buffer.data()), moved.bytes);
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

void Guest::upgrade(const HttpRequest& request, std::span<const uint8_t> rest) {
    const bool encrypted = tls_ != nullptr;
    auto websocket = make_websocket_transport(
        around_.loop, request, give_back(around_.loop, std::move(transport_), rest, std::move(place_)),
        around_.limits.frame_before_login);
    if (around_.policy.needs_encryption(address_, encrypted)) {
        around_.sessions.turn_away(
            std::move(websocket),
            {ErrorCode::encryption_required,
             "this server wants TLS from other machines: connect with wss://HOST:PORT"},
            started_us_);
    } else {
        ++(encrypted ? around_.stats.websocket_over_tls : around_.stats.websocket);
        around_.sessions.accept(std::move(websocket), started_us_);
    }
    out();
}

void Guest::answer(const HttpAnswer& what, bool head_only) {
    ++around_.stats.http_answers[what.status];
    if (beyond_limit_) around_.sessions.count_end(ErrorCode::too_many_connections);
    head_ = {};
    answer_ = text_of(what, head_only);
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
    stage_ = Stage::lingering;
    transport_->finish(ErrorCode::none);
}

// Refused by code; what was written goes out before the connection is closed, and what still comes is dropped.
void Guest::linger(ErrorCode code) {
    around_.sessions.count_end(code);
    end_handshake(false);
    stage_ = Stage::lingering;
    until_us_ = monotonic_us() + linger_us;
}

void Guest::drop_bytes() {
    if (transport_->read(around_.read_buffer).closed) out();
}

void Guest::leave(ErrorCode code) {
    if (stage_ == Stage::gone) return;
    // What has been answered or refused is counted already.
    if (stage_ == Stage::first_bytes || stage_ == Stage::head) around_.sessions.count_end(code);
    out();
}

void Guest::sweep(int64_t now_us) {
    if (stage_ == Stage::gone || now_us < until_us_) return;
    const bool can_be_told = stage_ == Stage::first_bytes && !handshaking_ && !beyond_limit_;
    if (can_be_told)
        turn_away(
            {ErrorCode::hello_deadline, fmt::format("no hello within {} ms: send it right after connecting",
                                                    around_.limits.hello_deadline_ms)});
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
