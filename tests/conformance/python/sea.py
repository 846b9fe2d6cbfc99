"""The ordered sum (chapters 2.7 and 2.11), the height at a fixed place (3) and known answers (4)."""
import math
import struct
from typing import NamedTuple

from binary32 import quotient, r1, r2, r3, r4, r6, r12
from hashing import fnv
from sea_features import MASK, NO_LAND, ONE, BoxAtTime, Round, gain_float, land_in_block, modulation, sine_cosine
from sea_noise import noise_at, octaves_at
from sea_records import train_constants
from sea_wake import wake_speed, wake_trains

TRAINS, SHELTER, REFRACTION, WAKES, IRREGULAR, ORBITS, ROUND, NOISE, DISPLAYED_NOISE = (1 << bit for bit in range(9))
AUTHORITATIVE = 255


class Lands:
    """Land blocks by (field, block x, block z)."""

    def __init__(self, blocks):
        self.blocks = blocks
        self.steps = {key[0]: block.step_log2 for key, block in blocks.items()}

    def at(self, field, bases, x, z):
        """The land of a field, or of the first of its bases that has a block there."""
        step = None
        while field:
            own = self.steps.get(field)
            if own is not None and (step is None or own == step):
                step = own
                block = self.blocks.get((field, x >> step + 4, z >> step + 4))
                if block is not None:
                    return land_in_block(block, x, z)
            field = bases.get(field, 0)
        return NO_LAND


class _Part:
    """What the sum knows of a box for every time."""

    def __init__(self, box):
        self.box = box
        self.bases = dict(box.overlays)
        self.trains = [train_constants(train) for train in box.trains]


class _Now(NamedTuple):
    """A box at a time."""
    part: _Part
    state: BoxAtTime
    phases: list  # of its trains, where x = z = 0
    octaves: list


class Sea:
    """Boxes and land: a sea that can be evaluated at any point and time."""

    def __init__(self, boxes, blocks):
        self._parts = [_Part(box) for box in sorted(boxes, key=lambda box: box.id)]
        self.lands = Lands(blocks)
        self._cached = None

    def sample(self, time, x, z, layers=AUTHORITATIVE):
        """The 15 floats of a `Sample` at a rest point."""
        sums = (0.0,) * 12
        for present in self._at_time(time):
            box, envelope = present.part.box, present.state.envelope(x, z)
            if envelope is None:
                continue
            if layers & TRAINS and box.trains:
                sums = self._add_trains(sums, present, envelope, time, x, z, layers)
            if layers & WAKES and box.wake.inverse_length:
                sums = _add_wake(sums, box.wake, present.state, envelope)
            if present.octaves and layers & (DISPLAYED_NOISE if box.noise.displayed_only else NOISE):
                sums = _add_noise(sums, present.octaves, envelope, x, z)
        return _sample(sums)

    def water(self, time, x, z):
        """Height, normal and velocity at a fixed place, and the rest point found."""
        rest_x, rest_z = x, z
        s = self.sample(time, x, z)
        for _ in range(4):
            fx, fz, a, b = r4((rest_x - x) * 2.0 ** -10, (rest_z - z) * 2.0 ** -10, s[3] * s[6], s[4] * s[5])
            fx, fz, det = r3(fx - s[0], fz - s[2], a - b)
            a, b, c, d = r4(s[6] * fx, s[4] * fz, s[3] * fz, s[5] * fx)
            dx, dz = r2(a - b, c - d)
            rest_x -= _step(quotient(dx, det))
            rest_z -= _step(quotient(dz, det))
            s = self.sample(time, rest_x, rest_z)
        nx, ny, nz = s[9:12]
        a, b, c = r3(nx * nx, ny * ny, nz * nz)
        length = r1(math.sqrt(r1(r1(a + b) + c)))
        return (s[1], quotient(nx, length), quotient(ny, length), quotient(nz, length), *s[12:15]), (rest_x, rest_z)

    def _at_time(self, time):
        """Boxes that are not still water at a time, with their state."""
        if self._cached is None or self._cached[0] != time:
            states = []
            for part in self._parts:
                state = BoxAtTime(part.box, time)
                if state.gain:
                    phases = [(train.phase - (((train.omega * time) & 0xFFFFFFFFFFFFFFFF) >> 32)) & MASK
                              for train in part.trains]
                    states.append(_Now(part, state, phases, octaves_at(part.box.noise, time)))
            self._cached = time, states
        return self._cached[1]

    def _add_trains(self, sums, now, envelope, time, x, z, layers):
        part, state, box = now.part, now.state, now.part.box
        modulated = (1.0, 0.0, 0.0)
        if box.irregular.share and layers & IRREGULAR:
            modulated = modulation(box.irregular, time, x, z)
        curve = Round(box, envelope.v) if box.roundness and layers & ROUND else None
        known = {}
        for train, turned in zip(part.trains, now.phases):
            field = train.field
            if field not in known:
                land = _layered(self.lands.at(field, part.bases, x, z), layers) if field else NO_LAND
                known[field] = land, _gains(envelope, land, modulated)
            land, gains = known[field]
            shift, qx, qz = land.shift, land.shift_dx, land.shift_dz
            if curve:
                bent, slope = curve.shift_and_slope(train.whole)
                shift += bent
                px, pz = r2(slope * -state.fz, slope * state.fx)
                qx, qz = r2(px + qx, pz + qz)
            phase = (train.kx * x + train.kz * z + turned + shift) & MASK
            sums = _add_train(sums, train.amplitude, train[9:14], train.k_x, train.k_z, phase, gains, qx, qz)
        return sums


