#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "protocol/units/assert.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/session.hpp"

namespace trochoid {

namespace {

// Views are considered at most this often; what comes in between waits, and the latest wins.
constexpr int64_t view_interval_us = 100'000;

}  // namespace

void Session::send(const ServerMessage& message) {
    if (stage_ == Stage::ended) return;
    if (!control_.push(frame(encode(message)))) {
        refuse({ErrorCode::queue_overflow,
                "answers pile up because the client does not read: connect again and keep reading"});
        return;
    }
    if (!taking_ || control_.half_full()) flush();
}

// Hands over what is begun and the control lane, as far as the socket takes it; then sees what else there is to do.
void Session::flush() {
    while (stage_ != Stage::ended) {
        if (outgoing_taken_ < outgoing_.size()) {
            const Transport::Moved moved = transport_->write(std::span(outgoing_).subspan(outgoing_taken_));
            if (moved.closed) {
                end(ErrorCode::client_closed, "the connection broke while writing");
                return;
            }
            if (moved.bytes == 0) {
                arm_writing();
                return;
            }
            outgoing_taken_ += moved.bytes;
            bytes_out_ += moved.bytes;
            progress_us_ = monotonic_us();
            continue;
        }
        outgoing_ = {};
        outgoing_taken_ = 0;
        if (control_.empty()) break;
        outgoing_ = control_.take_all(around_.stats.frames_out);
        around_.stats.control_bytes += outgoing_.size();
    }
    if (stage_ == Stage::parting && !finished_) {
        finished_ = true;
        transport_->finish(end_code_);
    }
    if (stage_ != Stage::live) return;
    const int64_t now_us = monotonic_us();
    if (bulk_to_write(now_us)) arm_writing();
    if (view_news_ && !aside_ && !due(now_us)) arm_view_timer(now_us);
}

// A view that came too soon after the last one considered waits for its turn.
void Session::arm_view_timer(int64_t now_us) {
    if (view_timer_armed_) return;
    view_timer_armed_ = true;
    const int64_t wait_ms = (considered_us_ + view_interval_us - now_us) / 1000 + 1;
    view_timer_.start(std::chrono::milliseconds(wait_ms), [weak = weak_from_this()] {
        const auto self = weak.lock();
        if (!self) return;
        self->view_timer_armed_ = false;
        self->flush();
    });
}

void Session::arm_writing() {
    if (writing_armed_) return;
    writing_armed_ = true;
    transport_->when_writable([weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->on_writable();
    });
}

void Session::on_writable() {
    around_.loop.assert_here();
    writing_armed_ = false;
    if (stage_ == Stage::ended) return;
    if (stage_ == Stage::live && outgoing_taken_ == outgoing_.size() && control_.empty()) write_bulk();
    flush();
    // A question was answered: room for what the client has sent meanwhile.
    if (stage_ == Stage::live && !reading_armed_ && !answers_.full()) {
        take_frames({});
        flush();
        arm_reading();
    }
}

bool Session::due(int64_t now_us) const {
    if (aside_) return false;
    return sea_news_ || (view_news_ && now_us >= considered_us_ + view_interval_us);
}

bool Session::bulk_to_write(int64_t now_us) const {
    const bool credit = state_.has_credit();
    if (state_.writing() || !answers_.idle()) return true;
    // Nothing is begun on what the result that is being computed aside will begin on.
    if (aside_ || !credit) return false;
    if (due(now_us) || state_.marker_due()) return true;
    return has_terrain_ && (terrain_news_ || !terrain_.idle());
}

// One frame of the most important lane that has something to say.
void Session::write_bulk() {
    const int64_t now_us = monotonic_us();
    if (!state_.writing() && !aside_ && state_.has_credit()) {
        if (due(now_us))
            consider(now_us);
        else if (state_.marker_due())
            state_.begin_marker(around_.sea.clock_facts().watermark);
    }
    if (write_state(now_us) || write_answer() || aside_) return;
    write_terrain(now_us);
}

ResultRequest Session::begin_considering(int64_t now_us) {
    sea_news_ = view_news_ = view_waits_ = false;
    considered_us_ = now_us;
    terrain_news_ = true;
    return {view_, regions_, state_.key(), state_.round_trip_us(), view_motion_.turn(now_us)};
}

// Whoever holds nothing yet has its result computed aside; so has whoever has used up its share of the io thread, and
// everybody once all together have.
void Session::consider(int64_t now_us) {
    if (state_.key() == nullptr || !io_share_.left(now_us) || !around_.io_share.left(now_us)) {
        aside_ = true;
        around_.wants_turn(shared_from_this());
        return;
    }
    std::optional<MadeResult> made = around_.sea.make_result(begin_considering(now_us));
    take_result(std::move(made));
    spend(monotonic_us() - now_us);
}

void Session::spend(int64_t us) {
    io_share_.spend(us);
    around_.io_share.spend(us);
}

// The request is of now: what has come since the session began to wait counts.
void Session::compute_aside(const std::function<void()>& done) {
    if (stage_ != Stage::live) return done();
    around_.sea.make_result_aside(
        begin_considering(monotonic_us()), [weak = weak_from_this(), done](std::optional<MadeResult> made) {
            if (const auto self = weak.lock(); self && self->stage_ == Stage::live) {
                self->aside_ = false;
                const int64_t begun_us = monotonic_us();
                self->take_result(std::move(made));
                self->spend(monotonic_us() - begun_us);
                self->arm_writing();
            }
            done();
        });
}

void Session::take_result(std::optional<MadeResult> made) {
    const bool owed = std::exchange(result_owed_, false);
    if (!made) {
        // Without a key a resync came in between: it asks for a result of its own.
        TROCHOID_ASSERT(state_.key() != nullptr || sea_news_, "session {} got no first result", id_);
        if (owed && state_.key() != nullptr) state_.begin_marker(around_.sea.clock_facts().watermark);
        return;
    }
    refresh_at_us_ = made->refresh_at_us;
    const InterestDelta change = around_.sea.change(*state_.base(), *made->state, made->key);
    ++around_.stats.results;
    if (change.empty()) ++around_.stats.empty_results;
    state_.begin(std::move(*made), change, around_.limits.frame_to_client);
}

bool Session::write_state(int64_t now_us) {
    if (!state_.writing()) return false;
    Delta piece = state_.take_piece();
    const bool last = piece.last;
    state_.wrote(put(std::move(piece), around_.stats.state_bytes), last, now_us);
    return true;
}

std::deque<ServerMessage> Session::answer_to(const Question& question) {
    const auto refusal = [this](uint32_t sequence, const Error& error) {
        ++around_.stats.refused[error.code];
        CommandReply reply;
        reply.sequence = sequence;
        reply.code = error.code;
        reply.message = error.message;
        return std::deque<ServerMessage>{reply};
    };
    if (const auto* list = std::get_if<ListRequest>(&question)) {
        BoxList boxes = around_.sea.list_boxes();
        boxes.sequence = list->sequence;
        return in_pieces(std::move(boxes));
    }
    if (const auto* sample = std::get_if<SampleRequest>(&question)) {
        Result<SampleReply> reply = around_.sea.sample(*sample);
        if (!reply) return refusal(sample->sequence, reply.error());
        return {std::move(*reply)};
    }
    if (const auto* probe = std::get_if<Probe>(&question)) return {answer_to(*probe)};
    const auto& request = std::get<RaysRequest>(question);
    Result<RaysReply> reply = around_.sea.rays(request);
    if (!reply) return refusal(request.sequence, reply.error());
    return in_pieces(std::move(*reply));
}

// Only the state that the client is known to have been sent whole is compared: of any other it may hold a part.
ProbeReply Session::answer_to(const Probe& probe) {
    ++around_.stats.probes;
    if (probe.result == state_.held()) return around_.sea.probe(*state_.base(), probe);
    ++around_.stats.stale_probes;
    ProbeReply reply;
    reply.sequence = probe.sequence;
    reply.result = probe.result;
    reply.time = probe.time;
    reply.stale = true;
    return reply;
}

bool Session::write_answer() {
    std::optional<ServerMessage> piece = answers_.take_piece();
    if (!piece) {
        const std::optional<Question> question = answers_.take_question();
        if (!question) return false;
        answers_.answer(answer_to(*question));
        piece = answers_.take_piece();
    }
    put(*piece, around_.stats.answer_bytes);
    return true;
}

bool Session::write_terrain(int64_t now_us) {
    if (!has_terrain_ || !state_.has_credit()) return false;
    if (std::exchange(terrain_news_, false))
        terrain_.want(around_.sea.tiles_for(view_),
                      [this](const TerrainTileKey& key) { return around_.sea.tile_revision(key); });
    const std::optional<TerrainTileKey> key = terrain_.take();
    if (!key) return false;
    TerrainTiles message;
    message.tiles.push_back(around_.sea.tile(*key));
    ++around_.stats.terrain_tiles;
    state_.wrote(put(std::move(message), around_.stats.terrain_bytes), false, now_us);
    return true;
}

// Bytes that the message takes on the stream.
size_t Session::put(const ServerMessage& message, uint64_t& lane_bytes) {
    outgoing_ = frame(encode(message));
    outgoing_taken_ = 0;
    TROCHOID_ASSERT(outgoing_.size() <= around_.limits.frame_to_client + frame_header_bytes,
                    "a frame of {} bytes for session {}", outgoing_.size(), id_);
    ++around_.stats.frames_out;
    lane_bytes += outgoing_.size();
    return outgoing_.size();
}

}  // namespace trochoid
