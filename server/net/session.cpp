#include "server/net/session.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "server/net/farewell.hpp"
#include "server/net/monotonic.hpp"

namespace trochoid {

namespace {

// A parting client gets this long to take its goodbye and close.
constexpr int64_t parting_us = 2 * microseconds_per_second;
// Messages of all kinds a second, above anything that the limits in the hello allow together.
constexpr uint32_t messages_per_second = 1000;
// A probe costs at most a few milliseconds.
constexpr uint32_t probes_per_second = 2;
constexpr uint32_t probes_at_once = 6;

}  // namespace

Session::Session(SessionSurroundings& around, uint64_t id, std::unique_ptr<Transport> transport)
    : around_(around),
      id_(id),
      transport_(std::move(transport)),
      peer_(transport_->peer()),
      started_us_(monotonic_us()),
      frames_(FrameReader::Opening::magic, around.limits.frame_before_login),
      view_rate_(around.limits.views_per_second, around.limits.views_per_second),
      command_rate_(around.limits.commands_per_second, around.limits.commands_per_second),
      message_rate_(messages_per_second, messages_per_second),
      probe_rate_(probes_per_second, probes_at_once),
      view_timer_(around.loop),
      control_(around.limits.control_messages) {}

void Session::start(int64_t since_us) {
    around_.loop.assert_here();
    if (stage_ != Stage::waiting) return;
    stage_ = Stage::hello;
    started_us_ = since_us;
    heard_us_ = progress_us_ = monotonic_us();
    arm_reading();
}

void Session::refuse(const Error& error, uint32_t offending_sequence) {
    part(goodbye_for(error, offending_sequence));
}

void Session::part(Goodbye goodbye) {
    around_.loop.assert_here();
    if (stage_ == Stage::parting || stage_ == Stage::ended) return;
    wind_up(goodbye.code, goodbye.message);
    send(goodbye);
    // Reading goes on until the peer closes, or has sent too much: closing over unread bytes would reset the stream and lose the goodbye.
    if (stage_ == Stage::parting) arm_reading();
}

// Nothing follows but what is said last; once that is written, the stream ends as its form has it.
void Session::wind_up(ErrorCode code, const std::string& reason) {
    stage_ = Stage::parting;
    end_code_ = code;
    end_reason_ = reason;
    parting_until_us_ = monotonic_us() + parting_us;
    view_timer_.stop();
    control_.clear();
    answers_.clear();
    unread_ = {};
}

void Session::end(ErrorCode code, const std::string& reason) {
    if (stage_ == Stage::ended) return;
    if (end_code_ == ErrorCode::none) {
        end_code_ = code;
        end_reason_ = reason;
    }
    stage_ = Stage::ended;
    view_timer_.stop();
    transport_->close();
    ++around_.stats.ended[end_code_];
    spdlog::info("session {} from {} ended: {} {} ({}), {:.1f} s, in {} bytes, out {} bytes", id_, peer_,
                 static_cast<unsigned>(end_code_), error_class(end_code_), end_reason_,
                 static_cast<double>(monotonic_us() - started_us_) * 1e-6, bytes_in_, bytes_out_);
    around_.ended(id_, end_code_);
}

void Session::log_start() const {
    spdlog::info("session {} from {} started: {}, {}", id_, peer_,
                 software_.empty() ? "unnamed client" : software_,
                 role_ == Role::admin      ? "admin"
                 : role_ == Role::director ? "director"
                                           : "viewer");
}

void Session::sea_changed() {
    around_.loop.assert_here();
    if (stage_ != Stage::live) return;
    sea_news_ = true;
    flush();
}

bool Session::waits_for_client() const {
    if (outgoing_taken_ < outgoing_.size() || writing_armed_ || state_.writing()) return true;
    const bool more = view_news_ || sea_news_ || !terrain_.idle();
    return more && !state_.has_credit();
}

void Session::sweep(int64_t now_us) {
    around_.loop.assert_here();
    const Limits& limits = around_.limits;
    switch (stage_) {
        case Stage::waiting:
        case Stage::ended: return;
        case Stage::parting:
            if (now_us >= parting_until_us_) end(end_code_, end_reason_);
            return;
        case Stage::hello:
            if (now_us - started_us_ >= int64_t{limits.hello_deadline_ms} * 1000)
                refuse(hello_came_late(limits));
            return;
        case Stage::live: break;
    }
    if (!waits_for_client()) progress_us_ = now_us;
    const int64_t patience_us = int64_t{limits.no_progress_ms} * 1000;
    if (now_us - progress_us_ >= patience_us || now_us - heard_us_ >= patience_us) {
        refuse({ErrorCode::no_progress,
                fmt::format("nothing read, acknowledged or sent for {} ms: connect again",
                            limits.no_progress_ms)});
        return;
    }
    if (now_us >= refresh_at_us_) {
        refresh_at_us_ = now_us + microseconds_per_second;  // again, should the provider find it too early
        sea_news_ = true;
        flush();
    }
}

}  // namespace trochoid
