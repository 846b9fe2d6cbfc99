#include "protocol/codec/delta_coding.hpp"
#include "protocol/codec/envelope.hpp"
#include "protocol/codec/plane_coding.hpp"
#include "server_generated.h"

namespace trochoid {

namespace {

flatbuffers::Offset<wire_fb::Limits> pack(Builder& b, const Limits& l) {
    return wire_fb::CreateLimits(b, l.frame_before_login, l.frame_after_login, l.frame_to_client,
                                 l.hello_deadline_ms, l.views_per_second, l.sync_regions, l.sync_radius,
                                 l.patches, l.trains_per_box, l.boxes, l.commands_per_second, l.sample_points,
                                 l.sessions, l.control_messages, l.no_progress_ms, l.command_lead_ms);
}

flatbuffers::Offset<wire_fb::TerrainTile> pack(Builder& b, const TerrainTile& t) {
    const auto heights = b.CreateVector(code_heights(t));
    return wire_fb::CreateTerrainTile(b, t.origin_x, t.origin_z, t.key.x, t.key.z, t.key.level,
                                      static_cast<uint8_t>(t.spacing_log2),
                                      static_cast<uint8_t>(t.height_step_log2), heights);
}

flatbuffers::Offset<wire_fb::BoxSummary> pack(Builder& b, const BoxSummary& s) {
    const auto name = b.CreateString(s.name);
    const wire_fb::Hull hull(s.hull.length, s.hull.beam);
    return wire_fb::CreateBoxSummary(b, s.box.value, name, s.begin.us, s.end.us, s.decay_us, s.trains,
                                     s.significant_height, s.wind_speed, s.towards_degrees, s.gain_now,
                                     static_cast<wire_fb::BoxKind>(s.kind), s.at.x, s.at.z, s.vx, s.vz,
                                     has_hull(s.hull) ? &hull : nullptr);
}

wire_fb::Sample pack(const SurfaceSample& s) {
    return {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz};
}

struct ServerEncoder {
    Builder& b;
    wire_fb::ServerBody tag = wire_fb::ServerBody::NONE;

    template <class Table>
    flatbuffers::Offset<void> as(wire_fb::ServerBody t, flatbuffers::Offset<Table> table) {
        tag = t;
        return table.Union();
    }

