"""What this program computes for the golden lines of the sea (tests/golden/sea.txt, edges.txt and fields.txt): the stranger to
`trochoid-conformance check-vectors`.

    trochoid-conformance vectors --questions | python3 golden_check.py | trochoid-conformance check-vectors -"""
import pathlib
import sys
from typing import NamedTuple

from binary32 import bits
from clock import Clock, sea_time_at
from golden_sea import GoldenSea, train_of
from sea import known_answer
from sea_features import MASK, land_in_block, sine_cosine
from sea_records import train_constants
from sea_wake import ROOT, SYSTEMS

SCHEMA = pathlib.Path(__file__).resolve().parents[3] / "protocol/schema"
IDENTIFIERS = {"client": b"TRCC", "server": b"TRCS", "event": b"TRLE"}
# Words of a line that are the question; the rest is the answer.
ARGUMENTS = {"sincos": 1, "wakenode": 2, "wakeroot": 1, "constants": 7, "phase": 7, "land": 4, "sample": 3, "layers": 4, "water": 3,
             "hash": 2}


def floats(values):
    return [f"{bits(value):08x}" for value in values]


def _land(golden, field, base, x, z):
    lands = golden.sea.lands
    land = lands.at(field, {field: base}, x, z)
    return [str(land.shift), *floats((land.shift_dx, land.shift_dz)), str(land.gain), *floats((land.gain_dx, land.gain_dz)),
            *floats((land.orbit, land.orbit_dx, land.orbit_dz))]


def _constants(train):
    c = train_constants(train)
    return [*floats((c.k_x, c.k_z, c.h_x, c.h_z, c.wavelength, c.angular)), str(c.whole)]


def _phase(kx, kz, omega, phase, time, x, z):
    turned = (omega * time & (1 << 64) - 1) >> 32
    return [str(kx * x + kz * z + phase - turned & MASK)]


def answer(golden, kind, words):
    """The words that belong behind a question."""
    if kind == "constants":
        return _constants(train_of(words))
    numbers = [int(word) for word in words[:ARGUMENTS[kind]]]
    if kind == "sincos":
        return floats(sine_cosine(*numbers))
    if kind == "wakenode":
        return list(map(str, SYSTEMS[numbers[0]][numbers[1]]))
    if kind == "wakeroot":
        return [str(ROOT[numbers[0]])]
    if kind == "phase":
        return _phase(*numbers)
    if kind == "land":
        return _land(golden, *numbers)
    if kind == "sample":
        return floats(golden.sea.sample(*numbers))
    if kind == "layers":
        return floats(golden.sea.sample(*numbers[1:], numbers[0]))
    if kind == "water":
        water, rest = golden.sea.water(*numbers)
        return floats(water) + list(map(str, rest))
    if kind == "hash":
        *_, known = known_answer(golden.sea, *numbers)
        return [f"{known:016x}"]
    raise ValueError(f"a line of unknown kind '{kind}'")


class SeaClock(NamedTuple):
    """The server's clock as the wire tells it."""
    epoch: int
    start_us: int
    monotonic_start_us: int
    rate_q16: int


class ClockReader:
    """The lines of wire_clock.txt, in their order."""

    def __init__(self):
        self.clock, self.sea = Clock(), None

    def answer(self, kind, words):
        """The words that belong behind a question; nothing for records."""
        numbers = [int(word) for word in words]
        if kind == "client":
            self.clock = Clock()
        elif kind == "clock":
            self.sea = SeaClock(*numbers)
        elif kind == "seatime":
            return [str(sea_time_at(self.sea, numbers[0]))]
        elif kind == "reading":
            return [str(self.clock.sea_time(numbers[0])), str(self.clock.error_bound(numbers[0]))]
        else:
            self.clock.follow(self.sea)
            (self.clock.begin if kind == "hello" else self.clock.add)(*numbers)
            return [str(self.clock.best().offset), str(self.clock.best().delay)]
        return None


CLOCK_ARGUMENTS = {"seatime": 1, "hello": 3, "exchange": 4, "reading": 1}


def clock_answers(lines):
    """Each question of a clock's lines with its answer, as text."""
    reader = ClockReader()
    for line in lines:
        kind, *words = line.split()
        answered = reader.answer(kind, words[:CLOCK_ARGUMENTS.get(kind, len(words))])
        if answered is not None:
            yield " ".join([kind, *words[:CLOCK_ARGUMENTS[kind]], *answered])


def sea_answers(lines):
    """The same of a sea's or of land fields' lines."""
    golden = GoldenSea(lines=lines)
    for kind, all_words in golden.lines.items():
        for words in all_words:
            question = words[:ARGUMENTS[kind]]
            yield " ".join([kind, *question, *answer(golden, kind, question)])


def encoding_answers(lines):
    """Each message read and written again."""
    # What messages alone need: the generated code, and python3-flatbuffers.
    from checks import check
    from fbs import Schema
    from reading import read
    from writing import Writer
    writer, schema = Writer(SCHEMA), Schema(SCHEMA)
    try:
        for line in lines:
            direction, name, data = line.split()
            envelope = read(schema, bytes.fromhex(data), IDENTIFIERS[direction])
            check(envelope)
            again = writer.again(envelope)
            again.size = len(writer.pack(again, IDENTIFIERS[direction]))
            yield f"{direction} {name} {writer.pack(again, IDENTIFIERS[direction]).hex()}"
    finally:
        writer.close()


def main():
    """Answers the questions on standard input; `vectors NAME` begins each set."""
    sets = []
    for line in sys.stdin:
        if line.startswith("vectors "):
            sets.append((line.split()[1], []))
        elif line.strip() and line[0] != "#":
            sets[-1][1].append(line)
    for name, lines in sets:
        print("vectors", name)
        answers = {"messages": encoding_answers, "clock": clock_answers}.get(name, sea_answers)
        for text in answers(lines):
            print(text, flush=True)


if __name__ == "__main__":
    main()