def _layered(land, layers):
    """Land without the layers that are left out."""
    if not layers & SHELTER:
        land = land._replace(gain=ONE, gain_dx=0.0, gain_dz=0.0)
    if not layers & REFRACTION:
        land = land._replace(shift=0, shift_dx=0.0, shift_dz=0.0)
    if not layers & ORBITS:
        land = land._replace(orbit=1.0, orbit_dx=0.0, orbit_dz=0.0)
    return land


def _gains(envelope, land, modulated):
    """g, gx, gz, gh, ghx, ghz of chapter 2.7."""
    a = gain_float((envelope.gain * land.gain) >> 24)
    box, ground = gain_float(envelope.gain), gain_float(land.gain)
    p, q, r, s = r4(envelope.dx * ground, box * land.gain_dx, envelope.dz * ground, box * land.gain_dz)
    ax, az = r2(p + q, r + s)
    m, mx, mz = modulated
    g, p, q, r, s, _ = r6(a * m, ax * m, a * mx, az * m, a * mz, 0.0)
    gx, gz = r2(p + q, r + s)
    orbit = land.orbit
    gh, p, q, r, s, _ = r6(g * orbit, gx * orbit, g * land.orbit_dx, gz * orbit, g * land.orbit_dz, 0.0)
    return g, gx, gz, gh, *r2(p + q, r + s)


def _add_train(sums, amplitude, h, k_x, k_z, phase, gains, qx, qz):
    """The sums with a train added; h is (hx, hz, omega hx, omega A, omega hz)."""
    g, gx, gz, gh, ghx, ghz = gains
    hx, hz, vx, vy, vz = h
    sine, cosine = sine_cosine(phase)
    s, c, sh, ch, kx, kz = r6(g * sine, g * cosine, gh * sine, gh * cosine, k_x + qx, k_z + qz)
    b1, b2, m1, m2, m3, m4 = r6(amplitude * kx, amplitude * kz, hx * kx, hx * kz, hz * kx, hz * kz)
    t = r12(hx * sh, amplitude * c, hz * sh, b1 * s, b2 * s, m1 * ch, m2 * ch, m3 * ch, m4 * ch, vx * ch, vy * s, vz * ch)
    sums = r12(*[value + term for value, term in zip(sums, t)])
    if gx or gz or ghx or ghz:
        b1, b2, m1, m2, m3, m4 = r6(amplitude * -gx, amplitude * -gz, hx * ghx, hx * ghz, hz * ghx, hz * ghz)
        b1, b2, m1, m2, m3, m4 = r6(b1 * cosine, b2 * cosine, m1 * sine, m2 * sine, m3 * sine, m4 * sine)
        aX, aY, aZ, b3, b4, m5, m6, m7, m8, *v = sums
        sums = (aX, aY, aZ, *r6(b3 + b1, b4 + b2, m5 + m1, m6 + m2, m7 + m3, m8 + m4), *v)
    return sums


