"""Reads the PNG pictures that the viewer writes: 8 bits a channel, RGB or RGBA, not interlaced. Standard library only."""
import pathlib
import struct
import zlib


class Picture:
    """width, height, and rows of bytes: three (red, green, blue) a pixel."""

    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        assert data[:8] == b"\x89PNG\r\n\x1a\n", f"{path} is no PNG"
        at, packed = 8, b""
        while at < len(data):
            length, kind = struct.unpack(">I4s", data[at:at + 8])
            body = data[at + 8:at + 8 + length]
            assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0], f"{path} is damaged"
            if kind == b"IHDR":
                self.width, self.height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
                assert depth == 8 and colour in (2, 6) and not interlaced, f"{path}: depth {depth}, colour type {colour}"
            if kind == b"IDAT":
                packed += body
            at += 12 + length
        self._channels = 3 if colour == 2 else 4
        self.rows = self._unfilter(zlib.decompress(packed))

    def _unfilter(self, raw):
        n, stride = self._channels, self.width * self._channels
        assert len(raw) == (stride + 1) * self.height
        above, rows = bytearray(stride), []
        for y in range(self.height):
            kind = raw[y * (stride + 1)]
            row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
            for i in range(stride):
                left = row[i - n] if i >= n else 0
                up = above[i]
                if kind == 1:
                    row[i] = (row[i] + left) & 255
                elif kind == 2:
                    row[i] = (row[i] + up) & 255
                elif kind == 3:
                    row[i] = (row[i] + (left + up) // 2) & 255
                elif kind == 4:
                    corner = above[i - n] if i >= n else 0
                    p = left + up - corner
                    a, b, c = abs(p - left), abs(p - up), abs(p - corner)
                    row[i] = (row[i] + (left if a <= b and a <= c else up if b <= c else corner)) & 255
            above = row
            rows.append(bytes(row) if n == 3 else bytes(v for i, v in enumerate(row) if i % 4 != 3))
        return rows

    def pixel(self, x, y):
        return tuple(self.rows[y][3 * x:3 * x + 3])

    def pixels(self, top, bottom, left=0.0, right=1.0):
        """((x, y), (r, g, b)) of a part given in shares of height and width."""
        for y in range(int(top * self.height), int(bottom * self.height)):
            for x in range(int(left * self.width), int(right * self.width)):
                yield (x, y), self.pixel(x, y)

    def mean(self, *part):
        total, count = [0, 0, 0], 0
        for _, rgb in self.pixels(*part):
            total = [t + v for t, v in zip(total, rgb)]
            count += 1
        return tuple(t / count for t in total)
