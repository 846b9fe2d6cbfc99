"""The records of the sea (chapter 2.1 of the standard) and what follows from them alone (2.2)."""
import math
from typing import NamedTuple

from binary32 import TAU, r1, r2


class Train(NamedTuple):
    """A wave train as it is sent."""
    kx: int
    kz: int
    omega: int
    phase: int
    amplitude: float
    choppiness: float
    field: int = 0


class Leg(NamedTuple):
    """A straight leg of a course."""
    begin: int
    duration: int
    x: int
    z: int
    vx: int
    vz: int


class Irregular(NamedTuple):
    """Irregular heights; share 0 is off."""
    share: int = 0
    ukx: int = 0
    ukz: int = 0
    vkx: int = 0
    vkz: int = 0
    omega: int = 0
    phase_u: int = 0
    phase_v: int = 0


class Noise(NamedTuple):
    """Surface noise; amplitude 0 is off."""
    amplitude: float = 0.0
    persistence: int = 0
    octaves: int = 1
    step_log2: int = 9
    period_log2: int = 19
    displayed_only: int = 1
    seed: int = 0


class Wake(NamedTuple):
    """A ship's wake; inverse_length 0 is off."""
    transverse: float = 0.0
    diverging: float = 0.0
    choppiness: float = 0.0
    inverse_length: int = 0
    group_speed: int = 0


class Box(NamedTuple):
    """A wave train box."""
    id: int
    first_train: int
    x: int
    z: int
    ux: int
    uz: int
    length: int
    width: int
    ramp_rear: int
    ramp_front: int
    ramp_side: int
    begin: int
    build_up: int
    end: int
    decay: int
    front_speed: int
    gain_max: int
    raised: int = 0
    fade: int = 0
    roundness: int = 0
    trains: tuple = ()
    overlays: tuple = ()  # of (field, base)
    course: tuple = ()
    irregular: Irregular = Irregular()
    noise: Noise = Noise()
    wake: Wake = Wake()


class Block(NamedTuple):
    """A land block: 17 x 17 nodes, row by row."""
    step_log2: int
    shifts: tuple
    gains: tuple
    orbits: tuple


class TrainConstants(NamedTuple):
    """What chapter 2.2 derives from a train, and the products of it that the sum needs."""
    kx: int  # mod 2^32
    kz: int
    omega: int
    phase: int
    field: int
    whole: int
    amplitude: float
    k_x: float
    k_z: float
    h_x: float
    h_z: float
    v_x: float  # omega * hx
    v_y: float  # omega * A
    v_z: float  # omega * hz
    wavelength: float
    angular: float  # omega, rad/s


def angular_frequency(omega):
    """rad/s of omega in turns per microsecond, Q0.64."""
    zeros = 64 - (omega | 1).bit_length()
    top = ((omega << zeros) & ((1 << 64) - 1)) >> 40
    return r1(TAU * r1(top * 2.0 ** -(24 + zeros) * 1e6))


def train_constants(train):
    tx, tz = r2(train.kx * 2.0 ** -22, train.kz * 2.0 ** -22)
    xx, zz = r2(tx * tx, tz * tz)
    n = r1(math.sqrt(r1(xx + zz)))
    dx, dz = r2(tx / n, tz / n)
    k, h = r2(TAU * n, train.choppiness * train.amplitude)
    h_x, h_z = r2(h * dx, h * dz)
    omega = angular_frequency(train.omega)
    return TrainConstants(
        train.kx & 0xFFFFFFFF, train.kz & 0xFFFFFFFF, train.omega, train.phase, train.field,
        math.isqrt(train.kx * train.kx + train.kz * train.kz), train.amplitude, *r2(k * dx, k * dz), h_x, h_z,
        r1(omega * h_x), r1(omega * train.amplitude), r1(omega * h_z), r1(1 / n), omega)
