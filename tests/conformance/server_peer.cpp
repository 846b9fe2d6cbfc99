#include "tests/conformance/server_peer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"

namespace trochoid::conformance {

namespace {

// After its goodbye a server has this long to end the stream; without one its end is due already.
constexpr Milliseconds end_patience{3000};
constexpr Milliseconds overdue_patience{300};

}  // namespace

ServerPeer::ServerPeer(const Target& target, Trial& trial, Way way)
    : target_(target),
      trial_(trial),
      stream_(stream_by(target.server, way, target.patience), FrameReader::Opening::frames,
              Limits{}.frame_to_client) {}

ClientHello ServerPeer::usual_hello() {
    ClientHello hello;
    hello.protocol_min = protocol_version_min;
    hello.protocol_max = protocol_version_max;
    hello.model = model_version;
    hello.schema_hash = schema_hash();
    hello.software = "trochoid-conformance";
    hello.view = view_of_sky();
    hello.clock_stamp_us = monotonic_us();
    return hello;
}

const ServerHello& ServerPeer::log_in(const ClientHello& hello) {
    if (!send_magic() || !send(hello)) throw Failed{"the server took no hello"};
    const Deadline deadline(target_.patience);
    const auto first = receive(deadline.left());
    if (!first) throw_missing("hello");
    if (goodbye_)
        throw Failed{fmt::format("the server refused a login: {} ({})", static_cast<unsigned>(goodbye_->code),
                                 goodbye_->message)};
    if (hello_->client_stamp_us != hello.clock_stamp_us)
        throw Failed{fmt::format("R-142: the hello echoes the stamp {}, not {}", hello_->client_stamp_us,
                                 hello.clock_stamp_us)};
    return *hello_;
}

const ServerHello& ServerPeer::log_in_as(Role role, ClientHello hello) {
    hello.token = target_.tokens.token(role, target_.hello.world);
    log_in(hello);
    if (hello_->role == Role::viewer || (role == Role::admin && hello_->role != Role::admin))
        throw Skipped{"the token given does not allow it: --sign-with"};
    return *hello_;
}

std::optional<ServerMessage> ServerPeer::receive(Milliseconds within) {
    if (phase_ == SessionPhase::closed) return std::nullopt;
    const auto arrived = stream_.next(within);
    if (!arrived) return std::nullopt;
    Result<ServerMessage> message = decode_server(arrived->payload);
    if (!message)
        throw Failed{fmt::format("R-{}: the server's message of {} bytes is refused: {}",
                                 requirement_of(message.error().code), arrived->payload.size(),
                                 message.error().message)};
    if (hello_ && hello_->protocol < 3 && std::holds_alternative<ProbeReply>(*message))
        throw Failed{"R-175: a message of version 3 comes in a session of version 2"};
    if (const auto may = expected(phase_, *message); !may)
        throw Failed{fmt::format("R-121: the server's message may not come now: {}", may.error().message)};
    phase_ = phase_after(phase_, *message);
    take(*message);
    if (watcher_) watcher_(*message, arrived->at_us);
    return std::move(*message);
}

void ServerPeer::take(const ServerMessage& message) {
    if (const auto* hello = std::get_if<ServerHello>(&message)) {
        hello_ = *hello;
        stream_.set_longest(hello->limits.frame_to_client);
        if (hello->resumed) {
            if (!offered_) throw Failed{"R-158: the server goes on with a state that was not offered"};
            held_.adopt(*offered_);
        }
    } else if (const auto* goodbye = std::get_if<Goodbye>(&message)) {
        goodbye_ = *goodbye;
    } else if (const auto* piece = std::get_if<Delta>(&message)) {
        if (held_.take(*piece) && acknowledges_) acknowledge();
    } else if (const auto* clock = std::get_if<ClockReply>(&message)) {
        take_clock(*clock);
    }
}

void ServerPeer::take_clock(const ClockReply& reply) {
    const auto require = [](bool holds, const char* sentence) {
        if (!holds) throw Failed{std::string("R-142: ") + sentence};
    };
    require(reply.server_received_us <= reply.server_sent_us,
            "a clock reply was sent (t2) before its request was received (t1)");
    if (last_clock_) {
        require(reply.server_received_us >= last_clock_->server_received_us,
                "the server's monotonic clock stepped back between two replies");
        if (reply.watermark < last_clock_->watermark)
            throw Failed{fmt::format("R-144: the watermark fell from {} to {}", last_clock_->watermark.us,
                                     reply.watermark.us)};
        if (reply.clock.epoch < last_clock_->clock.epoch ||
            (reply.clock.epoch == last_clock_->clock.epoch && reply.clock != last_clock_->clock))
            throw Failed{fmt::format("R-142: the clock changed without a new epoch (epoch {} after {})",
                                     reply.clock.epoch, last_clock_->clock.epoch)};
        if (reply.log_position < last_clock_->log_position ||
            (reply.log_position == last_clock_->log_position && reply.log_hash != last_clock_->log_hash))
            throw Failed{fmt::format("R-144: the log at position {} has another hash, or fell from {}",
                                     reply.log_position.value, last_clock_->log_position.value)};
    }
    last_clock_ = reply;
}

void ServerPeer::acknowledge(std::optional<uint64_t> hash) {
    Ack ack;
    ack.result = held_.result();
    ack.state_hash = hash.value_or(held_.hash());
    if (!answered_) ack.known_answer = known_answer_;
    answered_ = true;
    send(ack);
}

const Delta& ServerPeer::await_result(uint32_t after) {
    const Deadline deadline(target_.patience);
    while (!held_.last() || held_.last()->result <= after)
        if (!receive(deadline.left())) throw_missing("result");
    return *held_.last();
}

void ServerPeer::settle(Milliseconds quiet) {
    const Deadline deadline(target_.patience);
    while (!deadline.passed() && receive(quiet)) {
    }
}

ClockReply ServerPeer::ask_clock() {
    ClockRequest request;
    request.sequence = next_sequence();
    request.client_sent_us = monotonic_us();
    send(request);
    const auto reply =
        await<ClockReply>("clock reply", [&](const ClockReply& r) { return r.sequence == request.sequence; });
    if (reply.client_sent_us != request.client_sent_us)
        throw Failed{fmt::format("R-142: a clock reply echoes {}, not {}", reply.client_sent_us,
                                 request.client_sent_us)};
    return reply;
}

CommandReply ServerPeer::ask(Command command) {
    command.sequence = next_sequence();
    send(command);
    return await<CommandReply>("reply to a command",
                               [&](const CommandReply& r) { return r.sequence == command.sequence; });
}

BoxList ServerPeer::ask_boxes() {
    Command command;
    command.sequence = next_sequence();
    command.action = ListBoxes{};
    send(command);
    BoxList list;
    list.last = false;
    while (!list.last) {
        const auto piece =
            await<BoxList>("list of boxes", [&](const BoxList& l) { return l.sequence == command.sequence; });
        list.sequence = piece.sequence;
        list.now = piece.now;
        list.last = piece.last;
        list.boxes.insert(list.boxes.end(), piece.boxes.begin(), piece.boxes.end());
    }
    return list;
}

SampleReply ServerPeer::ask_samples(SeaTime time, std::vector<LatticePoint> points) {
    SampleRequest request;
    request.sequence = next_sequence();
    request.time = time;
    request.points = std::move(points);
    send(request);
    auto reply = await<SampleReply>("sample reply",
                                    [&](const SampleReply& r) { return r.sequence == request.sequence; });
    if (reply.time != time || reply.samples.size() != request.points.size())
        throw Failed{fmt::format("a sample reply has {} samples at {} us, but {} at {} us were asked for",
                                 reply.samples.size(), reply.time.us, request.points.size(), time.us)};
    return reply;
}

uint16_t ServerPeer::requirement_for(ErrorCode code) { return requirement_of(code); }

void ServerPeer::throw_missing(const char* what) const {
    if (goodbye_)
        throw Failed{fmt::format("no {} came: the server said goodbye with code {} ({})", what,
                                 static_cast<unsigned>(goodbye_->code), goodbye_->message)};
    if (stream_.state() != Stream::State::open)
        throw Failed{fmt::format("no {} came: the server ended the connection without a goodbye", what)};
    throw Failed{fmt::format("no {} came within {} ms", what, target_.patience.count())};
}

CloseReport ServerPeer::await_end(int64_t sent_at_us) {
    CloseReport report;
    if (goodbye_) {
        report.goodbye_us = std::max<int64_t>(0, monotonic_us() - sent_at_us);
        report.code = goodbye_->code;
        report.requirement = goodbye_->requirement;
        report.sentence = goodbye_->message;
    }
    const Deadline deadline(goodbye_ ? end_patience : overdue_patience);
    while (stream_.next(deadline.left()))
        if (goodbye_) throw Failed{"R-121: a message follows the server's goodbye"};
    switch (stream_.state()) {
        case Stream::State::open: report.verdict = CloseVerdict::left_open; break;
        case Stream::State::reset: report.verdict = CloseVerdict::reset; break;
        case Stream::State::ended:
            report.verdict = goodbye_ ? CloseVerdict::clean : CloseVerdict::no_goodbye;
            break;
    }
    if (stream_.state() != Stream::State::open)
        report.end_us = std::max<int64_t>(0, monotonic_us() - sent_at_us);
    return report;
}

Goodbye ServerPeer::expect_goodbye(ErrorCode code, uint16_t requirement, std::vector<ErrorCode> codes) {
    const int64_t sent_at_us = stream_.sent_at_us();
    const Deadline deadline(target_.patience);
    while (!goodbye_ && receive(deadline.left())) {
    }
    const CloseReport close = await_end(sent_at_us);
    trial_.close_seen(close);
    if (!goodbye_)
        throw Failed{fmt::format("no goodbye came, {} (code {}) was due", static_cast<unsigned>(code),
                                 error_class(code))};
    const bool other = std::find(codes.begin(), codes.end(), goodbye_->code) != codes.end();
    if (goodbye_->code != code && !other)
        throw Failed{fmt::format("the goodbye has code {} ({}), not {}",
                                 static_cast<unsigned>(goodbye_->code), goodbye_->message,
                                 static_cast<unsigned>(code))};
    if (!other && requirement != any_requirement && goodbye_->requirement != requirement)
        throw Failed{
            fmt::format("the goodbye names requirement {}, not {}", goodbye_->requirement, requirement)};
    if (goodbye_->message.empty()) throw Failed{"the goodbye has no sentence that says what to do"};
    if (close.verdict == CloseVerdict::left_open)
        throw Failed{fmt::format("the stream did not end within {} ms of the goodbye", end_patience.count())};
    return *goodbye_;
}

void ServerPeer::expect_service() { ask_clock(); }

void ServerPeer::expect_silent_end() {
    const int64_t sent_at_us = stream_.sent_at_us();
    const Deadline deadline(end_patience);
    while (!goodbye_ && receive(deadline.left())) {
    }
    const CloseReport close = await_end(sent_at_us);
    trial_.close_seen(close);
    if (goodbye_)
        throw Failed{fmt::format("a goodbye came (code {}), but there is nobody to say it to",
                                 static_cast<unsigned>(goodbye_->code))};
    if (close.verdict == CloseVerdict::left_open) throw Failed{"the server did not end the connection"};
}

}  // namespace trochoid::conformance
