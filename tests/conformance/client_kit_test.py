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
sys.path.insert(0, str(HERE / "mutants"))
import client_mutants  # noqa: E402

BIN = pathlib.Path(os.environ.get("TROCHOID_BIN", HERE.parents[1] / "build/release/bin")).resolve()
KIT = BIN / "trochoid-conformance"
PROBE = f"exec {shlex.quote(str(BIN / 'trochoid-probe'))} --connect {{address}} --point 0,0 --watch --every 0.5"
TRUST = {"tls": " --ca {ca}", "ws": "", "wss": " --ca {ca}"}
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
        self.assertEqual([c["id"] for c in cases.values() if c["verdict"] == "skipped" and not c["reason"].startswith("needs ")], [])


class Transports(Judged):
    """Beginnings, refusals and ends over TLS and WebSockets. All other cases go there too: --transport."""

    def over(self, transport, client):
        cases, _ = self.verdicts(0, "--transport", transport, "--run", client + TRUST[transport], "--longest-wait", 4, "--timeout", 8, "--jobs", 8,
                                 "--only", "R-10*", "--only", "R-121/t*", "--only", "R-13*", "--only", "R-15*")
        passed = {name for name, c in cases.items() if c["verdict"] == "passed"}
        self.assertIn("R-104/speaks-first", passed)
        self.assertIn("R-133/snapshot", passed)
        # Those of the raw stream's bytes, else those of the transport that is not there.
        for requirement, there in (("R-102", transport == "tls"), ("R-105", transport != "tls"), ("R-106", transport != "ws")):
            self.assertEqual(any(name.startswith(requirement) for name in passed), there, requirement)

    def test_tls(self):
        self.over("tls", PROBE)

    def test_websocket(self):
        self.over("ws", PROBE)

    def test_websocket_inside_tls(self):
        self.over("wss", PROBE)


class SecondClient(Judged):
    def test_it_conforms(self):
        if subprocess.run(["/usr/bin/python3", "-c", "import flatbuffers"], capture_output=True).returncode != 0:
            print("python3-flatbuffers is missing")
            sys.exit(77)
        self.conforms(SECOND, "expected-failures-python.txt")
        for transport, trust in TRUST.items():
            self.verdicts(0, "--transport", transport, "--run", SECOND + trust, "--only", "R-10*", "--only", "R-133/snapshot", "--timeout", 8)


class BadClients(Judged):
    """Clients that break one requirement (mutants/): the kit fails them for that one. All of them: tests/bench/run R8."""

    def spoilt(self, name, requirement, *only):
        """Ids that failed, with what the kit says of them; each for this requirement."""
        report = client_mutants.judge(BIN, name, requirement, only, timeout_s=2, jobs=16)
        failed = {c["id"]: c for c in report["cases"] if c["verdict"] == "failed"}
        self.assertEqual({client_mutants.broken_of(c) for c in failed.values()}, {requirement} if requirement else set(), failed)
        return {name: c["reason"] for name, c in failed.items()}

    def test_the_honest_relay(self):
        self.spoilt("honest", "", "R-10*", "R-11[1-6]/*", "R-12*", "R-13*", "R-142/stamps", "R-15*", "R-2*")

    def test_what_it_forgives(self):
        failed = self.spoilt("client-forgives-116", "R-116", "R-116/*Reply*", "R-117/ClockReply*", "R-133/snapshot")
        self.assertEqual(set(failed), {"R-116/SampleReply-nan", "R-116/SampleReply-infinite"})
        self.assertTrue(all("no goodbye came" in reason for reason in failed.values()), failed)
        failed = self.spoilt("client-forgives-134", "R-134", "R-134/*", "R-121/two-hellos")
        self.assertIn("R-134/piece-skipped", failed)
        self.assertNotIn("R-134/pieces", failed)

    def test_acknowledgements_with_another_hash(self):
        failed = self.spoilt("client-other-hash", "R-133", "R-133/snapshot", "R-134/there-and-back", "R-116/SampleReply-nan")
        self.assertEqual(set(failed), {"R-133/snapshot", "R-134/there-and-back"})

    def test_another_sea(self):
        failed = self.spoilt("client-other-sea", "R-205", "R-205/*", "R-133/snapshot")
        self.assertEqual(set(failed), {f"R-205/known-answer-{count}" for count in (0, 1, 48, 100)})

    def test_sequences_that_stand_still(self):
        failed = self.spoilt("client-same-sequence", "R-125", "R-142/stamps", "R-101/*", "R-121/first-Delta")
        self.assertEqual(set(failed), {"R-142/stamps"})

    def test_no_magic(self):
        failed = self.spoilt("client-no-magic", "R-101", "R-101/*", "R-133/snapshot")
        self.assertEqual(set(failed), {"R-101/magic", "R-133/snapshot"})

    def test_what_lies_below_messages(self):
        failed = self.spoilt("client-forgives-105", "R-105", "R-105/*", "R-103/long*", "R-133/snapshot")
        self.assertEqual(set(failed), {"R-105/text", "R-105/masked", "R-105/reserved-bits", "R-105/reserved-opcode"})
        failed = self.spoilt("client-small-letters", "R-104", "R-104/*", "R-105/goodbye")
        self.assertEqual(set(failed), {"R-104/speaks-first", "R-105/goodbye"})
        failed = self.spoilt("client-split-hello", "R-106", "R-106/client-hello", "R-133/snapshot", "R-104/speaks-first")
        self.assertEqual(set(failed), {"R-106/client-hello", "R-133/snapshot"})
        failed = self.spoilt("client-no-close-notify", "R-106", "R-106/*", "R-121/two-hellos", "R-133/snapshot")
        self.assertEqual(set(failed), {"R-106/close-notify", "R-121/two-hellos"})

    def test_nobody_speaks(self):
        done = kit("--run", f"exec {sys.executable} -c \"import socket;h,p='{{address}}'.split(':');s=socket.create_connection((h,int(p)));"
                   "s.close()\"", "--only", "R-133/snapshot", "--timeout", 1)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("no client says hello", done.stderr)

    def test_a_crash(self):
        judged, _ = self.verdicts(1, "--run", PROBE.removeprefix("exec ") + "; kill -SEGV $$", "--only", "R-121/no-retry", "--timeout", 2)
        self.assertIn("crashed", judged["R-121/no-retry"]["reason"])

    def test_options(self):
        for arguments in ((), ("--run", "x", "--listen", "1"), ("--only", "R-999/*", "--list"), ("--run", "exit 3", "--timeout", "0.1"),
                          ("--run", "x {ca}"), ("--run", "x", "--transport", "udp")):
            done = kit(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)


if __name__ == "__main__":
    if not KIT.exists():
        sys.exit(f"{KIT} is missing: build it, or set TROCHOID_BIN")
    unittest.main()
