"""Golden messages (R-119), plane coding both ways, and what the generated code makes of the same bytes."""
import pathlib
import random
import unittest

from checks import check
from fbs import Scalar, Schema, Struct, Table, Union, Vector
from planes import (BLOCK_SIDE, NODES, ORBIT_ONE, TILE_SIDE, PlaneError, decode_block, decode_plane, decode_tile, encode_block,
                    encode_plane)
from patch_planes import Patch, decode_patches
from reading import read
from refusal import Refusal
from writing import Writer, camel

ROOT = pathlib.Path(__file__).resolve().parents[3]
SCHEMA = ROOT / "protocol/schema"
GOLDEN = ROOT / "tests/golden/wire_messages.txt"
IDENTIFIERS = {"client": b"TRCC", "server": b"TRCS", "event": b"TRLE"}


def golden_messages():
    """(direction, name, bytes) of each line."""
    lines = [line.split() for line in GOLDEN.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    return [(direction, name, bytes.fromhex(data)) for direction, name, data in lines]


class WireTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema = Schema(SCHEMA)
        cls.writer = Writer(SCHEMA)

    @classmethod
    def tearDownClass(cls):
        cls.writer.close()

    def read(self, direction, data):
        envelope = read(self.schema, data, IDENTIFIERS[direction])
        check(envelope)
        return envelope

    def test_every_golden_message_is_read(self):
        messages = golden_messages()
        self.assertGreaterEqual(len(messages), 18)
        for direction, name, data in messages:
            with self.subTest(direction=direction, name=name):
                self.assertEqual(self.read(direction, data).size, len(data))

    def test_values_of_golden_messages(self):
        body = {(direction, name): self.read(direction, data).body for direction, name, data in golden_messages()}
        hello = body["server", "hello"]
        self.assertEqual((hello.world.decode(), hello.challenge_seed, hello.terrain.columns), ("fjørd", 2024, 513))
        self.assertEqual(body["client", "start_ship"].action.name.decode(), "MS Måke")
        self.assertEqual(body["server", "goodbye"].message, b"come back in a second")
        self.assertEqual(body["server", "delta"].boxes[1].trains[2].kz, -300007)

    def test_generated_code_reads_the_same(self):
        for direction, name, data in golden_messages():
            with self.subTest(direction=direction, name=name):
                root = f"{direction.capitalize()}Envelope"
                theirs = getattr(self.writer.generated(root), f"{root}T").InitFromBuf(data, int.from_bytes(data[:4], "little"))
                self.compare(self.schema.types[root], self.read(direction, data), theirs)

    def compare(self, kind, ours, theirs):
        """Recursively: a value of this reader and the object that flatc's code made."""
        if ours is None:
            self.assertIsNone(theirs)
        elif isinstance(kind, Table):
            for field in kind.fields:
                self.compare(field.kind, getattr(ours, field.name), getattr(theirs, camel(field.name)))
        elif isinstance(kind, Scalar):
            self.assertEqual(ours, theirs)
        elif isinstance(kind, Union):
            self.assertEqual(ours.of.name + "T", type(theirs).__name__)
            self.compare(ours.of, ours, theirs)
        elif isinstance(kind, Struct):
            for (name, _), own in zip(kind.members, ours):
                outer, _, inner = name.partition("_")  # of a struct within
                nested = not hasattr(theirs, camel(name))
                self.assertEqual(own, getattr(getattr(theirs, outer), inner) if nested else getattr(theirs, camel(name)))
        elif isinstance(kind, Vector) and kind.element is not None:
            self.assertEqual(len(ours), len(theirs))
            for one, other in zip(ours, theirs):
                self.compare(kind.element, one, other)
        else:
            self.assertEqual(ours, theirs)

    def test_any_damaged_byte_is_read_or_refused(self):
        chance = random.Random(1)
        messages = golden_messages()
        outcomes = {True: 0, False: 0}
        for _ in range(4000):
            direction, _, data = chance.choice(messages)
            damaged = bytearray(data)
            damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
            try:
                self.read(direction, bytes(damaged))
                outcomes[True] += 1
            except Refusal:
                outcomes[False] += 1
        self.assertGreater(min(outcomes.values()), 100)

    def test_no_truncated_message_is_read(self):
        for direction, _, data in golden_messages():
            for size in range(0, len(data), 7):
                with self.assertRaises(Refusal):
                    self.read(direction, data[:size])


class PlaneTest(unittest.TestCase):
    def test_golden_planes_both_ways(self):
        schema = Schema(SCHEMA)
        blocks = tiles = 0
        for direction, _, data in golden_messages():
            body = read(schema, data, IDENTIFIERS[direction]).body
            at = 0
            for head in getattr(body, "blocks", None) or ():
                nodes = body.nodes[at:at + head.node_bytes]
                self.assertEqual(encode_block(*decode_block(nodes)), nodes)
                at, blocks = at + head.node_bytes, blocks + 1
            for tile in getattr(body, "tiles", None) or ():
                self.assertEqual(encode_plane(decode_tile(tile.heights), TILE_SIDE), tile.heights)
                tiles += 1
        self.assertGreater(min(blocks, tiles), 0)

    def test_golden_patches(self):
        data = {name: data for _, name, data in golden_messages()}["delta_of_patches"]
        body = read(Schema(SCHEMA), data, IDENTIFIERS["server"]).body
        patches, removed = decode_patches(body.patch_planes, body.box_ids)
        self.assertEqual(list(patches)[:2] + list(patches)[-3:], [(15, -2, -3), (15, -2, -2), (16, 0, 2), (16, 1, -2), (26, -512, 511)])
        self.assertEqual(patches[15, -2, -3].boxes, ((1, 8), (7, 256)))
        self.assertEqual(patches[16, 1, -2], Patch((), 0.125, 0.25))
        self.assertEqual(patches[26, -512, 511].boxes, ((1, 0), (7, 4), (300000, 1)))
        self.assertEqual(removed, [(15, -1, -1), (15, -1, 0), (22, 8191, -8192)])
        for cut in range(len(body.patch_planes)):
            with self.assertRaises(Refusal):
                decode_patches(body.patch_planes[:cut], body.box_ids)
        for planes, ids in ((body.patch_planes + b"\0", body.box_ids), (body.patch_planes, body.box_ids[::-1]),
                            (body.patch_planes, body.box_ids[1:]), (body.patch_planes, [*body.box_ids, 300001])):
            with self.assertRaises(Refusal):
                decode_patches(planes, list(ids))

    def test_random_planes_both_ways(self):
        chance = random.Random(2)
        for spread in (0, 1, 3, 1000, (1 << 23) - 1):
            values = [chance.randint(-spread, spread) for _ in range(NODES)]
            data = encode_plane(values, BLOCK_SIDE)
            self.assertEqual(decode_plane(data, 0, BLOCK_SIDE), (values, len(data)))

    def test_an_even_block_takes_nine_bytes(self):
        even = encode_block([0] * NODES, [32768] * NODES, [ORBIT_ONE] * NODES)
        self.assertEqual(len(even), 9)
        self.assertEqual(len(encode_block([0] * NODES, [32768] * NODES, [20000] * NODES)) - len(even), 6)

    def test_only_the_shortest_form(self):
        plain = encode_plane([5] * NODES, BLOCK_SIDE)
        self.assertEqual(plain, bytes((10, 0, 0x9F, 2)))
        for bad in ((0x8A, 0, 0, 0x9F, 2), (10, 0, 0x8F, 1, 0, 0x8F, 1), (10, 0, 0xA0, 2), (10, 0, 0x9F), (10, 0x80, 0, 0x9F, 2),
                    (0x8A, 0x80, 0x80, 0x80, 0x80, 1, 0, 0x9F, 2)):
            with self.assertRaises(PlaneError):
                decode_plane(bytes(bad), 0, BLOCK_SIDE)
        whole = encode_block([0] * NODES, [32768] * NODES, [ORBIT_ONE] * NODES)
        for more in (b"\x00", encode_plane([ORBIT_ONE] * NODES, BLOCK_SIDE), encode_plane([1] * NODES, BLOCK_SIDE) + b"\x02"):
            with self.assertRaises(PlaneError):
                decode_block(whole + more)


if __name__ == "__main__":
    unittest.main()
