"""A second client of the Trochoid standard, written from its document alone. Exit status: 0 exact, 1 not, 2 usage, 3 refused."""
import argparse
import json
import pathlib
import re
import sys
from typing import NamedTuple

from agreement import Agreement
from clock import monotonic_us
from fbs import Schema
from golden_sea import GoldenSea
from refusal import Refusal
from sea import Sea
from session import Session
from transport import Closed, Connection, open_socket
from writing import Writer

ROOT = pathlib.Path(__file__).resolve().parents[3]
ADDRESS = re.compile(r"(?:(tcp|tls|ws|wss)://)?(\[[0-9a-fA-F:.]+\]|[^:/\[\]]+):(\d+)/?")
PATIENCE_S = 30


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--connect", required=True, metavar="ADDRESS", help="HOST:PORT, tcp://…, tls://…, ws://… or wss://…")
    parser.add_argument("--seconds", type=float, default=5.0, help="how long to stay (5)")
    parser.add_argument("--at", default="0,0", metavar="X,Z", help="where to look, metres (0,0)")
    parser.add_argument("--radius", type=float, default=128.0, help="of the sync region, metres (128)")
    parser.add_argument("--patches", type=int, default=64, metavar="N", help="patch budget of the view (64)")
    parser.add_argument("--requests", type=int, default=3, help="sample requests to compare (3)")
    parser.add_argument("--spacing", type=float, default=0.0, metavar="S", help="seconds between them (0)")
    parser.add_argument("--ca", metavar="FILE", help="certificates to trust with tls:// and wss://, PEM")
    parser.add_argument("--token-file", metavar="FILE", help="a token for servers that ask for one")
    parser.add_argument("--schema", default=ROOT / "protocol/schema", metavar="DIR", help="the standard's .fbs files")
    parser.add_argument("--sea", default=ROOT / "tests/golden/sea.txt", metavar="FILE", help="the reference sea's records")
    parser.add_argument("--resume", action="store_true", help="then cut the connection and go on with what is held")
    parser.add_argument("--json", action="store_true", help="the summary as JSON")
    return parser.parse_args()


def connect(options):
    """A connection as --connect says."""
    match = ADDRESS.fullmatch(options.connect)
    if not match:
        raise ValueError(f"--connect {options.connect}: HOST:PORT is needed, with tcp://, tls://, ws:// or wss:// before it or not")
    scheme, host, port = match[1] or "tcp", match[2].strip("[]"), int(match[3])
    sock = open_socket(host, port, scheme in ("tls", "wss"), options.ca, PATIENCE_S)
    if scheme in ("ws", "wss"):
        from websocket import WebSocket
        return WebSocket(sock, f"{match[2]}:{port}")
    return Connection(sock)


def flush(session, connection):
    while session.outbox:
        connection.send(session.outbox.popleft())


def work(session):
    """A slice of the first job; whether there is more to do now."""
    if not session.jobs:
        return False
    busy = next(session.jobs[0], None)
    if busy is None:
        session.jobs.popleft()
    return busy is not False


def converse(session, connection, agreement, seconds):
    """Until the time is over, the server has said goodbye, or Refusal or Closed."""
    begin = monotonic_us()
    session.say_hello()
    while not session.goodbye:
        now = monotonic_us()
        if session.hello is None and now - begin > PATIENCE_S * 1_000_000:
            raise Closed("no hello came")
        wait = session.tick(now)
        if session.hello:
            agreement.step(now)
            # A slow machine gets more time for what it has to work out.
            late = now - begin > (seconds + PATIENCE_S) * 1_000_000
            if now - begin > seconds * 1_000_000 and (late or session.verdict != "pending" and agreement.is_done()):
                return
        busy = work(session)
        flush(session, connection)
        connection.receive(0 if busy else min(wait / 1e6, 0.05))
        while (payload := connection.next()) is not None:
            session.take(payload)
            if session.hello:
                connection.limit = session.hello.limits.frame_to_client
            flush(session, connection)


class Visit:
    """One session from its connection to its end."""

    def __init__(self, options, tools, past=None):
        x, z = (round(float(number) * 1024) for number in options.at.split(","))
        view = {"x": x, "z": z, "altitude": 10 * 1024, "qw": 1.0, "tan_half_width": 0.8, "tan_half_height": 0.6,
                "accepted_error_px": 1.0, "patch_budget": options.patches, "viewport_width": 640, "viewport_height": 480}
        self.session = Session(tools.schema, tools.writer, tools.sea, view, round(options.radius * 1024), tools.token, past)
        self.agreement = Agreement(self.session, options.requests, round(options.spacing * 1e6))
        self.end, self.status = "", 1
        self._seconds = options.seconds
        self._connection = connect(options)

    def run(self, say_goodbye=True):
        session, connection = self.session, self._connection
        try:
            converse(session, connection, self.agreement, self._seconds)
            if not session.goodbye and say_goodbye:
                session.say_goodbye()
                flush(session, connection)
        except Refusal as refusal:
            self.end, self.status = f"refused: {refusal}", 3
            session.refuse(refusal)
            try:
                flush(session, connection)
            except OSError:
                pass
        except (Closed, OSError) as error:
            self.end = f"connection lost: {error}"
        if session.goodbye:
            goodbye = session.goodbye
            self.end = f"goodbye from the server: {goodbye.code} (R-{goodbye.requirement}) {goodbye.message.decode()}"
        connection.close()

    def summary(self):
        """What is printed."""
        session, agreement, hello, state = self.session, self.agreement, self.session.hello, self.session.state
        exact = not self.end and session.verdict == "exact" and not session.mismatches and session.results > 0
        result = {
            "exact": exact and agreement.equal == agreement.compared > 0, "end": self.end, "verdict": session.verdict,
            "protocol": hello.protocol if hello else 0, "world": hello.world.decode() if hello else "",
            "resumed": bool(hello and hello.resumed), "results": session.results, "snapshots": session.snapshots,
            "hash_mismatches": session.mismatches, "boxes": len(state.boxes), "blocks": len(state.blocks),
            "patches": len(state.patches), "tiles": session.tiles, "state_hash": f"{state.hash():016x}",
            "sample_requests": agreement.requests, "samples_refused": agreement.refused, "samples": agreement.compared,
            "samples_equal": agreement.equal, "difference": agreement.difference}
        if hello:
            best = session.clock.best()
            result.update(clock_delay_us=best.delay, clock_offset_us=best.offset, sea_time_us=session.clock.sea_time(monotonic_us()))
        return result


class Tools(NamedTuple):
    """What all sessions need."""
    schema: Schema
    writer: Writer
    sea: Sea
    token: str


def main():
    options = arguments()
    try:
        token = pathlib.Path(options.token_file).read_text(encoding="utf-8").strip() if options.token_file else ""
        tools = Tools(Schema(options.schema), Writer(options.schema), GoldenSea(options.sea).sea, token)
        visit = Visit(options, tools)
        visit.run(say_goodbye=not options.resume)
        if options.resume and visit.summary()["exact"]:
            # The connection is cut off without a word; what was held counts in the next session.
            visit = Visit(options, tools, visit.session.past())
            visit.run()
        tools.writer.close()
    except (OSError, ValueError, ImportError) as error:
        print(f"trochoid_client.py: {error}", file=sys.stderr)
        return 2
    result = visit.summary()
    if options.json:
        print(json.dumps(result, indent=1))
    else:
        print("\n".join(f"{name:16} {value}" for name, value in result.items()))
    if options.resume and not result["resumed"]:
        return visit.status
    return 0 if result["exact"] else visit.status


if __name__ == "__main__":
    sys.exit(main())
