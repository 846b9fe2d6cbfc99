"""Two clients and the server compute the same water, to the bit, through a wind's whole life."""
import unittest

from sea_programs import ProgramTest, Server, scene

POINTS = 1000
FLOATS = 15
RATE = 16  # sea seconds a second: a wind's decay takes half a minute at least
STEP_S = 5
STEPS = 40
AHEAD_S = 80  # five seconds to give all commands in


def parse_bits(text):
    """{time in us: {(x, z): bits}}"""
    times = {}
    for line in text.splitlines():
        time, x, z, *bits = line.split()
        assert len(bits) == FLOATS, line
        times.setdefault(int(time), {})[int(x), int(z)] = tuple(bits)
    return times


class Agreement(ProgramTest):
    def regions(self, places):
        return [option for x, z, r in places for option in ("--region", f"{x},{z},{r}")]

    def check(self, scene_name, places, wind_at):
        regions = self.regions(places)
        points = ["--points", POINTS, "--seed", 5]
        with Server(scene(scene_name)) as server:
            server.ctl_json("time", "--rate", RATE)
            begin = int(server.sea_time_s()) + AHEAD_S
            when = ["--at", begin, "--times", STEPS, "--every", STEP_S]
            # What is foreseen before anything happens.
            foreseen = parse_bits(self.finish(server.start_probe(*regions, *points, *when, "--bits"))[0])
            clients = [server.start_probe(*regions, *points, *when, "--bits", "--compare", "--follow") for _ in range(2)]
            wind = ["start-wind", "--speed", 10, "--towards", 60, "--origin", wind_at, "--fetch-km", 0.1, "--width-km", 0.1,
                    "--trains", 8]
            short = server.ctl_json(*wind, "--life-s", 30, "--at", begin + 20)
            self.assertEqual(short["effective_s"], begin + 20)
            endless = server.ctl_json(*wind, "--seed", 77, "--at", begin + 22)
            stop = server.ctl_json("stop-wind", endless["box"], "--at", begin + 60)
            self.assertEqual(stop["effective_s"], begin + 60)
            boxes = {b["box"]: b for b in server.ctl_json("list")["boxes"]}
            over = [boxes[short["box"]]["end_s"] + boxes[short["box"]]["decay_s"], stop["effective_s"] + boxes[endless["box"]]["decay_s"]]

            outputs = [self.finish(client) for client in clients]
            for _, words in outputs:
                self.assertIn(f"{POINTS * STEPS} of {POINTS * STEPS} identical", words)
                self.assertIn("| exact |", words)
                self.assertIn(" 0 resyncs", words)
            self.assertEqual(outputs[0][0], outputs[1][0], "the clients differ")
            lived = parse_bits(outputs[0][0])
            self.assertEqual(sorted(lived), [int((begin + i * STEP_S) * 1e6) for i in range(STEPS)])
            self.assertTrue(all(len(at) == POINTS for at in lived.values()))

            for time, water in lived.items():
                differing = sum(bits != foreseen[time][point] for point, bits in water.items())
                seconds = time * 1e-6 - begin
                if seconds <= 20 or time * 1e-6 >= max(over):
                    self.assertEqual(differing, 0, f"{seconds} s: the wind acts before it starts or after it is over")
                elif 50 <= seconds <= 60:
                    self.assertGreater(differing, POINTS // 40, f"{seconds} s: the wind does nothing")
            self.assertGreater(begin + STEPS * STEP_S, max(over) + STEP_S, "the test is too short to see the end")

            # Hindsight: a client that comes late reads the same past, as far as it is kept.
            late = parse_bits(self.finish(server.start_probe(*regions, *points, *when, "--bits", "--compare"))[0])
            self.assertEqual(late, lived)
            # And what one region tells, a wider one tells too, at its edge as well.
            x, z, r = places[0]
            edge = ["--point", f"{x + r},{z}", "--point", f"{x},{z - r}", "--at", begin + 50]
            narrow = self.finish(server.start_probe("--region", f"{x},{z},{r}", *edge, "--json"))[0]
            wide = self.finish(server.start_probe("--region", f"{x},{z},{min(2000, 3 * r)}", *edge, "--json"))[0]
            self.assertEqual(narrow.partition('"samples"')[2], wide.partition('"samples"')[2])
            self.assertEqual(server.stop(), 0, server.log())

    def test_open_sea(self):
        self.check("open-sea", [(43, -25, 70), (3000, 3800, 400)], "0,0")

    def test_scilly(self):
        self.check("scilly", [(-1457, -25, 70), (2500, 1500, 600)], "-1500,0")


if __name__ == "__main__":
    unittest.main()
