#include "protocol/codec/value_coding.hpp"

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
    return {w.origin.x,
            w.origin.z,
            w.fetch,
            w.width,
            w.life_us,
            w.seed,
            w.speed,
            w.towards_degrees,
            w.reference_depth,
            w.roundness,
            w.irregularity,
            w.noise,
            w.vx,
            w.vz,
            w.trains,
            w.directions,
            static_cast<wire_fb::Spectrum>(w.spectrum),
            static_cast<wire_fb::Spreading>(w.spreading)};
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
    w.towards_degrees = unpack_heading(check, "wind.towards_degrees", wind->towards_degrees());
    w.trains = wind->trains();
    check.require(w.trains <= most_trains, "the wind has more trains than a box may",
                  ErrorCode::too_many_trains);
    check.require(w.trains >= least_trains, "the wind has no trains");
    w.directions = wind->directions();
    check.require(w.directions == 0 || (w.directions <= w.trains && w.trains % w.directions == 0),
                  "wind.directions does not divide wind.trains");
    check.require(wind->spectrum() <= wire_fb::Spectrum::MAX, "wind.spectrum is none of the standard's");
    w.spectrum = static_cast<Spectrum>(wind->spectrum());
    check.require(wind->spreading() <= wire_fb::Spreading::MAX, "wind.spreading is none of the standard's");
    w.spreading = static_cast<Spreading>(wind->spreading());
    w.reference_depth =
        check.within("wind.reference_depth", wind->reference_depth(), 0.0F, deepest_reference);
    check.require(w.reference_depth == 0.0F || w.reference_depth >= shallowest_reference,
                  "wind.reference_depth is neither 0 (deep water) nor 1 m or more");
    w.roundness = check.within("wind.roundness", wind->roundness(), 0.0F, 1.0F);
    w.irregularity = check.within("wind.irregularity", wind->irregularity(), 0.0F, 1.0F);
    w.noise = check.within("wind.noise", wind->noise(), 0.0F, 1.0F);
    w.vx = check.within("wind.vx", wind->vx(), -fastest_wind_box, fastest_wind_box);
    w.vz = check.within("wind.vz", wind->vz(), -fastest_wind_box, fastest_wind_box);
    // In float64 both squares are exact; the slack is for components that were rounded from a heading.
    const auto square = [](float v) { return static_cast<double>(v) * static_cast<double>(v); };
    check.require(square(w.vx) + square(w.vz) <= 1.0001 * square(fastest_wind_box),
                  "the wind's box moves faster than 100 m/s");
    return w;
}

}  // namespace

StartWind unpack_asked(Scrutiny& check, const wire_fb::Wind* wind) {
    return unpack_wind(check, wind, 1.0F, 1, Limits{}.trains_per_box);
}

StartWind unpack_logged(Scrutiny& check, const wire_fb::Wind* wind) {
    return unpack_wind(check, wind, 0.0F, 0, most_trains_in_a_box);
}

float unpack_heading(Scrutiny& check, const char* name, float degrees) {
    const float heading = check.within(name, degrees, 0.0F, 360.0F);
    if (heading == 360.0F) check.refuse(ErrorCode::value_out_of_range, fmt::format("{} is 360: say 0", name));
    return heading;
}

flatbuffers::Offset<wire_fb::ChangeLand> pack(Builder& builder, const ChangeLand& change) {
    std::vector<wire_fb::Point> line;
    line.reserve(change.line.size());
    for (const LatticePoint& p : change.line) line.emplace_back(p.x, p.z);
    return wire_fb::CreateChangeLand(builder, builder.CreateVectorOfStructs(line), change.width, change.crest,
                                     change.dig);
}

ChangeLand unpack(Scrutiny& check, const wire_fb::ChangeLand& change) {
    ChangeLand out;
    const auto* line = check.list("line", change.line(), most_line_points);
    if (line == nullptr) return out;
    check.require(line->size() >= 2, "line has fewer than 2 points");
    out.line.reserve(line->size());
    for (const wire_fb::Point* p : *line) out.line.push_back(check.place("a point of line", p->x(), p->z()));
    out.width = check.within("width", change.width(), 1.0F, 2000.0F);
    out.crest = check.within("crest", change.crest(), -200.0F, 200.0F);
    out.dig = change.dig();
    return out;
}

flatbuffers::Offset<wire_fb::CullKey> pack(Builder& b, const CullKey& k) {
    const auto regions = pack(b, k.regions);
    const auto anchor = pack(k.anchor);
    return wire_fb::CreateCullKey(b, &anchor, k.slack, k.slack_tangent, k.error_in_force_px, k.patch_limit,
                                  regions, k.log_position.value, k.from.us, k.until.us);
}

CullKey unpack(Scrutiny& check, const wire_fb::CullKey* key) {
    constexpr float large = 1.0e6F;
    CullKey k;
    if (check.present("key", key) == nullptr) return k;
    if (const auto* anchor = check.present("key.anchor", key->anchor()))
        k.anchor = unpack(check, *anchor, widest_anchor);
    k.slack = key->slack();
    k.slack_tangent = check.within("key.slack_tangent", key->slack_tangent(), 0.0F, large);
    k.error_in_force_px = check.within("key.error_in_force_px", key->error_in_force_px(), 0.0F, large);
    k.patch_limit = check.within("key.patch_limit", key->patch_limit(), 0U, Limits{}.patches);
    k.regions = unpack_regions(check, key->regions());
    k.log_position = {key->log_position()};
    k.from = check.sea_time("key.from_us", key->from_us());
    k.until = check.sea_time("key.until_us", key->until_us());
    check.require(k.from <= k.until, "key.until_us is before key.from_us");
    return k;
}

WorldInstance unpack_instance(Scrutiny& check, const flatbuffers::Vector<uint8_t>* instance) {
    WorldInstance out;
    if (check.list("instance", instance, out.bytes.size()) == nullptr) return out;
    check.require(instance->size() == out.bytes.size(), "instance has not 16 bytes");
    std::copy(instance->begin(), instance->end(), out.bytes.begin());
    return out;
}

PatchKey unpack_patch_key(Scrutiny& check, uint8_t level, int32_t x, int32_t z) {
    check.within("a patch's level", level, finest_patch_level, coarsest_patch_level);
    if (check.refused()) return {};
    const int32_t most = int32_t{1} << (35 - level);  // 2^35 is the world's bound
    check.within("a patch's x", x, -most, most - 1);
    check.within("a patch's z", z, -most, most - 1);
    return {level, x, z};
}

wire_fb::Code pack(ErrorCode code) { return static_cast<wire_fb::Code>(code); }

ErrorCode unpack(Scrutiny& check, wire_fb::Code code) {
    // A later version may know more codes: their hundreds say what kind they are.
    check.require(is_a_code(static_cast<uint16_t>(code)), "the code is of none of the standard's classes");
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
