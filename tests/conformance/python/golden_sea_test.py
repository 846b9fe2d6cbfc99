"""Every line of tests/golden/sea.txt, edges.txt, fields.txt and wire_clock.txt, reproduced (R-205, R-142)."""
import pathlib
import unittest

import golden_check
from binary32 import bits
from golden_sea import GoldenSea
from sea import known_answer
from sea_features import sine_cosine
from sea_wake import ROOT, SYSTEMS

PATH = pathlib.Path(__file__).resolve().parents[2] / "golden/sea.txt"


def words(floats):
    return [f"{bits(value):08x}" for value in floats]


class GoldenSeaTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.golden = GoldenSea(PATH)

    def lines(self, kind, least):
        lines = self.golden.lines[kind]
        self.assertGreaterEqual(len(lines), least, f"{PATH} has too few lines '{kind}'")
        return lines

    def test_no_line_is_left_over(self):
        self.assertEqual(set(self.golden.lines), {"sincos", "wakenode", "wakeroot", "sample", "layers", "water", "hash"})

    def test_sine_and_cosine(self):
        for phase, *expected in self.lines("sincos", 256):
            self.assertEqual(words(sine_cosine(int(phase))), expected, phase)

    def test_wake_table(self):
        for system, j, *expected in self.lines("wakenode", 200):
            self.assertEqual(SYSTEMS[int(system)][int(j)], tuple(map(int, expected)), (system, j))
        for j, expected in self.lines("wakeroot", 20):
            self.assertEqual(ROOT[int(j)], int(expected), j)

    def test_samples(self):
        for t, x, z, *expected in self.lines("sample", 200):
            self.assertEqual(words(self.golden.sea.sample(int(t), int(x), int(z))), expected, (t, x, z))

    def test_layers(self):
        for mask, t, x, z, *expected in self.lines("layers", 200):
            self.assertEqual(words(self.golden.sea.sample(int(t), int(x), int(z), int(mask))), expected, (mask, t, x, z))

    def test_places(self):
        for t, x, z, *expected in self.lines("water", 60):
            water, rest = self.golden.sea.water(int(t), int(x), int(z))
            self.assertEqual(words(water) + list(map(str, rest)), expected, (t, x, z))

    def test_known_answers(self):
        for seed, count, expected in self.lines("hash", 3):
            *_, answer = known_answer(self.golden.sea, int(seed), int(count))
            self.assertEqual(f"{answer:016x}", expected, seed)

    def test_the_second_sea_and_the_fields(self):
        for name, kinds in (("edges", {"sincos": 2, "constants": 25, "phase": 25, "sample": 350, "layers": 50, "water": 40}),
                            ("fields", {"land": 200})):
            golden = GoldenSea(PATH.with_name(f"{name}.txt"))
            self.assertEqual(set(golden.lines), set(kinds))
            for kind, least in kinds.items():
                self.assertGreaterEqual(len(golden.lines[kind]), least, kind)
                for words_ in golden.lines[kind]:
                    asked = golden_check.ARGUMENTS[kind]
                    self.assertEqual(golden_check.answer(golden, kind, words_[:asked]), words_[asked:], (name, kind, words_[:asked]))

    def test_clock(self):
        lines = [line for line in PATH.with_name("wire_clock.txt").read_text(encoding="utf-8").splitlines() if line[0] != "#"]
        expected = [line for line in lines if line.split()[0] in golden_check.CLOCK_ARGUMENTS]
        self.assertGreater(len(expected), 150)
        self.assertEqual(list(golden_check.clock_answers(lines)), expected)


if __name__ == "__main__":
    unittest.main()
