#include <algorithm>
#include <optional>

#include "protocol/codec/value_coding.hpp"
#include "protocol/units/assert.hpp"

// A wave train box, to and from the schema's table: head and trains always, all else where the box has it.
namespace trochoid {

namespace {

uint32_t low_word(uint64_t v) { return static_cast<uint32_t>(v); }
uint32_t high_word(uint64_t v) { return static_cast<uint32_t>(v >> 32); }
uint64_t whole_word(uint32_t low, uint32_t high) { return (uint64_t{high} << 32) | low; }

struct FieldLists {
    std::vector<uint32_t> fields;
    Bytes field_of_train;
    bool any = false;
};

FieldLists field_lists(const WaveTrainBox& box) {
    FieldLists lists;
    for (const WaveTrain& t : box.trains) {
        const auto known = std::find(lists.fields.begin(), lists.fields.end(), t.field.value);
        const auto index = known - lists.fields.begin();
        if (known == lists.fields.end()) lists.fields.push_back(t.field.value);
        lists.field_of_train.push_back(static_cast<uint8_t>(index));
        lists.any = lists.any || t.field.value != 0;
    }
    TROCHOID_ASSERT(lists.fields.size() <= most_trains_in_a_box, "box {} has {} fields", box.id.value,
                    lists.fields.size());
    return lists;
}

wire_fb::BoxHead pack_head(const WaveTrainBox& box) {
    return {box.origin.x,    box.origin.z, box.length,    box.width,      box.begin.us,
            box.build_up_us, box.end.us,   box.decay_us,  box.id.value,   box.first_train.value,
            box.ux,          box.uz,       box.ramp_rear, box.ramp_front, box.ramp_side,
            box.front_speed, box.gain_max, box.roundness};
}

wire_fb::Irregular pack(const IrregularHeight& i) {
    return {low_word(i.omega), high_word(i.omega), i.ukx, i.ukz, i.vkx, i.vkz, i.phase_u, i.phase_v, i.share};
}

wire_fb::Noise pack(const SurfaceNoise& n) {
    return {n.amplitude, n.seed, n.persistence, n.octaves, n.step_log2, n.period_log2, n.displayed_only};
}

wire_fb::Wake pack(const ShipWake& w) {
    return {w.transverse, w.diverging, w.choppiness, w.inverse_length, w.group_speed};
}

wire_fb::Hull pack(const Hull& h) { return {h.length, h.beam}; }

/// A value that says what its absence says is left out.
template <class Value>
auto packed_unless_default(const Value& value) {
    return value == Value{} ? std::nullopt : std::optional(pack(value));
}
template <class Value>
const Value* pointer(const std::optional<Value>& value) {
    return value ? &*value : nullptr;
}

}  // namespace

wire_fb::Leg pack(const CourseLeg& leg) {
    return {leg.from.us, leg.duration_us, leg.origin.x, leg.origin.z, leg.vx, leg.vz};
}

flatbuffers::Offset<wire_fb::Box> pack(Builder& builder, const WaveTrainBox& box) {
    std::vector<wire_fb::Train> trains;
    std::vector<wire_fb::Overlay> overlays;
    std::vector<wire_fb::Leg> course;
    trains.reserve(box.trains.size());
    for (const WaveTrain& t : box.trains)
        trains.emplace_back(t.kx, t.kz, low_word(t.omega), high_word(t.omega), t.phase, t.amplitude,
                            t.choppiness);
    for (const FieldOverlay& o : box.overlays) overlays.emplace_back(o.field.value, o.base.value);
    for (const CourseLeg& leg : box.course) course.push_back(pack(leg));
    const FieldLists lists = field_lists(box);
    const auto trains_at = builder.CreateVectorOfStructs(trains);
    const auto fields_at = lists.any ? builder.CreateVector(lists.fields) : 0;
    const auto field_of_train_at = lists.any ? builder.CreateVector(lists.field_of_train) : 0;
    const auto overlays_at = overlays.empty() ? 0 : builder.CreateVectorOfStructs(overlays);
    const auto course_at = course.empty() ? 0 : builder.CreateVectorOfStructs(course);
    const wire_fb::BoxHead head = pack_head(box);
    const wire_fb::Succession succession(box.raised_us, box.fade_us);
    const bool succeeds = box.raised_us != 0 || box.fade_us != 0;
    const auto irregular = packed_unless_default(box.irregular);
    const auto noise = packed_unless_default(box.noise);
    const auto wake = packed_unless_default(box.wake);
    const auto hull = packed_unless_default(box.hull);
    return wire_fb::CreateBox(builder, &head, trains_at, fields_at, field_of_train_at,
                              succeeds ? &succession : nullptr, overlays_at, course_at, pointer(irregular),
                              pointer(noise), pointer(wake), pointer(hull));
}

namespace {

CourseLeg leg_of(const wire_fb::Leg& leg) {
    return {{leg.from_us()}, leg.duration_us(), {leg.x(), leg.z()}, leg.vx(), leg.vz()};
}

void unpack_fields(Scrutiny& check, const wire_fb::Box& box, std::vector<WaveTrain>& trains) {
    if (box.fields() == nullptr && box.field_of_train() == nullptr) return;
    const auto* fields = check.list("box.fields", box.fields(), most_trains_in_a_box);
    const auto* field_of_train = check.list("box.field_of_train", box.field_of_train(), most_trains_in_a_box);
    if (fields == nullptr || field_of_train == nullptr) return;
    check.require(field_of_train->size() == trains.size(), "box.field_of_train has not one entry a train");
    for (uint32_t i = 0; i < field_of_train->size() && !check.refused(); ++i) {
        check.require(field_of_train->Get(i) < fields->size(),
                      "box.field_of_train points outside box.fields");
        if (!check.refused()) trains[i].field = {fields->Get(field_of_train->Get(i))};
    }
}

void unpack_head(const wire_fb::BoxHead& head, WaveTrainBox& box) {
    box.id = {head.id()};
    box.first_train = {head.first_train()};
    box.origin = {head.x(), head.z()};
    box.ux = head.ux();
    box.uz = head.uz();
    box.length = head.length();
    box.width = head.width();
    box.ramp_rear = head.ramp_rear();
    box.ramp_front = head.ramp_front();
    box.ramp_side = head.ramp_side();
    box.begin = {head.begin_us()};
    box.build_up_us = head.build_up_us();
    box.end = {head.end_us()};
    box.decay_us = head.decay_us();
    box.front_speed = head.front_speed();
    box.gain_max = head.gain_max();
    box.roundness = head.roundness();
}

/// The structs that a plain box is without.
void unpack_extras(const wire_fb::Box& packed, WaveTrainBox& box) {
    if (const auto* s = packed.succession()) {
        box.raised_us = s->raised_us();
        box.fade_us = s->fade_us();
    }
    if (const auto* i = packed.irregular())
        box.irregular = {i->share(),   i->ukx(),    i->ukz(),
                         i->vkx(),     i->vkz(),    whole_word(i->omega_low(), i->omega_high()),
                         i->phase_u(), i->phase_v()};
    if (const auto* n = packed.noise())
        box.noise = {n->amplitude(),   n->persistence(),    n->octaves(), n->step_log2(),
                     n->period_log2(), n->displayed_only(), n->seed()};
    if (const auto* w = packed.wake())
        box.wake = {w->transverse(), w->diverging(), w->choppiness(), w->inverse_length(), w->group_speed()};
    if (const auto* h = packed.hull()) box.hull = {h->length(), h->beam()};
}

}  // namespace

CourseLeg unpack(Scrutiny& check, const wire_fb::Leg* packed) {
    if (check.present("leg", packed) == nullptr) return {};
    const CourseLeg leg = leg_of(*packed);
    check.require(validate(std::span(&leg, 1)));
    return leg;
}

WaveTrainBox unpack(Scrutiny& check, const wire_fb::Box& packed) {
    WaveTrainBox box;
    const auto* head = check.present("box.head", packed.head());
    const auto* trains =
        check.list("box.trains", packed.trains(), most_trains_in_a_box, ErrorCode::too_many_trains);
    const auto* overlays = check.optional_list("box.overlays", packed.overlays(), most_trains_in_a_box);
    const auto* course =
        check.optional_list("box.course", packed.course(), most_course_legs, ErrorCode::too_many_legs);
    if (head == nullptr || trains == nullptr || check.refused()) return box;
    unpack_head(*head, box);
    box.trains.reserve(trains->size());
    for (const wire_fb::Train* t : *trains)
        box.trains.push_back({t->kx(), t->kz(), whole_word(t->omega_low(), t->omega_high()), t->phase(),
                              t->amplitude(), t->choppiness(), FieldId{}});
    if (overlays != nullptr)
        for (const wire_fb::Overlay* o : *overlays) box.overlays.push_back({{o->field()}, {o->base()}});
    if (course != nullptr)
        for (const wire_fb::Leg* leg : *course) box.course.push_back(leg_of(*leg));
    unpack_extras(packed, box);
    unpack_fields(check, packed, box.trains);
    // Not of a box that is refused already: its lists may be short.
    if (!check.refused()) check.require(validate(box));
    return box;
}

}  // namespace trochoid
