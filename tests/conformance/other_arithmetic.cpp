#include "tests/conformance/other_arithmetic.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "protocol/model/ordered_sum.hpp"
#include "protocol/model/sincos.hpp"

namespace trochoid::conformance {

namespace {

/// Accumulators in the order of `Sums`; floats, unless the reckoning is wider.
using Totals = std::array<double, 12>;
constexpr std::array sums_in_order{&Sums::ax,  &Sums::ay,  &Sums::az,  &Sums::bx, &Sums::bz, &Sums::mxx,
                                   &Sums::mxz, &Sums::mzx, &Sums::mzz, &Sums::vx, &Sums::vy, &Sums::vz};
enum Total : size_t { ax, ay, az, bx, bz, mxx, mxz, mzx, mzz, vx, vy, vz };

Sums rounded(const Totals& totals) {
    Sums sums;
    for (size_t i = 0; i < totals.size(); ++i) sums.*sums_in_order[i] = static_cast<float>(totals[i]);
    return sums;
}

void take(Totals& totals, const Sums& sums) {
    for (size_t i = 0; i < totals.size(); ++i) totals[i] = static_cast<double>(sums.*sums_in_order[i]);
}

/// acc = (coefficient * value) + acc.
double step(Arithmetic how, float coefficient, float value, double acc) {
    if (how == Arithmetic::wider) return static_cast<double>(coefficient) * static_cast<double>(value) + acc;
    const auto so_far = static_cast<float>(acc);
    if (how == Arithmetic::fused) return static_cast<double>(std::fma(coefficient, value, so_far));
    return static_cast<double>(coefficient * value + so_far);
}

/// Sine and cosine of an eighth of a turn each side from their polynomials, put in their quadrant.
SinCos in_quadrant(uint32_t phase, float sine, float cosine) {
    const uint32_t q = phase + 0x20000000U;
    if ((q & 0x40000000U) != 0) std::swap(sine, cosine);
    return {std::bit_cast<float>(std::bit_cast<uint32_t>(sine) ^ (q & 0x80000000U)),
            std::bit_cast<float>(std::bit_cast<uint32_t>(cosine) ^ ((q + 0x40000000U) & 0x80000000U))};
}

SinCos wave_of(Arithmetic how, uint32_t phase) {
    using namespace sincos_bits;
    const auto coefficient = [](uint32_t bits) { return std::bit_cast<float>(bits); };
    const float t = static_cast<float>(static_cast<int32_t>(phase << 2) >> 8) * 0x1p-23F;
    const float z = t * t;
    switch (how) {
        case Arithmetic::library_sine: {
            const double angle = 2.0 * std::numbers::pi * (static_cast<double>(phase) * 0x1p-32);
            return {static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle))};
        }
        case Arithmetic::fused_sine: {
            const float sine =
                t * std::fma(z, std::fma(z, std::fma(z, coefficient(s7), coefficient(s5)), coefficient(s3)),
                             coefficient(s1));
            const float cosine = std::fma(
                z, std::fma(z, std::fma(z, coefficient(c6), coefficient(c4)), coefficient(c2)), 1.0F);
            return in_quadrant(phase, sine, cosine);
        }
        case Arithmetic::unfolded_sine: {
            const float zz = z * z;
            const float sine =
                t * ((coefficient(s1) + z * coefficient(s3)) + zz * (coefficient(s5) + z * coefficient(s7)));
            const float cosine = (1.0F + z * coefficient(c2)) + zz * (coefficient(c4) + z * coefficient(c6));
            return in_quadrant(phase, sine, cosine);
        }
        default: return sincos_turns(phase);
    }
}

/// `shift`: what land and roundness add.
uint32_t phase_of(Arithmetic how, const LiveBox& live, size_t i, SeaTime time, LatticePoint p,
                  uint32_t shift) {
    const WaveTrain& train = live.box->record.trains[i];
    if (how == Arithmetic::double_phases) {
        const double turns = static_cast<double>(train.kx) * 0x1p-32 * static_cast<double>(p.x) +
                             static_cast<double>(train.kz) * 0x1p-32 * static_cast<double>(p.z) +
                             static_cast<double>(train.phase) * 0x1p-32 -
                             static_cast<double>(train.omega) * 0x1p-64 * static_cast<double>(time.us);
        return static_cast<uint32_t>(static_cast<uint64_t>((turns - std::floor(turns)) * 0x1p32)) + shift;
    }
    const uint32_t exact = phase_from_place(train, p.x, p.z) + live.phase[i] + shift;
    return how == Arithmetic::short_phases ? exact & 0xffffff00U : exact;
}

