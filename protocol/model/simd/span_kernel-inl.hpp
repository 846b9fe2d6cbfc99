// The inner loop of all: trains of a stretch, added in order to accumulators that stay in registers.
#if defined(TROCHOID_SIMD_KERNEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TROCHOID_SIMD_KERNEL_INL
#undef TROCHOID_SIMD_KERNEL_INL
#else
#define TROCHOID_SIMD_KERNEL_INL
#endif

#include "protocol/model/simd/scratch.hpp"
#include "protocol/model/simd/span_noise-inl.hpp"
#include "protocol/model/simd/span_shape-inl.hpp"
#include "protocol/model/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace trochoid::simd::HWY_NAMESPACE {

/// Which accumulators are wanted, bits.
constexpr int sum_y = 1;       // ay
constexpr int sum_xz = 2;      // ax, az
constexpr int sum_slope = 4;   // bx, bz
constexpr int sum_matrix = 8;  // mxx, mxz, mzx, mzz
constexpr int sum_speed = 16;  // vx, vy, vz
constexpr int sum_displacement = sum_y | sum_xz;
constexpr int sum_normal = sum_displacement | sum_slope | sum_matrix;
constexpr int sum_all = sum_normal | sum_speed;
constexpr int sum_newton = sum_xz | sum_matrix;

struct Sums {
    /// On Arm a constructor that gcc makes by itself has the command line's target, and cannot take in that of a vector.
    HWY_INLINE Sums() {}  // NOLINT(modernize-use-equals-default): that one is made by itself
    VecF ax, ay, az, bx, bz, mxx, mxz, mzx, mzz, vx, vy, vz;
};

template <int parts, class Visit>
HWY_INLINE void visit_sums(Sums& s, SpanSums& m, Visit visit) {
    if constexpr ((parts & sum_xz) != 0) visit(s.ax, m.ax);
    if constexpr ((parts & sum_y) != 0) visit(s.ay, m.ay);
    if constexpr ((parts & sum_xz) != 0) visit(s.az, m.az);
    if constexpr ((parts & sum_slope) != 0) {
        visit(s.bx, m.bx);
        visit(s.bz, m.bz);
    }
    if constexpr ((parts & sum_matrix) != 0) {
        visit(s.mxx, m.mxx);
        visit(s.mxz, m.mxz);
        visit(s.mzx, m.mzx);
        visit(s.mzz, m.mzz);
    }
    if constexpr ((parts & sum_speed) != 0) {
        visit(s.vx, m.vx);
        visit(s.vy, m.vy);
        visit(s.vz, m.vz);
    }
}

/// Phases over a grid's tile: one vector a train, moved on each time it is read: by one vector's width, at a row's end to the
/// start of the next one.
struct RowPhases {
    PhaseVector* table;
    size_t move;  ///< index into PhaseVector::moves
    HWY_INLINE VecU take(const TrainRow&, size_t train) const {
        uint32_t* at = table[train].turns.data();
        const VecU phase = hn::Load(du, at);
        hn::Store(hn::Add(phase, hn::Set(du, table[train].moves[move])), du, at);
        return phase;
    }
    /// Passes over a vector that needs no sum.
    HWY_INLINE void skip(const TrainRow& row, size_t train) const { take(row, train); }
};

/// Phases at places.
struct PlacePhases {
    VecU x, z;
    HWY_INLINE VecU take(const TrainRow& row, size_t) const {
        return hn::Add(hn::Add(hn::Mul(hn::Set(du, row.kx), x), hn::Mul(hn::Set(du, row.kz), z)),
                       hn::Set(du, row.phase));
    }
    HWY_INLINE void skip(const TrainRow&, size_t) const {}
};

/// Adds one train from its gained sine and cosine, without any gradient: every product of constants is ready.
template <int parts>
HWY_INLINE void add_ready(const TrainRow& row, VecF s, VecF c, Sums& acc) {
    if constexpr ((parts & sum_xz) != 0) accumulate(acc.ax, splat(row.hx), s);
    if constexpr ((parts & sum_y) != 0) accumulate(acc.ay, splat(row.a), c);
    if constexpr ((parts & sum_xz) != 0) accumulate(acc.az, splat(row.hz), s);
    if constexpr ((parts & sum_slope) != 0) {
        accumulate(acc.bx, splat(row.akx), s);
        accumulate(acc.bz, splat(row.akz), s);
    }
    if constexpr ((parts & sum_matrix) != 0) {
        accumulate(acc.mxx, splat(row.hxkx), c);
        accumulate(acc.mxz, splat(row.hxkz), c);
        accumulate(acc.mzx, splat(row.hzkx), c);
        accumulate(acc.mzz, splat(row.hzkz), c);
    }
    if constexpr ((parts & sum_speed) != 0) {
        accumulate(acc.vx, splat(row.vx), c);
        accumulate(acc.vy, splat(row.vy), s);
        accumulate(acc.vz, splat(row.vz), c);
    }
}

