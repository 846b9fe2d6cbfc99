"""Winds, ships and land change while the sea runs: two clients and the server agree to the bit before, during and after."""
import math
import signal
import struct
import unittest

from sea_programs import ProgramTest, Server, scene

SCENE = "plane-beach"  # a swell towards north-east; the bed rises eastwards, dry from x = 775 m on
RATE = 2  # sea seconds a second: little goes by while a busy machine works
FOLLOWED_S = 30  # of sea, 15 s of our time
AHEAD_S = 160  # of sea
FLOATS = 15
HEIGHT = 1  # its place among them
FAR = (-700, -500)  # to windward of all that happens
# Each client's own region, and the far one of both.
REGIONS = ((200, 0, 330), (420, 60, 330))
SHARED = [(x, z) for x in range(180, 441, 65) for z in range(-160, 241, 80)] + [FAR]
LEE = [(x, z) for x in (355, 385, 415) for z in (-60, -20, 100)]
MOLE = ("--point", "300,-180", "--point", "320,40", "--point", "300,240")
GAP = ("--point", "240,30", "--point", "400,30")
BEHIND_THE_GAP = [(x, z) for x in (350, 370) for z in (10, 30)]
WIND = ("start-wind", "--speed", 12, "--towards", 80, "--origin", "-200,120", "--fetch-km", 0.7, "--width-km", 0.6, "--seed", 9,
        "--trains", 24, "--directions", 4, "--spectrum", "jonswap", "--spreading", "hasselmann", "--reference-depth", 20,
        "--round", 0.4, "--irregular", 0.5, "--noise", 0.02, "--move-towards", 110, "--move-speed", 2)
SHIP = ("start-ship", "--from", "130,-330", "--towards", 180, "--speed", 10, "--length", 100, "--name", "pilot boat")
PASSED = (150, -80)  # 250 m on along the course, 20 m beside it


def words_of(places):
    return [word for x, z in places for word in ("--point", f"{x},{z}")]


def parse(text):
    """{(seconds, x, z): bits}"""
    water = {}
    for line in text.splitlines():
        time, x, z, *bits = line.split()
        assert len(bits) == FLOATS, line
        water[int(time) / 1e6, int(x) / 1024, int(z) / 1024] = tuple(bits)
    return water


def height(bits):
    return struct.unpack(">f", bytes.fromhex(bits[HEIGHT]))[0]


def spread(water, places, begin, end):
    """Standard deviation of the heights, a quarter of the significant height."""
    heights = [height(bits) for (t, x, z), bits in water.items() if (x, z) in places and begin <= t <= end]
    assert len(heights) > 40 * len(places), "too short to judge"
    mean = sum(heights) / len(heights)
    return math.sqrt(sum((h - mean) ** 2 for h in heights) / len(heights))


