"""Plane coding (chapter 5): rows of counts as varints of what their neighbours do not predict."""

from itertools import accumulate

BLOCK_SIDE = 17
NODES = BLOCK_SIDE * BLOCK_SIDE
TILE_SIDE = 65
ORBIT_ONE = 16384


class PlaneError(Exception):
    """Bytes that are not the shortest form of a plane."""


def _varint(data, at):
    value = 0
    for place in range(5):
        if at + place >= len(data):
            raise PlaneError("the plane ends within a number")
        byte = data[at + place]
        value |= (byte & 127) << 7 * place
        if byte < 128:
            if byte == 0 and place:
                raise PlaneError("a padded varint")
            return value, at + place + 1
    raise PlaneError("a varint of more than 5 bytes")


def _residuals(data, at, count):
    result = []
    ran = False
    while len(result) < count:
        code, at = _varint(data, at)
        if code:
            result.append(code >> 1 if code % 2 == 0 else -(code + 1 >> 1))
            ran = False
            continue
        run, at = _varint(data, at)
        if ran or len(result) + run + 1 > count:
            raise PlaneError("a run beyond the plane, or right after a run")
        result += [0] * (run + 1)
        ran = True
    return result, at


def decode_plane(data, at, side):
    """The side x side values that start at data[at], and where they end."""
    residuals, at = _residuals(data, at, side * side)
    values = []
    for index, residual in enumerate(residuals):
        row, column = divmod(index, side)
        if row and column:
            residual += values[-1] + values[index - side] - values[index - side - 1]
        elif column:
            residual += values[-1]
        elif row:
            residual += values[index - side]
        values.append(residual)
    return values, at


def decode_column(data, at, count):
    """The values of a plane of one column that starts at data[at], and where it ends."""
    residuals, at = _residuals(data, at, count)
    return list(accumulate(residuals)), at


def _put_varint(out, value):
    while value >= 128:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)


def encode_plane(values, side):
    """The bytes of a plane."""
    out, run = bytearray(), 0

    def end_run():
        if run:
            out.append(0)
            _put_varint(out, run - 1)

    for index, value in enumerate(values):
        row, column = divmod(index, side)
        left = values[index - 1] if column else 0
        up = values[index - side] if row else 0
        residual = value - left - up + (values[index - side - 1] if row and column else 0)
        if residual == 0:
            run += 1
            continue
        end_run()
        run = 0
        _put_varint(out, 2 * residual if residual > 0 else -2 * residual - 1)
    end_run()
    return bytes(out)


def decode_block(data):
    """Shifts, gains and orbits of a land block."""
    shifts, at = decode_plane(data, 0, BLOCK_SIDE)
    gains, at = decode_plane(data, at, BLOCK_SIDE)
    if at == len(data):
        return shifts, gains, [ORBIT_ONE] * NODES
    orbits, at = decode_plane(data, at, BLOCK_SIDE)
    if at != len(data):
        raise PlaneError("bytes are left over")
    if orbits == [ORBIT_ONE] * NODES:
        raise PlaneError("orbits that are all 1 are left out")
    return shifts, gains, orbits


def encode_block(shifts, gains, orbits):
    """The bytes of a land block."""
    planes = [shifts, gains] if all(orbit == ORBIT_ONE for orbit in orbits) else [shifts, gains, orbits]
    return b"".join(encode_plane(plane, BLOCK_SIDE) for plane in planes)


def decode_tile(data):
    """The 65 x 65 counts of a terrain tile."""
    heights, at = decode_plane(data, 0, TILE_SIDE)
    if at != len(data):
        raise PlaneError("bytes are left over")
    return heights
