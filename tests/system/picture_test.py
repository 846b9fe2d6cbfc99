"""What the viewer draws offscreen: sky above, sea below, land where the map has it, and a sea that moves."""
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from png_picture import Picture
from sea_programs import BIN, PATIENCE_S, ProgramTest, Server, run, scene

# Metres east, up, south; heading and pitch in degrees: over St Agnes, looking north across the sound.
OVER_AN_ISLAND = "--camera=-500,60,2600,0,-4"
SMALL = ("--size", "640x360")


def is_land(rgb):
    """Sand and grass: red above blue, which neither water nor sky nor cloud has."""
    return rgb[0] > rgb[2] + 12


def differ(a, b):
    return max(abs(u - v) for u, v in zip(a, b)) > 6


class PictureTest(ProgramTest):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="trochoid-picture.")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def view(self, server, *options, **more):
        return run("trochoid-viewer", "--connect", server.address, "--offscreen", *options, **more)

    def share(self, picture, part, holds):
        pixels = list(picture.pixels(*part))
        return sum(holds(at, rgb) for at, rgb in pixels) / len(pixels)


class Content(PictureTest):
    def test_coast(self):
        first, second, summary = self.folder / "a.png", self.folder / "b.png", self.folder / "summary.json"
        with Server(scene("scilly")) as server:
            done = self.view(server, *SMALL, OVER_AN_ISLAND, "--seconds", 1, "--picture", first, "--second-picture", second,
                             "--second-picture-after", 1, "--summary-json", summary)
            self.assert_ends(done, 0, "exact viewer", stream="stdout")
            self.assertEqual(server.stop(), 0, server.log())
            self.assertIn("computes the same sea (exact)", server.log())
        a, b = Picture(first), Picture(second)
        self.assertEqual((a.width, a.height), (640, 360))

        red, green, blue = a.mean(0.0, 0.25)
        self.assertTrue(blue > green > red and blue > 150, f"the sky is not blue: {red:.0f} {green:.0f} {blue:.0f}")
        sea = (0.5, 0.75)
        red, green, blue = a.mean(*sea)
        self.assertTrue(blue > red + 30 and green > red + 20, f"the sea is not blue: {red:.0f} {green:.0f} {blue:.0f}")
        self.assertLess(sum(a.mean(*sea)), sum(a.mean(0.0, 0.25)), "the sea is brighter than the sky")
        self.assertEqual(self.share(a, (0.0, 0.4), lambda at, rgb: is_land(rgb)), 0, "land in the sky")
        self.assertLess(self.share(a, (0.55, 0.75), lambda at, rgb: is_land(rgb)), 0.01, "land where the sound is")
        self.assertGreater(self.share(a, (0.9, 1.0, 0.35, 0.65), lambda at, rgb: is_land(rgb)), 0.95, "no island below")
        self.assertGreater(self.share(a, (0.4, 0.5), lambda at, rgb: is_land(rgb)), 0.001, "no islands on the horizon")
        self.assertGreater(self.contrast(a, sea), 60, "the sea is flat: no waves are seen")

        moved = {part: self.share(a, part, lambda at, rgb: differ(rgb, b.pixel(*at))) for part in (sea, (0.93, 1.0, 0.4, 0.6))}
        self.assertGreater(moved[sea], 0.2, "the sea stands still")
        self.assertLess(moved[0.93, 1.0, 0.4, 0.6], 0.005, "the land moves")

        told = json.loads(summary.read_text())
        self.assertEqual(told["viewer"], "exact")
        self.assertEqual(told["resyncs"], 0)
        self.assertGreater(told["patches_drawn"], 20)
        self.assertGreater(told["land_triangles"], 1000)

    def contrast(self, picture, part):
        sums = [sum(rgb) for _, rgb in picture.pixels(*part)]
        return max(sums) - min(sums)

    def test_open_sea_has_no_land(self):
        path = self.folder / "open.png"
        with Server(scene("open-sea")) as server:
            self.assert_ends(self.view(server, *SMALL, "--seconds", 1, "--picture", path), 0, stream="stdout")
        picture = Picture(path)
        self.assertEqual(self.share(picture, (0.0, 1.0), lambda at, rgb: is_land(rgb)), 0)
        red, green, blue = picture.mean(0.7, 1.0)
        self.assertGreater(blue, red + 30)


