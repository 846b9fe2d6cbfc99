#!/usr/bin/python3 -B
"""Makes the fuzzers' seeds anew: tests/fuzz/corpus/TARGET.txt, lines "NAME HEX".

usage: seeds.py            write them; inputs that fuzzers have found (names found-…) stay
       seeds.py --check    exit 1 where a file is not what this would write
"""
import pathlib
import re
import struct
import sys
import zlib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
MAGIC = b"TROCHOID"


def golden_messages():
    """(direction, name, bytes) of today's golden messages and of every frozen version's."""
    histories = sorted((ROOT / "protocol/schema/history").glob("v*/messages.txt"))
    for prefix, file in [("", ROOT / "tests/golden/wire_messages.txt"), *((f"{f.parent.name}-", f) for f in histories)]:
        for line in file.read_text().splitlines():
            if not line.startswith("#"):
                direction, name, data = line.split()
                yield direction, prefix + name, bytes.fromhex(data)


def frame(payload):
    return struct.pack("<II", len(payload), 0) + payload


def codec(direction):
    """Each once: most of an older version's bytes are today's."""
    messages = {}
    for where, name, data in golden_messages():
        if where == direction:
            messages.setdefault(data, name)
    return [(name, data) for data, name in messages.items()]


def frames():
    small = frame(b"abc") + frame(b"x" * 40)
    return [("frames", bytes([0xF0, 3]) + small), ("magic", bytes([0xF1, 7]) + MAGIC + small), ("cut", bytes([0xF1, 9]) + MAGIC + small[:-5]),
            ("wrong_magic", b"\xf1\x01TROCHOIS"), ("zero", bytes([0xF0, 1]) + struct.pack("<II", 0, 0)),
            ("not_zero", bytes([0xF0, 1]) + struct.pack("<II", 4, 1)), ("long", bytes([0x00, 1]) + struct.pack("<II", 17, 0))]


def session():
    client = dict(codec("client"))
    order = ["hello", "view", "ack", "start_wind", "start_ship", "steer", "change_land", "skip_time", "probe", "desync"]
    whole = b"".join(frame(client[name]) for name in order)
    return [("admin", b"\x02" + whole), ("director", b"\x01" + whole), ("viewer", b"\x00" + frame(client["hello_again"]) + frame(client["view"]))]


def store():
    server = dict(codec("server"))
    order = ["hello", "delta", "delta_of_laden_boxes", "terrain_tile", "delta", "delta_of_patches"]
    whole = b"".join(frame(server[name]) for name in order)
    return [("fitting", b"\x01" + whole), ("as_sent", b"\x02" + whole), ("one_delta", b"\x03" + frame(server["hello"]) + frame(server["delta"]))]


def planes():
    flat = b"\x00\xe0\x41"  # 8,417 zeros: too many for any plane; a run as such
    return [("run", bytes([0, 8, 8]) + b"\x00\x50"), ("block", bytes([3, 0, 0]) + b"\x00\xa0\x02" + b"\x80\x80\x04\x00\x9f\x02"),
            ("tile", bytes([4, 0, 0]) + b"\x0e\x00\xff\x20"), ("wide", bytes([2, 3, 1]) + b"\xff\xff\xff\xff\x0f" * 2 + flat)]


def fnv(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


def terrain():
    text = b"+proj=tmerc"
    body = (b"TROCHTER" + struct.pack("<I", 1) + struct.pack("<qqIIIiidd", -32768, 32768, 15, 3, 2, 5, -4096, -6.5, 49.9)
            + struct.pack("<H", len(text)) + text + struct.pack("<H", 4) + b"made" + struct.pack("<6h", -9, 0, 5, 100, -100, 7))
    return [("small", body + struct.pack("<Q", fnv(body)))]


def scenes():
    for file in sorted(ROOT.glob("server/scenes/*/*.toml")):
        text = re.sub(r"^terrain\s*=.*\n", "", file.read_text(), flags=re.M)
        if len(text) <= 2000:
            yield f"{file.parent.name}-{file.stem}", text.encode()


def png():
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\x00" + struct.pack(">4H", *(row * 900 + column for column in range(4))) for row in range(3))
    for name, interlace in (("plain", 0), ("adam7", 1)):
        # Adam7 of 4 x 3: passes of 1, 1, 2, 2 and 4 samples.
        data = rows if not interlace else b"".join(b"\x00" + b"\x01\x02" * n for n in (1, 1, 2, 2, 2, 4))
        yield name, (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 3, 16, 0, 0, 0, interlace))
                     + chunk(b"IDAT", zlib.compress(data)) + chunk(b"IEND", b""))


