#include "protocol/model/ship_wake.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/box_course.hpp"
#include "protocol/model/gain.hpp"

namespace trochoid {

namespace {

constexpr float two_pi = 0x1.921fb6p+2F;
constexpr uint32_t unit_gain = 1U << 24;

int32_t q24(double v) {
    const double half_up = v * 0x1p24 + 0.5;
    return static_cast<int32_t>(half_up);
}

double smooth(double q) {
    const double held = q < 0.0 ? 0.0 : (q > 1.0 ? 1.0 : q);
    return held * held * (3.0 - 2.0 * held);
}

/// Amplitude of the stationary phase over the angle, softened at the cusp.
double stationary_gain(double t) {
    const double s = std::sqrt(1.0 + t * t);
    const double bend = 1.0 - 2.0 * t * t;
    return std::sqrt(s * (1.0 + 2.0 * t * t) / std::sqrt(bend * bend + 0.25)) / (1.0 + t * t);
}

WakeNode node(double tau, double t, double gain) {
    const double s = std::sqrt(1.0 + t * t);
    return {q24(s * (1.0 - tau * t)), q24(1.0 / s), q24(t / s), q24(gain)};
}

WakeTable make_table() {
    WakeTable table;
    const double cusp = 1.0 / std::sqrt(8.0);
    const double cusp_t = std::sqrt(0.5);
    for (int i = 0; i <= wake_cells; ++i) {
        const double tau = static_cast<double>(i) / 2048.0;
        // Beyond the cusp, and for diverging waves below lambda0 / 16, the last plane wave goes on.
        const double short_tau = tau < 0.125 ? 0.125 : tau;
        const bool inside = 8.0 * tau * tau < 1.0;
        const double t1 = inside ? 2.0 * tau / (1.0 + std::sqrt(1.0 - 8.0 * tau * tau)) : cusp_t;
        const double t2 =
            inside ? (1.0 + std::sqrt(1.0 - 8.0 * short_tau * short_tau)) / (4.0 * short_tau) : cusp_t;
        const double edge = 1.0 - smooth((tau - cusp) / (cusp / 20.0));
        const double long_enough = smooth((tau - 0.125) * 16.0);
        table.transverse[static_cast<size_t>(i)] =
            node(tau, t1, stationary_gain(t1) / stationary_gain(0.0) * edge);
        table.diverging[static_cast<size_t>(i)] =
            node(tau, t2, stationary_gain(t2) / stationary_gain(cusp_t) * edge * long_enough);
    }
    for (int i = 0; i <= wake_root_cells; ++i)
        table.root[static_cast<size_t>(i)] = q24(1.0 / std::sqrt(1.0 + static_cast<double>(i) / 32.0));
    return table;
}

float power_of_two(int exponent) { return std::bit_cast<float>(static_cast<uint32_t>(127 + exponent) << 23); }

/// n0 + (n1 - n0) * fraction, fraction with `bits` bits.
int32_t between(int32_t n0, int32_t n1, uint32_t fraction, int bits) {
    return n0 + static_cast<int32_t>((static_cast<int64_t>(n1 - n0) * fraction) >> bits);
}

/// A factor of the gain and its slope per lambda0.
struct Factor {
    uint32_t gain = 0;
    float slope = 0.0F;
};

/// q^2 (3 - 2q) of a ramp that is `q`, Q0.24, and rises by `steepness` per lambda0.
Factor smooth_ramp(uint32_t q, float steepness) {
    const uint32_t square = times(q, q);
    const float f = static_cast<float>(q) * 0x1p-24F;
    return {times(square, 3U * unit_gain - 2U * q), steepness * ((6.0F * f) * (1.0F - f))};
}

/// min((length * inverse) >> (16 + halvings), 1), Q0.24: full after 2^halvings lambda0; 0 for lengths below 0.
uint32_t ramp(int64_t length, uint32_t inverse, int halvings) {
    if (length <= 0) return 0;
    return static_cast<uint32_t>(
        std::min<uint64_t>((static_cast<uint64_t>(length) * inverse) >> (16 + halvings), unit_gain));
}

/// 1/sqrt(xi) from xi = 1 on, a straight line towards 3/2 before. xi: Q.20.
Factor distance_factor(uint32_t xi) {
    if (xi < (1U << 20)) return {(3U * unit_gain - (xi << 4)) >> 1, -0.5F};
    const int halvings = (static_cast<int>(std::bit_width(xi)) - 21) / 2;
    const uint32_t m = xi >> (2 * halvings);
    const size_t cell = (m - (1U << 20)) >> 15;
    const int32_t n0 = wake_table().root[cell];
    const int32_t n1 = wake_table().root[cell + 1];
    return {static_cast<uint32_t>(between(n0, n1, m & 32767U, 15)) >> halvings,
            static_cast<float>(n1 - n0) * power_of_two(-19 - 3 * halvings)};
}

/// What both systems share at a point.
struct Place {
    uint64_t distance = 0;   // behind / lambda0, Q.40
    uint32_t tau = 0;        // Q0.24
    float side = 1.0F;       // of the course: 1 right, -1 left
    float per_metre = 0.0F;  // 1 / behind
    float inverse = 0.0F;    // 1 / lambda0, 1/m
    Factor fall;             // with the distance
    Factor rise;             // behind the front
    Factor end;              // before the rear
};

WakeWave wave_at(const std::array<WakeNode, wake_cells + 1>& nodes, const Place& at, uint32_t lag) {
    const size_t cell = at.tau >> 13;
    const uint32_t fraction = at.tau & 8191U;
    const WakeNode& n0 = nodes[cell];
    const WakeNode& n1 = nodes[cell + 1];
    WakeWave w;
    const auto gain = static_cast<uint32_t>(between(n0.gain, n1.gain, fraction, 13));
    w.gain = times(times(times(gain, at.fall.gain), at.rise.gain), at.end.gain);
    if (w.gain == 0) return w;
    const auto turns = static_cast<uint32_t>(between(n0.phase, n1.phase, fraction, 13));
    const uint64_t high = at.distance >> 32;
    const uint64_t low = at.distance & 0xffffffffU;
    w.phase = lag - (static_cast<uint32_t>(high * turns) + static_cast<uint32_t>((low * turns) >> 32));
    const float tau = static_cast<float>(at.tau) * 0x1p-24F;
    const float phase = gain_to_float(turns);
    const float phase_slope = static_cast<float>(n1.phase - n0.phase) * 0x1p-13F;
    const float k0 = two_pi * at.inverse;
    w.ku = k0 * (phase - tau * phase_slope);
    w.kv = at.side * -(k0 * phase_slope);
    w.du = static_cast<float>(between(n0.along, n1.along, fraction, 13)) * 0x1p-24F;
    w.dv = at.side * (static_cast<float>(between(n0.outwards, n1.outwards, fraction, 13)) * 0x1p-24F);

    const float g = gain_to_float(gain);
    const float gain_slope = static_cast<float>(n1.gain - n0.gain) * 0x1p-13F;
    const float fall = gain_to_float(at.fall.gain);
    const float rise = gain_to_float(at.rise.gain);
    const float end = gain_to_float(at.end.gain);
    const float stand = rise * end;
    const float by_tau = (gain_slope * at.per_metre) * (fall * stand);
    const float by_distance =
        at.inverse * (g * (at.fall.slope * stand + fall * (at.rise.slope * end + rise * at.end.slope)));
    w.dgain_du = by_tau * tau - by_distance;
    w.dgain_dv = at.side * by_tau;
    return w;
}

bool finite(float v) { return (std::bit_cast<uint32_t>(v) & 0x7f800000U) != 0x7f800000U; }

Result<Done> range_error(const char* message) { return Error{ErrorCode::value_out_of_range, message}; }

double strongest(const std::array<WakeNode, wake_cells + 1>& nodes) {
    int32_t most = 0;
    for (const WakeNode& n : nodes) most = std::max(most, n.gain);
    return static_cast<double>(most) * 0x1p-24;
}

}  // namespace

const WakeTable& wake_table() {
    static const WakeTable table = make_table();
    return table;
}

float wake_speed(const ShipWake& wake) { return (static_cast<float>(wake.group_speed) * 0x1p-33F) * 1e6F; }

WakeSample wake_at(const ShipWake& wake, int64_t behind, int64_t aside, int64_t rear, int64_t front) {
    constexpr int64_t reach = int64_t{1} << 31;
    const int64_t off = aside < 0 ? -aside : aside;
    if (behind <= 0 || off >= behind || behind >= reach) return {};
    const auto x = static_cast<uint32_t>(behind);
    const auto y = static_cast<uint32_t>(off);
    // Both to 24 bits of the distance, so that three integer quotients of eight bits each give tau.
    const int excess = static_cast<int>(std::bit_width(x)) - 24;
    const uint32_t b = excess >= 0 ? x >> excess : x << -excess;
    const uint32_t a = excess >= 0 ? y >> excess : y << -excess;
    Place at;
    at.tau = static_cast<uint32_t>((static_cast<uint64_t>(a) << 24) / b);
    if (at.tau >= wake_cells << 13) return {};
    const auto reciprocal = static_cast<uint32_t>((uint64_t{1} << 47) / b);
    at.per_metre = static_cast<float>(reciprocal) * power_of_two(-37 - excess);
    at.side = aside < 0 ? -1.0F : 1.0F;
    at.inverse = static_cast<float>(wake.inverse_length) * 0x1p-30F;
    at.distance = uint64_t{x} * wake.inverse_length;
    at.fall = distance_factor(static_cast<uint32_t>(std::min<uint64_t>(at.distance >> 20, UINT32_MAX)));
    // Over two lambda0: nearer to the ship the wedge is so narrow that its edge would fold the crests.
    at.rise = smooth_ramp(ramp(behind - front, wake.inverse_length, 1), 0.5F);
    at.end = smooth_ramp(ramp(rear - behind, wake.inverse_length, 0), -1.0F);
    // A stationary point's phase leads or lags by an eighth of a turn.
    return {wave_at(wake_table().transverse, at, 0xe0000000U),
            wave_at(wake_table().diverging, at, 0x20000000U)};
}

double wake_bound(const ShipWake& wake) {
    // The product of fall and rise is largest, 0.725, at 1.8 lambda0.
    return 0.75 * (static_cast<double>(wake.transverse) * strongest(wake_table().transverse) +
                   static_cast<double>(wake.diverging) * strongest(wake_table().diverging));
}

Result<Done> validate(const ShipWake& wake) {
    for (const float v : {wake.transverse, wake.diverging, wake.choppiness})
        if (!finite(v)) return Error{ErrorCode::not_finite, "ship wake: a value is not finite"};
    for (const float a : {wake.transverse, wake.diverging})
        if (std::signbit(a) || (a != 0.0F && (a < 0x1p-20F || a > 32.0F)))
            return range_error("ship wake: an amplitude is neither 0 nor in 2^-20 to 32 m");
    if (wake.choppiness < 0.0F || wake.choppiness > 4.0F)
        return range_error("ship wake: the choppiness is not in 0 to 4");
    if (!has_wake(wake)) return Done{};
    if (wake.inverse_length < (1U << 20) || wake.inverse_length > (1U << 31))
        return range_error("ship wake: the wave length is not 0.5 to 1024 m");
    if (wake.group_speed == 0 || wake.group_speed > static_cast<uint32_t>(fastest_leg))
        return range_error("ship wake: the group speed is not in 1 to 2^21");
    return Done{};
}

}  // namespace trochoid
