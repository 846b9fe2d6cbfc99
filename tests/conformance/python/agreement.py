"""Compares this program's own sea with the server's, bit for bit, at points of the sync region."""
import random

from clock import monotonic_us
from sea import AUTHORITATIVE, sample_bytes

POINTS = 24  # a request
AHEAD_US = 1_000_000
PATIENCE_US = 5_000_000  # a reply whose log position the state has not reached waits so long


class Agreement:
    """Asks for samples now and then and compares them."""

    def __init__(self, session, requests_wanted, spacing_us):
        self._session, self._wanted, self._spacing = session, requests_wanted, spacing_us
        self._next = 0
        self._random = random.Random(7)
        self._asked = {}  # sequence: (time, points)
        self._moved = False
        self.compared = self.equal = self.refused = self.requests = 0
        self.difference = ""

    def step(self, now):
        """Asks where nothing is under way, and starts to compare what has come."""
        session = self._session
        while session.replies:
            reply = session.replies.popleft()
            if reply.of.name == "CommandReply":
                self._asked.pop(reply.sequence)
                self.refused += 1
                continue
            session.jobs.append(self._compare(reply, now + PATIENCE_US))
        if not self._asked and self.requests < self._wanted and now >= self._next:
            self._ask(now)

    def is_done(self):
        return self.requests >= self._wanted and not self._asked

    def _ask(self, now):
        session = self._session
        if session.key is None or session.region not in map(tuple, session.key.regions):
            return
        points, in_waves = self._points(*session.region)
        if not in_waves and not self._moved:
            # No wave comes into this region: try one that has waves.
            self._moved = True
            middle = session.state.nearest_waves(*session.region[:2])
            if middle:
                session.ask_region(*middle)
                return
        time = session.clock.sea_time(now) + AHEAD_US
        if session.key.from_us <= time <= session.key.until_us:
            self._asked[session.ask_samples(time, points)] = time, points
            self.requests += 1
            self._next = now + self._spacing

    def _points(self, x, z, radius):
        """Rest points within the disc, most of them where there are waves, and how many of them are. The region has the full
        sea: the train counts of its patches are about what is displayed there."""
        state, reach = self._session.state, int(radius * 0.7)
        waves, calm = [], []
        for _ in range(8 * POINTS):
            point = x + self._random.randint(-reach, reach), z + self._random.randint(-reach, reach)
            patch = state.patch_at(*point)
            (waves if patch and patch.boxes else calm).append(point)
        most = min(POINTS, self._session.hello.limits.sample_points)
        in_waves = min(most - most // 4, len(waves))
        return (waves[:in_waves] + calm)[:most], in_waves

    def _compare(self, reply, until):
        """A job: compares a reply; where it differs, again after the next results. Yields whether there is more to do now."""
        session = self._session
        time, points = self._asked[reply.sequence]
        if reply.time_us != time or len(reply.samples) != len(points):
            self.difference = self.difference or "a SampleReply for another time or other points"
            self.compared += len(points)
            del self._asked[reply.sequence]
            return
        results = None
        while True:
            if session.is_whole() and results != session.results:
                results, position, sea = session.results, session.key.log_position, session.state.sea()
                equal = []
                for (x, z), theirs in zip(points, reply.samples):
                    equal.append(sample_bytes(sea.sample(time, x, z, AUTHORITATIVE)) == sample_bytes(theirs))
                    yield True
                if all(equal) or position == reply.log_position:
                    break
            if results is not None and monotonic_us() > until:
                break
            yield False
        self.compared += len(points)
        self.equal += sum(equal)
        if not all(equal):
            at = equal.index(False)
            self.difference = self.difference or (
                f"time {time} point {points[at]}: log position {reply.log_position} there, {position} here")
        del self._asked[reply.sequence]
