"""What this client refuses of a server that breaks the standard, with which code; and what it forgives."""
import math
import pathlib
import unittest

from fbs import Schema
from golden_sea import GoldenSea
from interest import InterestState
from reading import read
from refusal import Refusal
from session import MOST_MISMATCHES, Session
from wire_test import SCHEMA, golden_messages
from writing import Writer

VIEW = {"x": 0, "z": 0, "altitude": 1024, "qw": 1.0, "tan_half_width": 1.0, "tan_half_height": 1.0, "accepted_error_px": 1.0,
        "patch_budget": 16, "viewport_width": 64, "viewport_height": 64}
SEA = pathlib.Path(__file__).resolve().parents[2] / "golden/sea.txt"


class SessionTest(unittest.TestCase):
    """A session without a connection; the server's messages are golden ones, changed."""

    @classmethod
    def setUpClass(cls):
        cls.schema, cls.writer, cls.sea = Schema(SCHEMA), Writer(SCHEMA), GoldenSea(SEA).sea
        cls.golden = {name: data for direction, name, data in golden_messages() if direction == "server"}

    @classmethod
    def tearDownClass(cls):
        cls.writer.close()

    def setUp(self):
        self.session = Session(self.schema, self.writer, self.sea, VIEW, 1024)
        self.session.say_hello()

    def body(self, name):
        """A golden message as the generated code's object."""
        data = self.golden[name]
        module = self.writer.generated("ServerEnvelope")
        return module.ServerEnvelopeT.InitFromBuf(data, int.from_bytes(data[:4], "little")).body

    def hello(self, **changes):
        hello = self.body("hello")
        hello.clientStampUs = self.session.stamp
        return self.changed(hello, changes)

    @staticmethod
    def changed(body, changes):
        """a__b = value sets body.a.b."""
        for path, value in changes.items():
            *outer, last = path.split("__")
            target = body
            for part in outer:
                target = getattr(target, part)
            if not hasattr(target, last):
                raise AttributeError(path)
            setattr(target, last, value)
        return body

    def delta(self, result, base=0, state_hash=None, **changes):
        """The golden delta as a result of one piece; state_hash None: the right one of a snapshot."""
        body = self.changed(self.body("delta"), {"result": result, "base": base, "piece": 0, "baseHash": 0, "removedBoxes": None,
                                                 "removedBlocks": None, "removedPatches": None, **changes})
        if state_hash is None:
            state = InterestState()
            state.apply(read(self.schema, self.writer.envelope(body, "Server"), b"TRCS").body)
            state_hash = state.hash()
        body.stateHash = state_hash
        return body

    def take(self, body):
        self.session.take(self.writer.envelope(body, "Server"))

    def log_in(self):
        self.take(self.hello())
        while self.session.jobs:
            try:
                next(self.session.jobs[0])
            except StopIteration:
                self.session.jobs.popleft()

    def acks(self):
        """What has been acknowledged since: (result, hash, whether the known answer came with it)."""
        bodies = [read(self.schema, payload, b"TRCC").body for payload in self.session.outbox]
        self.session.outbox.clear()
        return [(body.result, body.state_hash, bool(body.has_known_answer)) for body in bodies if body.of.name == "Ack"]

    def assert_refused(self, code, requirement, body):
        payload = body if isinstance(body, bytes) else self.writer.envelope(body, "Server")
        with self.assertRaises(Refusal) as caught:
            self.session.take(payload)
        self.assertEqual((caught.exception.code, caught.exception.requirement), (code, requirement), caught.exception)


