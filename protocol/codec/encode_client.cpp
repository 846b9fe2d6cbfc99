#include "client_generated.h"
#include "protocol/codec/envelope.hpp"
#include "protocol/codec/value_coding.hpp"

namespace trochoid {

namespace {

struct ClientEncoder {
    Builder& b;
    wire_fb::ClientBody tag = wire_fb::ClientBody::NONE;

    template <class Table>
    flatbuffers::Offset<void> as(wire_fb::ClientBody t, flatbuffers::Offset<Table> table) {
        tag = t;
        return table.Union();
    }

    flatbuffers::Offset<void> operator()(const ClientHello& m) {
        const auto software = b.CreateString(m.software);
        const auto world = b.CreateString(m.world);
        const auto token = b.CreateString(m.token);
        const auto regions = trochoid::pack(b, m.regions);
        const auto view = trochoid::pack(m.view);
        const auto ticket = m.ticket.empty() ? 0 : b.CreateVector(m.ticket);
        const auto resume = m.resume ? pack(*m.resume) : 0;
        return as(wire_fb::ClientBody::ClientHello,
                  wire_fb::CreateClientHello(b, m.protocol_min, m.protocol_max, m.model, m.schema_hash,
                                             software, world, token, &view, regions, m.clock_stamp_us,
                                             m.capabilities, ticket, resume, trochoid::pack(m.last_code)));
    }
    flatbuffers::Offset<wire_fb::Resume> pack(const ResumeState& r) {
        const auto instance = b.CreateVector(r.instance.bytes.data(), r.instance.bytes.size());
        const auto key = trochoid::pack(b, r.key);
        return wire_fb::CreateResume(b, instance, key, r.state_hash, r.log_position.value, r.log_hash);
    }
    flatbuffers::Offset<void> operator()(const ViewUpdate& m) {
        const auto view = trochoid::pack(m.view);
        return as(wire_fb::ClientBody::ViewUpdate, wire_fb::CreateViewUpdate(b, m.sequence, &view));
    }
    flatbuffers::Offset<void> operator()(const SyncRegions& m) {
        const auto regions = trochoid::pack(b, m.regions);
        return as(wire_fb::ClientBody::SyncRegions, wire_fb::CreateSyncRegions(b, m.sequence, regions));
    }
    flatbuffers::Offset<void> operator()(const ClockRequest& m) {
        return as(wire_fb::ClientBody::ClockRequest,
                  wire_fb::CreateClockRequest(b, m.sequence, m.client_sent_us));
    }
    flatbuffers::Offset<void> operator()(const Ack& m) {
        return as(wire_fb::ClientBody::Ack,
                  wire_fb::CreateAck(b, m.result, m.state_hash, m.patches_per_second,
                                     m.known_answer.has_value(), m.known_answer.value_or(0)));
    }
    flatbuffers::Offset<void> operator()(const Command& m);
    flatbuffers::Offset<void> operator()(const SampleRequest& m) {
        const auto points_at = pack(m.points);
        return as(wire_fb::ClientBody::SampleRequest,
                  wire_fb::CreateSampleRequest(b, m.sequence, m.time.us, points_at));
    }
    flatbuffers::Offset<flatbuffers::Vector<const wire_fb::Point*>> pack(
        const std::vector<LatticePoint>& list) {
        std::vector<wire_fb::Point> points;
        points.reserve(list.size());
        for (const LatticePoint& p : list) points.emplace_back(p.x, p.z);
        return b.CreateVectorOfStructs(points);
    }
    flatbuffers::Offset<void> operator()(const Probe& m) {
        const auto points_at = pack(m.points);
        return as(wire_fb::ClientBody::Probe,
                  wire_fb::CreateProbe(b, m.sequence, m.result, m.time.us, points_at));
    }
    flatbuffers::Offset<void> operator()(const Desync& m) {
        const wire_fb::Difference difference(wire_fb::Point(m.at.x, m.at.z), m.time.us, m.expected, m.actual,
                                             m.patch.x, m.patch.z, m.box.value, m.part, m.patch.level);
        return as(wire_fb::ClientBody::Desync, wire_fb::CreateDesync(b, m.sequence, m.result, &difference));
    }
    flatbuffers::Offset<void> operator()(const RaysRequest& m) {
        return as(wire_fb::ClientBody::RaysRequest, wire_fb::CreateRaysRequest(b, m.sequence, m.box.value));
    }
    flatbuffers::Offset<void> operator()(const Goodbye& m) {
        return as(wire_fb::ClientBody::Goodbye, trochoid::pack(b, m));
    }
};

struct ActionEncoder {
    Builder& b;
    wire_fb::Action tag = wire_fb::Action::NONE;

    flatbuffers::Offset<void> operator()(const StartWind& a) {
        tag = wire_fb::Action::StartWind;
        const auto wind = pack(a);
        return wire_fb::CreateStartWind(b, &wind).Union();
    }
    flatbuffers::Offset<void> operator()(const StopWind& a) {
        tag = wire_fb::Action::StopWind;
        return wire_fb::CreateStopWind(b, a.box.value).Union();
    }
    flatbuffers::Offset<void> operator()(const ListBoxes&) {
        tag = wire_fb::Action::ListBoxes;
        return wire_fb::CreateListBoxes(b).Union();
    }
    flatbuffers::Offset<void> operator()(const SetRate& a) {
        tag = wire_fb::Action::SetRate;
        return wire_fb::CreateSetRate(b, a.rate_q16).Union();
    }
    flatbuffers::Offset<void> operator()(const SkipTime& a) {
        tag = wire_fb::Action::SkipTime;
        return wire_fb::CreateSkipTime(b, a.forward_us).Union();
    }
    flatbuffers::Offset<void> operator()(const StartShip& a) {
        tag = wire_fb::Action::StartShip;
        const auto name = b.CreateString(a.name);
        const wire_fb::Ship ship(a.at.x, a.at.z, a.towards_degrees, a.speed, a.length, a.beam);
        return wire_fb::CreateStartShip(b, &ship, name).Union();
    }
    flatbuffers::Offset<void> operator()(const Steer& a) {
        tag = wire_fb::Action::Steer;
        return wire_fb::CreateSteer(b, a.box.value, a.towards_degrees, a.speed).Union();
    }
    flatbuffers::Offset<void> operator()(const ChangeLand& a) {
        tag = wire_fb::Action::ChangeLand;
        return pack(b, a).Union();
    }
};

flatbuffers::Offset<void> ClientEncoder::operator()(const Command& m) {
    ActionEncoder action{b};
    const auto action_at = std::visit(action, m.action);
    return as(wire_fb::ClientBody::Command,
              wire_fb::CreateCommand(b, m.sequence, m.at.us, m.refuse_if_late, action.tag, action_at));
}

}  // namespace

Bytes encode(const ClientMessage& message) {
    Builder builder(512);
    builder.ForceDefaults(true);
    ClientEncoder encoder{builder};
    const auto body = std::visit(encoder, message);
    return finish_envelope(builder, wire_fb::CreateClientEnvelope(builder, 0, encoder.tag, body),
                           wire_fb::ClientEnvelopeIdentifier());
}

}  // namespace trochoid
