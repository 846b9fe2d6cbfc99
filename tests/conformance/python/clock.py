"""Sea time and the clock exchange (chapter 7)."""
import collections
import time
from typing import NamedTuple

RECENT = 8  # exchanges among which the one with the least bound counts
DRIFT = 10_000  # two clocks drift apart by at most a part in so many
SLEW = 64  # shown time runs at most a part in so many faster or slower
LONGEST_LAG_US = 1_000_000  # farther behind than this, shown time jumps
FIRST_REQUESTS, FIRST_SPACING_US, SPACING_US = 8, 50_000, 2_000_000


def monotonic_us():
    return time.monotonic_ns() // 1000


def sea_time_at(sea, monotonic):
    """Sea time at a monotonic time of the server."""
    e = monotonic - sea.monotonic_start_us
    return sea.start_us + (e >> 16) * sea.rate_q16 + (((e & 0xFFFF) * sea.rate_q16) >> 16)


def _half(value):
    return value // 2 if value >= 0 else -(-value // 2)  # truncated


class Exchange(NamedTuple):
    """What four stamps say."""
    delay: int
    offset: int  # server - client
    at: int  # the client's clock at its end

    def bound(self, now):
        """How far the offset may be off at a time of the client."""
        return self.delay // 2 + 1 + max(now - self.at, 0) // DRIFT


class Clock:
    """The server's clock as this client knows it, all in microseconds."""

    def __init__(self):
        self.sea = None  # the wire's Clock
        self._exchanges = collections.deque(maxlen=RECENT)
        self._best = None
        self._shown = None  # (offset in use, when it was looked at last)
        self._asked = 0
        self._next = 0

    def start(self, hello, now):
        """The hello is a first exchange."""
        self.sea = hello.clock
        self.begin(hello.client_stamp_us, hello.server_now_us, now)
        self._next = now

    def due(self, now):
        """Whether a request is to be sent now; counts it."""
        if self.sea is None or now < self._next:
            return False
        self._asked += 1
        self._next = now + (FIRST_SPACING_US if self._asked < FIRST_REQUESTS else SPACING_US)
        return True

    def wait(self, now):
        """Microseconds to the next request."""
        return max(self._next - now, 0)

    def begin(self, t0, t1, t3):
        """A hello's stamps: what came before counts no more."""
        self._exchanges.clear()
        self.add(t0, t1, t1, t3)

    def follow(self, sea):
        """The server's clock as a reply tells it: a new epoch is shown at once."""
        if self.sea is not None and sea.epoch != self.sea.epoch:
            self._shown = None
        self.sea = sea

    def add(self, t0, t1, t2, t3):
        self._exchanges.append(Exchange(max((t3 - t0) - (t2 - t1), 0), _half((t1 - t0) + (t2 - t3)), t3))
        self._best = min(self._exchanges, key=lambda exchange: exchange.bound(t3))

    def best(self):
        """The exchange that counts."""
        return self._best

    def sea_time(self, now):
        """Shown sea time at a monotonic time of this client; asked with ascending times."""
        offset = self._best.offset
        if self._shown is None or offset - self._shown[0] > LONGEST_LAG_US:
            self._shown = offset, now
        used, looked = self._shown
        most = max(now - looked, 0) // SLEW
        used += min(max(offset - used, -most), most)
        self._shown = used, now if most > 0 or used == offset else looked
        return sea_time_at(self.sea, now + used)

    def error_bound(self, now):
        """How far sea_time may be off, in real time."""
        return self._best.bound(now) + (abs(self._best.offset - self._shown[0]) if self._shown else 0)