class OrderOfChecksTest(SessionTest):
    def test_layout(self):
        good = self.writer.envelope(self.hello(), "Server")
        self.assert_refused("verification_failed", 111, good[:7])
        self.assert_refused("unknown_message", 111, good[:4] + b"TRCC" + good[8:])
        self.assert_refused("verification_failed", 112, good[:40])
        self.assert_refused("verification_failed", 112, b"\xff\xff\xff\x7f" + good[4:])
        self.assert_refused("trailing_bytes", 113, good + bytes(8))

    def test_unknown_tag_comes_after_size(self):
        envelope = self.writer.make("ServerEnvelope", body_type=200, body=self.hello(), size=1)
        data = self.writer.pack(envelope, b"TRCS")
        self.assert_refused("trailing_bytes", 113, data)
        envelope.size = len(data)
        self.assert_refused("unknown_message", 114, self.writer.pack(envelope, b"TRCS"))

    def test_fields_of_the_hello(self):
        for code, requirement, changes in (
                ("missing_field", 115, {"software": None}), ("missing_field", 115, {"clock": None}),
                ("missing_field", 115, {"instance": None}), ("missing_field", 115, {"limits": None}),
                ("not_finite", 116, {"originLon": math.nan}), ("value_out_of_range", 117, {"clock__epoch": 0}),
                ("value_out_of_range", 117, {"clock__rateQ16": (16 << 16) + 1}), ("value_out_of_range", 117, {"role": 77}),
                ("value_out_of_range", 117, {"world": "a\nb"}), ("value_out_of_range", 117, {"world": b"\xc3("}),
                ("value_out_of_range", 117, {"world": "w" * 257}), ("value_out_of_range", 117, {"instance": [0] * 15}),
                ("value_out_of_range", 117, {"challengeCount": 65537}), ("value_out_of_range", 117, {"lastCode": 801}),
                ("value_out_of_range", 117, {"limits__frameToClient": 1023}), ("protocol_version", 123, {"protocol": 4}),
                ("model_version", 141, {"model": 3})):
            with self.subTest(changes=changes):
                self.assert_refused(code, requirement, self.hello(**changes))

    def test_codes_are_taken_for_their_class(self):
        self.take(self.hello(lastCode=499))
        self.assertEqual(self.session.hello.last_code, 499)

    def test_fields_of_a_delta(self):
        self.log_in()
        train = self.body("delta").boxes[0].trains[0]
        leg = self.body("delta_of_laden_boxes").boxes[0].course[0]
        for code, requirement, changes in (
                ("not_a_unit_quaternion", 118, {"key__anchor__qw": 0.9}), ("not_finite", 116, {"key__slackTangent": math.inf}),
                ("missing_field", 115, {"key": None}), ("missing_field", 115, {"key__regions": None}),
                ("too_many_regions", 117, {"key__regions": self.body("delta").key.regions * 33}),
                ("value_out_of_range", 117, {"base": 1}), ("value_out_of_range", 117, {"nodes": []}),
                ("value_out_of_range", 117, {"boxIds": []}), ("value_out_of_range", 117, {"key__fromUs": 1 << 60})):
            with self.subTest(changes=changes):
                self.assert_refused(code, requirement, self.delta(1, **{"state_hash": 1, **changes}))
        for code, change in (
                ("too_many_trains", lambda box: setattr(box, "trains", [train] * 257)),
                ("too_many_legs", lambda box: setattr(box, "course", [leg] * 65)),
                ("value_out_of_range", lambda box: setattr(box.head, "id", 4000)),
                ("value_out_of_range", lambda box: setattr(box.head, "ux", 1 << 29)),
                ("value_out_of_range", lambda box: setattr(box.trains[0], "amplitude", 33.0)),
                ("value_out_of_range", lambda box: setattr(box.trains[0], "kz", -(1 << 31)))):
            delta = self.delta(1, state_hash=1)
            change(delta.boxes[0])
            self.assert_refused(code, 117, delta)


