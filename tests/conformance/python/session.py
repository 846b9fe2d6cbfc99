"""A client's session (chapters 6 to 8): what it says, and what it makes of what comes."""
import collections
from typing import NamedTuple

from checks import check
from clock import Clock, monotonic_us
from interest import InterestState
from reading import read
from refusal import Refusal
from sea import known_answer

PROTOCOL_MIN, PROTOCOL_MAX, MODEL = 2, 3, 2
CAPABILITIES = 2  # bit 1: resume
SOFTWARE = "python conformance client"
VERDICTS = ("pending", "exact", "approximate")
MOST_MISMATCHES = 8  # results out of step, one after the other, before this client leaves
WORTH_RETRYING = (111, 114, 401, 402, 407, 408, 411, 701, 702)


class Past(NamedTuple):
    """What a client keeps of a session that was cut off, to go on with."""
    ticket: bytes
    instance: bytes
    key: object  # the wire's CullKey
    state: InterestState
    state_hash: int
    log_position: int
    log_hash: int


class Session:
    """The state of a session; `outbox` holds payloads to be sent, `jobs` work that is done a slice at a time:
    generators that yield whether they have more to do now."""

    def __init__(self, schema, writer, reference_sea, view, region_radius, token="", past=None):
        self.schema, self.writer = schema, writer
        self.outbox, self.jobs = collections.deque(), collections.deque()
        self.hello = self.goodbye = self.key = self.region = None
        self.clock, self.state = Clock(), InterestState()
        self.verdict = "pending"
        self.watermark = self.log_position = None
        self.results = self.snapshots = self.mismatches = self.tiles = 0
        self.replies = collections.deque()  # SampleReply and CommandReply, for who asked
        self._reference_sea, self._view, self._radius, self._token = reference_sea, view, region_radius, token
        self.stamp = 0
        self._offending = 0  # sequence number of the message being taken, 0 where it has none
        self._sequence = 0
        self._requests = {}  # clock requests by sequence: when they were sent
        self._asked = set()  # sequences of other requests
        self._receiving = None  # (result, base) and the next piece
        self._lost = 0  # results out of step one after the other
        self._ignoring = False
        self._applied, self._applied_hash = 0, None
        self._answer = None
        self._past = past
        self._log_hash = 0
        self._acks = []

    # What this client says

    def past(self):
        """What a next session can go on with, or None."""
        if not self.hello or not self.hello.ticket or not self._applied or self.log_position is None:
            return None
        return Past(self.hello.ticket, self.hello.instance, self.key, self.state, self._applied_hash, self.log_position,
                    self._log_hash)

    def is_whole(self):
        """Whether what is held is a whole result, not one of which pieces are missing."""
        return bool(self._applied) and not self._receiving and not self._ignoring

    def say_hello(self):
        self.stamp = monotonic_us()
        fields = {"protocol_min": PROTOCOL_MIN, "protocol_max": PROTOCOL_MAX, "model": MODEL, "software": SOFTWARE, "world": "",
                  "token": self._token, "view": self.writer.make("View", **self._view), "regions": [],
                  "clock_stamp_us": self.stamp, "capabilities": CAPABILITIES}
        past = self._past
        if past:
            fields["ticket"] = list(past.ticket)
            fields["resume"] = self.writer.make(
                "Resume", instance=list(past.instance), key=self.writer.again(past.key), state_hash=past.state_hash,
                log_position=past.log_position, log_hash=past.log_hash)
        self._send("ClientHello", **fields)

    def say_goodbye(self, code=0, message="", requirement=0):
        self._send("Goodbye", code=code, message=message[:250], retry=code in WORTH_RETRYING, requirement=requirement,
                   offending_sequence=self._offending)

    def refuse(self, refusal):
        self.say_goodbye(self.schema.codes()[refusal.code], refusal.message, refusal.requirement)

    def ask_samples(self, time, points):
        """Sends a SampleRequest; gives its sequence number."""
        points = [self.writer.make("Point", x=x, z=z) for x, z in points]
        sequence = self._count()
        self._asked.add(sequence)
        self._send("SampleRequest", sequence=sequence, time_us=time, points=points)
        return sequence

    def ask_region(self, x, z):
        """Asks for the full sea around a place; self.region is the disc, or None where the server grants none."""
        limits = self.hello.limits
        if limits.sync_regions and limits.sync_radius:
            self.region = x, z, min(self._radius, limits.sync_radius)
            region = self.writer.make("Region", x=x, z=z, radius=self.region[2])
            self._send("SyncRegions", sequence=self._count(), regions=[region])

    def tick(self, now):
        """Sends what is due; gives microseconds to the next time."""
        if self.clock.due(now):
            sequence = self._count()
            self._requests[sequence] = now
            self._send("ClockRequest", sequence=sequence, client_sent_us=now)
        return self.clock.wait(now) if self.hello else 1_000_000

    def _count(self):
        self._sequence += 1
        return self._sequence

    def _send(self, name, **fields):
        self.outbox.append(self.writer.message(name, **fields))

    # What comes

    def take(self, payload):
        """A message from the server; Refusal where the standard says so."""
        now = monotonic_us()
        if self.goodbye:
            raise Refusal("unexpected_message", 121, "a message after the Goodbye")
        envelope = read(self.schema, payload, b"TRCS")
        self._offending = getattr(envelope.body, "sequence", 0)
        check(envelope)
        body = envelope.body
        name = body.of.name
        if (self.hello is None) != (name == "ServerHello") and name != "Goodbye":
            raise Refusal("unexpected_message", 121, f"{name} {'before' if self.hello is None else 'after'} the hello")
        handler = getattr(self, f"_take_{name}", self._take_answer)
        handler(body, now)
        self._offending = 0

    def _take_ServerHello(self, hello, now):
        if not PROTOCOL_MIN <= hello.protocol <= PROTOCOL_MAX:
            raise Refusal("protocol_version", 123, f"protocol {hello.protocol} was not offered")
        if hello.model != MODEL:
            raise Refusal("model_version", 141, f"the server computes model {hello.model}, this client {MODEL}")
        if hello.client_stamp_us != self.stamp:
            raise Refusal("value_out_of_range", 142, "the hello does not echo the client's stamp")
        if hello.resumed:
            self._go_on(hello)
        self.hello = hello
        self.clock.start(hello, now)
        self.jobs.append(self._work_out_answer())
        self.ask_region(self._view["x"], self._view["z"])

    def _go_on(self, hello):
        """What is held counts as result 1."""
        past = self._past
        if not past or hello.instance != past.instance:
            raise Refusal("unexpected_message", 129, "resumed, but nothing of this instance is held")
        self.state, self.key = past.state, past.key
        self.results = self._applied = 1
        self._applied_hash = past.state_hash

    def _work_out_answer(self):
        for answer in known_answer(self._reference_sea, self.hello.challenge_seed, self.hello.challenge_count):
            self._answer = answer
            yield True
        self._send_acks()

    def _take_Goodbye(self, goodbye, _):
        self.goodbye = goodbye

    def _take_ClockReply(self, reply, now):
        if self._requests.pop(reply.sequence, None) != reply.client_sent_us:
            raise Refusal("unexpected_message", 142, f"ClockReply {reply.sequence} answers nothing")
        self.clock.follow(reply.clock)
        self.clock.add(reply.client_sent_us, reply.server_received_us, reply.server_sent_us, now)
        if self.watermark is not None and reply.watermark_us < self.watermark:
            raise Refusal("value_out_of_range", 144, "the watermark has fallen")
        self.watermark, self.log_position, self._log_hash = reply.watermark_us, reply.log_position, reply.log_hash
        self.verdict = VERDICTS[reply.verdict]

    def _take_TerrainTiles(self, tiles, _):
        grid = self.hello.terrain
        if grid.columns == 0:
            raise Refusal("unexpected_message", 121, "a tile where there is no terrain")
        for tile in tiles.tiles:
            side = 64 << tile.level + grid.spacing_log2
            place = grid.origin_x + tile.x * side, grid.origin_z + tile.z * side
            if (tile.origin_x, tile.origin_z) != place or tile.spacing_log2 != grid.spacing_log2 + tile.level:
                raise Refusal("value_out_of_range", 136, "a tile that is not of the grid")
            self.tiles += 1

    def _take_answer(self, reply, _):
        if reply.sequence not in self._asked:
            raise Refusal("unexpected_message", 125, f"{reply.of.name} {reply.sequence} answers nothing")
        self._asked.remove(reply.sequence)
        self.replies.append(reply)

    # Results

    def _take_Delta(self, delta, _):
        self._check_order(delta)
        if delta.piece == 0:
            self._begin_result(delta)
        if not self._ignoring:
            self.state.apply(delta)
        self._receiving = None if delta.last else (delta.result, delta.base, delta.base_hash, delta.piece + 1)
        if delta.last:
            self._end_result(delta)

    def _check_order(self, delta):
        if self._receiving:
            expected = self._receiving
        else:
            expected = (self.results + 1, delta.base, delta.base_hash, 0)
        if (delta.result, delta.piece) != (expected[0], expected[3]):
            raise Refusal("sequence_not_monotone", 134, f"result {delta.result} piece {delta.piece} instead of {expected[0]}, "
                          f"{expected[3]}")
        if (delta.base, delta.base_hash) != expected[1:3]:
            raise Refusal("sequence_not_monotone", 134, f"pieces of result {delta.result} name different bases")

    def _begin_result(self, delta):
        if delta.base == 0:
            self.state.clear()
            self.snapshots += 1
            self._ignoring = False
        elif not self._ignoring and (delta.base, delta.base_hash) != (self._applied, self._applied_hash):
            self._ignoring = True

    def _end_result(self, delta):
        self.results = delta.result
        if not self._ignoring:
            self.state.check_whole()
            self._applied, self._applied_hash, self.key = delta.result, self.state.hash(), delta.key
        if self._ignoring or self._applied_hash != delta.state_hash:
            self.mismatches += 1
            self._lost += 1
            self._ignoring = True
            if self._lost >= MOST_MISMATCHES:
                raise Refusal("base_mismatch", 133, f"{self._lost} results one after the other are out of step")
        else:
            self._lost = 0
        self._acks.append((delta.result, self._applied_hash or 0))
        self._send_acks()

    def _send_acks(self):
        """Acknowledges what is due; the first one waits for the known answer."""
        if self._answer is None:
            return
        for result, state_hash in self._acks:
            first = self._answer is not False
            self._send("Ack", result=result, state_hash=state_hash, patches_per_second=0, has_known_answer=first,
                       known_answer=self._answer if first else 0)
            self._answer = False
        self._acks.clear()