/// With 32 registers three trains can be under way at once; with 16 the accumulators would not stay in registers.
constexpr bool many_registers = lanes == 16 || (HWY_ARCH_ARM != 0);

/// Trains [first, end) in order, in steps that overlap, as none of them could be waited for: the next train's angle, with many
/// registers also the next one's sine, are on their way while one is added. `phase(t)` gives a phase, `add_train(t, wave)` adds.
template <bool deep, class Phase, class AddTrain>
HWY_INLINE void sum_run(size_t first, size_t end, Phase phase, AddTrain add_train) {
    Angle angle = angle_of(phase(first));
    if constexpr (deep) {
        Wave wave = wave_of(angle);
        size_t t = first + 1;
        if (t < end) {
            angle = angle_of(phase(t));
            for (++t; t < end; ++t) {
                const Angle next_angle = angle_of(phase(t));
                const Wave next_wave = wave_of(angle);
                add_train(t - 2, wave);
                angle = next_angle;
                wave = next_wave;
            }
            const Wave last = wave_of(angle);
            add_train(end - 2, wave);
            wave = last;
        }
        add_train(end - 1, wave);
    } else {
        for (size_t t = first + 1; t < end; ++t) {
            const Angle next = angle_of(phase(t));
            add_train(t - 1, wave_of(angle));
            angle = next;
        }
        add_train(end - 1, wave_of(angle));
    }
}

/// Calls sum(i, phases, acc) for the vectors [begin, end) of a span, i the first point of each. `first`: nothing has been summed yet.
template <int parts, class MakePhases, class Sum>
HWY_INLINE void each_vector(bool first, size_t begin, size_t end, SpanSums& sums,
                            const MakePhases& make_phases, Sum sum) {
    for (size_t i = begin; i < end; i += lanes) {
        Sums acc;
        if (first)
            visit_sums<parts>(acc, sums, [](VecF& v, SpanOf<float>&) HWY_ATTR { v = hn::Zero(df); });
        else
            visit_sums<parts>(acc, sums,
                              [i](VecF& v, SpanOf<float>& m) HWY_ATTR { v = hn::Load(df, &m[i]); });
        sum(i, make_phases(i), acc);
        visit_sums<parts>(acc, sums, [i](VecF& v, SpanOf<float>& m) HWY_ATTR { hn::Store(v, df, &m[i]); });
    }
}

/// Trains where the envelope is full and nothing else acts. Not inlined: alone in its function the loop keeps its registers.
template <int parts, bool unit_gain, class MakePhases>
HWY_NOINLINE void sum_fast(const TrainRow* rows, size_t count, bool first, size_t n, SpanSums& sums,
                           const MakePhases make_phases) {
    each_vector<parts>(first, 0, n, sums, make_phases, [=](size_t, const auto& phases, Sums& acc) HWY_ATTR {
        sum_run<many_registers>(
            0, count, [&](size_t t) HWY_ATTR { return phases.take(rows[t], t); },
            [&](size_t t, const Wave& wave) HWY_ATTR {
                if constexpr (unit_gain) {
                    add_ready<parts>(rows[t], wave.sine, wave.cosine, acc);
                } else {
                    const VecF g = splat(rows[t].g);
                    add_ready<parts>(rows[t], mul(g, wave.sine), mul(g, wave.cosine), acc);
                }
            });
    });
}

/// A vector of a SpanLocal, in registers over a run of trains.
struct Shape {
    VecU shift;
    VecF g, gx, gz, gh, ghx, ghz, qx, qz;
};
HWY_INLINE Shape shape_at(const SpanLocal& l, size_t i) {
    return {hn::Load(du, &l.shift[i]), hn::Load(df, &l.g[i]),  hn::Load(df, &l.gx[i]),
            hn::Load(df, &l.gz[i]),    hn::Load(df, &l.gh[i]), hn::Load(df, &l.ghx[i]),
            hn::Load(df, &l.ghz[i]),   hn::Load(df, &l.qx[i]), hn::Load(df, &l.qz[i])};
}

