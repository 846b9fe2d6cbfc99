"""What trochoid-ctl and trochoid-probe print, and what they refuse."""
import json
import re
import signal
import time
import unittest

from sea_programs import BIN, ProgramTest, Server, run, scene

WIND = ("start-wind", "--speed", 8, "--towards", 30, "--origin", "-100,200", "--fetch-km", 1, "--width-km", 0.5)


SHIP = ("start-ship", "--from", "300,-50", "--towards", 90, "--speed", 9, "--name", "ferry")
MOLE = ("breakwater", "--point", "100,0", "--point", "200,50")


class Ctl(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.server = Server(scene("open-sea"))

    @classmethod
    def tearDownClass(cls):
        cls.server.close()

    def test_list_shows_the_scenes_winds(self):
        done = self.server.ctl("list", token=False)
        self.assert_ends(done, 0, "trade wind", "squall", "grown", stream="stdout")
        lines = done.stdout.splitlines()
        self.assertRegex(lines[0], r"^sea time \d+\.\d{3} s \(\d\d:\d\d:\d\d\.\d{3}\)$")
        header = next(line for line in lines if line.lstrip().startswith("BOX"))
        row = next(line for line in lines if "trade wind" in line)
        self.assertEqual(header.index("STAGE"), row.index("grown"), "columns are not aligned:\n" + done.stdout)
        listed = self.server.ctl_json("list")
        self.assertEqual([b["name"] for b in listed["boxes"][:2]], ["trade wind", "squall"])
        self.assertIsNone(listed["boxes"][0]["end_s"])

    def test_time_runs(self):
        first = self.server.ctl_json("time")
        time.sleep(0.3)
        second = self.server.ctl_json("time")
        self.assertEqual(first["rate"], 1)
        self.assertGreater(second["sea_time_us"] - first["sea_time_us"], 250_000)
        self.assertGreater(second["watermark_s"], second["sea_time_s"])
        self.assert_ends(self.server.ctl("time"), 0, "sea time", "rate       1", "epoch", "watermark", stream="stdout")

    def test_a_wind_comes_and_goes(self):
        started = self.server.ctl(*WIND, "--life-s", 5)
        self.assert_ends(started, 0, "the wind starts at sea time", stream="stdout")
        box = int(re.match(r"box (\d+):", started.stdout).group(1))
        listed = {b["box"]: b for b in self.server.ctl_json("list")["boxes"]}
        self.assertAlmostEqual(listed[box]["end_s"] - listed[box]["begin_s"], 5)
        self.assertEqual(listed[box]["towards_degrees"], 30)
        stopped = self.server.ctl("stop-wind", box)
        self.assertIn(stopped.returncode, (0, 1), stopped.stderr)
        again = self.server.ctl("stop-wind", box)
        self.assert_ends(again, 1, "decays from sea time", "needs no stop")

    def test_effective_times(self):
        now = self.server.sea_time_s()
        later = self.server.ctl_json(*WIND, "--at", round(now + 30, 3))
        self.assertAlmostEqual(later["effective_s"], round(now + 30, 3), places=3)
        self.assertEqual(later["deferred_s"], 0)
        soon = self.server.ctl_json(*WIND, "--in", 20)
        self.assertGreater(soon["effective_s"], now + 20)
        self.assertLess(soon["effective_s"], now + 25)
        deferred = self.server.ctl(*WIND, "--at", round(now, 3))
        self.assert_ends(deferred, 0, "deferred by", stream="stdout")
        refused = self.server.ctl(*WIND, "--at", round(now, 3), "--or-refuse")
        self.assert_ends(refused, 1, "604", "--or-refuse")

    def test_only_directors_change_the_sea(self):
        for command in (WIND, ("stop-wind", 1), ("time", "--rate", 2)):
            self.assert_ends(self.server.ctl(*command, token=False), 1, "301", "token")
        for command in (SHIP, ("steer", 1, "--towards", 1, "--speed", 1), MOLE):
            self.assert_ends(self.server.ctl(*command, token=False), 1, "301", "token")

    def test_a_token_is_good_once(self):
        token = self.server.token("director", "open sea")
        def ctl(*words):
            return self.server.ctl("--token-file", token, *words, token=False)
        self.assert_ends(ctl("stop-wind", 4_000_000), 1, "602")
        self.assert_ends(ctl("list"), 1, "used already")
        self.server.token("director", "open sea")
        self.assert_ends(ctl("time", "--rate", 1), 1, "301", "admin")
        self.server.token("admin", "open sea")
        self.assert_ends(ctl("time", "--rate", 1), 0, "rate 1", stream="stdout")
        self.server.token("director", "another sea")
        self.assert_ends(ctl("list"), 1, "another world", "--world 'open sea'")
        self.server.token("viewer", "open sea", "--for", "1h")
        self.assert_ends(ctl(*WIND), 1, "301", "director")

    def test_time_goes_forward(self):
        before = self.server.sea_time_s()
        skipped = self.server.ctl_json("time", "--skip", 3600)
        self.assertGreater(skipped["effective_s"], before + 3600)
        time.sleep(1)
        self.assertGreater(self.server.sea_time_s(), before + 3600)
        self.assert_ends(self.server.ctl("time", "--skip", 60, token=False), 1, "301", "admin")

    def test_keys_that_nobody_knows(self):
        stranger = self.server.key_file.with_name("stranger")
        self.assert_ends(run("trochoid-ctl", "token", "new-key", stranger), 0, f"{stranger}.pub", stream="stdout")
        self.assert_ends(run("trochoid-ctl", "token", "new-key", stranger), 2, "not written over")
        self.assertEqual(stranger.stat().st_mode & 0o777, 0o600)
        self.assert_ends(self.server.ctl("--sign-with", stranger, "list", token=False), 1, "not signed by a key")
        self.assert_ends(self.server.ctl("--sign-with", f"{stranger}.pub", "list", token=False), 2, "no private Ed25519 key")
        stranger.chmod(0o644)
        warned = self.server.ctl("--sign-with", stranger, "list", token=False)
        self.assert_ends(warned, 1, "warning", f"chmod 600 {stranger}")

    def test_tokens_are_shown(self):
        token = self.server.token("director", "Süd see", "--for", "5m")
        shown = run("trochoid-ctl", "token", "show", token, "--pub", f"{self.server.key_file}.pub")
        self.assert_ends(shown, 0, "director", "Süd see", "signature  good", stream="stdout")
        told = json.loads(run("trochoid-ctl", "token", "show", token.read_text().strip(), "--json").stdout)
        self.assertEqual((told["role"], told["world"], told["signature"]), ("director", "Süd see", "not checked"))
        self.assertEqual(told["expiry"] - told["issued"], 300)
        other = self.server.key_file.with_name("other")
        run("trochoid-ctl", "token", "new-key", other)
        wrong = run("trochoid-ctl", "token", "show", token, "--pub", f"{other}.pub")
        self.assert_ends(wrong, 1, "signature  wrong", stream="stdout")
        self.assert_ends(run("trochoid-ctl", "token", "show", "trochoid1.a.b"), 2, "TOKEN")

    def test_unknown_box(self):
        self.assert_ends(self.server.ctl("stop-wind", 4_000_000), 1, "602", "trochoid-ctl list")

    def test_a_ship_sails_turns_and_ends(self):
        started = self.server.ctl_json(*SHIP)
        first = started["box"]
        time.sleep(1.5)
        listed = {b["box"]: b for b in self.server.ctl_json("list")["boxes"]}
        ship = listed[first]
        self.assertEqual((ship["kind"], ship["name"], ship["towards_degrees"]), ("ship", "ferry", 90))
        self.assertAlmostEqual(ship["vx_m_s"], 9, delta=0.01)
        self.assertAlmostEqual(ship["vz_m_s"], 0, delta=0.01)
        self.assertGreaterEqual(ship["x_m"], 300)
        self.assertAlmostEqual(ship["z_m"], -50, delta=1)
        self.assert_ends(self.server.ctl("list"), 0, "ferry", "ship", "9.0", "90°", stream="stdout")
        second = self.server.ctl_json("steer", first, "--towards", 180, "--speed", 6)["box"]
        self.assertNotEqual(second, first)
        time.sleep(1.5)
        listed = {b["box"]: b for b in self.server.ctl_json("list")["boxes"]}
        self.assertAlmostEqual(listed[second]["vz_m_s"], 6, delta=0.01)
        self.assertEqual(listed[first]["stage"], "decaying")
        lying = self.server.ctl_json("steer", second, "--towards", 0, "--speed", 0)["box"]
        time.sleep(1.5)
        places = []
        for _ in range(2):
            ship = {b["box"]: b for b in self.server.ctl_json("list")["boxes"]}[lying]
            places.append((ship["x_m"], ship["z_m"]))
            self.assertEqual((ship["kind"], ship["name"], ship["stage"], ship["length_m"]), ("ship", "ferry", "lying", 100))
            self.assertEqual((ship["vx_m_s"], ship["vz_m_s"], ship["towards_degrees"]), (0, 0, 180))
            time.sleep(0.5)
        self.assertEqual(*places)
        self.assert_ends(self.server.ctl("steer", lying, "--towards", 0, "--speed", 0), 1, "605", "lies still already")
        last = self.server.ctl_json("steer", lying, "--towards", 45, "--speed", 7)["box"]
        self.assert_ends(self.server.ctl("stop", last), 0, "the decay starts", stream="stdout")

    def test_a_storm_moves_and_turns(self):
        started = self.server.ctl_json(*WIND, "--trains", 32, "--directions", 4, "--spectrum", "jonswap", "--spreading",
                                       "hasselmann", "--round", 0.3, "--irregular", 0.5, "--noise", 0.02,
                                       "--move-towards", 90, "--move-speed", 15)
        box = started["box"]
        again = self.server.ctl_json("steer", box, "--towards", 0, "--speed", 20, "--in", 2)
        self.assertEqual(again["box"], box)
        time.sleep(3.5)
        storm = {b["box"]: b for b in self.server.ctl_json("list")["boxes"]}[box]
        self.assertEqual((storm["kind"], storm["trains"]), ("wind", 32))
        self.assertAlmostEqual(storm["vz_m_s"], -20, delta=0.01)
        self.assertGreater(storm["x_m"], -100)

    def test_what_lies_still_is_not_steered(self):
        self.assert_ends(self.server.ctl("steer", 1, "--towards", 0, "--speed", 5), 1, "605", "only ships and winds")

    def test_no_land_to_change(self):
        self.assert_ends(self.server.ctl(*MOLE), 1, "606", "terrain")

    def test_bad_options_say_what_to_do(self):
        ctl = self.server.ctl
        self.assert_ends(ctl(), 2, "start-wind, start-ship, steer, stop-wind, breakwater, list, time or token")
        self.assert_ends(ctl(*WIND, "--round", "nan"), 2, "--round", "0 to 1", "--help")
        self.assert_ends(ctl(*WIND, "--directions", 3), 2, "--directions 3 does not divide")
        self.assert_ends(ctl(*WIND, "--spectrum", "pink"), 2, "pink", "jonswap", "--help")
        self.assert_ends(ctl(*SHIP, "--length", 0), 2, "--length", "1 to 500")
        self.assert_ends(ctl("steer", 1, "--towards", "nan", "--speed", 1), 2, "--towards")
        self.assert_ends(ctl("breakwater"), 2, "2 to 64 points", "--point X,Z")
        self.assert_ends(ctl("breakwater", "--point", "1,2", "--point", ""), 2, "--point")
        self.assert_ends(ctl("frobnicate"), 2, "frobnicate", "--help")
        self.assert_ends(ctl("list", "--fast"), 2, "--fast", "--help")
        self.assert_ends(ctl("start-wind", "--speed", 8), 2, "required", "--help")
        self.assert_ends(ctl(*WIND, "--speed", 99), 2, "--speed")
        self.assert_ends(ctl(*WIND, "--at", "nan"), 2, "--help")
        self.assert_ends(ctl(*WIND, "--at", 3, "--in", 3), 2, "--at")
        self.assert_ends(ctl("stop-wind", "0"), 2, "BOX")
        self.assert_ends(run("trochoid-ctl", "--connect", "7421", "list"), 2, "127.0.0.1:7421")
        self.assert_ends(run("trochoid-ctl", "--token-file", "/nowhere/token", "list"), 2, "--token-file /nowhere/token")
        self.assert_ends(run("trochoid-ctl", "--sign-with", "/nowhere/key", "list"), 2, "--sign-with /nowhere/key")
        empty = self.server.key_file.with_name("empty")
        empty.write_text("\n")
        self.assert_ends(run("trochoid-ctl", "--token-file", empty, "list"), 2, "holds no token")
        key = self.server.key_file
        self.assert_ends(ctl("--token-file", empty, "list"), 2, "--token-file and --sign-with")
        self.assert_ends(run("trochoid-ctl", "--world", "w", "list"), 2, "--world", "--sign-with")
        self.assert_ends(run("trochoid-ctl", "token"), 2, "new-key", "make", "show")
        make = ("token", "make", "--key", key, "--role", "director", "--world", "w")
        for life in ("0", "61m", "1.5h", "2 h", "-1s", "99999999999999999999"):
            self.assert_ends(run("trochoid-ctl", *make, f"--for={life}"), 2, "--for wants 1 s to 1 h")
        self.assert_ends(run("trochoid-ctl", "token", "make", "--key", key, "--role", "king", "--world", "w"), 2, "king")
        self.assert_ends(run("trochoid-ctl", "token", "make", "--key", key, "--role", "admin", "--world", "w" * 257), 2, "256")

    def test_help_and_version(self):
        for program in ("trochoid-ctl", "trochoid-probe", "trochoid-server"):
            self.assert_ends(run(program, "--version"), 0, program, "protocol", "model", stream="stdout")
            self.assert_ends(run(program, "--help"), 0, "Usage", stream="stdout")
        for command in ("start-wind", "start-ship", "steer", "stop-wind", "stop", "breakwater", "list", "time", "token"):
            self.assert_ends(run("trochoid-ctl", command, "--help"), 0, "Example", stream="stdout")


class Land(ProgramTest):
    """The bed changes while the sea runs, and clients go on agreeing with the server."""

    def test_a_breakwater_rises(self):
        with Server(scene("plane-beach")) as server:
            where = ("--region", "350,0,300", "--points", 200)
            self.assert_ends(server.probe(*where, "--compare"), 0, "200 of 200 identical", stream="stdout")
            built = server.ctl_json("breakwater", "--point", "300,-200", "--point", "320,200", "--width", 20, "--crest", 3)
            self.assertNotIn("box", built)
            wait = built["effective_s"] + 1
            self.assert_ends(server.probe(*where, "--at", wait, "--compare"), 0, "200 of 200 identical", stream="stdout")
            listed = server.ctl_json("list")["boxes"]
            self.assertEqual(len({b["name"] for b in listed}), 1, "a box goes on under the same name")
            self.assertGreater(max(b["box"] for b in listed), 1)
            far = server.ctl("breakwater", "--point", "9000000,0", "--point", "9000100,0")
            self.assert_ends(far, 1, "106")


class Probe(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.server = Server(scene("open-sea"))

    @classmethod
    def tearDownClass(cls):
        cls.server.close()

    def test_table_and_json_tell_the_same(self):
        where = ("--point", "10,-20.5", "--at", 60, "--times", 3, "--every", 0.5)
        table = self.server.probe(*where)
        self.assert_ends(table, 0, "exact", "bytes received", stream="stdout")
        told = json.loads(self.server.probe(*where, "--json").stdout)
        self.assertEqual([s["time_s"] for s in told["samples"]], [60, 60.5, 61])
        self.assertEqual(told["fidelity"], "exact")
        for sample in told["samples"]:
            self.assertIn(f"{sample['height_m']:+9.4f}", table.stdout)
            self.assertAlmostEqual(sum(n * n for n in sample["normal"]), 1, places=5)
            self.assertEqual((sample["x_m"], sample["z_m"], sample["trust"]), (10, -20.5, "exact"))
        heights = {round(s["height_m"], 4) for s in told["samples"]}
        self.assertEqual(len(heights), 3, "the sea does not move")

    def test_compare(self):
        done = self.server.probe("--region", "0,0,500", "--points", 300, "--compare")
        self.assert_ends(done, 0, "300 of 300 identical", stream="stdout")

    def test_watch_ends_by_signal(self):
        watcher = self.server.start_probe("--point", "0,0", "--watch", "--every", 0.1)
        first = watcher.stdout.readline()
        self.assertRegex(first, r"^sea time .* height [+-]\d+\.\d{4} m ")
        watcher.stdout.readline()
        watcher.send_signal(signal.SIGINT)
        out, _ = self.finish(watcher)
        self.assertIn("bytes received", out)

    def test_bad_options_say_what_to_do(self):
        probe = self.server.probe
        self.assert_ends(probe(), 2, "--point")
        self.assert_ends(probe("--point", "1"), 2, "X,Z")
        self.assert_ends(probe("--point", "1,2,"), 2, "X,Z")
        self.assert_ends(probe("--point", "1,nan"), 2, "X,Z")
        self.assert_ends(probe("--point", "99999999,0"), 2, "outside the world")
        self.assert_ends(probe("--region", "0,0,3000", "--points", 3), 2, "2048")
        self.assert_ends(probe("--region", "0,0,300"), 2, "--points")
        self.assert_ends(probe("--region", "0,0,300", "--points", 0), 2, "--points")
        self.assert_ends(probe("--bits", "--json", "--point", "0,0"), 2, "--json")
        self.assert_ends(probe(*[o for i in range(40) for o in ("--point", f"{i * 1000},0")]), 2, "regions are too many")


if __name__ == "__main__":
    unittest.main()
