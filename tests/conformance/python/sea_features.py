"""The parts of the sum that a box may have: envelope, land, round waves, irregular heights (chapters 2.4 to 2.6, 2.8)."""
from typing import NamedTuple

from binary32 import TAU, from_bits, r1, r2, r3, r4, r6

ONE = 1 << 24  # Q0.24
MASK = 0xFFFFFFFF

S1, S3, S5, S7, C2, C4, C6 = map(
    from_bits, (0x3F490FDA, 0xBDA55DBE, 0x3B232873, 0xB815DFA5, 0xBE9DE9D1, 0x3C81D8C7, 0xB9A7588A))
LAND_TURN = from_bits(0x38C90FDB)  # 2 pi * 2^-16


def sine_cosine(p):
    """Sine and cosine of a phase in turns, Q0.32."""
    t = ((((p << 2) & MASK) ^ 0x80000000) - 0x80000000 >> 8) * 2.0 ** -23
    z = r1(t * t)
    s, c = r2(z * S7, z * C6)
    s, c = r2(S5 + s, C4 + c)
    s, c = r2(z * s, z * c)
    s, c = r2(S3 + s, C2 + c)
    s, c = r2(z * s, z * c)
    s, c = r2(S1 + s, 1.0 + c)
    s = r1(t * s)
    q = p + 0x20000000
    if q & 0x40000000:
        s, c = c, s
    return (-s if q & 0x80000000 else s), (-c if q + 0x40000000 & 0x80000000 else c)


def times(a, b):
    return (a * b) >> 24


def unit(gain):
    return gain * 2.0 ** -24  # exact: gains are below 2^25


def gain_float(gain):
    """f(g) of chapter 2.7."""
    return (gain >> 2) * 2.0 ** -22


def ramp(elapsed, duration):
    if elapsed < 0:
        return 0
    return ONE if elapsed >= duration else (elapsed << 24) // duration


