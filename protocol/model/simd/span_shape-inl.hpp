// What shapes the trains over a span: envelopes, irregular heights, round waves and land fields, many points at once.
#if defined(TROCHOID_SIMD_SHAPE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TROCHOID_SIMD_SHAPE_INL
#undef TROCHOID_SIMD_SHAPE_INL
#else
#define TROCHOID_SIMD_SHAPE_INL
#endif

#include <algorithm>

#include "protocol/model/simd/scratch.hpp"
#include "protocol/model/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace trochoid::simd::HWY_NAMESPACE {

HWY_INLINE VecF gain_to_float(VecU gain) { return mul(float_of(hn::ShiftRight<2>(gain)), splat(0x1p-22F)); }
HWY_INLINE VecF unit(VecU gain) { return mul(float_of(gain), splat(0x1p-24F)); }

/// A side of the envelope: ramp_gain and its slope.
struct Side {
    VecU gain;
    VecF slope;
};
HWY_INLINE Side side_of(VecI distance, const SideRamp& ramp) {
    const VecI zero = hn::Zero(di);
    const VecI length = hn::Set(di, ramp.length);
    const VecI held = hn::Min(hn::Max(distance, zero), length);
    const VecU rising = mul_shift<16>(hn::BitCast(du, held), hn::Set(du, ramp.reciprocal));
    const auto before = hn::Lt(distance, length);
    const auto within = hn::And(hn::Gt(distance, zero), before);
    return {hn::IfThenElse(hn::RebindMask(du, before), rising, hn::Set(du, full_gain)),
            hn::IfThenElseZero(hn::RebindMask(df, within), splat(ramp.slope))};
}
HWY_INLINE Side no_side() { return {hn::Set(du, full_gain), hn::Zero(df)}; }

/// Fills u and v of the envelope. False where a point is out of the box's reach.
inline bool place_in_box(const PlannedBox& box, Scratch& at) {
    constexpr int64_t reach = int64_t{1} << 31;
    constexpr int64_t most = int64_t{1} << 30;
    const WaveTrainBox& record = box.live->box->record;
    const LatticePoint origin = box.live->instant.origin;
    const int64_t ux = record.ux;
    const int64_t uz = record.uz;
    bool in_reach = true;
    for (size_t i = 0; i < at.padded; ++i) {
        const int64_t dx = at.x[i] - origin.x;
        const int64_t dz = at.z[i] - origin.z;
        in_reach &= dx <= reach && dx >= -reach && dz <= reach && dz >= -reach;
    }
    if (!in_reach) return false;
    for (size_t i = 0; i < at.padded; ++i) {
        const int64_t dx = at.x[i] - origin.x;
        const int64_t dz = at.z[i] - origin.z;
        const int64_t u = (dx * ux + dz * uz) >> 30;
        const int64_t v = (dz * ux - dx * uz) >> 30;
        at.envelope.u[i] = static_cast<int32_t>(u < 0 ? 0 : (u > most ? most : u));
        at.envelope.v[i] = static_cast<int32_t>(v < 0 ? 0 : (v > most ? most : v));
    }
    return true;
}