    flatbuffers::Offset<void> operator()(const ServerHello& m) {
        const auto software = b.CreateString(m.software);
        const auto world = b.CreateString(m.world);
        const auto instance = b.CreateVector(m.instance.bytes.data(), m.instance.bytes.size());
        const auto limits = pack(b, m.limits);
        const auto projection = b.CreateString(m.projection);
        const auto clock = trochoid::pack(m.clock);
        const wire_fb::Terrain terrain(m.terrain.origin_x, m.terrain.origin_z, m.terrain.spacing_log2,
                                       m.terrain.columns, m.terrain.rows, m.terrain.height_step_log2,
                                       m.terrain.open_sea_depth);
        const auto ticket = m.ticket.empty() ? 0 : b.CreateVector(m.ticket);
        return as(wire_fb::ServerBody::ServerHello,
                  wire_fb::CreateServerHello(
                      b, m.protocol, m.model, m.schema_hash, software, m.session, world, instance,
                      static_cast<wire_fb::Role>(m.role), m.log_position.value, &clock, m.client_stamp_us,
                      m.server_now_us, limits, m.challenge_seed, m.challenge_count, projection, m.origin_lon,
                      m.origin_lat, &terrain, m.capabilities, m.resumed, ticket, m.ticket_life_ms,
                      m.last_session, trochoid::pack(m.last_code)));
    }
    flatbuffers::Offset<void> operator()(const ClockReply& m) {
        const auto clock = trochoid::pack(m.clock);
        return as(wire_fb::ServerBody::ClockReply,
                  wire_fb::CreateClockReply(b, m.sequence, m.client_sent_us, m.server_received_us,
                                            m.server_sent_us, &clock, m.watermark.us, m.log_position.value,
                                            m.log_hash, static_cast<wire_fb::Verdict>(m.verdict)));
    }
    flatbuffers::Offset<void> operator()(const Delta& m) {
        return as(wire_fb::ServerBody::Delta, trochoid::pack(b, m));
    }
    flatbuffers::Offset<void> operator()(const TerrainTiles& m) {
        std::vector<flatbuffers::Offset<wire_fb::TerrainTile>> tiles;
        tiles.reserve(m.tiles.size());
        for (const TerrainTile& t : m.tiles) tiles.push_back(pack(b, t));
        const auto tiles_at = b.CreateVector(tiles);
        return as(wire_fb::ServerBody::TerrainTiles, wire_fb::CreateTerrainTiles(b, tiles_at));
    }
    flatbuffers::Offset<void> operator()(const CommandReply& m) {
        const auto message = b.CreateString(sentence_for_wire(m.message));
        return as(wire_fb::ServerBody::CommandReply,
                  wire_fb::CreateCommandReply(b, m.sequence, trochoid::pack(m.code), message, m.effective.us,
                                              m.log_position.value, m.box.value));
    }
    flatbuffers::Offset<void> operator()(const BoxList& m) {
        std::vector<flatbuffers::Offset<wire_fb::BoxSummary>> boxes;
        boxes.reserve(m.boxes.size());
        for (const BoxSummary& s : m.boxes) boxes.push_back(pack(b, s));
        const auto boxes_at = b.CreateVector(boxes);
        return as(wire_fb::ServerBody::BoxList,
                  wire_fb::CreateBoxList(b, m.sequence, m.now.us, boxes_at, m.last));
    }
    flatbuffers::Offset<void> operator()(const SampleReply& m) {
        std::vector<wire_fb::Sample> samples;
        samples.reserve(m.samples.size());
        for (const SurfaceSample& s : m.samples) samples.push_back(pack(s));
        const auto samples_at = b.CreateVectorOfStructs(samples);
        return as(wire_fb::ServerBody::SampleReply,
                  wire_fb::CreateSampleReply(b, m.sequence, m.time.us, m.log_position.value, samples_at));
    }
    flatbuffers::Offset<void> operator()(const RaysReply& m) {
        std::vector<wire_fb::Ray> rays;
        std::vector<wire_fb::ActionPoint> points;
        for (const WaveRay& r : m.rays) {
            rays.emplace_back(wire_fb::Point(r.start.x, r.start.z), wire_fb::Point(r.end.x, r.end.z),
                              static_cast<uint32_t>(r.points.size()));
            for (const ActionPoint& p : r.points)
                points.emplace_back(p.at.x, p.at.z, static_cast<uint8_t>(p.kind));
        }
        const auto rays_at = b.CreateVectorOfStructs(rays);
        const auto points_at = b.CreateVectorOfStructs(points);
        return as(wire_fb::ServerBody::RaysReply,
                  wire_fb::CreateRaysReply(b, m.sequence, m.box.value, rays_at, points_at, m.last));
    }
    flatbuffers::Offset<void> operator()(const ProbeReply& m) {
        std::vector<uint64_t> samples;
        std::vector<uint16_t> counts;
        std::vector<wire_fb::Part> parts;
        std::vector<uint64_t> sums;
        for (const ProbedPoint& point : m.points) {
            samples.push_back(point.sample);
            counts.push_back(static_cast<uint16_t>(point.parts.size()));
            for (const ProbePart& part : point.parts) {
                parts.emplace_back(part.box.value, part.part);
                sums.push_back(part.sum);
            }
        }
        const auto samples_at = b.CreateVector(samples);
        const auto counts_at = b.CreateVector(counts);
        const auto parts_at = b.CreateVectorOfStructs(parts);
        const auto sums_at = b.CreateVector(sums);
        return as(wire_fb::ServerBody::ProbeReply,
                  wire_fb::CreateProbeReply(b, m.sequence, m.result, m.stale, m.time.us, samples_at,
                                            counts_at, parts_at, sums_at));
    }
    flatbuffers::Offset<void> operator()(const Goodbye& m) {
        return as(wire_fb::ServerBody::Goodbye, trochoid::pack(b, m));
    }
};

}  // namespace

Bytes encode(const ServerMessage& message) {
    Builder builder(1024);
    builder.ForceDefaults(true);
    ServerEncoder encoder{builder};
    const auto body = std::visit(encoder, message);
    return finish_envelope(builder, wire_fb::CreateServerEnvelope(builder, 0, encoder.tag, body),
                           wire_fb::ServerEnvelopeIdentifier());
}

}  // namespace trochoid
