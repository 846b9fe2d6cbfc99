#include "client_generated.h"
#include "protocol/codec/envelope.hpp"
#include "protocol/codec/value_coding.hpp"

namespace trochoid {

namespace {

/// Envelope, body, action; no client message nests more.
constexpr flatbuffers::uoffset_t most_tables = 16;

ViewState unpack_view(Scrutiny& check, const wire_fb::View* view) {
    return check.present("view", view) == nullptr ? ViewState{} : unpack(check, *view, widest_view);
}

ResumeState unpack(Scrutiny& check, const wire_fb::Resume& r) {
    ResumeState out;
    out.instance = unpack_instance(check, r.instance());
    out.key = unpack(check, r.key());
    out.state_hash = r.state_hash();
    out.log_position = {r.log_position()};
    out.log_hash = r.log_hash();
    return out;
}

ClientMessage unpack(Scrutiny& check, const wire_fb::ClientHello& m) {
    ClientHello out;
    out.protocol_min = m.protocol_min();
    out.protocol_max = m.protocol_max();
    check.require(out.protocol_min <= out.protocol_max, "protocol_min is above protocol_max");
    out.model = m.model();
    out.schema_hash = m.schema_hash();
    out.software = check.text("software", m.software(), longest_name);
    out.world = check.text("world", m.world(), longest_name);
    out.token = check.text("token", m.token(), longest_token);
    out.view = unpack_view(check, m.view());
    out.regions = unpack_regions(check, m.regions());
    out.clock_stamp_us = check.stamp("clock_stamp_us", m.clock_stamp_us());
    out.capabilities = m.capabilities();
    if (const auto* ticket = check.optional_list("ticket", m.ticket(), longest_ticket))
        out.ticket.assign(ticket->begin(), ticket->end());
    if (m.resume() != nullptr) out.resume = unpack(check, *m.resume());
    out.last_code = unpack(check, m.last_code());
    return out;
}

ClientMessage unpack(Scrutiny& check, const wire_fb::ViewUpdate& m) {
    return ViewUpdate{m.sequence(), unpack_view(check, m.view())};
}

ClientMessage unpack(Scrutiny& check, const wire_fb::SyncRegions& m) {
    return SyncRegions{m.sequence(), unpack_regions(check, m.regions())};
}

ClientMessage unpack(Scrutiny& check, const wire_fb::ClockRequest& m) {
    return ClockRequest{m.sequence(), check.stamp("client_sent_us", m.client_sent_us())};
}

ClientMessage unpack(Scrutiny& check, const wire_fb::Ack& m) {
    Ack out;
    out.result = m.result();
    out.state_hash = m.state_hash();
    out.patches_per_second = m.patches_per_second();
    if (m.has_known_answer()) out.known_answer = m.known_answer();
    check.require(m.has_known_answer() || m.known_answer() == 0,
                  "known_answer is set but has_known_answer is not");
    return out;
}

StartShip unpack(Scrutiny& check, const wire_fb::StartShip& a) {
    StartShip out;
    const auto* ship = check.present("ship", a.ship());
    if (ship == nullptr) return out;
    out.at = check.place("ship", ship->x(), ship->z());
    out.towards_degrees = unpack_heading(check, "ship.towards_degrees", ship->towards_degrees());
    out.speed = check.within("ship.speed", ship->speed(), slowest_ship, fastest_ship);
    out.length = check.within("ship.length", ship->length(), 1.0F, longest_ship);
    out.beam = check.within("ship.beam", ship->beam(), 0.0F, longest_ship);
    check.require(out.beam <= out.length, "ship.beam is above ship.length");
    out.name = check.text("name", a.name(), longest_ship_name);
    return out;
}

Steer unpack(Scrutiny& check, const wire_fb::Steer& a) {
    Steer out{{a.box()}, 0.0F, 0.0F};
    out.towards_degrees = unpack_heading(check, "towards_degrees", a.towards_degrees());
    out.speed = check.within("speed", a.speed(), 0.0F, fastest_wind_box);
    return out;
}

ClientMessage unpack(Scrutiny& check, const wire_fb::Command& m) {
    Command out;
    out.sequence = m.sequence();
    out.at = check.sea_time("at_us", m.at_us());
    out.refuse_if_late = m.refuse_if_late();
    const bool present = check.present("action", m.action()) != nullptr;
    switch (m.action_type()) {
        case wire_fb::Action::StartWind:
            if (present) out.action = unpack_asked(check, m.action_as_StartWind()->wind());
            break;
        case wire_fb::Action::StopWind:
            if (present) out.action = StopWind{{m.action_as_StopWind()->box()}};
            break;
        case wire_fb::Action::ListBoxes: out.action = ListBoxes{}; break;
        case wire_fb::Action::SetRate:
            if (present)
                out.action = SetRate{
                    check.within("rate_q16", m.action_as_SetRate()->rate_q16(), 0U, largest_rate_q16)};
            break;
        case wire_fb::Action::StartShip:
            if (present) out.action = unpack(check, *m.action_as_StartShip());
            break;
        case wire_fb::Action::Steer:
            if (present) out.action = unpack(check, *m.action_as_Steer());
            break;
        case wire_fb::Action::ChangeLand:
            if (present) out.action = unpack(check, *m.action_as_ChangeLand());
            break;
        case wire_fb::Action::SkipTime:
            if (present)
                out.action = SkipTime{check.within("forward_us", m.action_as_SkipTime()->forward_us(),
                                                   int64_t{1}, longest_skip_us)};
            break;
        default: check.refuse(ErrorCode::unknown_message, "the command's action is none of the standard's");
    }
    return out;
}

std::vector<LatticePoint> unpack_points(Scrutiny& check,
                                        const flatbuffers::Vector<const wire_fb::Point*>* list, size_t most) {
    std::vector<LatticePoint> out;
    const auto* points = check.list("points", list, most);
    if (points == nullptr) return out;
    out.reserve(points->size());
    for (const wire_fb::Point* p : *points) out.push_back(check.place("a point", p->x(), p->z()));
    return out;
}

ClientMessage unpack(Scrutiny& check, const wire_fb::SampleRequest& m) {
    return SampleRequest{m.sequence(), check.sea_time("time_us", m.time_us()),
                         unpack_points(check, m.points(), Limits{}.sample_points)};
}

ClientMessage unpack(Scrutiny& check, const wire_fb::Probe& m) {
    Probe out{m.sequence(), m.result(), check.sea_time("time_us", m.time_us()),
              unpack_points(check, m.points(), most_probe_points)};
    check.require(check.refused() || !out.points.empty(), "points is empty");
    check.require(out.result > 0, "result is 0");
    return out;
}

ClientMessage unpack(Scrutiny& check, const wire_fb::Desync& m) {
    Desync out;
    out.sequence = m.sequence();
    out.result = m.result();
    const auto* d = check.present("difference", m.difference());
    if (d == nullptr) return out;
    out.at = check.place("difference.at", d->at().x(), d->at().z());
    out.time = check.sea_time("difference.time_us", d->time_us());
    out.expected = d->expected();
    out.actual = d->actual();
    out.box = {d->box()};
    out.part = d->part();
    out.patch = unpack_patch_key(check, d->patch_level(), d->patch_x(), d->patch_z());
    return out;
}

ClientMessage unpack(Scrutiny&, const wire_fb::RaysRequest& m) {
    return RaysRequest{m.sequence(), {m.box()}};
}

ClientMessage unpack_body(Scrutiny& check, const wire_fb::ClientEnvelope& e) {
    const auto table = [&](const auto* body) -> ClientMessage {
        return check.present("body", body) == nullptr ? ClientMessage{} : ClientMessage{unpack(check, *body)};
    };
    switch (e.body_type()) {
        case wire_fb::ClientBody::ClientHello: return table(e.body_as_ClientHello());
        case wire_fb::ClientBody::ViewUpdate: return table(e.body_as_ViewUpdate());
        case wire_fb::ClientBody::SyncRegions: return table(e.body_as_SyncRegions());
        case wire_fb::ClientBody::ClockRequest: return table(e.body_as_ClockRequest());
        case wire_fb::ClientBody::Ack: return table(e.body_as_Ack());
        case wire_fb::ClientBody::Command: return table(e.body_as_Command());
        case wire_fb::ClientBody::SampleRequest: return table(e.body_as_SampleRequest());
        case wire_fb::ClientBody::RaysRequest: return table(e.body_as_RaysRequest());
        case wire_fb::ClientBody::Goodbye: return table(e.body_as_Goodbye());
        case wire_fb::ClientBody::Probe: return table(e.body_as_Probe());
        case wire_fb::ClientBody::Desync: return table(e.body_as_Desync());
        default:
            check.refuse(ErrorCode::unknown_message,
                         "the message is none that a client may send in this protocol version");
            return ClientMessage{};
    }
}

}  // namespace

Result<ClientMessage> decode_client(std::span<const uint8_t> data) {
    const auto envelope =
        open_envelope<wire_fb::ClientEnvelope>(data, wire_fb::ClientEnvelopeIdentifier(), most_tables);
    if (!envelope) return envelope.error();
    Scrutiny check;
    ClientMessage message = unpack_body(check, **envelope);
    if (check.refused()) return check.error();
    return message;
}

}  // namespace trochoid
