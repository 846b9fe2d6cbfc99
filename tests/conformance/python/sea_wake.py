"""Ship wakes (chapter 2.9): the table of Kelvin's two systems of waves, and a wake at a point."""
import math
from typing import NamedTuple

from binary32 import TAU, r1, r2, r3, r4
from sea_features import MASK, ONE, gain_float, times

NODES = 769
LAGS = (0xE0000000, 0x20000000)  # transverse, diverging
FULL = (1 << 31) - 1


def _fixed(value):
    return math.floor(value * 2.0 ** 24 + 0.5)


def _smooth(v):
    h = min(max(v, 0.0), 1.0)
    return h * h * (3 - 2 * h)


def _strength(t):
    s = math.sqrt(1 + t * t)
    e = 1 - (2 * t) * t
    return math.sqrt((s * (1 + (2 * t) * t)) / math.sqrt(e * e + 0.25)) / (1 + t * t)


def _node(j):
    """(phase, along, outwards, gain) of both systems at tau = j / 2048."""
    tau = j / 2048
    far = max(tau, 0.125)
    cusp = 1 / math.sqrt(8)
    tc = math.sqrt(0.5)
    t1 = (2 * tau) / (1 + math.sqrt(1 - (8 * tau) * tau)) if (8 * tau) * tau < 1 else tc
    t2 = (1 + math.sqrt(1 - (8 * far) * far)) / (4 * far) if (8 * far) * far < 1 else tc
    edge = 1 - _smooth((tau - cusp) / (cusp / 20))
    long = _smooth((tau - 0.125) * 16)
    gains = (_strength(t1) / _strength(0.0)) * edge, ((_strength(t2) / _strength(tc)) * edge) * long
    node = []
    for t, gain in zip((t1, t2), gains):
        s = math.sqrt(1 + t * t)
        node.append((_fixed(s * (1 - tau * t)), _fixed(1 / s), _fixed(t / s), _fixed(gain)))
    return node


_nodes = [_node(j) for j in range(NODES)]
SYSTEMS = [[node[system] for node in _nodes] for system in (0, 1)]
ROOT = [_fixed(1 / math.sqrt(1 + j / 32)) for j in range(97)]


def _at(n0, n1, weight, shift):
    return n0 + (((n1 - n0) * weight) >> shift)


def _sailed(elapsed, group_speed):
    """How far a wake's end has come, lattice units."""
    if elapsed <= 0:
        return 0
    return FULL if elapsed >= (FULL << 24) // group_speed else (elapsed * group_speed) >> 24


def _end_ramp(q, slope):
    p = unit_of(q)
    a, b = r2(6 * p, 1 - p)
    return times(times(q, q), 3 * ONE - 2 * q), r1(slope * r1(a * b))


def unit_of(value):
    return value * 2.0 ** -24


def _fall(xi):
    """1 / sqrt(1 + ...) of the way behind, with its slope."""
    if xi < 1 << 20:
        return (3 * ONE - (xi << 4)) >> 1, -0.5
    h = (xi.bit_length() - 21) // 2
    m = xi >> 2 * h
    j = (m - (1 << 20)) >> 15
    return _at(ROOT[j], ROOT[j + 1], m & 32767, 15) >> h, (ROOT[j + 1] - ROOT[j]) * 2.0 ** (-19 - 3 * h)


class WakeTrain(NamedTuple):
    """A system at a point: a train of the sum, in the world."""
    phase: int
    d_x: float
    d_z: float
    k_x: float
    k_z: float
    k_u: float
    gain: int
    gain_dx: float
    gain_dz: float


def wake_trains(state, u, v):
    """The systems of a box's wake at (u, v), (index, WakeTrain) each."""
    box, wake = state.box, state.box.wake
    behind, aside = box.length - u, v - box.width // 2
    if behind <= 0 or abs(aside) >= behind or behind >= 1 << 31:
        return
    e = behind.bit_length() - 24
    b, a = (behind >> e, abs(aside) >> e) if e >= 0 else (behind << -e, abs(aside) << -e)
    tau = (a << 24) // b
    if tau >= (NODES - 1) << 13:
        return
    i = wake.inverse_length
    per = ((1 << 47) // b) * 2.0 ** (-37 - e)
    inverse = r1(i * 2.0 ** -30)
    way = behind * i
    fall, fall_slope = _fall(min(way >> 20, MASK))
    rear, front = _sailed(state.grown, wake.group_speed), _sailed(state.after, wake.group_speed)
    rise, rise_slope = _end_ramp(min((max(behind - front, 0) * i) >> 17, ONE), 0.5)
    end, end_slope = _end_ramp(min((max(rear - behind, 0) * i) >> 16, ONE), -1.0)
    at, weight = tau >> 13, tau & 8191
    side = -1.0 if aside < 0 else 1.0
    t = tau * 2.0 ** -24
    k0 = r1(TAU * inverse)
    for index, nodes in enumerate(SYSTEMS):
        (phase0, along0, out0, gain0), (phase1, along1, out1, gain1) = nodes[at], nodes[at + 1]
        own = _at(gain0, gain1, weight, 13)
        gain = times(times(times(own, fall), rise), end)
        if gain == 0:
            continue
        turns = _at(phase0, phase1, weight, 13)
        phase = (LAGS[index] - (way >> 32) * turns - (((way & MASK) * turns) >> 32)) & MASK
        bend = (phase1 - phase0) * 2.0 ** -13
        lean = r1(t * bend)
        lean, k_v = r2(gain_float(turns) - lean, k0 * bend)
        k_u = r1(k0 * lean)
        k_v = side * -k_v
        du = _at(along0, along1, weight, 13) * 2.0 ** -24
        dv = side * (_at(out0, out1, weight, 13) * 2.0 ** -24)
        slopes = (gain1 - gain0) * 2.0 ** -13, per, fall_slope, rise_slope, end_slope
        pu, pv = _gain_slopes(slopes, tuple(map(gain_float, (own, fall, rise, end))), inverse, t, side)
        yield index, WakeTrain(phase, *state.turned(du, dv), *state.turned(k_u, k_v), k_u, gain, *state.turned(pu, pv))


def _gain_slopes(slopes, gains, inverse, t, side):
    """The gain's slopes along u and v."""
    own_slope, per, fall_slope, rise_slope, end_slope = slopes
    g, d, r, z = gains
    n, across, rising, ending = r4(r * z, own_slope * per, rise_slope * z, r * end_slope)
    both, a, c = r3(d * n, fall_slope * n, rising + ending)
    c = r1(d * c)
    tau_part, total = r2(across * both, a + c)
    total, shrunk = r2(g * total, tau_part * t)
    xi_part = r1(inverse * total)
    return r1(shrunk - xi_part), side * tau_part


def wake_speed(wake):
    """V, m/s."""
    return r1(r1(wake.group_speed * 2.0 ** -33) * 1e6)
