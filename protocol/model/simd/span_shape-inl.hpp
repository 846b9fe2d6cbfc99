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

/// A vector's west nodes and its east nodes, which lie in turns.
struct NodePairs {
    VecI west, east;
};
HWY_INLINE NodePairs load_pairs(const int32_t* from) {
#if HWY_TARGET == HWY_SCALAR
    return {hn::Load(di, from), hn::Load(di, from + 1)};
#else
    const VecI first = hn::Load(di, from);
    const VecI second = hn::Load(di, from + lanes);
    return {hn::ConcatEven(di, second, first), hn::ConcatOdd(di, second, first)};
#endif
}

HWY_INLINE LandVectors open_water() {
    const VecF zero = hn::Zero(df);
    return {hn::Zero(du), hn::Set(du, full_gain), zero, zero, zero, zero, splat(1.0F), zero, zero};
}

/// What steps between nodes are worth on a lattice: its cells' sides turn them into gradients.
struct LandSteps {
    float shift, gain, orbit;
};
inline LandSteps steps_of(const LandField& field) {
    const float metres = static_cast<float>(int32_t{1} << (field.step_log2() - 10));
    return {0x1.921fb6p-14F / metres, 0x1p-23F / metres, 0x1p-22F / metres};
}

/// `everything`: no layer of the land is switched off.
template <bool everything>
HWY_INLINE LandVectors sample_land(const Plan& plan, const LandSteps& steps, const SpanPlaces& places,
                                   const SpanCells& c, size_t i) {
    LandVectors out = open_water();
    const VecI ix = hn::Load(di, &places.in_x[i]);
    const VecI iz = hn::Load(di, &places.in_z[i]);
    if (everything || plan.refraction) {
        // Shifts are below 2^30 and steps below 2^23, so every difference fits.
        const NodePairs north_edge = load_pairs(&c.shift0[2 * i]);
        const NodePairs south_edge = load_pairs(&c.shift1[2 * i]);
        const VecI p00 = north_edge.west;
        const VecI east = hn::Sub(north_edge.east, p00);
        const VecI south = hn::Sub(south_edge.west, p00);
        const VecI cross = hn::Sub(hn::Sub(south_edge.east, south_edge.west), east);
        const VecI slope_x = hn::Add(east, scale16(cross, iz));
        const VecI slope_z = hn::Add(south, scale16(cross, ix));
        out.shift = hn::BitCast(
            du, hn::Add(hn::Add(hn::ShiftLeft<16>(p00), hn::Mul(south, iz)), hn::Mul(slope_x, ix)));
        out.shift_dx = mul(hn::ConvertTo(df, slope_x), splat(steps.shift));
        out.shift_dz = mul(hn::ConvertTo(df, slope_z), splat(steps.shift));
    }
    if (everything || plan.shelter) {
        const CellVectors gain = interpolate(hn::Load(du, &c.gain0[i]), hn::Load(du, &c.gain1[i]), ix, iz);
        out.gain = hn::BitCast(du, hn::ShiftLeft<1>(gain.value));
        out.gain_dx = mul(hn::ConvertTo(df, gain.east), splat(steps.gain));
        out.gain_dz = mul(hn::ConvertTo(df, gain.south), splat(steps.gain));
    }
    if (everything || plan.orbits) {
        const CellVectors orbit = interpolate(hn::Load(du, &c.orbit0[i]), hn::Load(du, &c.orbit1[i]), ix, iz);
        out.orbit = mul(hn::ConvertTo(df, orbit.value), splat(0x1p-22F));
        out.orbit_dx = mul(hn::ConvertTo(df, orbit.east), splat(steps.orbit));
        out.orbit_dz = mul(hn::ConvertTo(df, orbit.south), splat(steps.orbit));
    }
    return out;
}

HWY_INLINE bool all_zero(VecF bits) { return hn::AllTrue(du, hn::Eq(hn::BitCast(du, bits), hn::Zero(du))); }