HWY_INLINE void ramp_envelope(const PlannedBox& box, SpanEnvelope& e, size_t i) {
    const WaveTrainBox& record = box.live->box->record;
    const BoxInstant& instant = box.live->instant;
    Side rear = no_side();
    Side front = no_side();
    Side left = no_side();
    Side right = no_side();
    const VecI u = hn::Load(di, &e.u[i]);
    const VecI v = hn::Load(di, &e.v[i]);
    if (record.length != 0) {
        rear = side_of(u, box.rear);
        front = side_of(hn::Sub(hn::Set(di, static_cast<int32_t>(instant.front)), u), box.front);
    }
    if (record.width != 0) {
        left = side_of(v, box.side);
        right = side_of(hn::Sub(hn::Set(di, static_cast<int32_t>(record.width)), v), box.side);
        right.slope = hn::Neg(right.slope);
    }
    const VecU along = mul_shift<24>(rear.gain, front.gain);
    const VecU across = mul_shift<24>(left.gain, right.gain);
    const VecU gain = mul_shift<24>(mul_shift<24>(along, across), hn::Set(du, instant.time_gain));
    const VecF time = unit(hn::Set(du, instant.time_gain));
    const VecF du_slope = mul(
        mul(add(mul(rear.slope, unit(front.gain)), mul(unit(rear.gain), front.slope)), unit(across)), time);
    const VecF dv_slope = mul(
        mul(add(mul(left.slope, unit(right.gain)), mul(unit(left.gain), right.slope)), unit(along)), time);
    const VecF ux = splat(box.ux);
    const VecF uz = splat(box.uz);
    const auto still = hn::RebindMask(df, hn::Eq(gain, hn::Zero(du)));
    hn::Store(gain, du, &e.gain[i]);
    hn::Store(hn::IfThenZeroElse(still, sub(mul(du_slope, ux), mul(dv_slope, uz))), df, &e.dx[i]);
    hn::Store(hn::IfThenZeroElse(still, add(mul(du_slope, uz), mul(dv_slope, ux))), df, &e.dz[i]);
}

/// Distances from the middle of a box of round waves (round_shift's a, f and side).
HWY_INLINE void place_across(const PlannedBox& box, SpanEnvelope& e, size_t i) {
    const auto width = static_cast<int32_t>(box.live->box->record.width);
    const VecI held = hn::Min(hn::Load(di, &e.v[i]), hn::Set(di, width));
    const VecI off = hn::Sub(held, hn::Set(di, width / 2));
    const VecU distance = hn::BitCast(du, hn::Abs(off));
    hn::Store(distance, du, &e.off[i]);
    if (box.width_reciprocal <= UINT32_MAX) {
        const VecU reciprocal = hn::Set(du, static_cast<uint32_t>(box.width_reciprocal));
        hn::Store(hn::Min(mul_shift<9>(distance, reciprocal), hn::Set(du, 1U << 30)), du, &e.part[i]);
    } else {
        // A box narrower than 256 units: one by one.
        for (size_t lane = i; lane < i + lanes; ++lane)
            e.part[lane] = static_cast<uint32_t>(
                std::min<uint64_t>((e.off[lane] * box.width_reciprocal) >> 9, uint64_t{1} << 30));
    }
    hn::Store(hn::And(hn::BitCast(du, off), hn::Set(du, 0x80000000U)), du, &e.side[i]);
}

/// Irregular heights: modulation_at.
HWY_INLINE void modulate(const PlannedBox& box, VecU pu, VecU pv, SpanEnvelope& e, size_t i) {
    const Wave u = wave_of(pu);
    const Wave v = wave_of(pv);
    const VecF share = splat(box.share);
    const VecF along = mul(u.cosine, v.sine);
    const VecF across = mul(u.sine, v.cosine);
    const VecF dx = mul(share, add(mul(along, splat(box.ukx)), mul(across, splat(box.vkx))));
    const VecF dz = mul(share, add(mul(along, splat(box.ukz)), mul(across, splat(box.vkz))));
    hn::Store(sub(splat(1.0F), mul(share, mul(u.sine, v.sine))), df, &e.factor[i]);
    hn::Store(hn::Neg(dx), df, &e.factor_dx[i]);
    hn::Store(hn::Neg(dz), df, &e.factor_dz[i]);
}

