#include "event_generated.h"
#include "protocol/codec/envelope.hpp"
#include "protocol/codec/value_coding.hpp"

namespace trochoid {

namespace {

/// Envelope, body, box.
constexpr flatbuffers::uoffset_t most_tables = 16;

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
};

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
    }
}

}  // namespace

Bytes encode(const LogEvent& event) {
    Builder builder(512);
    builder.ForceDefaults(true);
    EventEncoder encoder{builder};
    const auto body = std::visit(encoder, event.what);
    return finish_envelope(
        builder,
        wire_fb::CreateEventEnvelope(builder, 0, event.event_id, event.effective.us, encoder.tag, body),
        wire_fb::EventEnvelopeIdentifier());
}

Result<LogEvent> decode_event(std::span<const uint8_t> data) {
    const auto envelope =
        open_envelope<wire_fb::EventEnvelope>(data, wire_fb::EventEnvelopeIdentifier(), most_tables);
    if (!envelope) return envelope.error();
    Scrutiny check;
    LogEvent event;
    event.event_id = (*envelope)->event_id();
    event.effective = check.sea_time("effective_us", (*envelope)->effective_us());
    unpack_body(check, **envelope, event);
    if (check.refused()) return check.error();
    return event;
}

}  // namespace trochoid
