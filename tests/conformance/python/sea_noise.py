"""Surface noise (chapter 2.10)."""
from typing import NamedTuple

from binary32 import r1, r2, r3, r4, r6, r8, r12, r16

MASK = 0xFFFFFFFF
CORNERS = [(l, r, c) for l in (0, 1) for r in (0, 1) for c in (0, 1)]


def _mix(v):
    v = ((v ^ v >> 16) * 0x7FEB352D) & MASK
    v = ((v ^ v >> 15) * 0x846CA68B) & MASK
    return v ^ v >> 16


def _gradients():
    """(gx, gz, gt) for each of the 16 values of a corner's hash."""
    result = []
    for h in range(16):
        e1, e2 = (-1.0 if h & 1 else 1.0), (-1.0 if h & 2 else 1.0)
        result.append(((e1, e2, 0.0), (e1, 0.0, e2), (0.0, e1, e2), (e1, e2, 0.0))[h >> 2])
    return result


GRADIENTS = _gradients()


def _fades(p):
    """fade and fade' of three numbers: two tuples."""
    a, b, c = p
    a2, b2, c2, a6, b6, c6 = r6(a * a, b * b, c * c, a * 6, b * 6, c * 6)
    a3, b3, c3, u, v, w = r6(a2 * a, b2 * b, c2 * c, a6 - 15, b6 - 15, c6 - 15)
    u, v, w, a1, b1, c1 = r6(a * u, b * v, c * w, a - 1, b - 1, c - 1)
    u, v, w, a1, b1, c1 = r6(u + 10, v + 10, w + 10, a1 * a1, b1 * b1, c1 * c1)
    a2, b2, c2 = r3(30 * a2, 30 * b2, 30 * c2)
    return r3(a3 * u, b3 * v, c3 * w), r3(a2 * a1, b2 * b1, c2 * c1)


class Octave(NamedTuple):
    """An octave at a time."""
    amplitude: float
    slope: float  # amplitude * 2^(10 - S)
    rate: float  # amplitude * 10^6 * 2^-R
    step: int  # S
    bases: tuple
    t: float


def octaves_at(noise, time):
    """The octaves of a layer that count, at a time."""
    result = []
    amplitude = noise.amplitude
    share = noise.persistence * 2.0 ** -16
    for j in range(noise.octaves):
        if amplitude < 2.0 ** -24:
            break
        step, period = noise.step_log2 - j, noise.period_log2 - j
        layer = time >> period & MASK
        seed = _mix((noise.seed + j * 0x9E3779B9) & MASK)
        bases = tuple(_mix(((n & MASK) * 0xCB1AB31F + seed) & MASK) for n in (layer, layer + 1))
        t = ((time % (1 << period)) >> max(period - 24, 0)) * 2.0 ** -min(period, 24)
        rate = r1(1e6 * 2.0 ** -period)
        result.append(Octave(amplitude, *r2(amplitude * 2.0 ** (10 - step), amplitude * rate), step, bases, t))
        amplitude = r1(amplitude * share)
    return result


def _corners(octave, x, z, px, pz):
    """Value and gradient of the eight corners, in the order of CORNERS."""
    step = octave.step
    whole = (1 << 32 - step) - 1
    column, row = (x & MASK) >> step, (z & MASK) >> step
    columns = column * 0x8DA6B343, (column + 1 & whole) * 0x8DA6B343
    rows = row * 0xD8163841, (row + 1 & whole) * 0xD8163841
    gradients = [GRADIENTS[_mix(octave.bases[l] + rows[r] + columns[c] & MASK) >> 28] for l, r, c in CORNERS]
    dx, dz, dt = (px, px - 1), (pz, pz - 1), (octave.t, octave.t - 1)
    flat = r8(*[g[0] * dx[c] + g[1] * dz[r] for g, (_, r, c) in zip(gradients, CORNERS)])
    return r8(*[f + g[2] * dt[l] for f, g, (l, _, _) in zip(flat, gradients, CORNERS)]), gradients


def _octave(octave, x, z):
    """(value, gx, gz, gt) of an octave at a point."""
    scale = 2.0 ** -octave.step
    rest = (1 << octave.step) - 1
    px, pz = (x & rest) * scale, (z & rest) * scale
    (wx, wz, wt), (sx, sz, st) = _fades((px, pz, octave.t))
    v, g = _corners(octave, x, z, px, pz)
    # Rows: the difference of two gradients is exact, and so is its product with a weight.
    step = r4(v[1] - v[0], v[3] - v[2], v[5] - v[4], v[7] - v[6])
    part = r8(*[wx * d for d in step], *[sx * d for d in step])
    mixed = r16(*[v[2 * n] + part[n] for n in range(4)],
                *[g[2 * n][axis] + wx * (g[2 * n + 1][axis] - g[2 * n][axis]) for axis in range(3) for n in range(4)])
    value, gz, gt = mixed[0:4], mixed[8:12], mixed[12:16]
    gx = r4(*[mixed[4 + n] + part[4 + n] for n in range(4)])
    # Layers, each of two rows.
    step = r8(value[1] - value[0], value[3] - value[2], gx[1] - gx[0], gx[3] - gx[2],
              gz[1] - gz[0], gz[3] - gz[2], gt[1] - gt[0], gt[3] - gt[2])
    part = r12(*[wz * d for d in step], sz * step[0], sz * step[1], 0.0, 0.0)
    v0, v1, x0, x1, z0, z1, t0, t1 = r8(*[base + p for base, p in zip(
        (value[0], value[2], gx[0], gx[2], gz[0], gz[2], gt[0], gt[2]), part)])
    z0, z1 = r2(z0 + part[8], z1 + part[9])
    # The octave.
    dv, dx, dz, dt = r4(v1 - v0, x1 - x0, z1 - z0, t1 - t0)
    pv, px, pz, pt, turn, *_ = r8(wt * dv, wt * dx, wt * dz, wt * dt, st * dv, 0.0, 0.0, 0.0)
    value, gx, gz, gt = r4(v0 + pv, x0 + px, z0 + pz, t0 + pt)
    return value, gx, gz, r1(gt + turn)


def noise_at(octaves, x, z):
    """Height, its slopes along x and z, and its rate, of a layer with these octaves."""
    sums = 0.0, 0.0, 0.0, 0.0
    for octave in octaves:
        value, gx, gz, gt = _octave(octave, x, z)
        a, b, c, d = r4(octave.amplitude * value, octave.slope * gx, octave.slope * gz, octave.rate * gt)
        sums = r4(sums[0] + a, sums[1] + b, sums[2] + c, sums[3] + d)
    return sums