/// The envelope over the span: gains, gradients and what round waves and irregular heights need.
inline void shape_envelope(const PlannedBox& box, bool full, Scratch& at, int n) {
    SpanEnvelope& e = at.envelope;
    const auto count = static_cast<size_t>(n);
    bool placed = false;
    if (!full || box.round) placed = place_in_box(box, at);
    if (full || (placed && !box.limited)) {
        for (size_t i = 0; i < count; i += lanes) {
            hn::Store(hn::Set(du, box.live->instant.time_gain), du, &e.gain[i]);
            hn::Store(hn::Zero(df), df, &e.dx[i]);
            hn::Store(hn::Zero(df), df, &e.dz[i]);
        }
    } else if (placed) {
        for (size_t i = 0; i < count; i += lanes) ramp_envelope(box, e, i);
    } else {
        // Partly beyond the reach of 2^31 units: rare, so one by one.
        for (size_t i = 0; i < at.padded; ++i) {
            const LatticePoint p{at.x[i], at.z[i]};
            const Envelope one = envelope_at(box.live->box->record, box.live->instant, p);
            e.gain[i] = one.gain;
            e.dx[i] = one.dg_dx;
            e.dz[i] = one.dg_dz;
            const BoxPosition place = box_position(box.live->box->record, box.live->instant, p);
            e.v[i] =
                static_cast<int32_t>(place.v < 0 ? 0 : (place.v > longest_side ? longest_side : place.v));
        }
    }
    if (box.round)
        for (size_t i = 0; i < count; i += lanes) place_across(box, e, i);
    if (box.uneven)
        for (size_t i = 0; i < count; i += lanes) {
            // Turns wrap, so the low halves of the places do.
            const IrregularHeight& irregular = box.live->box->record.irregular;
            const IrregularPhases& start = box.live->irregular;
            const VecU x = hn::Load(du, &at.x_low[i]);
            const VecU z = hn::Load(du, &at.z_low[i]);
            const auto turns = [&](int32_t kx, int32_t kz, uint32_t from) HWY_ATTR {
                return hn::Add(hn::Add(hn::Mul(hn::Set(du, static_cast<uint32_t>(kx)), x),
                                       hn::Mul(hn::Set(du, static_cast<uint32_t>(kz)), z)),
                               hn::Set(du, from));
            };
            modulate(box, turns(irregular.ukx, irregular.ukz, start.u),
                     turns(irregular.vkx, irregular.vkz, start.v), e, i);
        }
}

/// A land field's sample of one vector, as LandField::sample and SeaInstant's `layered` give it.
struct LandVectors {
    VecU shift;
    VecU gain;
    VecF shift_dx, shift_dz, gain_dx, gain_dz, orbit, orbit_dx, orbit_dz;
};

/// One quantity at a cell's four nodes (west in the low halves, east in the high ones) as LandField::sample interpolates it: its value, its
/// change from west to east and from north to south.
struct CellVectors {
    VecI value, east, south;
};
HWY_INLINE CellVectors interpolate(VecU north, VecU south, VecI fx, VecI fz) {
    const VecU low = hn::Set(du, 0xffffU);
    const VecU ux = hn::BitCast(du, fx);
    const VecU uz = hn::BitCast(du, fz);
    const VecU x_rest = hn::Sub(hn::Set(du, 65536U), ux);
    const VecU z_rest = hn::Sub(hn::Set(du, 65536U), uz);
    const VecU v00 = hn::And(north, low);
    const VecU v10 = hn::ShiftRight<16>(north);
    const VecU v01 = hn::And(south, low);
    const VecU v11 = hn::ShiftRight<16>(south);
    const auto edge = [](VecU a, VecU wa, VecU b, VecU wb) HWY_ATTR {
        return hn::BitCast(di, hn::ShiftRight<8>(hn::Add(hn::Mul(a, wa), hn::Mul(b, wb))));
    };
    const VecI west = edge(v00, z_rest, v01, uz);
    const VecI change = hn::Sub(edge(v10, z_rest, v11, uz), west);
    const VecI down = hn::Sub(edge(v01, x_rest, v11, ux), edge(v00, x_rest, v10, ux));
    return {hn::Add(west, scale16(change, fx)), change, down};
}

HWY_INLINE LandVectors open_water() {
    const VecF zero = hn::Zero(df);
    return {hn::Zero(du), hn::Set(du, full_gain), zero, zero, zero, zero, splat(1.0F), zero, zero};
}