class SameWater(PictureTest):
    """Two viewers side by side: one sea time, one sea."""

    def record(self, server, name, *options):
        folder = self.folder / name
        self.assert_ends(self.view(server, "--size", "320x180", OVER_AN_ISLAND, "--record", folder, *options), 0, stream="stdout")
        return folder

    def test_recordings_of_the_same_sea_time_are_the_same_bytes(self):
        with Server(scene("scilly")) as server:
            # Beside each other, at different moments of the server's own time.
            steps = ("--at", server.sea_time_s() + 2, "--fixed-step", 0.5, "--frames", 4)
            one, other = self.record(server, "one", *steps), self.record(server, "other", *steps)
        names = [f"frame_{i:06}.png" for i in range(4)]
        self.assertEqual(sorted(p.name for p in one.iterdir()), names)
        pictures = [Picture(one / name) for name in names]
        for name in names:
            self.assertEqual((one / name).read_bytes(), (other / name).read_bytes(), name)
        sea = (0.5, 0.75)
        for a, b in zip(pictures, pictures[1:]):
            self.assertGreater(self.share(a, sea, lambda at, rgb, b=b: differ(rgb, b.pixel(*at))), 0.02, "the sea stands still")

    def test_a_full_folder_is_refused(self):
        (self.folder / "mine.txt").write_text("precious")
        with Server(scene("open-sea")) as server:
            self.assert_ends(self.view(server, *SMALL, "--frames", 1, "--record", self.folder), 2, "not empty")
        self.assertEqual([p.name for p in self.folder.iterdir()], ["mine.txt"])


class Trouble(PictureTest):
    def test_nobody_there(self):
        with Server(scene("open-sea")) as server:
            address = server.address
        done = run("trochoid-viewer", "--connect", address, "--offscreen", "--patience", 2, "--seconds", 1)
        self.assertIn(done.returncode, (1, 2), done.stderr)
        self.assertIn("nothing listens at " + address, done.stderr)

    def test_no_opengl_4_1(self):
        with Server(scene("open-sea")) as server:
            old = dict(os.environ, MESA_GL_VERSION_OVERRIDE="3.3", MESA_GLSL_VERSION_OVERRIDE="330")
            done = self.view(server, "--seconds", 1, env=old)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("4.1", done.stderr)

    def test_server_gone_while_viewing(self):
        path = self.folder / "late.png"
        with Server(scene("open-sea")) as server:
            viewer = subprocess.Popen([BIN / "trochoid-viewer", "--connect", server.address, "--offscreen", *SMALL, "--seconds", "5",
                                       "--picture", path], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            deadline = time.monotonic() + PATIENCE_S
            while "computes the same sea" not in server.log() and time.monotonic() < deadline:
                time.sleep(0.05)
            time.sleep(1.5)
            server.process.send_signal(signal.SIGKILL)
            server.process.wait()
            out, err = viewer.communicate(timeout=PATIENCE_S)
        # What was written shows the sea as it was known, and the status says that it was not to the end.
        self.assertEqual(viewer.returncode, 1, err)
        self.assertIn("server gone", out + err)
        self.assertIn("before the end", err)
        red, _, blue = Picture(path).mean(0.7, 1.0)
        self.assertGreater(blue, red + 30, "the picture did not go on")

    def test_server_gone_for_longer_than_patience(self):
        with Server(scene("open-sea")) as server:
            viewer = subprocess.Popen([BIN / "trochoid-viewer", "--connect", server.address, "--offscreen", *SMALL, "--seconds", "600",
                                       "--patience", "3"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            deadline = time.monotonic() + PATIENCE_S
            while "computes the same sea" not in server.log() and time.monotonic() < deadline:
                time.sleep(0.05)
            server.process.send_signal(signal.SIGKILL)
            server.process.wait()
            _, err = viewer.communicate(timeout=PATIENCE_S)
        self.assertEqual(viewer.returncode, 1, err)
        self.assertIn("did not come back within --patience", err)

    def test_bad_options(self):
        self.assert_ends(run("trochoid-viewer", "--frobnicate"), 2, "--frobnicate")
        self.assert_ends(run("trochoid-viewer", "--connect", "nowhere", "--offscreen"), 2, "127.0.0.1:7421")
        self.assert_ends(run("trochoid-viewer", "--offscreen", "--size", "0x7"), 2, "--size")
        with Server(scene("open-sea")) as server:
            self.assert_ends(self.view(server, *SMALL, "--seconds", 0.5, "--picture", "/nowhere/a.png"), 2, "/nowhere")
        self.assert_ends(run("trochoid-viewer", "--mesher", "knitting"), 2, "patches, uniform, projected and coherent")
        self.assert_ends(run("trochoid-viewer", "--offscreen", "--preset", "doldrums"), 2, "calm, breeze, gale, storm, harbour")
        self.assert_ends(run("trochoid-viewer", "--help"), 0, "Usage", stream="stdout")
        self.assert_ends(run("trochoid-viewer", "--list-presets"), 0, "gale\t", stream="stdout")


if __name__ == "__main__":
    unittest.main()
