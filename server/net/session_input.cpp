#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <random>
#include <utility>

#include "protocol/model/self_check.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/session.hpp"

namespace trochoid {

namespace {

// Points of the known-answer challenge.
constexpr uint32_t challenge_points = 64;
// A client that still disagrees after so many snapshots in a row computes another hash: no use in sending more.
constexpr int most_resyncs_in_a_row = 4;
// Reads in one go before others get their turn.
constexpr int reads_in_a_row = 4;

uint64_t random_seed() {
    std::random_device device;
    return (uint64_t{device()} << 32) | device();
}

}  // namespace

void Session::arm_reading() {
    if (reading_armed_ || stage_ == Stage::ended || answers_.full()) return;
    reading_armed_ = true;
    transport_->when_readable([weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->on_readable();
    });
}

void Session::on_readable() {
    around_.loop.assert_here();
    reading_armed_ = false;
    for (int i = 0; i < reads_in_a_row && stage_ != Stage::ended && !answers_.full(); ++i) {
        const Transport::Moved moved = transport_->read(around_.read_buffer);
        if (moved.closed) {
            end(ErrorCode::client_closed, "the connection was closed without a goodbye");
            return;
        }
        if (moved.bytes == 0) break;
        if (stage_ == Stage::parting) continue;
        read_at_us_ = heard_us_ = monotonic_us();
        bytes_in_ += moved.bytes;
        around_.stats.bytes_in += moved.bytes;
        take_frames(around_.read_buffer.first(moved.bytes));
    }
    flush();
    arm_reading();
}

// Takes what was left over and then these bytes, frame by frame, until questions have to wait.
void Session::take_frames(std::span<const uint8_t> bytes) {
    const Bytes left_over = std::exchange(unread_, {});
    std::span<const uint8_t> input = left_over.empty() ? bytes : std::span<const uint8_t>(left_over);
    TROCHOID_ASSERT(left_over.empty() || bytes.empty(), "{} bytes were read over {} unread ones",
                    bytes.size(), left_over.size());
    while ((stage_ == Stage::hello || stage_ == Stage::live) && !answers_.full()) {
        const Result<std::optional<Bytes>> payload = frames_.next(input);
        if (!payload) {
            refuse(payload.error());
            return;
        }
        if (!payload->has_value()) return;
        take_frame(**payload);
    }
    if (stage_ == Stage::live) unread_.assign(input.begin(), input.end());
}

void Session::take_frame(std::span<const uint8_t> payload) {
    ++around_.stats.frames_in;
    Result<ClientMessage> message = decode_client(payload);
    if (!message) {
        refuse(message.error());
        return;
    }
    const Result<Done> timely = in_time(*message);
    if (!timely) {
        refuse(timely.error(), sequence_of(*message));
        return;
    }
    std::visit([this](auto& m) { handle(m); }, *message);
}

// Phase, order and rate of messages: what their content cannot tell.
Result<Done> Session::in_time(const ClientMessage& message) {
    Result<Done> phase =
        expected(stage_ == Stage::hello ? SessionPhase::awaiting_hello : SessionPhase::open, message);
    if (!phase) return phase;
    Result<Done> order = sequence_.accept(message);
    if (!order) return order;
    if (!message_rate_.take(read_at_us_))
        return Error{ErrorCode::rate_limited,
                     "too many messages a second: send views, acks and questions only when needed"};
    const bool view =
        std::holds_alternative<ViewUpdate>(message) || std::holds_alternative<SyncRegions>(message);
    if (view && !view_rate_.take(read_at_us_))
        return Error{ErrorCode::rate_limited,
                     fmt::format("more than {} views and regions a second: send the latest, less often",
                                 around_.limits.views_per_second)};
    return Done{};
}

Result<Role> Session::welcome(const ClientHello& hello) const {
    const Result<uint16_t> version = common_version(hello);
    if (!version) return version.error();
    const std::string world = around_.sea.hello_facts().world;
    if (!hello.world.empty() && hello.world != world)
        return Error{ErrorCode::wrong_world,
                     fmt::format("this server's world is '{}', not '{}': ask for that one or for none", world,
                                 hello.world)};
    const Result<Done> regions = fits(hello.regions);
    if (!regions) return regions.error();
    return around_.sea.role_for(hello.token);
}

Result<Done> Session::fits(const std::vector<SyncRegion>& regions) const {
    const Limits& limits = around_.limits;
    if (regions.size() > limits.sync_regions)
        return Error{ErrorCode::too_many_regions, fmt::format("{} sync regions, but at most {} are allowed",
                                                              regions.size(), limits.sync_regions)};
    for (const SyncRegion& region : regions)
        if (region.radius > limits.sync_radius)
            return Error{ErrorCode::region_too_large,
                         fmt::format("a sync region of radius {} lattice units, but at most {} are allowed",
                                     region.radius, limits.sync_radius)};
    return Done{};
}

ServerHello Session::server_hello(const ClientHello& hello) {
    const HelloFacts facts = around_.sea.hello_facts();
    challenge_seed_ = random_seed();
    challenge_open_ = true;
    has_terrain_ = facts.terrain.columns > 0;
    ServerHello reply;
    reply.protocol = *common_version(hello);
    reply.model = model_version;
    reply.schema_hash = schema_hash();
    reply.software = fmt::format("trochoid-server {}", software_version());
    reply.session = id_;
    reply.world = facts.world;
    reply.instance = facts.instance;
    reply.role = role_;
    reply.log_position = facts.log_position;
    reply.clock = facts.clock;
    reply.client_stamp_us = hello.clock_stamp_us;
    reply.limits = around_.limits;
    reply.challenge_seed = challenge_seed_;
    reply.challenge_count = challenge_points;
    reply.projection = facts.projection;
    reply.origin_lon = facts.origin_lon;
    reply.origin_lat = facts.origin_lat;
    reply.terrain = facts.terrain;
    reply.server_now_us = monotonic_us();
    return reply;
}

void Session::handle(ClientHello& hello) {
    const Result<Role> role = welcome(hello);
    if (!role) {
        refuse(role.error());
        return;
    }
    role_ = *role;
    stage_ = Stage::live;
    frames_.set_longest(around_.limits.frame_after_login);
    software_ = hello.software;
    view_ = hello.view;
    regions_ = std::move(hello.regions);
    sea_news_ = true;
    progress_us_ = read_at_us_;
    ++around_.stats.sessions_started;
    log_start();
    send(server_hello(hello));
}

void Session::handle(const ViewUpdate& update) {
    ++around_.stats.views;
    if (view_news_) ++around_.stats.views_superseded;
    view_ = update.view;
    view_news_ = true;
}

void Session::handle(SyncRegions& update) {
    const Result<Done> fitting = fits(update.regions);
    if (!fitting) {
        refuse(fitting.error(), update.sequence);
        return;
    }
    regions_ = std::move(update.regions);
    sea_news_ = true;
}

void Session::handle(const ClockRequest& request) {
    const ClockFacts facts = around_.sea.clock_facts();
    ClockReply reply;
    reply.sequence = request.sequence;
    reply.client_sent_us = request.client_sent_us;
    reply.server_received_us = read_at_us_;
    reply.clock = facts.clock;
    reply.watermark = facts.watermark;
    reply.log_position = facts.log_position;
    reply.log_hash = facts.log_hash;
    reply.verdict = verdict_;
    reply.server_sent_us = monotonic_us();
    send(reply);
}

void Session::handle(const Ack& ack) {
    if (ack.known_answer && challenge_open_) check_known_answer(*ack.known_answer);
    switch (state_.acknowledge(ack, read_at_us_)) {
        case StateLane::Acknowledged::never_written: {
            Goodbye goodbye = goodbye_for(
                {ErrorCode::value_out_of_range,
                 fmt::format("result {} is acknowledged but was never written whole", ack.result)});
            goodbye.requirement = requirement::result_order;
            part(goodbye);
            return;
        }
        case StateLane::Acknowledged::superseded: return;
        case StateLane::Acknowledged::in_step:
            progress_us_ = read_at_us_;
            resyncs_in_a_row_ = 0;
            return;
        case StateLane::Acknowledged::out_of_step: break;
    }
    progress_us_ = read_at_us_;
    if (++resyncs_in_a_row_ > most_resyncs_in_a_row) {
        refuse(
            {ErrorCode::base_mismatch,
             fmt::format(
                 "the state hash differed after {} snapshots in a row: check how the client hashes its state",
                 most_resyncs_in_a_row)});
        return;
    }
    ++around_.stats.resyncs;
    spdlog::warn("session {}: state hash differs after result {}: starting again from nothing", id_,
                 ack.result);
    state_.resync();
    sea_news_ = true;
}

void Session::check_known_answer(uint64_t answer) {
    challenge_open_ = false;
    const bool exact = answer == reference_hash(challenge_seed_, challenge_points);
    verdict_ = exact ? Verdict::exact : Verdict::approximate;
    ++(exact ? around_.stats.exact_viewers : around_.stats.approximate_viewers);
    if (exact)
        spdlog::info("session {}: computes the same sea (exact)", id_);
    else
        spdlog::warn("session {}: computes another sea (approximate): its known answer is wrong", id_);
}

void Session::handle(const Command& command) {
    ++around_.stats.commands;
    if (!command_rate_.take(read_at_us_)) {
        ++around_.stats.refused[ErrorCode::rate_limited];
        CommandReply reply;
        reply.sequence = command.sequence;
        reply.code = ErrorCode::rate_limited;
        reply.message = fmt::format("more than {} commands a second: send it again later",
                                    around_.limits.commands_per_second);
        send(reply);
        return;
    }
    if (std::holds_alternative<ListBoxes>(command.action)) {
        answers_.ask(ListRequest{command.sequence});
        return;
    }
    around_.sea.command(command, role_, id_, [weak = weak_from_this()](const CommandReply& reply) {
        const auto self = weak.lock();
        if (!self || self->stage_ != Stage::live) return;
        if (reply.code != ErrorCode::none) ++self->around_.stats.refused[reply.code];
        self->send(reply);
        self->flush();
    });
}

void Session::handle(SampleRequest& request) { answers_.ask(std::move(request)); }

void Session::handle(const RaysRequest& request) { answers_.ask(request); }

// Our hello promises no probes.
void Session::handle(const Probe& probe) {
    refuse({ErrorCode::unexpected_message, "this server answers no probes: its hello does not promise them"},
           probe.sequence);
}

void Session::handle(const Desync& desync) {
    refuse({ErrorCode::unexpected_message,
            "this server has answered no probe that could have found a difference"},
           desync.sequence);
}

void Session::handle(const Goodbye& goodbye) {
    end(goodbye.code == ErrorCode::none ? ErrorCode::client_closed : goodbye.code,
        goodbye.message.empty() ? "the client said goodbye" : "the client: " + goodbye.message);
}

}  // namespace trochoid