/// SeaInstant's `combine`. `plain`: the box's envelope is 1 everywhere, and its heights are even.
template <bool plain>
HWY_INLINE void combine(const PlannedBox& box, const SpanEnvelope& e, const LandVectors& land, SpanLocal& out,
                        size_t i) {
    VecF g;
    VecF gx;
    VecF gz;
    if constexpr (plain) {
        // What is left of the products and sums below, to the bit: no gradient of the land is -0.
        g = gain_to_float(land.gain);
        gx = land.gain_dx;
        gz = land.gain_dz;
    } else {
        const VecU box_gain_bits = hn::Load(du, &e.gain[i]);
        g = gain_to_float(mul_shift<24>(box_gain_bits, land.gain));
        const VecF box_gain = gain_to_float(box_gain_bits);
        const VecF land_gain = gain_to_float(land.gain);
        gx = add(mul(hn::Load(df, &e.dx[i]), land_gain), mul(box_gain, land.gain_dx));
        gz = add(mul(hn::Load(df, &e.dz[i]), land_gain), mul(box_gain, land.gain_dz));
        if (box.uneven) {
            const VecF factor = hn::Load(df, &e.factor[i]);
            gx = add(mul(gx, factor), mul(g, hn::Load(df, &e.factor_dx[i])));
            gz = add(mul(gz, factor), mul(g, hn::Load(df, &e.factor_dz[i])));
            g = mul(g, factor);
        }
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
    // By bits: a -0 only costs the time of terms that are 0.
    const VecF gradients = hn::Or(hn::Or(gx, gz), hn::Or(ghx, ghz));
    const VecF others = hn::Or(hn::Or(land.shift_dx, land.shift_dz), hn::Xor(g, gh));
    if (!all_zero(hn::Or(gradients, others)))
        out.needs[i] = SpanNeeds::all;
    else
        out.needs[i] = all_zero(g) ? SpanNeeds::nothing : SpanNeeds::gain;
}

/// The first n points' places in their cells, Q0.16, and which of them have come into another cell; called once for every evaluation
/// of a span. The vectors' other points keep whatever cells they had.
inline void place_cells(const Plan& plan, Scratch& at, int n) {
    const auto count = static_cast<size_t>(n);
    for (int step = 12; step <= 20; ++step) {
        if ((plan.steps >> step & 1U) == 0) continue;
        SpanPlaces& p = at.places[static_cast<size_t>(step - 12)];
        const PlannedLattice& lattice = plan.lattices[static_cast<size_t>(step - 12)];
        alignas(64) SpanOf<int32_t> column;
        alignas(64) SpanOf<int32_t> row;
        int32_t differs = 0;
        const uint32_t mask = (1U << step) - 1U;
        for (size_t i = 0; i < at.padded; ++i) {
            p.in_x[i] = static_cast<int32_t>((at.x_low[i] & mask) << 4 >> (step - 12));
            p.in_z[i] = static_cast<int32_t>((at.z_low[i] & mask) << 4 >> (step - 12));
        }
        for (size_t i = 0; i < count; ++i) {
            column[i] = static_cast<int32_t>(at.x[i] >> step);
            row[i] = static_cast<int32_t>(at.z[i] >> step);
            differs |= (column[i] ^ p.column[i]) | (row[i] ^ p.row[i]);
        }
        const bool known = p.count == count;
        if (known && differs == 0) continue;
        p.changes = 0;
        for (size_t i = 0; known && i < count; ++i) {
            p.changed[static_cast<size_t>(p.changes)] = static_cast<uint8_t>(i);
            p.changes += column[i] != p.column[i] || row[i] != p.row[i] ? 1 : 0;
        }
        for (size_t i = 0; i < count; ++i) {
            p.column[i] = column[i];
            p.row[i] = row[i];
            p.block[i] = lattice.place({column[i] >> 4, row[i] >> 4});
            p.node[i] = static_cast<uint32_t>((row[i] & 15) * block_nodes + (column[i] & 15));
        }
        // Of other points than before nothing is known: a step of two makes every field look at all of them.
        p.version += known ? 1 : 2;
        p.count = count;
    }
}

/// The locals of every field of the box. `plain`: as for combine, and no layer of the land is switched off.
template <bool plain>
HWY_INLINE void shape_fields(const Plan& plan, const PlannedBox& box, Scratch& at, size_t count) {
    for (size_t f = 0; f < box.fields.size(); ++f) {
        const LandField& field = *box.fields[f].field;
        const LandSteps steps = steps_of(field);
        const SpanPlaces& places = at.places[static_cast<size_t>(field.step_log2() - 12)];
        const SpanCells& cells = at.cells[box.first_field + f];
        SpanLocal& local = at.locals[f + 1];
        for (size_t i = 0; i < count; i += lanes)
            combine<plain>(box, at.envelope, sample_land<plain>(plan, steps, places, cells, i), local, i);
    }
}

/// Envelope, and the locals of open water and of every field of the box.
inline void shape_span(const Plan& plan, const PlannedBox& box, bool full, Scratch& at, int n) {
    const auto count = static_cast<size_t>(n);
    // All of them first: vectors that are read right after their points were written one by one would have to wait.
    for (size_t f = 0; f < box.fields.size(); ++f)
        load_cells(box.fields[f], at.places[static_cast<size_t>(box.fields[f].field->step_log2() - 12)],
                   at.cells[box.first_field + f]);
    shape_envelope(box, full, at, n);
    if (box.open_rows)
        for (size_t i = 0; i < count; i += lanes)
            combine<false>(box, at.envelope, open_water(), at.locals[0], i);
    const bool everything = plan.refraction && plan.shelter && plan.orbits;
    if (full && everything && box.live->instant.time_gain == full_gain && !box.uneven)
        shape_fields<true>(plan, box, at, count);
    else
        shape_fields<false>(plan, box, at, count);
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