class Live(ProgramTest):
    """Commands one by one, each with readings of the past, the present and the future around it."""

    def start_both(self, *options):
        return [self.server.start_probe("--region", f"{x},{z},{r}", *options) for x, z, r in REGIONS]

    def look(self, times, places, *options):
        """Starts both clients, each to read the same times and places and compare the server's samples."""
        begin, end, step = times
        when = ["--at", begin, "--times", int((end - begin) / step) + 1, "--every", step]
        return self.start_both("--region", f"{FAR[0]},{FAR[1]},40", *words_of(places), *when, "--bits", "--compare", *options)

    def finish_looking(self, probes):
        """What both have seen: each equal to the server's bits."""
        seen = []
        for probe in probes:
            out, words = self.finish(probe)
            water = parse(out)
            self.assertIn(f"{len(water)} of {len(water)} identical", words)
            self.assertIn("| exact |", words)
            self.assertIn(" 0 resyncs", words)
            seen.append(water)
        return seen

    def read(self, times, places, *options):
        """Both clients' answers, which have to be one where they overlap."""
        first, second = self.finish_looking(self.look(times, places, *options))
        shared = first.keys() & second.keys()
        self.assertGreaterEqual(len({key[1:] for key in shared}), len(places))
        self.assertEqual([key for key in shared if first[key] != second[key]], [], "the clients differ")
        return first | second

    def now(self):
        return int(self.server.sea_time_s())

    def step(self, *command):
        """Gives a command with the clients looking on; (what ctl says, the sea without it, the sea with it)."""
        now = self.now()
        where = (now - now % 5 - 60, now - now % 5 + AHEAD_S, 5), SHARED, "--points", 40, "--seed", 7
        before = self.read(*where)
        self.assertEqual({key: bits for key, bits in self.known.items() if key in before and before[key] != bits}, {},
                         "the sea is another, though nobody changed it")
        self.assertTrue(not self.known or self.known.keys() & before.keys())
        looking = self.look(*where)
        said = self.server.ctl_json(*command)
        during = self.finish_looking(looking)
        after = self.read(*where)
        effective = said["effective_s"]
        self.assertGreater(effective, now)
        changed_past = [key for key in before if key[0] <= effective and before[key] != after[key]]
        self.assertEqual(changed_past, [], f"{command}: changes what was before {effective} s")
        for seen in during:
            for time in {key[0] for key in seen}:
                moment = {key: bits for key, bits in seen.items() if key[0] == time}
                self.assertTrue(all(before[key] == bits for key, bits in moment.items()) or
                                all(after[key] == bits for key, bits in moment.items()),
                                f"{command}: at {time} s the water is neither that before nor that after")
        self.known = after
        return said, before, after

    def change(self, before, after, place, begin, end):
        """Greatest change of height at a place, metres."""
        times = [key for key in before if key[1:] == place and begin <= key[0] <= end]
        self.assertGreater(len(times), 3)
        return max(abs(height(before[key]) - height(after[key])) for key in times)

    def greatest_change(self, before, after, begin, end):
        return max(abs(height(before[key]) - height(after[key])) for key in before if begin <= key[0] <= end)

    def box_named(self, name):
        """The box that goes on under a name: the latest."""
        return max(b["box"] for b in self.server.ctl_json("list")["boxes"] if b["name"] == name)

    def test_all_that_a_director_may_do(self):
        with Server(scene(SCENE)) as self.server:
            self.known = {}
            self.server.ctl_json("time", "--rate", RATE)
            begin = self.now() + 3
            followed = (begin, begin + FOLLOWED_S, 0.5), SHARED, "--points", 40, "--patience", 100
            followers = self.look(*followed, "--follow")
            watchers = self.start_both("--point", "300,0", "--watch", "--every", 0.1)
            wind = self.raise_a_wind()
            self.sail()
            self.steer_the_wind(wind)
            self.build_and_dig()
            self.stop_both()
            # Who followed all of it live saw what a newcomer reads in hindsight.
            lived = self.finish_looking(followers)
            self.assertEqual(lived, self.finish_looking(self.look(*followed)))
            self.check_watchers(watchers)
            self.assertEqual(self.server.stop(), 0, self.server.log())

    def check_watchers(self, watchers):
        for watcher in watchers:
            watcher.send_signal(signal.SIGINT)
            out, err = self.finish(watcher)
            self.assertEqual(err, "")
            *lines, words = out.splitlines()
            self.assertGreater(len(lines), 10)
            self.assertTrue(all("  exact, " in line for line in lines), out[-2000:])
            times = [float(line.split()[2]) for line in lines]
            self.assertEqual(times, sorted(times), "sea time runs backwards")
            self.assertIn(" 0 resyncs", words)

    def raise_a_wind(self):
        said, calm, windy = self.step(*WIND)
        after = said["effective_s"] + 40
        self.assertGreater(self.greatest_change(calm, windy, after, math.inf), 0.01, "the wind does nothing")
        box = {b["box"]: b for b in self.server.ctl_json("list")["boxes"]}[said["box"]]
        self.assertEqual((box["kind"], box["trains"]), ("wind", 24))
        return said["box"]

    def sail(self):
        """A ship southwards, which turns east before she comes to what she would have passed."""
        window = (self.now(), self.now() + AHEAD_S, 1), [PASSED]
        nobody = self.read(*window)
        said, empty, sailed = self.step(*SHIP)
        begin = said["effective_s"]
        somebody = self.read(*window)
        self.assertLess(self.change(empty, sailed, FAR, begin, math.inf), 1e-5)
        first = said["box"]
        self.assertLess(self.change(nobody, somebody, PASSED, begin, begin + 20), 1e-5, "the wake runs ahead of the ship")
        self.assertGreater(self.change(nobody, somebody, PASSED, begin + 25, begin + 60), 0.05, "no wake")
        said, straight, turned = self.step("steer", first, "--towards", 90, "--speed", 6)
        self.assertNotEqual(said["box"], first)
        elsewhere = self.read(*window)
        self.assertGreater(self.change(somebody, elsewhere, PASSED, begin + 25, begin + 60), 0.05, "the old course's wake")
        self.assertLess(self.change(straight, turned, FAR, begin, math.inf), 1e-5)
        boxes = {b["box"]: b for b in self.server.ctl_json("list")["boxes"]}
        self.assertEqual(boxes[said["box"]]["name"], "pilot boat")
        self.assertEqual(boxes[first]["end_s"], said["effective_s"])

    def steer_the_wind(self, wind):
        said, before, after = self.step("steer", wind, "--towards", 20, "--speed", 5)
        self.assertEqual(said["box"], wind)
        self.assertGreater(self.greatest_change(before, after, said["effective_s"] + 20, math.inf), 0.005)

    def build_and_dig(self):
        """A mole makes a lee, and a gap in it lets waves through again; far away nobody notices."""
        now = self.now()
        window = (now - 70, now + AHEAD_S, 1)
        open_beach = self.read(window, LEE)
        said, before, after = self.step("breakwater", *MOLE)
        built = said["effective_s"]
        self.assertLess(self.change(before, after, FAR, built, math.inf), 1e-5)
        lee = self.read(window, LEE)
        long_before = spread(open_beach, LEE, built - 60, built)
        without = spread(open_beach, LEE, built + 12, built + 72)
        with_mole = spread(lee, LEE, built + 12, built + 72)
        self.assertLess(with_mole, 0.6 * without)
        self.assertLess(with_mole, 0.6 * long_before)

        wind = self.box_named("wind 2")
        again = self.server.ctl("stop", 2)
        self.assert_ends(again, 1, f"box 2 goes on as box {wind}")

        window = (self.now(), self.now() + AHEAD_S, 1)
        closed = self.read(window, BEHIND_THE_GAP)
        said, before, after = self.step("breakwater", *GAP, "--dig", "--crest", -8, "--width", 60)
        dug = said["effective_s"]
        self.assertGreaterEqual(dug - built, 9.999, "the land changes before it has settled")
        self.assertLess(self.change(before, after, FAR, built, math.inf), 1e-5)
        opened = self.read(window, BEHIND_THE_GAP)
        without, with_gap = (spread(water, BEHIND_THE_GAP, dug + 12, dug + 72) for water in (closed, opened))
        self.assertGreater(with_gap, 2 * without)

    def stop_both(self):
        for name in ("wind 2", "pilot boat"):
            said, before, after = self.step("stop", self.box_named(name))
            self.assertGreater(self.greatest_change(before, after, said["effective_s"] + 30, math.inf), 0.001)
            self.assert_ends(self.server.ctl("stop", said["box"]), 1, "decays from sea time", "it needs no stop")