void add_train(Arithmetic how, Totals& acc, const TrainConstants& t, const Local& l, const SinCos& wave) {
    const auto add = [&](Total which, float coefficient, float value) {
        acc[which] = step(how, coefficient, value, acc[which]);
    };
    const float s = l.g * wave.sin;
    const float c = l.g * wave.cos;
    const float sh = l.gh * wave.sin;
    const float ch = l.gh * wave.cos;
    const float kx = t.kx + l.qx;
    const float kz = t.kz + l.qz;
    add(ax, t.hx, sh);
    add(ay, t.a, c);
    add(az, t.hz, sh);
    add(bx, t.a * kx, s);
    add(bz, t.a * kz, s);
    add(mxx, t.hx * kx, ch);
    add(mxz, t.hx * kz, ch);
    add(mzx, t.hz * kx, ch);
    add(mzz, t.hz * kz, ch);
    if (l.gx != 0.0F || l.gz != 0.0F || l.ghx != 0.0F || l.ghz != 0.0F) {
        add(bx, t.a * -l.gx, wave.cos);
        add(bz, t.a * -l.gz, wave.cos);
        add(mxx, t.hx * l.ghx, wave.sin);
        add(mxz, t.hx * l.ghz, wave.sin);
        add(mzx, t.hz * l.ghx, wave.sin);
        add(mzz, t.hz * l.ghz, wave.sin);
    }
    add(vx, t.omega * t.hx, ch);
    add(vy, t.omega * t.a, s);
    add(vz, t.omega * t.hz, ch);
}

void add_box(Arithmetic how, std::span<Totals> lanes, const LiveBox& live, const Envelope& e, SeaTime time,
             LatticePoint p) {
    const PreparedBox& box = *live.box;
    const WaveTrainBox& record = box.record;
    const HeightModulation m = modulation_at(record.irregular, live.irregular, p);
    const int64_t v = record.roundness != 0 ? box_position(record, live.instant, p).v : 0;
    const float fx = static_cast<float>(record.ux) * 0x1p-30F;
    const float fz = static_cast<float>(record.uz) * 0x1p-30F;
    for (size_t i = 0; i < box.constants.size(); ++i) {
        const int16_t field = box.field_of_train[i];
        const LandSample land = field < 0 ? LandSample{} : box.fields[static_cast<size_t>(field)]->sample(p);
        Local local = combine(e, land, m);
        if (record.roundness != 0) {
            const RoundShift bent = round_shift(record.roundness, box.constants[i].whole, record.width, v);
            local.shift += bent.shift;
            local.qx = bent.slope * -fz + local.qx;
            local.qz = bent.slope * fx + local.qz;
        }
        add_train(how, lanes[i % lanes.size()], box.constants[i], local,
                  wave_of(how, phase_of(how, live, i, time, p, local.shift)));
    }
}

}  // namespace

SurfaceSample with_normal(SurfaceSample s, bool fused) {
    if (fused) {
        s.nx = std::fma(s.yz, s.pzx, -(s.pzz * s.yx));
        s.ny = std::fma(s.pzz, s.pxx, -(s.pxz * s.pzx));
        s.nz = std::fma(s.pxz, s.yx, -(s.yz * s.pxx));
    } else {
        s.nx = s.yz * s.pzx - s.pzz * s.yx;
        s.ny = s.pzz * s.pxx - s.pxz * s.pzx;
        s.nz = s.pxz * s.yx - s.yz * s.pxx;
    }
    return s;
}

SurfaceSample sample_by(Arithmetic how, const SeaInstant& instant, LatticePoint place) {
    std::array<Totals, 4> lanes{};
    const std::span used = std::span(lanes).first(how == Arithmetic::four_sums ? 4 : 1);
    for (const LiveBox& live : instant.live()) {
        const WaveTrainBox& record = live.box->record;
        const Envelope e = envelope_at(record, live.instant, place);
        if (e.gain == 0) continue;
        add_box(how, used, live, e, instant.time(), place);
        if (!has_wake(record.wake) && live.noise.empty()) continue;
        Sums sums = rounded(lanes[0]);
        if (has_wake(record.wake)) add_wake(sums, live, e, place);
        if (!live.noise.empty()) add_noise(sums, live.noise, e, place);
        take(lanes[0], sums);
    }
    Sums all = rounded(lanes[0]);
    for (const Totals& lane : used.subspan(1))
        for (const auto part : sums_in_order) all.*part += rounded(lane).*part;
    return with_normal(finish(all), how == Arithmetic::fused);
}

}  // namespace trochoid::conformance