HWY_INLINE LandVectors sample_land(const Plan& plan, const LandField& field, const SpanCells& c,
                                   const Scratch& at, size_t i) {
    LandVectors out = open_water();
    const int step = field.step_log2();
    const VecU mask = hn::Set(du, (1U << step) - 1U);
    const auto in_cell = [&](const SpanOf<uint32_t>& low) HWY_ATTR {
        const VecU place = hn::And(hn::Load(du, &low[i]), mask);
        return step >= 16 ? hn::ShiftRightSame(place, step - 16) : hn::ShiftLeftSame(place, 16 - step);
    };
    const VecU fx = in_cell(at.x_low);
    const VecU fz = in_cell(at.z_low);
    const VecI ix = hn::BitCast(di, fx);
    const VecI iz = hn::BitCast(di, fz);
    const float metres = static_cast<float>(int32_t{1} << (step - 10));
    if (plan.refraction) {
        // Shifts are below 2^30 and steps below 2^23, so every difference fits.
        const VecI p00 = hn::Load(di, &c.p00[i]);
        const VecI p01 = hn::Load(di, &c.p01[i]);
        const VecI east = hn::Sub(hn::Load(di, &c.p10[i]), p00);
        const VecI south = hn::Sub(p01, p00);
        const VecI cross = hn::Sub(hn::Sub(hn::Load(di, &c.p11[i]), p01), east);
        const VecI slope_x = hn::Add(east, scale16(cross, iz));
        const VecI slope_z = hn::Add(south, scale16(cross, ix));
        out.shift = hn::BitCast(
            du, hn::Add(hn::Add(hn::ShiftLeft<16>(p00), hn::Mul(south, iz)), hn::Mul(slope_x, ix)));
        const VecF per_step = splat(0x1.921fb6p-14F / metres);
        out.shift_dx = mul(hn::ConvertTo(df, slope_x), per_step);
        out.shift_dz = mul(hn::ConvertTo(df, slope_z), per_step);
    }
    if (plan.shelter) {
        const CellVectors gain = interpolate(hn::Load(du, &c.gain0[i]), hn::Load(du, &c.gain1[i]), ix, iz);
        out.gain = hn::BitCast(du, hn::ShiftLeft<1>(gain.value));
        const VecF per_step = splat(0x1p-23F / metres);
        out.gain_dx = mul(hn::ConvertTo(df, gain.east), per_step);
        out.gain_dz = mul(hn::ConvertTo(df, gain.south), per_step);
    }
    if (plan.orbits) {
        const CellVectors orbit = interpolate(hn::Load(du, &c.orbit0[i]), hn::Load(du, &c.orbit1[i]), ix, iz);
        out.orbit = mul(hn::ConvertTo(df, orbit.value), splat(0x1p-22F));
        const VecF per_step = splat(0x1p-22F / metres);
        out.orbit_dx = mul(hn::ConvertTo(df, orbit.east), per_step);
        out.orbit_dz = mul(hn::ConvertTo(df, orbit.south), per_step);
    }
    return out;
}

