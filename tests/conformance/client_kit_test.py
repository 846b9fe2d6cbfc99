"""The conformance kit's client half: both clients pass but for what is listed, clients that break the standard fail, each in its own way."""
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
BIN = pathlib.Path(os.environ.get("TROCHOID_BIN", HERE.parents[1] / "build/release/bin")).resolve()
KIT = BIN / "trochoid-conformance"
PROBE = f"exec {shlex.quote(str(BIN / 'trochoid-probe'))} --connect {{address}} --point 0,0 --watch --every 0.5"
SECOND = f"exec /usr/bin/python3 -B {shlex.quote(str(HERE / 'python/trochoid_client.py'))} --connect {{address}} --seconds 20"
PATIENCE_S = 280


def kit(*arguments):
    return subprocess.run([KIT, "client", *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE_S)


class Judged(unittest.TestCase):
    def verdicts(self, status, *arguments):
        """Cases by id, and what was printed."""
        with tempfile.TemporaryDirectory() as folder:
            report = pathlib.Path(folder) / "r.json"
            done = kit("--json", report, "--quiet", *arguments)
            self.assertEqual(done.returncode, status, done.stdout[-6000:] + done.stderr)
            return {c["id"]: c for c in json.loads(report.read_text())["cases"]}, done.stdout

    def conforms(self, command, listed):
        cases, printed = self.verdicts(0, "--run", command, "--expect-failures", HERE / listed, "--longest-wait", 4, "--timeout", 8)
        self.assertIn("conforms", printed)
        self.assertEqual(sorted(cases), sorted(kit("--list").stdout.split()))
        self.assertGreaterEqual(len(cases), 300)
        said = [c for c in cases.values() if c["close"]["verdict"] == "clean" and c["close"]["goodbye_us"] >= 0]
        self.assertGreater(len(said), 200, "most cases end in a goodbye of the client")
        return cases


class OwnProbe(Judged):
    def test_it_conforms(self):
        cases = self.conforms(PROBE, "expected-failures-probe.txt")
        self.assertEqual([c["id"] for c in cases.values() if c["verdict"] == "skipped"], [])


class SecondClient(Judged):
    def test_it_conforms(self):
        if subprocess.run(["/usr/bin/python3", "-c", "import flatbuffers"], capture_output=True).returncode != 0:
            print("python3-flatbuffers is missing")
            sys.exit(77)
        self.conforms(SECOND, "expected-failures-python.txt")


class BadClients(Judged):
    """A relay between the kit and trochoid-probe that spoils one thing."""

    def spoilt(self, how, *cases):
        """Ids that failed, with what the kit says of them."""
        command = PROBE.replace("{address}", "{here}")
        relay = f"exec {shlex.quote(sys.executable)} -B {shlex.quote(str(HERE / 'client_relay.py'))} {how} {{address}} {shlex.quote(command)}"
        only = [word for case in cases for word in ("--only", case)]
        judged, _ = self.verdicts(1, "--run", relay, "--timeout", 2, *only)
        return {name: c["reason"] for name, c in judged.items() if c["verdict"] == "failed"}

    def test_goodbyes_swallowed(self):
        failed = self.spoilt("no-goodbye", "R-116/ClockReply*", "R-116/SampleReply*", "R-102/word-*", "R-133/snapshot")
        self.assertEqual(set(failed), {"R-116/SampleReply-nan", "R-116/SampleReply-infinite", "R-102/word-1", "R-102/word-max"})
        self.assertTrue(all("no goodbye came" in reason for reason in failed.values()), failed)

    def test_acknowledgements_with_another_hash(self):
        failed = self.spoilt("other-hash", "R-133/snapshot", "R-134/there-and-back", "R-116/SampleReply-nan")
        self.assertEqual(set(failed), {"R-133/snapshot", "R-134/there-and-back"})
        self.assertTrue(all("R-133" in reason for reason in failed.values()), failed)

    def test_another_sea(self):
        failed = self.spoilt("other-answer", "R-205/known-answer-*", "R-133/snapshot")
        self.assertEqual(len(failed), 4, failed)
        self.assertTrue(all("R-205" in reason for reason in failed.values()), failed)

    def test_sequences_that_stand_still(self):
        failed = self.spoilt("same-sequence", "R-142/stamps", "R-101/*", "R-121/first-Delta")
        self.assertIn("R-125", failed.get("R-142/stamps", ""))
        self.assertEqual(len(failed), 1, failed)

    def test_no_magic(self):
        done = kit("--run", f"exec {sys.executable} -c \"import socket;h,p='{{address}}'.split(':');s=socket.create_connection((h,int(p)));"
                   "s.sendall(b'GET / HTTP/1.1\\r\\n\\r\\n');s.recv(9)\"", "--only", "R-133/snapshot", "--timeout", 1)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("R-101", done.stderr)

    def test_a_crash(self):
        judged, _ = self.verdicts(1, "--run", PROBE.removeprefix("exec ") + "; kill -SEGV $$", "--only", "R-121/no-retry", "--timeout", 2)
        self.assertIn("crashed", judged["R-121/no-retry"]["reason"])

    def test_options(self):
        for arguments in ((), ("--run", "x", "--listen", "1"), ("--only", "R-999/*", "--list"), ("--run", "exit 3", "--timeout", "0.1")):
            done = kit(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)


if __name__ == "__main__":
    if not KIT.exists():
        sys.exit(f"{KIT} is missing: build it, or set TROCHOID_BIN")
    unittest.main()
