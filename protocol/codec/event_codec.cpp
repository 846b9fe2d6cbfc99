#include "event_generated.h"
#include "protocol/codec/envelope.hpp"
#include "protocol/codec/value_coding.hpp"

namespace trochoid {

namespace {

/// Envelope, body, up to 64 changes, and two tables for each box that goes on.
constexpr flatbuffers::uoffset_t most_tables = 4096;

struct EventEncoder {
    Builder& b;
    wire_fb::EventBody tag = wire_fb::EventBody::NONE;

    flatbuffers::Offset<void> operator()(const BoxStarted& e) {
        tag = wire_fb::EventBody::BoxStarted;
        const auto box = pack(b, e.box);
        const auto name = b.CreateString(e.name);
        const auto wind = pack(e.wind);
        return wire_fb::CreateBoxStarted(b, box, name, &wind).Union();
    }
    flatbuffers::Offset<void> operator()(const BoxEnding& e) {
        tag = wire_fb::EventBody::BoxEnding;
        return wire_fb::CreateBoxEnding(b, e.box.value, e.end.us).Union();
    }
    flatbuffers::Offset<void> operator()(const ClockChanged& e) {
        tag = wire_fb::EventBody::ClockChanged;
        const auto clock = pack(e.clock);
        return wire_fb::CreateClockChanged(b, &clock).Union();
    }
    flatbuffers::Offset<void> operator()(const BoxSteered& e) {
        tag = wire_fb::EventBody::BoxSteered;
        const auto leg = pack(e.leg);
        return wire_fb::CreateBoxSteered(b, e.box.value, &leg).Union();
    }
    flatbuffers::Offset<void> operator()(const LandChanged& e) {
        tag = wire_fb::EventBody::LandChanged;
        const auto change = pack(b, e.change);
        std::vector<flatbuffers::Offset<wire_fb::BoxSucceeded>> boxes;
        boxes.reserve(e.boxes.size());
        for (const BoxSucceeded& s : e.boxes) {
            const auto box = pack(b, s.box);
            boxes.push_back(wire_fb::CreateBoxSucceeded(b, s.predecessor.value, box));
        }
        const auto boxes_at = b.CreateVector(boxes);
        if (e.also.empty()) return wire_fb::CreateLandChanged(b, change, boxes_at).Union();
        std::vector<flatbuffers::Offset<wire_fb::ChangeLand>> also;
        also.reserve(e.also.size());
        for (const ChangeLand& next : e.also) also.push_back(pack(b, next));
        return wire_fb::CreateLandChanged(b, change, boxes_at, b.CreateVector(also)).Union();
    }
};

LandChanged unpack(Scrutiny& check, const wire_fb::LandChanged& changed) {
    LandChanged out;
    if (const auto* change = check.present("change", changed.change())) out.change = unpack(check, *change);
    if (const auto* also = check.optional_list("also", changed.also(), most_joined_changes)) {
        // Empty and absent would be two forms of one event.
        check.require(also->size() > 0, "also is there, but empty");
        for (const wire_fb::ChangeLand* next : *also) out.also.push_back(unpack(check, *next));
    }
    const auto* boxes = check.list("boxes", changed.boxes(), Limits{}.boxes, ErrorCode::too_many_boxes);
    if (boxes == nullptr) return out;
    for (const wire_fb::BoxSucceeded* s : *boxes) {
        if (check.refused()) return out;
        BoxSucceeded next{{s->predecessor()}, {}};
        check.require(
            out.boxes.empty() ? next.predecessor.value != 0 : out.boxes.back().predecessor < next.predecessor,
            "the boxes are not by ascending predecessor above 0");
        if (const auto* box = check.present("box", s->box())) next.box = unpack(check, *box);
        check.require(next.predecessor < next.box.id, "a successor's id is not above its predecessor's");
        out.boxes.push_back(std::move(next));
    }
    return out;
}

void unpack_body(Scrutiny& check, const wire_fb::EventEnvelope& e, LogEvent& out) {
    if (e.body_type() < wire_fb::EventBody::BoxStarted || e.body_type() > wire_fb::EventBody::MAX)
        return check.refuse(ErrorCode::unknown_message,
                            "the event is none that this version of the log knows");
    if (check.present("body", e.body()) == nullptr) return;
    if (const auto* started = e.body_as_BoxStarted()) {
        BoxStarted value;
        if (const auto* box = check.present("box", started->box())) value.box = unpack(check, *box);
        value.name = check.text("name", started->name(), longest_name);
        value.wind = unpack_logged(check, started->wind());
        out.what = std::move(value);
    } else if (const auto* ending = e.body_as_BoxEnding()) {
        out.what = BoxEnding{{ending->box()}, check.sea_time("end_us", ending->end_us())};
    } else if (const auto* changed = e.body_as_ClockChanged()) {
        out.what = ClockChanged{unpack(check, changed->clock())};
    } else if (const auto* steered = e.body_as_BoxSteered()) {
        out.what = BoxSteered{{steered->box()}, unpack(check, steered->leg())};
    } else if (const auto* land = e.body_as_LandChanged()) {
        out.what = unpack(check, *land);
    }
}

}  // namespace

Bytes encode(const LogEvent& event) {
    Builder builder(512);
    builder.ForceDefaults(true);
    EventEncoder encoder{builder};
    const auto body = std::visit(encoder, event.what);
    wire_fb::EventEnvelopeBuilder envelope(builder);
    envelope.add_effective_us(event.effective.us);
    envelope.add_event_id(event.event_id);
    // Absent where it is not known: an event from before it was logged keeps its bytes.
    if (event.present != end_of_time) envelope.add_present_us(event.present.us);
    envelope.add_body(body);
    envelope.add_size(0);
    envelope.add_body_type(encoder.tag);
    return finish_envelope(builder, envelope.Finish(), wire_fb::EventEnvelopeIdentifier());
}

Result<LogEvent> decode_event(std::span<const uint8_t> data) {
    const auto envelope =
        open_envelope<wire_fb::EventEnvelope>(data, wire_fb::EventEnvelopeIdentifier(), most_tables);
    if (!envelope) return envelope.error();
    Scrutiny check;
    LogEvent event;
    event.event_id = (*envelope)->event_id();
    event.effective = check.sea_time("effective_us", (*envelope)->effective_us());
    event.present = check.sea_time("present_us", (*envelope)->present_us());
    unpack_body(check, **envelope, event);
    if (check.refused()) return check.error();
    return event;
}

}  // namespace trochoid
