#include "protocol/codec/value_coding.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"

namespace trochoid {

wire_fb::View pack(const ViewState& v) {
    return {v.position.x,
            v.position.z,
            v.altitude,
            v.qx,
            v.qy,
            v.qz,
            v.qw,
            v.tan_half_width,
            v.tan_half_height,
            v.vx,
            v.vy,
            v.vz,
            v.accepted_error_px,
            v.patch_budget,
            v.viewport_width,
            v.viewport_height};
}

ViewState unpack(Scrutiny& check, const wire_fb::View& view, float widest) {
    ViewState v;
    v.position = check.place("view", view.x(), view.z());
    v.altitude = view.altitude();
    v.qx = check.finite("view.qx", view.qx());
    v.qy = check.finite("view.qy", view.qy());
    v.qz = check.finite("view.qz", view.qz());
    v.qw = check.finite("view.qw", view.qw());
    // In float64 no product of finite floats overflows. Within 1e-3 of length 1.
    const auto square = [](float q) { return static_cast<double>(q) * static_cast<double>(q); };
    const double norm = square(v.qx) + square(v.qy) + square(v.qz) + square(v.qw);
    check.require(norm >= 0.999 * 0.999 && norm <= 1.001 * 1.001,
                  "the view's quaternion is not of length 1 within 0.001", ErrorCode::not_a_unit_quaternion);
    v.tan_half_width = check.within("view.tan_half_width", view.tan_half_width(), 0.01F, widest);
    v.tan_half_height = check.within("view.tan_half_height", view.tan_half_height(), 0.01F, widest);
    v.viewport_width =
        check.within("view.viewport_width", view.viewport_width(), uint16_t{1}, uint16_t{16384});
    v.viewport_height =
        check.within("view.viewport_height", view.viewport_height(), uint16_t{1}, uint16_t{16384});
    v.vx = check.within("view.vx", view.vx(), -10000.0F, 10000.0F);
    v.vy = check.within("view.vy", view.vy(), -10000.0F, 10000.0F);
    v.vz = check.within("view.vz", view.vz(), -10000.0F, 10000.0F);
    v.accepted_error_px = check.within("view.accepted_error_px", view.accepted_error_px(), 0.1F, 100.0F);
    v.patch_budget = check.within("view.patch_budget", view.patch_budget(), 1U, Limits{}.patches);
    return v;
}

flatbuffers::Offset<flatbuffers::Vector<const wire_fb::Region*>> pack(
    Builder& builder, const std::vector<SyncRegion>& regions) {
    std::vector<wire_fb::Region> packed;
    packed.reserve(regions.size());
    for (const SyncRegion& r : regions) packed.emplace_back(r.centre.x, r.centre.z, r.radius);
    return builder.CreateVectorOfStructs(packed);
}

std::vector<SyncRegion> unpack_regions(Scrutiny& check,
                                       const flatbuffers::Vector<const wire_fb::Region*>* regions) {
    std::vector<SyncRegion> out;
    const auto* list = check.list("regions", regions, Limits{}.sync_regions, ErrorCode::too_many_regions);
    if (list == nullptr) return out;
    out.reserve(list->size());
    for (const wire_fb::Region* r : *list) {
        check.require(r->radius() <= Limits{}.sync_radius, "a sync region's radius is above 2 km",
                      ErrorCode::region_too_large);
        out.push_back({check.place("a sync region", r->x(), r->z()), r->radius()});
    }
    return out;
}

wire_fb::Clock pack(const SeaClock& c) { return {c.start.us, c.monotonic_start_us, c.epoch, c.rate_q16}; }

SeaClock unpack(Scrutiny& check, const wire_fb::Clock* clock) {
    SeaClock c;
    if (check.present("clock", clock) == nullptr) return c;
    c.start = check.sea_time("clock.start_us", clock->start_us());
    c.monotonic_start_us = check.stamp("clock.monotonic_start_us", clock->monotonic_start_us());
    c.epoch = check.within("clock.epoch", clock->epoch(), 1U, UINT32_MAX);
    c.rate_q16 = check.within("clock.rate_q16", clock->rate_q16(), 0U, largest_rate_q16);
    return c;
}

wire_fb::Wind pack(const StartWind& w) {
    return {w.origin.x, w.origin.z, w.fetch,           w.width, w.life_us,
            w.seed,     w.speed,    w.towards_degrees, w.trains};
}

namespace {

StartWind unpack_wind(Scrutiny& check, const wire_fb::Wind* wind, float least_speed, uint16_t least_trains,
                      uint32_t most_trains) {
    StartWind w;
    if (check.present("wind", wind) == nullptr) return w;
    w.origin = check.place("wind", wind->x(), wind->z());
    w.fetch = check.within("wind.fetch", wind->fetch(), int64_t{0}, longest_side);
    w.width = check.within("wind.width", wind->width(), int64_t{0}, longest_side);
    w.life_us = check.within("wind.life_us", wind->life_us(), int64_t{0}, sea_time_bound);
    w.seed = wind->seed();
    w.speed = check.within("wind.speed", wind->speed(), least_speed, 40.0F);
    w.towards_degrees = check.within("wind.towards_degrees", wind->towards_degrees(), 0.0F, 360.0F);
    check.require(w.towards_degrees < 360.0F, "wind.towards_degrees is 360: say 0");
    w.trains = wind->trains();
    check.require(w.trains <= most_trains, "the wind has more trains than a box may",
                  ErrorCode::too_many_trains);
    check.require(w.trains >= least_trains, "the wind has no trains");
    return w;
}

}  // namespace

StartWind unpack_asked(Scrutiny& check, const wire_fb::Wind* wind) {
    return unpack_wind(check, wind, 1.0F, 1, Limits{}.trains_per_box);
}

StartWind unpack_logged(Scrutiny& check, const wire_fb::Wind* wind) {
    return unpack_wind(check, wind, 0.0F, 0, most_trains_in_a_box);
}

flatbuffers::Offset<wire_fb::Box> pack(Builder& builder, const WaveTrainBox& box) {
    std::vector<wire_fb::Train> trains;
    std::vector<uint32_t> fields;
    Bytes field_of_train;
    trains.reserve(box.trains.size());
    bool any_field = false;
    for (const WaveTrain& t : box.trains) {
        trains.emplace_back(t.kx, t.kz, static_cast<uint32_t>(t.omega), static_cast<uint32_t>(t.omega >> 32),
                            t.phase, t.amplitude, t.choppiness);
        const auto known = std::find(fields.begin(), fields.end(), t.field.value);
        const auto index = known - fields.begin();
        if (known == fields.end()) fields.push_back(t.field.value);
        field_of_train.push_back(static_cast<uint8_t>(index));
        any_field = any_field || t.field.value != 0;
    }
    TROCHOID_ASSERT(fields.size() <= most_trains_in_a_box, "box {} has {} fields", box.id.value,
                    fields.size());
    const wire_fb::BoxHead head(box.origin.x, box.origin.z, box.length, box.width, box.begin.us,
                                box.build_up_us, box.end.us, box.decay_us, box.id.value,
                                box.first_train.value, box.ux, box.uz, box.ramp_rear, box.ramp_front,
                                box.ramp_side, box.front_speed, box.gain_max);
    const auto trains_at = builder.CreateVectorOfStructs(trains);
    const auto fields_at = any_field ? builder.CreateVector(fields) : 0;
    const auto field_of_train_at = any_field ? builder.CreateVector(field_of_train) : 0;
    return wire_fb::CreateBox(builder, &head, trains_at, fields_at, field_of_train_at);
}

namespace {

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

}  // namespace

WaveTrainBox unpack(Scrutiny& check, const wire_fb::Box& packed) {
    WaveTrainBox box;
    const auto* head = check.present("box.head", packed.head());
    const auto* trains =
        check.list("box.trains", packed.trains(), most_trains_in_a_box, ErrorCode::too_many_trains);
    if (head == nullptr || trains == nullptr) return box;
    box.id = {head->id()};
    box.first_train = {head->first_train()};
    box.origin = {head->x(), head->z()};
    box.ux = head->ux();
    box.uz = head->uz();
    box.length = head->length();
    box.width = head->width();
    box.ramp_rear = head->ramp_rear();
    box.ramp_front = head->ramp_front();
    box.ramp_side = head->ramp_side();
    box.begin = {head->begin_us()};
    box.build_up_us = head->build_up_us();
    box.end = {head->end_us()};
    box.decay_us = head->decay_us();
    box.front_speed = head->front_speed();
    box.gain_max = head->gain_max();
    box.trains.reserve(trains->size());
    for (const wire_fb::Train* t : *trains)
        box.trains.push_back({t->kx(), t->kz(), (uint64_t{t->omega_high()} << 32) | t->omega_low(),
                              t->phase(), t->amplitude(), t->choppiness(), FieldId{}});
    unpack_fields(check, packed, box.trains);
    check.require(validate(box));
    return box;
}

wire_fb::Code pack(ErrorCode code) { return static_cast<wire_fb::Code>(code); }

ErrorCode unpack(Scrutiny& check, wire_fb::Code code) {
    // The generated names know exactly the schema's values.
    check.require(*wire_fb::EnumNameCode(code) != '\0', "the code is none of the standard's");
    return static_cast<ErrorCode>(code);
}

flatbuffers::Offset<wire_fb::Goodbye> pack(Builder& builder, const Goodbye& g) {
    const auto message = builder.CreateString(sentence_for_wire(g.message));
    return wire_fb::CreateGoodbye(builder, pack(g.code), message, g.retry, g.retry_after_ms,
                                  g.offending_sequence, g.requirement);
}

Goodbye unpack(Scrutiny& check, const wire_fb::Goodbye& goodbye) {
    Goodbye g;
    g.code = unpack(check, goodbye.code());
    g.message = check.text("goodbye.message", goodbye.message(), longest_sentence);
    g.retry = goodbye.retry();
    g.retry_after_ms = goodbye.retry_after_ms();
    g.offending_sequence = goodbye.offending_sequence();
    g.requirement = goodbye.requirement();
    return g;
}

}  // namespace trochoid
