"""Patches as planes (chapter 8): what a delta sets and removes, in one column each of levels, places, bounds and boxes."""
import math
from typing import NamedTuple

from binary32 import from_bits
from planes import PlaneError, decode_column
from refusal import Refusal

MOST_SET, MOST_REMOVED, MOST_ENTRIES, MOST_TRAINS = 1024, 65536, 65536, 256


class Patch(NamedTuple):
    """A square of the sea: (box, how many of its trains) each."""
    boxes: tuple
    left_out: float
    height_error: float


def _need(condition, what, code="value_out_of_range", requirement=117):
    if not condition:
        raise Refusal(code, requirement, f"patch_planes: {what}")


class _Columns:
    def __init__(self, data):
        self.data, self.at = bytes(data), 0

    def next(self, count):
        try:
            values, self.at = decode_column(self.data, self.at, count)
        except PlaneError as error:
            raise Refusal("value_out_of_range", 117, f"patch_planes: {error}") from None
        return values

    def keys(self, count):
        keys = list(zip(self.next(count), self.next(count), self.next(count)))
        for level, x, z in keys:
            _need(15 <= level <= 26, f"level {level}")
            reach = 1 << 35 - level
            _need(-reach <= x < reach and -reach <= z < reach, "a patch outside of the world")
        _need(all(a < b for a, b in zip(keys, keys[1:])), "keys do not ascend")
        return keys

    def left(self):
        return len(self.data) - self.at


def _bound(bits):
    _need(-(1 << 31) <= bits < 1 << 31, "a bound of more than 32 bits")
    value = from_bits(bits & 0xFFFFFFFF)
    _need(math.isfinite(value), f"a bound is {value}", "not_finite", 116)
    _need(bits >= 0, f"a bound is {value}")
    return value


def decode_patches(data, box_ids):
    """({(level, x, z): Patch} that are set, [(level, x, z)] that are removed)."""
    _need(all(a < b for a, b in zip(box_ids, box_ids[1:])), "box_ids do not ascend")
    columns = _Columns(data)
    count, gone = columns.next(2)
    _need(0 <= count <= MOST_SET and 0 <= gone <= MOST_REMOVED and count + gone > 0, f"{count} patches, {gone} removed")
    _need(count + gone <= columns.left(), f"{count + gone} patches in {columns.left()} bytes")
    keys = columns.keys(count)
    left_out, height_error = columns.next(count), columns.next(count)
    bounds = [(_bound(a), _bound(b)) for a, b in zip(left_out, height_error)]
    boxes = [[] for _ in keys]
    entries = 0
    for box in box_ids:
        for patch, trains in enumerate(columns.next(count)):
            _need(0 <= trains <= MOST_TRAINS + 1, f"{trains - 1} trains of box {box}")
            if trains:
                entries += 1
                _need(entries <= MOST_ENTRIES, f"more than {MOST_ENTRIES} boxes")
                boxes[patch].append((box, trains - 1))
    removed = columns.keys(gone)
    _need(columns.left() == 0, f"{columns.left()} bytes too many")
    return {key: Patch(tuple(named), *pair) for key, named, pair in zip(keys, boxes, bounds)}, removed
