"""Sea time and the clock exchange (chapter 7)."""
import collections
import time

RECENT = 16  # exchanges among which the one with the least delay counts
FIRST_REQUESTS, FIRST_SPACING_US, SPACING_US = 8, 50_000, 2_000_000


def monotonic_us():
    return time.monotonic_ns() // 1000


class Clock:
    """The server's clock as this client knows it."""

    def __init__(self):
        self.sea = None  # the wire's Clock
        self._exchanges = collections.deque(maxlen=RECENT)  # (delay, offset), microseconds
        self._asked = 0
        self._next = 0

    def start(self, hello, now):
        """The hello is a first exchange."""
        self.sea = hello.clock
        self.add(hello.client_stamp_us, hello.server_now_us, hello.server_now_us, now)
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

    def add(self, t0, t1, t2, t3):
        self._exchanges.append(((t3 - t0) - (t2 - t1), ((t1 - t0) + (t2 - t3)) // 2))

    def best(self):
        """(delay, offset server - client) of the exchange that counts."""
        return min(self._exchanges)

    def sea_time(self, now):
        """Sea time at a monotonic time of this client."""
        e = now + self.best()[1] - self.sea.monotonic_start_us
        rate = self.sea.rate_q16
        return self.sea.start_us + (e >> 16) * rate + (((e & 0xFFFF) * rate) >> 16)