def side(distance, length, sign):
    """Gain and slope of a ramp in space."""
    if distance <= 0:
        return 0, 0.0
    if distance >= length:
        return ONE, 0.0
    return (distance * ((1 << 40) // length)) >> 16, sign * r1(1024 / float(length))


class Envelope(NamedTuple):
    """Of a box at a point: gain, its gradient, and where the point is in the box."""
    gain: int
    dx: float
    dz: float
    u: int
    v: int


class BoxAtTime:
    """What chapter 2.5 says of a box once per time."""

    def __init__(self, box, time):
        age = time - box.begin
        after = time - box.end
        self.box = box
        self.grown = age + box.raised
        self.after = after
        gain = 0 if age < 0 else times(ramp(self.grown, box.build_up), ramp(age, box.fade))
        if after >= 0:
            gain = 0 if after >= box.decay else times(gain, ONE - ramp(after, box.decay))
        self.gain = gain
        self.front = box.length
        if box.front_speed and box.length and self.grown < (box.length << 24) // box.front_speed:
            self.front = min(box.length, (self.grown * box.front_speed) >> 24)
        self.corner = self._corner(time)
        self.fx, self.fz = r2(box.ux * 2.0 ** -30, box.uz * 2.0 ** -30)

    def _corner(self, time):
        box = self.box
        if not box.course:
            return box.x, box.z
        leg = box.course[0]
        for later in box.course:
            if later.begin <= time:
                leg = later
        moved = min(max(time - leg.begin, 0), leg.duration)
        return leg.x + ((leg.vx * moved) >> 24), leg.z + ((leg.vz * moved) >> 24)

    def envelope(self, x, z):
        """Chapter 2.5 at a point; None where the box adds nothing."""
        box = self.box
        if self.gain == 0:
            return None
        dx, dz = x - self.corner[0], z - self.corner[1]
        u = (dx * box.ux + dz * box.uz) >> 30
        v = (dz * box.ux - dx * box.uz) >> 30
        if box.length == 0 and box.width == 0:
            return Envelope(self.gain, 0.0, 0.0, u, v)
        if abs(dx) > 1 << 31 or abs(dz) > 1 << 31:
            return None
        rear = front = left = right = (ONE, 0.0)
        if box.length:
            rear, front = side(u, box.ramp_rear, 1), side(self.front - u, box.ramp_front, -1)
        if box.width:
            left, right = side(v, box.ramp_side, 1), side(box.width - v, box.ramp_side, -1)
        along, across = times(rear[0], front[0]), times(left[0], right[0])
        gain = times(times(along, across), self.gain)
        if gain == 0:
            return None
        a, b, c, d = r4(rear[1] * unit(front[0]), unit(rear[0]) * front[1], left[1] * unit(right[0]), unit(left[0]) * right[1])
        gu, gv = r2(a + b, c + d)
        gu, gv = r2(gu * unit(across), gv * unit(along))
        gu, gv = r2(gu * unit(self.gain), gv * unit(self.gain))
        return Envelope(gain, *self.turned(gu, gv), u, v)

    def turned(self, pu, pv):
        """A vector along u and v, in the world."""
        fx, fz = self.fx, self.fz
        a, b, c, d = r4(pu * fx, pv * fz, pu * fz, pv * fx)
        return r2(a - b, c + d)


class Land(NamedTuple):
    """A land field at a point (chapter 2.6)."""
    shift: int = 0
    shift_dx: float = 0.0
    shift_dz: float = 0.0
    gain: int = ONE
    gain_dx: float = 0.0
    gain_dz: float = 0.0
    orbit: float = 1.0
    orbit_dx: float = 0.0
    orbit_dz: float = 0.0


NO_LAND = Land()


def _between(plane, at, fx, fz):
    """A plane's value (24 bits) within the cell at node `at`, and its differences east - west and south - north."""
    n00, n10, n01, n11 = plane[at], plane[at + 1], plane[at + 17], plane[at + 18]
    west = (n00 * (65536 - fz) + n01 * fz) >> 8
    east = (n10 * (65536 - fz) + n11 * fz) >> 8
    north = (n00 * (65536 - fx) + n10 * fx) >> 8
    south = (n01 * (65536 - fx) + n11 * fx) >> 8
    return west + (((east - west) * fx) >> 16), east - west, south - north


def land_in_block(block, x, z):
    """A block's land at a point that lies over it."""
    s = block.step_log2
    at = (z >> s & 15) * 17 + (x >> s & 15)
    fx, fz = (x % (1 << s) << 16) >> s, (z % (1 << s) << 16) >> s
    p00, p10, p01, p11 = block.shifts[at], block.shifts[at + 1], block.shifts[at + 17], block.shifts[at + 18]
    cross = (p11 - p01) - (p10 - p00)
    slope_x = (p10 - p00) + ((cross * fz) >> 16)
    slope_z = (p01 - p00) + ((cross * fx) >> 16)
    shift = (p00 * 65536 + (p01 - p00) * fz + slope_x * fx) & MASK
    gain, gain_x, gain_z = _between(block.gains, at, fx, fz)
    orbit, orbit_x, orbit_z = _between(block.orbits, at, fx, fz)
    m = 2.0 ** (s - 10)
    turn, fine, coarse = r3(LAND_TURN / m, 2.0 ** -23 / m, 2.0 ** -22 / m)
    slopes = r6(slope_x * turn, slope_z * turn, gain_x * fine, gain_z * fine, orbit_x * coarse, orbit_z * coarse)
    return Land(shift, slopes[0], slopes[1], gain << 1, slopes[2], slopes[3], orbit * 2.0 ** -22, slopes[4], slopes[5])


class Round:
    """Round waves of a box at a point (chapter 2.8)."""

    def __init__(self, box, v):
        v = min(max(v, 0), box.width)
        middle = box.width // 2
        self._a = abs(v - middle)
        self._f = min((self._a * ((1 << 40) // box.width)) >> 9, 1 << 30)
        self._sign = -1.0 if v < middle else 1.0
        self._roundness = box.roundness

    def shift_and_slope(self, whole):
        """Of a train with so many turns per lattice unit, Q0.32."""
        p = self._f * ((whole * self._roundness) >> 15)
        shift = (self._a * (p >> 31)) + ((self._a * (p & 0x7FFFFFFF)) >> 31)
        return shift & MASK, self._sign * r1((p >> 31) * 2.0 ** -21 * TAU)


def modulation(irregular, time, x, z):
    """M, Mx, Mz of irregular heights (chapter 2.8)."""
    i = irregular
    turned = ((i.omega * time) & 0xFFFFFFFFFFFFFFFF) >> 32
    su, cu = sine_cosine((i.ukx * x + i.ukz * z + i.phase_u - turned) & MASK)
    sv, cv = sine_cosine((i.vkx * x + i.vkz * z + i.phase_v) & MASK)
    r = i.share * 2.0 ** -15
    wux, wuz, wvx, wvz = (r1(TAU * r1(k * 2.0 ** -22)) for k in (i.ukx, i.ukz, i.vkx, i.vkz))
    both, u_falls, v_falls = r3(su * sv, cu * sv, su * cv)
    a, b, c, d = r4(u_falls * wux, v_falls * wvx, u_falls * wuz, v_falls * wvz)
    mx, mz = r2(a + b, c + d)
    lost, mx, mz = r3(r * both, r * mx, r * mz)
    return r1(1.0 - lost), -mx, -mz
