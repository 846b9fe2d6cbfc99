#include "tests/conformance/client_peer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "protocol/model/probe_sum.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"
#include "tests/conformance/kit_sea.hpp"
#include "tests/conformance/local_sea.hpp"

namespace trochoid::conformance {

namespace {

// After its goodbye a client has this long to end the stream.
constexpr Milliseconds end_patience{3000};
constexpr int64_t span_us = int64_t{600} * microseconds_per_second;

std::string list_of(const std::vector<Due>& dues) {
    std::string text;
    for (const Due& due : dues)
        text += fmt::format("{}{} (R-{})", text.empty() ? "" : " or ", static_cast<unsigned>(due.code),
                            due.requirement);
    return text;
}

}  // namespace

ClientPeer::ClientPeer(std::unique_ptr<Stream> stream, Milliseconds patience, Trial& trial)
    : patience_(patience),
      trial_(trial),
      stream_(std::move(stream), FrameReader::Opening::magic, Limits{}.frame_before_login) {}

std::optional<ClientMessage> ClientPeer::receive(Milliseconds within) {
    if (phase_ == SessionPhase::closed) return std::nullopt;
    const auto arrived = stream_.next(within);
    if (!arrived) return std::nullopt;
    Result<ClientMessage> message = decode_client(arrived->payload);
    if (!message)
        throw Failed{
            fmt::format("R-{}: the client's message of {} bytes is refused: {}",
                        goodbye_for_payload(message.error(), arrived->payload, client_identifier).requirement,
                        arrived->payload.size(), message.error().message)};
    if (const auto may = expected(phase_, *message); !may)
        throw Failed{fmt::format("R-121: the client's message may not come now: {}", may.error().message)};
    if (const auto ascends = sequences_.accept(*message); !ascends)
        throw Failed{fmt::format("R-125: {}", ascends.error().message)};
    phase_ = phase_after(phase_, *message);
    if (ours_.protocol != 0) conduct_.judge(*message, ours_, arrived->at_us);
    take(*message, arrived->at_us);
    if (answers_) answer(*message, arrived->at_us);
    return std::move(*message);
}

void ClientPeer::take(const ClientMessage& message, int64_t at_us) {
    if (const auto* hello = std::get_if<ClientHello>(&message)) {
        hello_ = *hello;
        view_ = hello->view;
        regions_ = hello->regions;
        stream_.set_longest(Limits{}.frame_after_login);
    } else if (const auto* goodbye = std::get_if<Goodbye>(&message)) {
        goodbye_ = *goodbye;
    } else if (const auto* ack = std::get_if<Ack>(&message)) {
        if (ack->result == 0 || ack->result > result_)
            throw Failed{fmt::format("R-135: result {} is acknowledged, {} are whole", ack->result, result_)};
        acks_.push_back(*ack);
    } else if (const auto* request = std::get_if<ClockRequest>(&message)) {
        clock_requests_.push_back(*request);
        clock_requests_at_us_.push_back(at_us);
    } else if (const auto* update = std::get_if<ViewUpdate>(&message)) {
        view_ = update->view;
    } else if (const auto* discs = std::get_if<SyncRegions>(&message)) {
        regions_ = discs->regions;
    } else if (std::holds_alternative<Desync>(message)) {
        reported_ = true;
    }
}

void ClientPeer::answer(const ClientMessage& message, int64_t at_us) {
    if (const auto* request = std::get_if<ClockRequest>(&message)) return answer_clock(*request, at_us);
    if (const auto* samples = std::get_if<SampleRequest>(&message)) return answer_samples(*samples);
    if (const auto* probe = std::get_if<Probe>(&message)) return answer_probe(*probe);
    const bool moved =
        std::holds_alternative<ViewUpdate>(message) || std::holds_alternative<SyncRegions>(message);
    if (moved && follows_ && result_ > 0) send_result(state_);
    const auto* command = std::get_if<Command>(&message);
    const auto* rays = std::get_if<RaysRequest>(&message);
    if (command == nullptr && rays == nullptr) return;
    CommandReply reply;
    reply.sequence = command != nullptr ? command->sequence : rays->sequence;
    reply.code = ErrorCode::token_required;
    reply.message = "this server only tests its client";
    send(reply);
}

void ClientPeer::answer_clock(const ClockRequest& request, int64_t at_us) {
    ClockReply reply;
    reply.sequence = request.sequence;
    reply.client_sent_us = request.client_sent_us;
    reply.server_received_us = at_us;
    reply.server_sent_us = std::max(at_us, monotonic_us());
    reply.clock = ours_.clock;
    reply.watermark = sea_time_now();
    reply.log_position = {log_length};
    reply.log_hash = log_hash;
    reply.verdict = verdict_;
    if (bend_clock_) bend_clock_(reply);
    send(reply);
}

void ClientPeer::answer_samples(const SampleRequest& request) {
    const SeaInstant instant(local_sea(state_), request.time);
    SampleReply reply;
    reply.sequence = request.sequence;
    reply.time = request.time;
    reply.log_position = {log_length};
    for (const LatticePoint point : request.points) reply.samples.push_back(instant.evaluate(point));
    send(reply);
}

void ClientPeer::answer_probe(const Probe& probe) {
    ProbeReply reply;
    reply.sequence = probe.sequence;
    reply.result = result_;
    reply.time = probe.time;
    reply.stale = probe.result != result_;
    if (!reply.stale)
        for (const LatticePoint point : probe.points) {
            const PointSum sum = probe_sum(state_, probe.time, point);
            ProbedPoint out;
            out.sample = sum.sample;
            for (const PartSum& part : sum.parts) out.parts.push_back({part.box, part.part, part.sum});
            reply.points.push_back(std::move(out));
        }
    if (bend_probe_) bend_probe_(reply);
    send(reply);
}

const ClientHello& ClientPeer::await_hello() {
    constexpr uint32_t slack_ms = 200;  // a machine that is busy delivers later
    if (!receive(Milliseconds(Limits{}.hello_deadline_ms + slack_ms))) {
        if (stream_.state() != Stream::State::open) throw_missing("hello");
        throw Failed{
            fmt::format("R-122: no hello came within {} ms of the connection", Limits{}.hello_deadline_ms)};
    }
    if (!hello_) throw Failed{"R-121: the client's first message is no hello"};
    return *hello_;
}

ServerHello ClientPeer::usual_hello() const {
    ServerHello hello;
    hello.protocol = std::min<uint16_t>(hello_->protocol_max, protocol_version_max);
    hello.model = hello_->model;
    hello.schema_hash = schema_hash();
    hello.software = "trochoid-conformance";
    hello.session = 77;
    hello.world = kit_world;
    hello.instance.bytes.fill(instance_byte);
    hello.log_position = {log_length};
    hello.client_stamp_us = hello_->clock_stamp_us;
    hello.server_now_us = monotonic_us();
    hello.clock.start = kit_sea_begin;
    hello.clock.monotonic_start_us = hello.server_now_us;
    hello.challenge_seed = 0xc0ffee;
    hello.challenge_count = 4;
    return hello;
}

const ServerHello& ClientPeer::welcome(const std::function<void(ServerHello&)>& change) {
    await_hello();
    return welcome_now(change);
}

const ServerHello& ClientPeer::welcome_now(const std::function<void(ServerHello&)>& change) {
    ours_ = usual_hello();
    change(ours_);
    stream_.set_longest(ours_.limits.frame_after_login);
    send(ours_);
    if (ours_.resumed) result_ = 1;
    return ours_;
}

CullKey ClientPeer::key() const {
    CullKey key;
    key.anchor = view_;
    key.slack = 1024;
    key.regions = regions_;
    key.log_position = {log_length};
    key.from = ours_.clock.start;
    key.until = {ours_.clock.start.us + span_us};
    return key;
}

std::vector<Delta> ClientPeer::pieces_to(const InterestState& state, bool snapshot,
                                         size_t piece_bytes) const {
    Delta header;
    header.result = result_ + 1;
    header.base = snapshot ? 0 : result_;
    header.base_hash = header.base == 0 ? 0 : hash_of(state_);
    header.state_hash = hash_of(state);
    header.key = key();
    header.watermark = sea_time_now();
    return split(header, difference(header.base == 0 ? InterestState{} : state_, state), piece_bytes);
}

void ClientPeer::send_result(const InterestState& state, bool snapshot, size_t piece_bytes) {
    for (const Delta& piece : pieces_to(state, snapshot, piece_bytes)) send(piece);
    hold(result_ + 1, state);
}

Ack ClientPeer::await_ack(uint32_t result) {
    const auto wanted = [&](const Ack& ack) { return ack.result == result; };
    const auto found = std::find_if(acks_.begin(), acks_.end(), wanted);
    const Ack ack = found != acks_.end() ? *found : await<Ack>("acknowledgement", wanted);
    if (result == result_ && ack.state_hash != hash_of(state_))
        throw Failed{
            fmt::format("R-133: result {} is acknowledged with the hash {:016x}, the state has {:016x}",
                        result, ack.state_hash, hash_of(state_))};
    return ack;
}

void ClientPeer::listen(Milliseconds span) {
    const Deadline deadline(span);
    while (!deadline.passed() && !goodbye_ && stream_.state() == Stream::State::open)
        receive(deadline.left());
}

void ClientPeer::throw_missing(const char* what) const {
    if (goodbye_)
        throw Failed{fmt::format("no {} came: the client said goodbye with code {}, R-{} ({})", what,
                                 static_cast<unsigned>(goodbye_->code), goodbye_->requirement,
                                 goodbye_->message)};
    if (stream_.state() != Stream::State::open)
        throw Failed{fmt::format("no {} came: the client ended the connection without a goodbye", what)};
    throw Failed{fmt::format("no {} came within {} ms", what, patience_.count())};
}

CloseReport ClientPeer::await_end(int64_t sent_at_us) {
    CloseReport report;
    if (goodbye_) {
        report.goodbye_us = std::max<int64_t>(0, monotonic_us() - sent_at_us);
        report.code = goodbye_->code;
        report.requirement = goodbye_->requirement;
        report.sentence = goodbye_->message;
    }
    // A client may wait for our side to end first.
    stream_.finish();
    const Deadline deadline(end_patience);
    while (stream_.state() == Stream::State::open && !deadline.passed())
        if (stream_.next(deadline.left()) && goodbye_)
            throw Failed{"R-121: a message follows the client's goodbye"};
    switch (stream_.state()) {
        case Stream::State::open: report.verdict = CloseVerdict::left_open; break;
        case Stream::State::reset: report.verdict = CloseVerdict::reset; break;
        case Stream::State::ended:
            report.verdict = goodbye_ ? CloseVerdict::clean : CloseVerdict::no_goodbye;
            break;
    }
    if (stream_.state() != Stream::State::open)
        report.end_us = std::max<int64_t>(0, monotonic_us() - sent_at_us);
    // Whoever has said goodbye ends the stream in its own way, too.
    if (const std::string wrong = stream_.wrong_end(); goodbye_ && !wrong.empty()) throw Failed{wrong};
    return report;
}

Goodbye ClientPeer::expect_goodbye(Due due, const std::vector<Due>& others) {
    std::vector<Due> dues{due};
    dues.insert(dues.end(), others.begin(), others.end());
    const int64_t sent_at_us = stream_.sent_at_us();
    const Deadline deadline(patience_);
    while (!goodbye_ && receive(deadline.left())) {
    }
    const CloseReport close = await_end(sent_at_us);
    trial_.close_seen(close);
    if (!goodbye_) throw Failed{fmt::format("no goodbye came, {} was due", list_of(dues))};
    const auto fits = [&](const Due& it) {
        return it.code == goodbye_->code &&
               (it.requirement == any_due_requirement || it.requirement == goodbye_->requirement);
    };
    if (std::none_of(dues.begin(), dues.end(), fits))
        throw Failed{fmt::format("the goodbye has code {}, R-{} ({}), not {}",
                                 static_cast<unsigned>(goodbye_->code), goodbye_->requirement,
                                 goodbye_->message, list_of(dues))};
    if (goodbye_->message.empty()) throw Failed{"the goodbye has no sentence that says what is wrong"};
    if (close.verdict == CloseVerdict::left_open)
        throw Failed{fmt::format("the stream did not end within {} ms of the goodbye", end_patience.count())};
    return *goodbye_;
}

void ClientPeer::expect_service() {
    send_result(small_sea(), true);
    await_ack(result_);
}

void ClientPeer::expect_goodbye_or_service(const std::vector<Due>& dues) {
    const uint32_t next = result_ + 1;
    send_result(small_sea(), true);
    const Deadline deadline(patience_);
    const auto answered = [&] {
        return std::any_of(acks_.begin(), acks_.end(), [&](const Ack& ack) { return ack.result == next; });
    };
    while (!goodbye_ && !answered() && receive(deadline.left())) {
    }
    if (answered()) {
        await_ack(next);
        trial_.note("the session goes on");
        return;
    }
    expect_goodbye(dues.front(), {dues.begin() + 1, dues.end()});
}

void ClientPeer::expect_end() {
    const int64_t sent_at_us = stream_.sent_at_us();
    const Deadline deadline(end_patience);
    while (!goodbye_ && stream_.state() == Stream::State::open && !deadline.passed())
        receive(deadline.left());
    const CloseReport close = await_end(sent_at_us);
    trial_.close_seen(close);
    if (close.verdict != CloseVerdict::left_open) return;
    const std::string wrong = stream_.wrong_end();
    throw Failed{wrong.empty() ? "the client did not end the connection" : wrong};
}

}  // namespace trochoid::conformance