def _add_wake(sums, wake, state, envelope):
    speed = wake_speed(wake)
    for index, train in wake_trains(state, envelope.u, envelope.v):
        amplitude = (wake.transverse, wake.diverging)[index]
        h, omega = r2(wake.choppiness * amplitude, speed * train.k_u)
        hx, hz = r2(h * train.d_x, h * train.d_z)
        vx, vy, vz = r3(omega * hx, omega * amplitude, omega * hz)
        land = NO_LAND._replace(gain=train.gain, gain_dx=train.gain_dx, gain_dz=train.gain_dz)
        gains = _gains(envelope, land, (1.0, 0.0, 0.0))
        sums = _add_train(sums, amplitude, (hx, hz, vx, vy, vz), train.k_x, train.k_z, train.phase, gains, 0.0, 0.0)
    return sums


def _add_noise(sums, octaves, envelope, x, z):
    height, dx, dz, dt = noise_at(octaves, x, z)
    g = gain_float(envelope.gain)
    up, bx, bz, gx, gz, rate = r6(g * height, -g * dx, -g * dz, -envelope.dx * height, -envelope.dz * height, g * dt)
    aX, aY, aZ, sx, sz, *m, vx, vy, vz = sums
    aY, sx, sz, vy = r4(aY + up, sx + bx, sz + bz, vy + rate)
    return (aX, aY, aZ, *r2(sx + gx, sz + gz), *m, vx, vy, vz)


def _sample(sums):
    aX, aY, aZ, bx, bz, mxx, mxz, mzx, mzz, vx, vy, vz = sums
    pxx, pzz = r2(1 - mxx, 1 - mzz)
    pxz, pzx, yx, yz = -mxz, -mzx, -bx, -bz
    p = r6(yz * pzx, pzz * yx, pzz * pxx, pxz * pzx, pxz * yx, yz * pxx)
    return (aX, aY, aZ, pxx, pxz, pzx, pzz, yx, yz, *r3(p[0] - p[1], p[2] - p[3], p[4] - p[5]), vx, vy, vz)


def _step(metres):
    """A step of chapter 3, lattice units."""
    if metres != metres:
        return 0
    return round(min(max(1024 * metres, -65536.0), 65536.0))


def sample_bytes(sample):
    return struct.pack("<15f", *sample)


def _splitmix64(x):
    word = 0xFFFFFFFFFFFFFFFF
    x = x + 0x9E3779B97F4A7C15 & word
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 & word
    x = (x ^ x >> 27) * 0x94D049BB133111EB & word
    return x ^ x >> 31


def known_answer(sea, seed, count):
    """Chapter 4: a generator that yields None after each sample, and the answer at the end."""
    answer = fnv(b"")
    for group in range(0, count, 64):
        h = _splitmix64(seed ^ (group << 32) & 0xFFFFFFFFFFFFFFFF)
        time = h % (900_000_000 if group // 64 % 2 == 0 else 378_432_000_000_000)
        for j in range(min(64, count - group)):
            a = _splitmix64(h + j & 0xFFFFFFFFFFFFFFFF)
            b = _splitmix64(a)
            span = 20_480_000_000 if j % 8 == 7 else 4_194_304
            sample = sea.sample(time, a % span - span // 2, b % span - span // 2)
            answer = fnv(sample_bytes(sample), answer)
            yield None
    yield answer
