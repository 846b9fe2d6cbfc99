"""This client against a running trochoid-server: the same sea to the bit, also while the sea is changed."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "system"))

from sea_programs import BIN, PATIENCE_S, Server, scene  # noqa: E402

GOLDEN_SEA = HERE.parents[1] / "golden/sea.txt"


class LiveTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not (BIN / "trochoid-server").exists():
            raise AssertionError(f"there is no trochoid-server in {BIN} (TROCHOID_BIN)")

    def start(self, server, *options):
        command = [sys.executable, "-B", HERE / "trochoid_client.py", "--json", "--connect", server.address, *options]
        client = subprocess.Popen(list(map(str, command)), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True)
        self.addCleanup(client.kill)
        return client

    def finish(self, client):
        out, err = client.communicate(timeout=PATIENCE_S)
        self.assertEqual(client.returncode, 0, out + err)
        report = json.loads(out)
        self.assertTrue(report["exact"])
        self.assertEqual((report["verdict"], report["hash_mismatches"]), ("exact", 0))
        self.assertEqual(report["samples"], report["samples_equal"])
        return report

    def test_waves_over_a_beach(self):
        with Server(scene("scenario-1")) as server:
            report = self.finish(self.start(server, "--seconds", 2))
            self.assertIn("computes the same sea (exact)", server.log())
        self.assertGreaterEqual(report["samples"], 48)
        self.assertGreater(min(report["boxes"], report["blocks"], report["patches"], report["tiles"]), 0)

    def test_another_sea_is_not_exact(self):
        text = GOLDEN_SEA.read_text(encoding="utf-8")
        other = text.replace("train 40018 8021 ", "train 40018 8022 ")
        self.assertNotEqual(other, text)
        with tempfile.TemporaryDirectory(prefix="trochoid-test.") as folder, Server(scene("scenario-1")) as server:
            sea = pathlib.Path(folder) / "sea.txt"
            sea.write_text(other, encoding="utf-8")
            client = self.start(server, "--seconds", 1, "--sea", sea)
            report = json.loads(client.communicate(timeout=PATIENCE_S)[0])
            self.assertEqual(client.returncode, 1)
        self.assertEqual((report["exact"], report["verdict"], report["end"]), (False, "approximate", ""))

    def test_islands(self):
        with Server(scene("scilly")) as server:
            report = self.finish(self.start(server, "--seconds", 1, "--patches", 128))
        self.assertGreater(report["blocks"], 1000)

    def test_wakes(self):
        with Server(scene("ship-wakes")) as server:
            # Where the ferry turns at time 0: close behind a ship, and in what is left of a wake.
            report = self.finish(self.start(server, "--seconds", 4, "--at", "240,60", "--requests", 6, "--spacing", 0.5))
        self.assertGreaterEqual(report["boxes"], 3)

    def test_going_on_with_what_is_held(self):
        with Server(scene("harbour")) as server:
            report = self.finish(self.start(server, "--seconds", 1, "--resume", "--patches", 256))
        self.assertEqual((report["resumed"], report["snapshots"]), (True, 0))

    @unittest.skipUnless(shutil.which("openssl"), "openssl, which makes the certificate, is missing")
    def test_every_way_to_connect(self):
        with tempfile.TemporaryDirectory(prefix="trochoid-test.") as folder:
            key, certificate = pathlib.Path(folder) / "key.pem", pathlib.Path(folder) / "certificate.pem"
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ed25519", "-nodes", "-keyout", key, "-out", certificate, "-days",
                            "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1"], check=True,
                           capture_output=True)
            with Server(scene("ship-wakes"), "--tls-cert", certificate, "--tls-key", key) as server:
                for scheme in ("tcp", "tls", "ws", "wss"):
                    with self.subTest(scheme=scheme):
                        options = "--seconds", 0, "--requests", 1, "--ca", certificate, "--connect", f"{scheme}://{server.address}"
                        self.finish(self.start(server, *options))

    def test_a_sea_that_changes(self):
        with Server(scene("harbour")) as server:
            client = self.start(server, "--seconds", 6, "--requests", 10, "--spacing", 0.5)
            time.sleep(1)
            for command in (
                    ("start-wind", "--speed", 25, "--towards", 90, "--origin", "-4000,0", "--fetch-km", 12, "--width-km", 10,
                     "--trains", 64, "--round", 0.3, "--irregular", 0.5, "--noise", 0.03, "--move-towards", 90, "--move-speed", 12),
                    ("start-ship", "--from", "0,0", "--towards", 200, "--speed", 9, "--length", 140),
                    ("breakwater", "--point", "200,-300", "--point", "450,-120", "--width", 15, "--crest", 4)):
                done = server.ctl(*command)
                self.assertEqual(done.returncode, 0, done.stderr)
            report = self.finish(client)
        self.assertGreater(report["results"], 3)
        self.assertGreater(report["boxes"], 3)
        self.assertGreaterEqual(report["sample_requests"], 8)


if __name__ == "__main__":
    unittest.main()