def geotiff():
    columns, rows = 4, 3
    heights = struct.pack(f"<{columns * rows}h", *range(-6, 6))
    keys = (1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326)
    doubles = {33550: (0.5, 0.5, 0.0), 33922: (0.0, 0.0, 0.0, -6.5, 50.0, 0.0)}
    entries = {256: (3, 1, columns), 257: (3, 1, rows), 258: (3, 1, 16), 259: (3, 1, 1), 262: (3, 1, 1), 273: (4, 1, None), 277: (3, 1, 1),
               278: (3, 1, rows), 279: (4, 1, len(heights)), 339: (3, 1, 2), 33550: (12, 3, None), 33922: (12, 6, None), 34735: (3, len(keys), None)}
    behind = 8 + 2 + 12 * len(entries) + 4
    tail, directory = b"", struct.pack("<H", len(entries))
    for tag, (kind, count, value) in sorted(entries.items()):
        if value is None:
            value = behind + len(tail)
            tail += heights if tag == 273 else (struct.pack(f"<{len(keys)}H", *keys) if tag == 34735
                                                else struct.pack(f"<{count}d", *doubles[tag]))
        directory += struct.pack("<HHII", tag, kind, count, value)
    return [("int16", b"II*\x00" + struct.pack("<I", 8) + directory + b"\x00" * 4 + tail)]


def http():
    upgrade = (b"GET / HTTP/1.1\r\nHost: localhost:4000\r\nUpgrade: websocket\r\nConnection: keep-alive, Upgrade\r\nSec-WebSocket-Version: 13\r\n"
               b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: chat, trochoid\r\nOrigin: http://localhost:8080\r\n\r\n")
    return [("upgrade", upgrade), ("livez", b"GET /livez HTTP/1.1\r\nHost: [::1]:4000\r\n\r\n"), ("metrics", b"GET /metrics?x=1 HTTP/1.0\r\n\r\n"),
            ("post", b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 3\r\n\r\nabc"), ("chunked", b"PUT /x HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"),
            ("trace", b"TRACE / HTTP/1.1\r\n\r\n"), ("magic", MAGIC), ("tls", b"\x16\x03\x01\x00\xc8\x01"), ("smuggled", b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n X: y\r\n\r\n")]


def login():
    token = bytes([1, 1]) + bytes(8) + struct.pack("<QQ", 1_800_000_090, 1_800_000_150) + bytes(range(16)) + b"scilly"
    return [("signed", b"\x01" + token), ("other_key", b"\x02" + token), ("ticket", b"\x03" + bytes(range(60)) + bytes(93)),
            ("text", b"\x00trochoid1.AQEAAAAAAAAAAA.AAAA"), ("old", b"\x01" + token.replace(struct.pack("<Q", 1_800_000_150), struct.pack("<Q", 1_800_000_091)))]


TARGETS = {"decode_client": lambda: codec("client"), "decode_server": lambda: codec("server"), "decode_event": lambda: codec("event"),
           "frames": frames, "session": session, "store": store, "planes": planes, "terrain_file": terrain, "scene": scenes, "png": png,
           "geotiff": geotiff, "http": http, "login": login}


def text_of(target):
    kept = HERE / "corpus" / f"{target}.txt"
    found = [line for line in (kept.read_text().splitlines() if kept.exists() else []) if line.startswith("found-")]
    seeds = [f"{name} {data.hex()}" for name, data in TARGETS[target]()]
    return "\n".join([f"# Seeds of the fuzzer {target}: NAME HEX. Made by tests/fuzz/seeds.py; found-… by fuzzers.", *seeds, *found]) + "\n"


def main():
    wrong = 0
    for target in TARGETS:
        file = HERE / "corpus" / f"{target}.txt"
        text = text_of(target)
        if sys.argv[1:] == ["--check"]:
            if not file.exists() or file.read_text() != text:
                print(f"seeds: tests/fuzz/corpus/{target}.txt is not up to date: run tests/fuzz/seeds.py")
                wrong = 1
        else:
            file.parent.mkdir(exist_ok=True)
            file.write_text(text)
    return wrong


if __name__ == "__main__":
    sys.exit(main())