class SessionOrderTest(SessionTest):
    def test_hello_comes_first_and_once(self):
        self.assert_refused("unexpected_message", 121, self.body("samples"))
        self.take(self.hello())
        self.assert_refused("unexpected_message", 121, self.hello())

    def test_goodbye_may_be_the_answer_and_is_the_last(self):
        self.take(self.body("goodbye"))
        self.assertEqual(self.session.goodbye.message, b"come back in a second")
        self.assert_refused("unexpected_message", 121, self.body("goodbye"))

    def test_answers_to_nothing(self):
        self.log_in()
        self.assert_refused("unexpected_message", 125, self.body("samples"))
        self.assert_refused("unexpected_message", 142, self.clock_reply(77, 0, 0))

    def clock_reply(self, sequence, sent, watermark):
        return self.writer.make("ClockReply", sequence=sequence, client_sent_us=sent, server_received_us=5, server_sent_us=6,
                                clock=self.body("hello").clock, watermark_us=watermark, log_position=3)

    def test_the_watermark_never_falls(self):
        self.log_in()
        now = 1 << 50
        for watermark in (10, 10, 11):
            self.session.outbox.clear()
            now += 2_000_000
            self.session.tick(now)
            request = read(self.schema, self.session.outbox.pop(), b"TRCC").body
            self.take(self.clock_reply(request.sequence, request.client_sent_us, watermark))
        self.session.tick(now + 2_000_000)
        request = read(self.schema, self.session.outbox.pop(), b"TRCC").body
        self.assert_refused("value_out_of_range", 144, self.clock_reply(request.sequence, request.client_sent_us, 10))

    def test_tiles_fit_the_grid(self):
        self.log_in()
        self.take(self.body("terrain_tile"))
        self.assertEqual(self.session.tiles, 1)
        tile = self.body("terrain_tile")
        tile.tiles[0].originX += 1
        self.assert_refused("value_out_of_range", 136, tile)


class ResultsTest(SessionTest):
    def setUp(self):
        super().setUp()
        self.log_in()
        self.acks()

    def test_a_snapshot_and_its_acknowledgement(self):
        snapshot = self.delta(1)
        self.take(snapshot)
        self.assertEqual(self.acks(), [(1, snapshot.stateHash, True)])
        self.take(self.delta(2))
        self.assertEqual([(result, known) for result, _, known in self.acks()], [(2, False)])
        self.assertEqual(self.session.mismatches, 0)

    def test_order_of_results_and_pieces(self):
        self.assert_refused("sequence_not_monotone", 134, self.delta(2, state_hash=1))
        self.assert_refused("sequence_not_monotone", 134, self.delta(1, state_hash=1, piece=1))
        self.take(self.delta(1, state_hash=1, last=False))
        self.assert_refused("sequence_not_monotone", 134, self.delta(2, state_hash=1))
        self.assert_refused("sequence_not_monotone", 134, self.delta(1, state_hash=1, piece=2))
        self.assert_refused("sequence_not_monotone", 134, self.delta(1, state_hash=1, piece=1, baseHash=5))

    def test_a_wrong_hash_is_acknowledged_as_it_is_and_a_snapshot_awaited(self):
        right = self.delta(1).stateHash
        self.take(self.delta(1, state_hash=right ^ 1))
        self.assertEqual(self.acks(), [(1, right, True)])
        self.take(self.delta(2, base=1, state_hash=7, baseHash=right ^ 1))
        self.assertEqual(self.acks(), [(2, right, False)])
        self.take(self.delta(3))
        self.assertEqual(self.acks(), [(3, right, False)])
        self.assertEqual(self.session.mismatches, 2)
        self.take(self.delta(4, base=3, baseHash=right))
        self.assertEqual((self.session.mismatches, self.acks()), (2, [(4, right, False)]))

    def test_a_server_that_never_comes_into_step(self):
        for result in range(1, MOST_MISMATCHES):
            self.take(self.delta(result, state_hash=1))
        self.assert_refused("base_mismatch", 133, self.delta(MOST_MISMATCHES, state_hash=1))

    def test_patches_name_what_is_held(self):
        self.assert_refused("value_out_of_range", 117, self.delta(1, state_hash=1, boxes=None))


if __name__ == "__main__":
    unittest.main()