/// Adds one train with everything that may shape it. Terms that are 0 change no bit, as no accumulator is ever -0.
template <int parts>
HWY_INLINE void add_shaped(const TrainRow& row, const Shape& l, VecF qx, VecF qz, const Wave& wave,
                           Sums& acc) {
    const VecF sine = wave.sine;
    const VecF cosine = wave.cosine;
    const VecF sh = mul(l.gh, sine);
    const VecF ch = mul(l.gh, cosine);
    const VecF hx = splat(row.hx);
    const VecF a = splat(row.a);
    const VecF hz = splat(row.hz);
    if constexpr ((parts & sum_xz) != 0) accumulate(acc.ax, hx, sh);
    if constexpr ((parts & sum_y) != 0) accumulate(acc.ay, a, mul(l.g, cosine));
    if constexpr ((parts & sum_xz) != 0) accumulate(acc.az, hz, sh);
    const VecF kx = add(splat(row.wave_kx), qx);
    const VecF kz = add(splat(row.wave_kz), qz);
    if constexpr ((parts & sum_slope) != 0) {
        const VecF s = mul(l.g, sine);
        accumulate(acc.bx, mul(a, kx), s);
        accumulate(acc.bz, mul(a, kz), s);
        accumulate(acc.bx, mul(a, hn::Neg(l.gx)), cosine);
        accumulate(acc.bz, mul(a, hn::Neg(l.gz)), cosine);
    }
    if constexpr ((parts & sum_matrix) != 0) {
        accumulate(acc.mxx, mul(hx, kx), ch);
        accumulate(acc.mxz, mul(hx, kz), ch);
        accumulate(acc.mzx, mul(hz, kx), ch);
        accumulate(acc.mzz, mul(hz, kz), ch);
        accumulate(acc.mxx, mul(hx, l.ghx), sine);
        accumulate(acc.mxz, mul(hx, l.ghz), sine);
        accumulate(acc.mzx, mul(hz, l.ghx), sine);
        accumulate(acc.mzz, mul(hz, l.ghz), sine);
    }
    if constexpr ((parts & sum_speed) != 0) {
        accumulate(acc.vx, splat(row.vx), ch);
        accumulate(acc.vy, splat(row.vy), mul(l.g, sine));
        accumulate(acc.vz, splat(row.vz), ch);
    }
}

/// round_shift of a train: what it adds to the phase and to its gradient.
HWY_INLINE void bend_round(const PlannedBox& box, const SpanEnvelope& e, const TrainRow& row, size_t i,
                           VecU& phase, VecF& qx, VecF& qz) {
    const VecU off = hn::Load(du, &e.off[i]);
    const VecU part = hn::Load(du, &e.part[i]);
    const VecU number = hn::Set(du, row.round_wave_number);
    const VecU whole = mul_shift<31>(part, number);
    const VecU rest = hn::And(hn::Mul(part, number), hn::Set(du, 0x7fffffffU));
    phase = hn::Add(phase, hn::Add(hn::Mul(off, whole), mul_shift<31>(off, rest)));
    const VecF steepness = mul(mul(float_of(whole), splat(0x1p-21F)), splat(0x1.921fb6p+2F));
    const VecF slope = hn::Xor(steepness, hn::BitCast(df, hn::Load(du, &e.side[i])));
    qx = add(mul(slope, splat(-box.uz)), qx);
    qz = add(mul(slope, splat(box.ux)), qz);
}

/// A run of trains of one field over the vectors [begin, end). Not inlined, as sum_fast is not.
template <int parts, SpanNeeds needs, class MakePhases>
HWY_NOINLINE void sum_local(const TrainRow* rows, size_t count, const SpanLocal& local, size_t begin,
                            size_t end, SpanSums& sums, const MakePhases make_phases) {
    each_vector<parts>(
        false, begin, end, sums, make_phases, [&](size_t i, const auto& phases, Sums& acc) HWY_ATTR {
            const Shape l = shape_at(local, i);
            const auto phase = [&](size_t t) HWY_ATTR { return hn::Add(phases.take(rows[t], t), l.shift); };
            if constexpr (needs == SpanNeeds::all)
                sum_run<(many_registers && parts == sum_newton) || lanes == 16>(
                    0, count, phase, [&](size_t t, const Wave& wave) HWY_ATTR {
                        add_shaped<parts>(rows[t], l, l.qx, l.qz, wave, acc);
                    });
            else
                sum_run<many_registers>(0, count, phase, [&](size_t t, const Wave& wave) HWY_ATTR {
                    add_ready<parts>(rows[t], mul(l.g, wave.sine), mul(l.g, wave.cosine), acc);
                });
        });
}

/// Passes over the vectors [begin, end) of a run.
template <class MakePhases>
HWY_INLINE void skip_local(const TrainRow* rows, size_t count, size_t begin, size_t end,
                           const MakePhases& make_phases) {
    for (size_t i = begin; i < end; i += lanes) {
        const auto phases = make_phases(i);
        for (size_t t = 0; t < count; ++t) phases.skip(rows[t], t);
    }
}