NO_NUMBERS = ("nan", "inf", "-inf", "1e999", "", "much")
NO_PLACES = ("nan,0", "0,inf", "1e9,0", "0", "1,2,3", "", "here")


def changed(command, option, value):
    """The command with another value of an option."""
    at = command.index(option) if option in command else len(command)
    return (*command[:at], option, value, *command[at + 2:])


def along(*points):
    return ("breakwater", *(word for point in points for word in ("--point", point)))


class BadInput(ProgramTest):
    """Each refusal is one line with the option or the reason in it; the sea does not notice."""

    @classmethod
    def setUpClass(cls):
        cls.server = Server(scene(SCENE))

    @classmethod
    def tearDownClass(cls):
        status = cls.server.stop()
        cls.server.close()
        assert status == 0, status

    def sea(self):
        time = self.server.ctl_json("time")
        boxes = self.server.ctl_json("list")["boxes"]
        return time["log_position"], time["log_hash"], [(b["box"], b["name"], b["end_s"]) for b in boxes]

    def setUp(self):
        self.before = self.sea()

    def tearDown(self):
        self.assertIsNone(self.server.process.poll(), self.server.log()[-3000:])
        self.assertEqual(self.sea(), self.before)
        self.assert_ends(self.server.probe("--region", "300,0,100", "--points", 50, "--compare"), 0, "50 of 50 identical",
                         stream="stdout")

    def refused(self, status, command, *words):
        with self.subTest(command=" ".join(map(str, command))):
            done = self.server.ctl(*command)
            self.assert_ends(done, status, *words)
            self.assertEqual(done.stdout, "")
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertTrue(done.stderr.startswith("trochoid-ctl: "), done.stderr)

    def refuse_each(self, command, options):
        """Every one of the values, and what is no number, as a bad option."""
        for option, values in options.items():
            for value in (*NO_NUMBERS, *values):
                self.refused(2, changed(command, option, value), option)

    def test_winds(self):
        self.refuse_each(WIND, {
            "--speed": (0, -5, 0.9, 100), "--towards": (-1, 361), "--fetch-km": (0, -1, 0.001, 10_000),
            "--width-km": (0, -1, 0.001, 10_000), "--trains": (0, -1, 257, 1.5), "--directions": (-1, 257, 7),
            "--spectrum": ("pink",), "--spreading": ("wide",), "--reference-depth": (-1, 0.5, 20_000), "--round": (-0.1, 1.1),
            "--irregular": (-0.1, 1.1), "--noise": (-1, 2), "--move-speed": (0, -1, 101), "--move-towards": (-1, 361),
            "--life-s": (-1, 0.5, 1e11), "--seed": (-1, 2**63), "--at": (1e13,), "--in": (-1,)})
        for place in NO_PLACES:
            self.refused(2, changed(WIND, "--origin", place), "--origin")
        edge = changed(changed(WIND, "--origin", "33554000,0"), "--fetch-km", 500)
        self.refused(1, edge, "106", "leaves the world", "33554432")
        self.refused(1, changed(WIND, "--noise", 1e-9), "106", "noise")
        ripples = ("start-wind", "--speed", 1, "--towards", 0, "--origin", "0,0", "--fetch-km", 0.032, "--width-km", 0.1,
                   "--trains", 64, "--seed", 5, "--round", 0.5)
        self.refused(1, ripples, "106", "cannot be round", "longer fetch")

    def test_ships(self):
        self.refuse_each(SHIP, {"--speed": (0, 0.4, -1, 31), "--towards": (-1, 361), "--length": (0, -1, 600),
                                "--beam": (-1, 101, 600)})
        for place in NO_PLACES:
            self.refused(2, changed(SHIP, "--from", place), "--from")
        for name in ("x" * 65, "two\nlines"):
            self.refused(2, changed(SHIP, "--name", name), "name")
        self.refused(1, changed(SHIP, "--from", "33554000,0"), "106", "leaves the world", "farther from its edge")
        for dunes in ("800,0", "1020,-300"):
            self.refused(1, changed(SHIP, "--from", dunes), "106", "on land", "on water")

    def test_courses(self):
        steer = ("steer", 1, "--towards", 90, "--speed", 5)
        self.refuse_each(steer, {"--towards": (-1, 361), "--speed": (-1, 101)})
        for box in (*NO_NUMBERS, 0, -1, 2**32):
            self.refused(2, ("steer", box, *steer[2:]), "BOX")
            self.refused(2, ("stop", box), "BOX")
        for box in (99, 2**32 - 1):
            self.refused(1, ("steer", box, *steer[2:]), "602", f"no box {box}", "trochoid-ctl list")
            self.refused(1, ("stop", box), "602", f"no box {box}", "trochoid-ctl list")
        self.refused(1, steer, "605", "box 1 lies still", "only ships and winds")

    def test_land(self):
        mole = along("0,0", "100,0")
        self.refuse_each(mole, {"--width": (0, -1, 2001), "--crest": (201, -201)})
        for count in (0, 1, 65):
            self.refused(2, along(*(f"{i},0" for i in range(count))), f"2 to 64 points, not {count}")
        for place in NO_PLACES:
            self.refused(2, along("0,0", place), "--point")
        self.refused(1, along("5000,5000", "6000,5000"), "106", "beside the terrain")
        self.refused(1, (*mole, "--crest", -100), "106", "as high already")
        self.refused(1, (*mole, "--dig", "--crest", 10), "106", "as deep already")

    def test_time(self):
        self.refuse_each(("time",), {"--rate": (-1, 17)})


if __name__ == "__main__":
    unittest.main()
