#include "client/app/session_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"

namespace trochoid {

namespace {

constexpr int clock_burst = 8;
constexpr std::chrono::milliseconds clock_burst_interval{50};
constexpr std::chrono::milliseconds clock_interval{2000};
/// While an event may be about to change the clock.
constexpr std::chrono::milliseconds clock_watch_interval{100};
constexpr int64_t longest_watch_us = 10'000'000;
/// A server that says nothing for this long, though it is asked for its clock, is gone.
constexpr int64_t longest_silence_us = 8'000'000;
constexpr int64_t view_interval_us = 100'000;
constexpr int64_t steady_after_us = 5'000'000;
constexpr int64_t first_pause_ms = 500;
constexpr int64_t longest_pause_ms = 10'000;

/// Whether this build computes the normative sea; shown until a clock reply brings the server's own verdict.
Fidelity own_fidelity() {
    static const Fidelity fidelity = [] {
        try {
            self_check();
            return Fidelity::exact;
        } catch (const OperatorError&) {
            return Fidelity::approximate;
        }
    }();
    return fidelity;
}

/// 0.5 s, doubling up to 10 s, each a quarter more or less so that clients do not come all at once.
int64_t pause_ms(uint32_t failures) {
    const int64_t pause = std::min(longest_pause_ms, first_pause_ms << std::min(failures, 10U));
    const auto dice = static_cast<int64_t>(splitmix64(static_cast<uint64_t>(client_monotonic_us())) % 512);
    return pause * (768 + dice) / 1024;
}

/// Results out of order break another requirement than messages of a client do.
uint16_t requirement_of_result(ErrorCode code) {
    return code == ErrorCode::sequence_not_monotone ? requirement::result_order : requirement_of(code);
}

uint32_t sequence_of_answer(const ServerMessage& message) {
    return std::visit(
        [](const auto& m) -> uint32_t {
            if constexpr (requires { m.sequence; })
                return m.sequence;
            else
                return 0;
        },
        message);
}

}  // namespace

SessionLink::SessionLink(NetLoop& loop, SessionBoard& board, const SessionOptions& options)
    : loop_(loop), board_(board), options_(options) {}

ClientHello SessionLink::hello_now() {
    ClientHello hello;
    hello.protocol_min = protocol_version_min;
    hello.protocol_max = protocol_version_max;
    hello.model = model_version;
    hello.schema_hash = schema_hash();
    hello.software = options_.software;
    hello.world = options_.world;
    const int64_t now_us = client_monotonic_us();
    ticket_shown_ = !ticket_.empty() && now_us < ticket_until_us_ && keeps_secrets(options_.server);
    if (ticket_shown_) hello.ticket = ticket_;
    // Where the ticket counts no more, the token does; where it does, the token stays unused.
    if (options_.fresh_token && keeps_secrets(options_.server)) hello.token = options_.fresh_token();
    hello.capabilities = capability_probes | capability_resume;
    hello.last_code = last_code_;
    hello.resume = store_.resume_state();
    resume_asked_ = hello.resume.has_value();
    if (hello.resume) {
        hello.resume->log_position = told_position_;
        hello.resume->log_hash = told_log_hash_;
    }
    {
        const std::lock_guard lock(board_.mutex);
        hello.view = told_view_ = board_.view;
        hello.regions = told_regions_ = board_.regions;
    }
    hello.clock_stamp_us = client_monotonic_us();
    return hello;
}

void SessionLink::connect() {
    loop_.assert_here();
    if (ending_) return;
    live_ = false;
    given_up_.reset();
    {
        const std::lock_guard lock(board_.mutex);
        board_.state = LinkState::connecting;
        board_.changed();
    }
    auto connection = Connection::open(
        loop_, options_.server,
        {[this] { connection_->send(hello_now()); },
         [this](ServerMessage message, int64_t received_us) { receive(std::move(message), received_us); },
         [this](const Goodbye& goodbye, CloseCause cause) { closed(goodbye, cause); }});
    const std::lock_guard lock(board_.mutex);
    connection_ = std::move(connection);
}

void SessionLink::end() {
    ending_ = true;
    Goodbye goodbye;
    goodbye.message = "done";
    if (connection_)
        connection_->close(goodbye);
    else
        closed(goodbye, CloseCause::closed_here);
}

void SessionLink::receive(ServerMessage message, int64_t received_us) {
    heard_us_ = received_us;
    if (const auto* hello = std::get_if<ServerHello>(&message)) return on(*hello, received_us);
    if (const auto* reply = std::get_if<ClockReply>(&message)) return on(*reply, received_us);
    if (const auto* delta = std::get_if<Delta>(&message)) return on(*delta, received_us);
    if (const auto* tiles = std::get_if<TerrainTiles>(&message)) return on(*tiles, received_us);
    answer(sequence_of_answer(message), message);
}

void SessionLink::on(const ServerHello& hello, int64_t received_us) {
    if (hello.resumed && !resume_asked_)
        return connection_->refuse(
            {ErrorCode::unexpected_message, "the server resumes a session that was not asked for"},
            requirement::resumed_state);
    live_ = true;
    live_since_us_ = received_us;
    if (!store_.hello() || store_.hello()->instance != hello.instance) {
        told_position_ = {};
        told_log_hash_ = empty_log;
    }
    store_.begin(hello);
    last_code_ = ErrorCode::none;
    ticket_ = hello.ticket;
    ticket_until_us_ = received_us + int64_t{hello.ticket_life_ms} * 1000;
    probe_round_ = 0;
    known_answer_ = reference_hash(hello.challenge_seed, hello.challenge_count);
    {
        const std::lock_guard lock(board_.mutex);
        board_.hello = std::make_shared<ServerHello>(hello);
        board_.clock.begin(hello, received_us);
        board_.state = LinkState::live;
        board_.fidelity = own_fidelity();
        ++board_.connections;
    }
    show_store();
    // What changed while the hellos were under way.
    view_changed();
    regions_changed();
    log_position_ = hello.log_position;
    watch_clock_until_us_ = 0;
    ask_clock(++clock_row_, 0);
}

/// An event has come. It may be a new rate of time, which takes hold up to the server's lead later: the clock is asked
/// often until then, or shown time would run wrong until the next regular exchange.
void SessionLink::log_grew(LogPosition position) {
    log_position_ = position;
    const int64_t lead_us = int64_t{store_.hello()->limits.command_lead_ms} * 1000;
    watch_clock_until_us_ = client_monotonic_us() + std::min(lead_us, longest_watch_us) +
                            2 * clock_watch_interval / std::chrono::microseconds(1);
    ask_clock(++clock_row_, std::min(clock_done_ + 1, clock_burst));
}

void SessionLink::ask_clock(uint64_t row, int done) {
    if (row != clock_row_ || !live_) return;
    clock_done_ = done;
    const int64_t now_us = client_monotonic_us();
    if (now_us - heard_us_ > longest_silence_us) {
        given_up_ = fmt::format("the server at {} has said nothing for {} s", to_text(options_.server),
                                longest_silence_us / 1'000'000);
        Goodbye goodbye;
        goodbye.code = ErrorCode::no_progress;
        goodbye.message = "no answer to the clock requests";
        connection_->close(goodbye);
        return;
    }
    ClockRequest request;
    request.sequence = ++sequence_;
    request.client_sent_us = client_monotonic_us();
    connection_->send(request);
    const auto pause = done + 1 < clock_burst           ? clock_burst_interval
                       : now_us < watch_clock_until_us_ ? clock_watch_interval
                                                        : clock_interval;
    loop_.after(pause, [this, row, done] { ask_clock(row, std::min(done + 1, clock_burst)); });
}

void SessionLink::on(const ClockReply& reply, int64_t received_us) {
    store_.confirm(reply.watermark, reply.log_position);
    told_position_ = reply.log_position;
    told_log_hash_ = reply.log_hash;
    {
        const std::lock_guard lock(board_.mutex);
        board_.clock.add(reply, received_us);
        if (reply.verdict == Verdict::exact) board_.fidelity = Fidelity::exact;
        if (reply.verdict == Verdict::approximate) board_.fidelity = Fidelity::approximate;
    }
    show_store();
}

void SessionLink::on(const Delta& delta, int64_t received_us) {
    auto ack = store_.apply(delta);
    if (!ack) return connection_->refuse(ack.error(), requirement_of_result(ack.error().code));
    if (!*ack) return;
    const size_t patches = delta.change.patches.size();
    if (patches >= 8) {
        const auto took_us = static_cast<double>(std::max<int64_t>(1, client_monotonic_us() - received_us));
        const double rate = static_cast<double>(patches) * 1e6 / took_us;
        patches_per_second_ =
            patches_per_second_ == 0.0 ? rate : patches_per_second_ + (rate - patches_per_second_) / 8.0;
    }
    (*ack)->patches_per_second = static_cast<uint32_t>(std::min(patches_per_second_, 1e6));
    const bool answers = known_answer_.has_value();
    (*ack)->known_answer = std::exchange(known_answer_, std::nullopt);
    show_store();
    connection_->send(**ack);
    if (probe_round_ == 0) probe_after(std::chrono::milliseconds(0));
    // The next clock reply brings the verdict; while the first ones are under way it comes by itself.
    if (answers && clock_done_ + 1 >= clock_burst) ask_clock(++clock_row_, clock_burst - 2);
    if (live_ && delta.key.log_position > log_position_) log_grew(delta.key.log_position);
}

void SessionLink::on(const TerrainTiles& tiles, int64_t) {
    if (const auto taken = store_.apply(tiles); !taken)
        return connection_->refuse(taken.error(), requirement::tiles_of_grid);
    show_store();
}

void SessionLink::show_store() {
    const std::lock_guard lock(board_.mutex);
    board_.snapshot = store_.snapshot();
    board_.counters = store_.counters();
    board_.changed();
}

void SessionLink::view_changed() {
    loop_.assert_here();
    ViewUpdate update;
    {
        const std::lock_guard lock(board_.mutex);
        board_.view_posted = false;
        update.view = board_.view;
    }
    if (!live_ || view_timer_ || update.view == told_view_) return;
    const int64_t now_us = client_monotonic_us();
    const int64_t wait_us = told_view_us_ + view_interval_us - now_us;
    if (wait_us > 0) {
        view_timer_ = true;
        loop_.after(std::chrono::milliseconds(wait_us / 1000 + 1), [this] {
            view_timer_ = false;
            view_changed();
        });
        return;
    }
    told_view_ = update.view;
    told_view_us_ = now_us;
    update.sequence = ++sequence_;
    connection_->send(update);
    const std::lock_guard lock(board_.mutex);
    ++board_.views_sent;
}

void SessionLink::regions_changed() {
    SyncRegions update;
    {
        const std::lock_guard lock(board_.mutex);
        update.regions = board_.regions;
    }
    if (!live_ || update.regions == told_regions_) return;
    told_regions_ = update.regions;
    update.sequence = ++sequence_;
    connection_->send(update);
}

void SessionLink::ask(const std::function<ClientMessage(uint32_t)>& make, Question question) {
    if (!live_) {
        Error error{ErrorCode::client_closed, {}};
        {
            const std::lock_guard lock(board_.mutex);
            error.message = sentence_of(board_, options_.server, client_monotonic_us());
        }
        question.fail(error);
        return;
    }
    const uint32_t sequence = ++sequence_;
    questions_.emplace(sequence, std::move(question));
    connection_->send(make(sequence));
}

void SessionLink::answer(uint32_t sequence, ServerMessage& message) {
    const auto asked = questions_.find(sequence);
    if (asked == questions_.end())
        return connection_->refuse({ErrorCode::unexpected_message,
                                    fmt::format("an answer to question {}, which was not asked", sequence)},
                                   0);
    if (!asked->second.take(message)) return;
    questions_.erase(asked);
}

void SessionLink::closed(const Goodbye& goodbye, CloseCause cause) {
    const bool was_live = std::exchange(live_, false);
    const int64_t now_us = client_monotonic_us();
    if (was_live && now_us - live_since_us_ > steady_after_us) failures_ = 0;
    ++probe_row_;
    if (was_live) last_code_ = cause == CloseCause::lost ? ErrorCode::client_closed : goodbye.code;
    // A ticket that counts no more leaves the token, where there is one.
    const bool ticket_refused = cause == CloseCause::server_goodbye && ticket_shown_ && !was_live &&
                                goodbye.code == ErrorCode::token_refused;
    if (ticket_refused) ticket_.clear();
    const bool refused = cause == CloseCause::server_goodbye && !goodbye.retry && !ticket_refused;
    // The same view and regions would come to the same again.
    const bool too_much = cause == CloseCause::over_our_limit;
    const bool again = options_.reconnect && !ending_ && !refused && !too_much;
    std::string reason = given_up_ ? *given_up_ : goodbye.message;
    if (cause == CloseCause::server_goodbye) reason = fmt::format("the server says: {}", goodbye.message);
    if (cause == CloseCause::refused_server && was_live)
        reason = fmt::format("the server broke the protocol ({} {})", static_cast<unsigned>(goodbye.code),
                             goodbye.message);
    if (too_much) reason = fmt::format("a limit of this client: {}", goodbye.message);
    const int64_t pause = std::max<int64_t>(pause_ms(failures_++), goodbye.retry_after_ms);
    {
        const std::lock_guard lock(board_.mutex);
        if (connection_) {
            const Traffic traffic = connection_->traffic();
            past_traffic_.bytes_received += traffic.bytes_received;
            past_traffic_.bytes_sent += traffic.bytes_sent;
            past_traffic_.frames_received += traffic.frames_received;
            past_traffic_.frames_sent += traffic.frames_sent;
            connection_.reset();
        }
        board_.reason = reason;
        board_.state = again ? LinkState::waiting : LinkState::ended;
        board_.next_try_us = now_us + pause * 1000;
        board_.changed();
    }
    for (auto& [sequence, question] : std::exchange(questions_, {}))
        question.fail({ErrorCode::client_closed, reason});
    if (again) loop_.after(std::chrono::milliseconds(pause), [this] { connect(); });
}

Traffic SessionLink::traffic() const {
    Traffic sum = past_traffic_;
    if (!connection_) return sum;
    const Traffic now = connection_->traffic();
    sum.bytes_received += now.bytes_received;
    sum.bytes_sent += now.bytes_sent;
    sum.frames_received += now.frames_received;
    sum.frames_sent += now.frames_sent;
    return sum;
}

}  // namespace trochoid