/// A run of trains of a box of round waves.
template <int parts, class MakePhases>
HWY_NOINLINE void sum_round(const PlannedBox& box, const SpanEnvelope& envelope, const TrainRow* rows,
                            size_t count, const SpanLocal& local, size_t begin, size_t end, SpanSums& sums,
                            const MakePhases make_phases) {
    each_vector<parts>(false, begin, end, sums, make_phases,
                       [&](size_t i, const auto& phases, Sums& acc) HWY_ATTR {
                           const Shape l = shape_at(local, i);
                           for (size_t t = 0; t < count; ++t) {
                               VecU phase = hn::Add(phases.take(rows[t], t), l.shift);
                               VecF qx = l.qx;
                               VecF qz = l.qz;
                               bend_round(box, envelope, rows[t], i, phase, qx, qz);
                               add_shaped<parts>(rows[t], l, qx, qz, wave_of(phase), acc);
                           }
                       });
}

/// Anything: gains, gradients, land, round waves; by runs of trains of one field, and in each by vectors of the same needs.
template <int parts, class PhasesFrom>
HWY_INLINE void sum_general(const Plan& plan, const PlannedBox& box, const Stretch& stretch, size_t n,
                            Scratch& at, const PhasesFrom& phases_from) {
    const int32_t past = stretch.first_row + stretch.rows;
    for (size_t r = stretch.first_run; r < box.runs.size() && box.runs[r].first_row < past; ++r) {
        const TrainRun& run = box.runs[r];
        const auto first_row = static_cast<size_t>(run.first_row);
        const TrainRow* rows = plan.rows.data() + first_row;
        const auto count = static_cast<size_t>(run.rows);
        const SpanLocal& local = at.locals[static_cast<size_t>(run.local)];
        const auto phases = phases_from(first_row);
        for (size_t i = 0; i < n;) {
            const SpanNeeds needs = local.needs[i];
            size_t end = i + lanes;
            while (end < n && local.needs[end] == needs) end += lanes;
            if (needs == SpanNeeds::nothing)
                skip_local(rows, count, i, end, phases);
            else if (box.round)
                sum_round<parts>(box, at.envelope, rows, count, local, i, end, at.sums, phases);
            else if (needs == SpanNeeds::all)
                sum_local<parts, SpanNeeds::all>(rows, count, local, i, end, at.sums, phases);
            else
                sum_local<parts, SpanNeeds::gain>(rows, count, local, i, end, at.sums, phases);
            i = end;
        }
    }
}

inline void clear_sums(Scratch& at) {
    Sums zero;
    for (size_t i = 0; i < at.padded; i += lanes)
        visit_sums<sum_all>(zero, at.sums,
                            [i](VecF&, SpanOf<float>& m) HWY_ATTR { hn::Store(hn::Zero(df), df, &m[i]); });
}

/// A stretch without land or envelope over a span. `first`: nothing has been summed yet.
template <int parts, class PhasesFrom>
HWY_INLINE void sum_open(const Plan& plan, const Stretch& stretch, bool first, int n, Scratch& at,
                         const PhasesFrom& phases_from) {
    const auto first_row = static_cast<size_t>(stretch.first_row);
    const TrainRow* rows = plan.rows.data() + first_row;
    const auto count = static_cast<size_t>(stretch.rows);
    const auto points = static_cast<size_t>(n);
    if (stretch.kind == Stretch::Kind::fast_unit)
        sum_fast<parts, true>(rows, count, first, points, at.sums, phases_from(first_row));
    else
        sum_fast<parts, false>(rows, count, first, points, at.sums, phases_from(first_row));
}

/// All stretches over a span. `phases_from(row)` gives what gives a vector's phases of the trains from that row on.
template <int parts, class PhasesFrom>
HWY_INLINE void sum_span(const Plan& plan, int n, Scratch& at, PhasesFrom phases_from) {
    bool first = true;
    const PlannedBox* shaped = nullptr;
    place_cells(plan, at, n);
    for (const Stretch& stretch : at.stretches) {
        if (stretch.box == nullptr) {
            sum_open<parts>(plan, stretch, first, n, at, phases_from);
            first = false;
            continue;
        }
        const PlannedBox& box = *stretch.box;
        if (&box != shaped) shape_span(plan, box, stretch.full, at, n);
        shaped = &box;
        if (first) clear_sums(at);
        first = false;
        if (stretch.kind == Stretch::Kind::general) {
            sum_general<parts>(plan, box, stretch, static_cast<size_t>(n), at, phases_from);
        } else {
            if (box.wake) add_wake(box, at, n);
            if (box.noise) add_noise_span(box, at, n);
        }
    }
    if (first) clear_sums(at);
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
