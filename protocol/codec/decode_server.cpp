#include "protocol/codec/delta_coding.hpp"
#include "protocol/codec/envelope.hpp"
#include "protocol/codec/plane_coding.hpp"

namespace trochoid {

namespace {

/// Envelope, delta, key and its boxes, or a list's entries.
constexpr flatbuffers::uoffset_t most_tables = 2048;
constexpr uint32_t most_challenge_points = 65536;
constexpr size_t most_rays = 65536;

Limits unpack(Scrutiny& check, const wire_fb::Limits* limits) {
    constexpr uint32_t least_frame = 1024;
    constexpr uint32_t most_frame = uint32_t{1} << 24;
    Limits l;
    if (check.present("limits", limits) == nullptr) return l;
    l.frame_before_login =
        check.within("limits.frame_before_login", limits->frame_before_login(), least_frame, most_frame);
    l.frame_after_login =
        check.within("limits.frame_after_login", limits->frame_after_login(), least_frame, most_frame);
    l.frame_to_client =
        check.within("limits.frame_to_client", limits->frame_to_client(), least_frame, most_frame);
    l.hello_deadline_ms = limits->hello_deadline_ms();
    l.views_per_second = limits->views_per_second();
    l.sync_regions = limits->sync_regions();
    l.sync_radius = limits->sync_radius();
    l.patches = limits->patches();
    l.trains_per_box = limits->trains_per_box();
    l.boxes = limits->boxes();
    l.commands_per_second = limits->commands_per_second();
    l.sample_points = limits->sample_points();
    l.sessions = limits->sessions();
    l.control_messages = limits->control_messages();
    l.no_progress_ms = limits->no_progress_ms();
    l.command_lead_ms = limits->command_lead_ms();
    return l;
}

/// The ranges of TerrainGrid; columns 0 says that there is no terrain.
TerrainInfo unpack(Scrutiny& check, const wire_fb::Terrain* terrain) {
    TerrainInfo t;
    if (check.present("terrain", terrain) == nullptr) return t;
    const uint32_t least_side = terrain->columns() == 0 ? 0 : 2;
    t.spacing_log2 = check.within("terrain.spacing_log2", terrain->spacing_log2(), 0U, 20U);
    t.columns = check.within("terrain.columns", terrain->columns(), least_side, 16385U);
    t.rows = check.within("terrain.rows", terrain->rows(), least_side, 16385U);
    t.height_step_log2 = check.within("terrain.height_step_log2", terrain->height_step_log2(), 0, 10);
    t.open_sea_depth = check.within("terrain.open_sea_depth", terrain->open_sea_depth(), -(1 << 24),
                                    t.columns == 0 ? 0 : -1);
    const LatticePoint origin = check.place("terrain.origin", terrain->origin_x(), terrain->origin_z());
    t.origin_x = origin.x;
    t.origin_z = origin.z;
    if (check.refused() || t.columns == 0) return t;
    const int64_t spacing = int64_t{1} << t.spacing_log2;
    check.require((t.origin_x & (spacing - 1)) == 0 && (t.origin_z & (spacing - 1)) == 0,
                  "terrain.origin is not a multiple of the spacing");
    check.place("terrain's far corner", t.origin_x + (int64_t{t.columns} - 1) * spacing,
                t.origin_z + (int64_t{t.rows} - 1) * spacing);
    return t;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::ServerHello& m) {
    ServerHello out;
    out.protocol = check.within("protocol", m.protocol(), uint16_t{1}, uint16_t{UINT16_MAX});
    out.model = m.model();
    out.schema_hash = m.schema_hash();
    out.software = check.text("software", m.software(), longest_name);
    out.session = m.session();
    out.world = check.text("world", m.world(), longest_name);
    out.instance = unpack_instance(check, m.instance());
    check.require(m.role() <= wire_fb::Role::admin, "role is none of viewer, director, admin");
    out.role = static_cast<Role>(m.role());
    out.log_position = {m.log_position()};
    out.clock = unpack(check, m.clock());
    out.client_stamp_us = check.stamp("client_stamp_us", m.client_stamp_us());
    out.server_now_us = check.stamp("server_now_us", m.server_now_us());
    out.limits = unpack(check, m.limits());
    out.challenge_seed = m.challenge_seed();
    out.challenge_count = check.within("challenge_count", m.challenge_count(), 0U, most_challenge_points);
    out.projection = check.text("projection", m.projection(), longest_projection);
    out.origin_lon = check.within("origin_lon", m.origin_lon(), -180.0, 180.0);
    out.origin_lat = check.within("origin_lat", m.origin_lat(), -90.0, 90.0);
    out.terrain = unpack(check, m.terrain());
    out.capabilities = m.capabilities();
    out.resumed = m.resumed();
    if (const auto* ticket = check.optional_list("ticket", m.ticket(), longest_ticket))
        out.ticket.assign(ticket->begin(), ticket->end());
    out.ticket_life_ms = m.ticket_life_ms();
    out.last_session = m.last_session();
    out.last_code = unpack(check, m.last_code());
    return out;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::ClockReply& m) {
    ClockReply out;
    out.sequence = m.sequence();
    out.client_sent_us = check.stamp("client_sent_us", m.client_sent_us());
    out.server_received_us = check.stamp("server_received_us", m.server_received_us());
    out.server_sent_us = check.stamp("server_sent_us", m.server_sent_us());
    check.require(out.server_received_us <= out.server_sent_us,
                  "server_sent_us is before server_received_us");
    out.clock = unpack(check, m.clock());
    out.watermark = check.sea_time("watermark_us", m.watermark_us());
    out.log_position = {m.log_position()};
    out.log_hash = m.log_hash();
    check.require(m.verdict() <= wire_fb::Verdict::approximate,
                  "verdict is not pending, exact or approximate");
    out.verdict = static_cast<Verdict>(m.verdict());
    return out;
}

/// Coarsest level of the largest grid: 16,384 cells in one tile of 64.
constexpr uint8_t coarsest_tile_level = 8;

TerrainTile unpack_tile(Scrutiny& check, const wire_fb::TerrainTile& t) {
    TerrainTile out;
    out.key.level = check.within("a tile's level", t.level(), uint8_t{0}, coarsest_tile_level);
    if (check.refused()) return out;
    const int32_t last = (int32_t{256} >> out.key.level) - 1;
    out.key.x = check.within("a tile's x", t.x(), 0, last);
    out.key.z = check.within("a tile's z", t.z(), 0, last);
    out.spacing_log2 = check.within("a tile's spacing_log2", t.spacing_log2(), out.key.level,
                                    static_cast<uint8_t>(20 + out.key.level));
    out.height_step_log2 =
        check.within("a tile's height_step_log2", t.height_step_log2(), uint8_t{0}, uint8_t{10});
    const LatticePoint origin = check.place("a tile's origin", t.origin_x(), t.origin_z());
    out.origin_x = origin.x;
    out.origin_z = origin.z;
    if (check.refused()) return out;
    // The grid that the key and the origin imply must start on its own spacing, inside the world.
    const int64_t side = int64_t{terrain_tile_cells} << out.spacing_log2;
    const LatticePoint grid =
        check.place("a tile's grid", origin.x - out.key.x * side, origin.z - out.key.z * side);
    const int64_t below_spacing = (int64_t{1} << (out.spacing_log2 - out.key.level)) - 1;
    check.require(((grid.x | grid.z) & below_spacing) == 0,
                  "a tile's origin does not fit its key and spacing");
    if (const auto* heights = check.list("a tile's heights", t.heights(), size_t{1} << 16))
        check.require(read_heights({heights->data(), heights->size()}, out));
    return out;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::TerrainTiles& m) {
    TerrainTiles out;
    if (const auto* tiles = check.list("tiles", m.tiles(), most_tables))
        for (const wire_fb::TerrainTile* t : *tiles) {
            if (check.refused()) break;
            out.tiles.push_back(unpack_tile(check, *t));
        }
    return out;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::CommandReply& m) {
    CommandReply out;
    out.sequence = m.sequence();
    out.code = unpack(check, m.code());
    out.message = check.text("message", m.message(), longest_sentence);
    out.effective = check.sea_time("effective_us", m.effective_us());
    out.log_position = {m.log_position()};
    out.box = {m.box()};
    return out;
}

BoxSummary unpack_summary(Scrutiny& check, const wire_fb::BoxSummary& s) {
    BoxSummary out;
    out.box = {s.box()};
    out.name = check.text("a box's name", s.name(), longest_name);
    out.begin = check.sea_time("a box's begin_us", s.begin_us());
    out.end = check.sea_time("a box's end_us", s.end_us());
    out.decay_us = check.within("a box's decay_us", s.decay_us(), int64_t{0}, sea_time_bound);
    out.trains = s.trains();
    out.significant_height = check.finite("a box's significant_height", s.significant_height());
    out.wind_speed = check.finite("a box's wind_speed", s.wind_speed());
    out.towards_degrees = check.finite("a box's towards_degrees", s.towards_degrees());
    out.gain_now = check.finite("a box's gain_now", s.gain_now());
    check.require(s.kind() <= wire_fb::BoxKind::MAX, "a box's kind is none of the standard's");
    out.kind = static_cast<BoxKind>(s.kind());
    out.at = check.place("a box's place", s.x(), s.z());
    out.vx = check.finite("a box's vx", s.vx());
    out.vz = check.finite("a box's vz", s.vz());
    if (const auto* hull = s.hull()) {
        out.hull = {hull->length(), hull->beam()};
        check.require(validate(out.hull));
    }
    return out;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::BoxList& m) {
    BoxList out;
    out.sequence = m.sequence();
    out.now = check.sea_time("now_us", m.now_us());
    if (const auto* boxes = check.list("boxes", m.boxes(), Limits{}.boxes, ErrorCode::too_many_boxes))
        for (const wire_fb::BoxSummary* s : *boxes) out.boxes.push_back(unpack_summary(check, *s));
    out.last = m.last();
    return out;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::SampleReply& m) {
    SampleReply out;
    out.sequence = m.sequence();
    out.time = check.sea_time("time_us", m.time_us());
    out.log_position = {m.log_position()};
    if (const auto* samples = check.list("samples", m.samples(), Limits{}.sample_points))
        for (const wire_fb::Sample* s : *samples) {
            const auto f = [&](float v) { return check.finite("a sample", v); };
            out.samples.push_back({f(s->ax()), f(s->ay()), f(s->az()), f(s->pxx()), f(s->pxz()), f(s->pzx()),
                                   f(s->pzz()), f(s->yx()), f(s->yz()), f(s->nx()), f(s->ny()), f(s->nz()),
                                   f(s->vx()), f(s->vy()), f(s->vz())});
        }
    return out;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::RaysReply& m) {
    RaysReply out;
    out.sequence = m.sequence();
    out.box = {m.box()};
    out.last = m.last();
    const auto* rays = check.list("rays", m.rays(), most_rays);
    const auto* points = check.list("points", m.points(), most_rays);
    if (rays == nullptr || points == nullptr) return out;
    uint32_t next = 0;
    for (const wire_fb::Ray* r : *rays) {
        WaveRay ray;
        ray.start = check.place("a ray's start", r->start().x(), r->start().z());
        ray.end = check.place("a ray's end", r->end().x(), r->end().z());
        check.require(r->point_count() <= points->size() - next,
                      "the rays' point_counts add up to more than points holds");
        for (uint32_t i = 0; i < r->point_count() && !check.refused(); ++i) {
            const wire_fb::ActionPoint* p = points->Get(next++);
            const uint8_t kind = check.within("an action point's kind", p->kind(), uint8_t{1}, uint8_t{4});
            ray.points.push_back(
                {check.place("an action point", p->x(), p->z()), static_cast<ActionKind>(kind)});
        }
        if (check.refused()) return out;
        out.rays.push_back(std::move(ray));
    }
    check.require(next == points->size(), "points holds more than the rays' point_counts add up to");
    return out;
}

ServerMessage unpack(Scrutiny& check, const wire_fb::ProbeReply& m) {
    ProbeReply out;
    out.sequence = m.sequence();
    out.result = m.result();
    out.stale = m.stale();
    out.time = check.sea_time("time_us", m.time_us());
    const auto* samples = check.list("samples", m.samples(), most_probe_points);
    const auto* counts = check.list("part_counts", m.part_counts(), most_probe_points);
    const auto* parts = check.list("parts", m.parts(), most_probe_parts);
    const auto* sums = check.list("sums", m.sums(), most_probe_parts);
    if (check.refused()) return out;
    check.require(samples->size() == counts->size(), "samples and part_counts differ in length");
    check.require(parts->size() == sums->size(), "parts and sums differ in length");
    check.require(!out.stale || samples->size() == 0, "a stale reply has points");
    uint32_t next = 0;
    for (uint32_t i = 0; i < samples->size() && !check.refused(); ++i) {
        ProbedPoint point;
        point.sample = samples->Get(i);
        const uint32_t count = counts->Get(i);
        check.require(count <= parts->size() - next, "the part_counts add up to more than parts holds");
        for (uint32_t j = 0; j < count && !check.refused(); ++j, ++next)
            point.parts.push_back({{parts->Get(next)->box()}, parts->Get(next)->part(), sums->Get(next)});
        out.points.push_back(std::move(point));
    }
    check.require(check.refused() || next == parts->size(),
                  "parts holds more than the part_counts add up to");
    return out;
}

ServerMessage unpack_body(Scrutiny& check, const wire_fb::ServerEnvelope& e) {
    const auto table = [&](const auto* body) -> ServerMessage {
        return check.present("body", body) == nullptr ? ServerMessage{} : ServerMessage{unpack(check, *body)};
    };
    switch (e.body_type()) {
        case wire_fb::ServerBody::ServerHello: return table(e.body_as_ServerHello());
        case wire_fb::ServerBody::ClockReply: return table(e.body_as_ClockReply());
        case wire_fb::ServerBody::Delta: return table(e.body_as_Delta());
        case wire_fb::ServerBody::TerrainTiles: return table(e.body_as_TerrainTiles());
        case wire_fb::ServerBody::CommandReply: return table(e.body_as_CommandReply());
        case wire_fb::ServerBody::BoxList: return table(e.body_as_BoxList());
        case wire_fb::ServerBody::SampleReply: return table(e.body_as_SampleReply());
        case wire_fb::ServerBody::RaysReply: return table(e.body_as_RaysReply());
        case wire_fb::ServerBody::Goodbye: return table(e.body_as_Goodbye());
        case wire_fb::ServerBody::ProbeReply: return table(e.body_as_ProbeReply());
        default:
            check.refuse(ErrorCode::unknown_message,
                         "the message is none that a server may send in this protocol version");
            return ServerMessage{};
    }
}

}  // namespace

Result<ServerMessage> decode_server(std::span<const uint8_t> data) {
    const auto envelope =
        open_envelope<wire_fb::ServerEnvelope>(data, wire_fb::ServerEnvelopeIdentifier(), most_tables);
    if (!envelope) return envelope.error();
    Scrutiny check;
    ServerMessage message = unpack_body(check, **envelope);
    if (check.refused()) return check.error();
    return message;
}

}  // namespace trochoid
