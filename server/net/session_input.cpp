#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "protocol/model/self_check.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/peer_address.hpp"
#include "server/net/session.hpp"

namespace trochoid {

namespace {

// Points of the known-answer challenge.
constexpr uint32_t challenge_points = 64;
// A client that still disagrees after so many snapshots in a row computes another hash: no use in sending more.
constexpr int most_resyncs_in_a_row = 4;
// Read in one turn; then others get theirs. Some dozen small messages: whoever floods holds up the rest for a tenth of a millisecond.
constexpr size_t bytes_a_turn = 1024;
// A client that finds difference after difference costs a snapshot each.
constexpr int64_t desync_interval_us = 5 * microseconds_per_second;

uint64_t random_seed() {
    std::random_device device;
    return (uint64_t{device()} << 32) | device();
}

}  // namespace

void Session::arm_reading() {
    if (reading_armed_ || stage_ == Stage::ended || answers_.full() || dropped_bytes_ >= most_dropped_bytes)
        return;
    reading_armed_ = true;
    transport_->when_readable([weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->on_readable();
    });
}

void Session::on_readable() {
    around_.loop.assert_here();
    reading_armed_ = false;
    if (stage_ == Stage::ended || answers_.full()) return;
    // While parting what comes is thrown away, much at a time.
    const Transport::Moved moved = transport_->read(
        stage_ == Stage::parting ? around_.read_buffer : around_.read_buffer.first(bytes_a_turn));
    if (moved.closed) {
        end(ErrorCode::client_closed, "the connection was closed without a goodbye");
        return;
    }
    if (stage_ == Stage::parting) {
        // What a form swallows (records without content, a stream that is broken) counts as a whole read.
        dropped_bytes_ += moved.bytes > 0 ? moved.bytes : around_.read_buffer.size();
    } else if (moved.bytes == 0) {
        if (const auto fault = transport_->fault()) {
            Goodbye goodbye = goodbye_for(fault->error);
            if (fault->requirement != 0) goodbye.requirement = fault->requirement;
            part(std::move(goodbye));
        }
    } else {
        read_at_us_ = heard_us_ = monotonic_us();
        bytes_in_ += moved.bytes;
        around_.stats.bytes_in += moved.bytes;
        taking_ = true;  // the answers go out together, in one write
        take_frames(around_.read_buffer.first(moved.bytes));
        taking_ = false;
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
    // Before anything is made of it: what is too much costs next to nothing.
    if (!message_rate_.take(read_at_us_)) {
        refuse({ErrorCode::rate_limited,
                "too many messages a second: send views, acks and questions only when needed"});
        return;
    }
    Result<ClientMessage> message = decode_client(payload);
    if (!message) {
        part(goodbye_for_payload(message.error(), payload, client_identifier));
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
    const bool view =
        std::holds_alternative<ViewUpdate>(message) || std::holds_alternative<SyncRegions>(message);
    if (view && !view_rate_.take(read_at_us_))
        return Error{ErrorCode::rate_limited,
                     fmt::format("more than {} views and regions a second: send the latest, less often",
                                 around_.limits.views_per_second)};
    return Done{};
}

Result<LoginDecision> Session::welcome(const ClientHello& hello) const {
    const Result<uint16_t> version = common_version(hello);
    if (!version) return version.error();
    const std::string world = around_.sea.hello_facts().world;
    if (!hello.world.empty() && hello.world != world)
        return Error{ErrorCode::wrong_world,
                     fmt::format("this server's world is '{}', not '{}': ask for that one or for none", world,
                                 hello.world)};
    const Result<Done> regions = fits(hello.regions);
    if (!regions) return regions.error();
    return around_.sea.login(hello, peer_address(peer_).loopback);
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
    reply.protocol = protocol_;
    reply.model = model_version;
    reply.schema_hash = schema_hash();
    reply.software = fmt::format("trochoid-server {}", software_version());
    reply.session = id_;
    reply.world = facts.world;
    reply.instance = facts.instance;
    // Version 2 knows no admins.
    reply.role = reply.protocol < 3 ? std::min(role_, Role::director) : role_;
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
    reply.capabilities = capability_probes | capability_resume;
    reply.resumed = resumed_;
    IssuedTicket issued = around_.sea.new_ticket(id_, role_);
    reply.ticket = std::move(issued.ticket);
    reply.ticket_life_ms = issued.life_ms;
    reply.last_session = last_session_;
    reply.last_code = around_.how_ended(last_session_);
    reply.server_now_us = monotonic_us();
    return reply;
}

void Session::handle(ClientHello& hello) {
    const Result<LoginDecision> decision = welcome(hello);
    if (!decision) {
        refuse(decision.error());
        return;
    }
    role_ = decision->role;
    last_session_ = decision->last_session;
    protocol_ = *common_version(hello);
    if (protocol_ >= first_with_patch_planes) state_.set_patch_form(PatchForm::planes);
    stage_ = Stage::live;
    frames_.set_longest(around_.limits.frame_after_login);
    transport_->set_longest(around_.limits.frame_after_login);
    software_ = hello.software;
    view_ = hello.view;
    regions_ = std::move(hello.regions);
    sea_news_ = true;
    progress_us_ = read_at_us_;
    ++around_.stats.sessions_started;
    if (hello.last_code != ErrorCode::none) ++around_.stats.clients_ends[hello.last_code];
    log_start();
    if (hello.resume && protocol_ >= first_with_resume) resume(*hello.resume);
    send(server_hello(hello));
}

// Whatever the client claims, its session begins; only what it is sent first differs.
void Session::resume(const ResumeState& claim) {
    Resumption resumption{ResumeVerdict::no_such_key, {}};
    if (fits(claim.key.regions) && claim.key.patch_limit <= around_.limits.patches)
        resumption = around_.sea.resume(claim);
    ++around_.stats.resumes[resumption.verdict];
    spdlog::info("session {}: resume from log position {}: {}", id_, claim.key.log_position.value,
                 name_of(resumption.verdict));
    if (resumption.verdict != ResumeVerdict::resumed) return;
    resumed_ = result_owed_ = true;
    refresh_at_us_ = resumption.held.refresh_at_us;
    state_.resume(std::move(resumption.held));
}

void Session::handle(const ViewUpdate& update) {
    ++around_.stats.views;
    if (std::exchange(view_waits_, true)) ++around_.stats.views_superseded;
    view_motion_.take(view_, update.view, read_at_us_);
    view_ = update.view;
    view_news_ = true;
}

void Session::handle(SyncRegions& update) {
    const Result<Done> fitting = fits(update.regions);
    if (!fitting) {
        refuse(fitting.error(), update.sequence);
        return;
    }
    if (update.regions == regions_) return;
    regions_ = std::move(update.regions);
    // Considered as often as views: alternating regions cost no more than a camera that moves.
    view_news_ = true;
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
            goodbye.requirement = requirement::whole_results;
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
    if (protocol_ < first_with_skip_time && std::holds_alternative<SkipTime>(command.action))
        return refuse({ErrorCode::unknown_message,
                       fmt::format("there is no SkipTime in protocol version {}", protocol_)},
                      command.sequence);
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

Result<Done> Session::probes_promised() const {
    if (protocol_ >= first_with_probes) return Done{};
    return Error{ErrorCode::unexpected_message,
                 fmt::format("there are no probes in protocol version {}: ask for version {} in the hello",
                             protocol_, first_with_probes)};
}

void Session::handle(Probe& probe) {
    if (const auto ok = probes_promised(); !ok) return refuse(ok.error(), probe.sequence);
    if (probe_rate_.take(read_at_us_)) return answers_.ask(std::move(probe));
    ++around_.stats.refused[ErrorCode::rate_limited];
    CommandReply reply;
    reply.sequence = probe.sequence;
    reply.code = ErrorCode::rate_limited;
    reply.message = "too many probes: ask again in a second";
    send(reply);
}

void Session::handle(const Desync& desync) {
    if (const auto ok = probes_promised(); !ok) return refuse(ok.error(), desync.sequence);
    if (read_at_us_ - desync_at_us_ < desync_interval_us) {
        Goodbye goodbye = goodbye_for(
            {ErrorCode::rate_limited,
             fmt::format("two differences within {} s: wait for the snapshot before probing again",
                         desync_interval_us / microseconds_per_second)},
            desync.sequence);
        goodbye.requirement = requirement::desync_answered;
        return part(std::move(goodbye));
    }
    desync_at_us_ = read_at_us_;
    const PartKind kind = kind_of(desync.box, desync.part);
    ++around_.stats.desyncs[kind];
    spdlog::error(
        "session {}: another sea after result {}, in patch {} {} {}, box {}, {} {}: sea time {} us at x {} z {} (lattice "
        "units): {:016x} here, {:016x} there; starting again from nothing",
        id_, desync.result, desync.patch.level, desync.patch.x, desync.patch.z, desync.box.value,
        name_of(kind), desync.part, desync.time.us, desync.at.x, desync.at.z, desync.expected, desync.actual);
    state_.resync();
    sea_news_ = true;
}

void Session::handle(const Goodbye& goodbye) {
    wind_up(goodbye.code == ErrorCode::none ? ErrorCode::client_closed : goodbye.code,
            goodbye.message.empty() ? "the client said goodbye" : "the client: " + goodbye.message);
}

}  // namespace trochoid
