#!/usr/bin/env python3
"""Draws the synthetic grounds of the scenes: 16-bit PNGs with their sidecars, and the terrains that trochoid-import makes of them.

  server/scenes/grounds/make.py [path of trochoid-import]

Needs nothing but Python. Only exact arithmetic decides a pixel, so the files come out the same everywhere. MIT, our own work.
"""

import math
import os
import struct
import subprocess
import sys
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
SPACING = 16  # m
COUNT = 1 / 32  # m
OFFSET = -64.0  # m of count 0


def beach(x, z):
    """A plane beach: the bed rises by 1 in 50 eastwards, from 36 m deep to dunes of 5 m; straight contours."""
    return min(x / 50 - 15.5, 5)


def island(x, z):
    """A round island of 300 m radius on a shelf: slopes of 1 in 12 down to 30 m, then level."""
    return max(-30.0, min((300 - math.isqrt(x * x + z * z)) / 12, 14))


def harbour(x, z):
    """A straight quay in the north, 8 m deep at its foot, falling 1 in 40 seawards; two moles with a gap of 160 m."""
    bed = max(-32.0, min(-(z + 560) / 40 - 8, -8.0)) if z > -560 else min((-560 - z) / 8 - 8, 10)
    arm = 3.5 if 0 <= z - 240 < 32 and 80 <= abs(x) <= 640 else -99.0
    side = 3.5 if 0 <= abs(x) - 624 < 32 and -640 <= z <= 256 else -99.0
    return max(bed, arm, side)


GROUNDS = {"beach": (beach, 128), "island": (island, 160), "harbour": (harbour, 144)}


def png(rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 16, 0, 0, 0, 0)
    data = b"".join(b"\0" + struct.pack(f">{len(row)}H", *row) for row in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b"")


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else os.path.join(HERE, "../../../build/release/bin/trochoid-import")
    if not os.access(program, os.X_OK):
        print(f"make.py: {program} is missing: build trochoid-import, or give its path", file=sys.stderr)
        return 2
    for name, (ground, cells) in GROUNDS.items():
        half = cells // 2
        rows = [[round((ground((c - half) * SPACING, (r - half) * SPACING) - OFFSET) / COUNT) for c in range(cells + 1)]
                for r in range(cells + 1)]
        with open(os.path.join(HERE, name + ".png"), "wb") as out:
            out.write(png(rows))
        edge = (half + 0.5) * SPACING
        with open(os.path.join(HERE, name + ".toml"), "w") as out:
            out.write(f"# {ground.__doc__}\nheight_scale  = {COUNT}\nheight_offset = {OFFSET}\n"
                      'projection    = "+proj=tmerc +lon_0=0 +lat_0=0 +ellps=WGS84"\n'
                      f"origin        = [{-edge}, {edge}]\npixel_size    = [{SPACING}, {SPACING}]\n"
                      'source        = "Synthetic ground by make.py, MIT."\n')
        subprocess.run([program, "raster", os.path.join(HERE, name + ".png"), "--out", os.path.join(HERE, name + ".terrain"),
                        "--origin=0,0", f"--extent={cells * SPACING},{cells * SPACING}", f"--spacing={SPACING}"],
                       check=True, stdout=subprocess.DEVNULL)
    return 0


if __name__ == "__main__":
    sys.exit(main())
