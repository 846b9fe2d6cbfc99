"""IEEE 754 binary32 in pure Python.

Python's floats are binary64. The sum, difference, product, quotient or root of two binary32 numbers, computed in binary64 and
then rounded once more to binary32, is the correctly rounded binary32 result (53 >= 2 * 24 + 2, subnormals too). So every
operation of the standard is written as a binary64 operation whose result goes through one of the functions here. Operations
that do not depend on each other go through together: one call of `struct` rounds them all.
"""
import struct


def _rounder(count):
    form = struct.Struct(f"{count}f")  # native 'f' is a C cast: to nearest even, never an error
    pack, unpack = form.pack, form.unpack

    def rounded(*values):
        return unpack(pack(*values))

    return rounded


_one = struct.Struct("f")


def r1(value, pack=_one.pack, unpack=_one.unpack):
    """The binary32 number nearest to a binary64 one."""
    return unpack(pack(value))[0]


r2, r3, r4, r6, r8, r12, r16 = map(_rounder, (2, 3, 4, 6, 8, 12, 16))


def bits(value):
    """The 32 bits of a binary32 number."""
    return struct.unpack("<I", struct.pack("<f", value))[0]


def from_bits(word):
    """The binary32 number with these 32 bits."""
    return struct.unpack("<f", struct.pack("<I", word))[0]


def quotient(a, b):
    """a / b, rounded; where b is 0 an infinity or NaN, as IEEE 754 says."""
    if b != 0:
        return r1(a / b)
    if a == 0 or a != a:
        return float("nan")
    negative = (bits(a) ^ bits(b)) >> 31
    return float("-inf") if negative else float("inf")


TAU = from_bits(0x40C90FDB)  # 2 pi