/// SeaInstant's `combine`.
HWY_INLINE void combine(const PlannedBox& box, const SpanEnvelope& e, const LandVectors& land, SpanLocal& out,
                        size_t i) {
    const VecU box_gain_bits = hn::Load(du, &e.gain[i]);
    VecF g = gain_to_float(mul_shift<24>(box_gain_bits, land.gain));
    const VecF box_gain = gain_to_float(box_gain_bits);
    const VecF land_gain = gain_to_float(land.gain);
    VecF gx = add(mul(hn::Load(df, &e.dx[i]), land_gain), mul(box_gain, land.gain_dx));
    VecF gz = add(mul(hn::Load(df, &e.dz[i]), land_gain), mul(box_gain, land.gain_dz));
    if (box.uneven) {
        const VecF factor = hn::Load(df, &e.factor[i]);
        gx = add(mul(gx, factor), mul(g, hn::Load(df, &e.factor_dx[i])));
        gz = add(mul(gz, factor), mul(g, hn::Load(df, &e.factor_dz[i])));
        g = mul(g, factor);
    }
    const VecF gh = mul(g, land.orbit);
    const VecF ghx = add(mul(gx, land.orbit), mul(g, land.orbit_dx));
    const VecF ghz = add(mul(gz, land.orbit), mul(g, land.orbit_dz));
    hn::Store(land.shift, du, &out.shift[i]);
    hn::Store(g, df, &out.g[i]);
    hn::Store(gx, df, &out.gx[i]);
    hn::Store(gz, df, &out.gz[i]);
    hn::Store(gh, df, &out.gh[i]);
    hn::Store(ghx, df, &out.ghx[i]);
    hn::Store(ghz, df, &out.ghz[i]);
    hn::Store(land.shift_dx, df, &out.qx[i]);
    hn::Store(land.shift_dz, df, &out.qz[i]);
    const auto any = [&](VecF a, VecF b) HWY_ATTR {
        return !hn::AllTrue(df, hn::And(hn::Eq(a, hn::Zero(df)), hn::Eq(b, hn::Zero(df))));
    };
    uint8_t needs = 0;
    if (any(gx, gz) || any(ghx, ghz)) needs |= needs_gradient;
    if (!hn::AllTrue(df, hn::Eq(g, gh))) needs |= needs_orbit;
    if (any(land.shift_dx, land.shift_dz)) needs |= needs_bend;
    if (needs != 0 || any(g, g)) needs |= needs_sum;
    out.needs[i] = needs;
}

/// Looks at which points have come into another cell; called once for every evaluation of a span.
inline void place_cells(const Plan& plan, Scratch& at) {
    for (int step = 12; step <= 20; ++step) {
        if ((plan.steps >> step & 1U) == 0) continue;
        SpanPlaces& p = at.places[static_cast<size_t>(step - 12)];
        alignas(64) SpanOf<int32_t> column;
        alignas(64) SpanOf<int32_t> row;
        int32_t differs = 0;
        for (size_t i = 0; i < at.padded; ++i) {
            column[i] = static_cast<int32_t>(at.x[i] >> step);
            row[i] = static_cast<int32_t>(at.z[i] >> step);
            differs |= (column[i] ^ p.column[i]) | (row[i] ^ p.row[i]);
        }
        const bool known = p.count == at.padded;
        if (known && differs == 0) continue;
        p.changes = 0;
        for (size_t i = 0; i < at.padded; ++i) {
            p.changed[static_cast<size_t>(p.changes)] = static_cast<uint8_t>(i);
            p.changes += column[i] != p.column[i] || row[i] != p.row[i] ? 1 : 0;
        }
        for (size_t i = 0; i < at.padded; ++i) {
            p.column[i] = column[i];
            p.row[i] = row[i];
        }
        // Of other points than before nothing is known: a step of two makes every field look at all of them.
        p.version += known ? 1 : 2;
        p.count = at.padded;
    }
}

/// Envelope, and the locals of open water and of every field of the box.
inline void shape_span(const Plan& plan, const PlannedBox& box, bool full, Scratch& at, int n) {
    shape_envelope(box, full, at, n);
    const auto count = static_cast<size_t>(n);
    if (box.open_rows)
        for (size_t i = 0; i < count; i += lanes) combine(box, at.envelope, open_water(), at.locals[0], i);
    for (size_t f = 0; f < box.fields.size(); ++f) {
        const LandField& field = *box.fields[f].field;
        SpanCells& cells = at.cells[box.first_field + f];
        load_cells(box.fields[f], at.places[static_cast<size_t>(field.step_log2() - 12)], cells);
        for (size_t i = 0; i < count; i += lanes)
            combine(box, at.envelope, sample_land(plan, field, cells, at, i), at.locals[f + 1], i);
    }
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
