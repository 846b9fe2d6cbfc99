"""The conformance kit: the project's own server passes, a server that is none fails, and the reports are what they claim to be."""
import json
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import xml.etree.ElementTree

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("TROCHOID_BIN", SOURCE / "build/release/bin")).resolve()
KIT = BIN / "trochoid-conformance"
PATIENCE_S = 150


def kit(*arguments):
    return subprocess.run([KIT, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE_S)


class Server:
    """A trochoid-server on a free port that takes tokens signed by `key`."""

    def __init__(self, scene, *options):
        self._folder = tempfile.TemporaryDirectory(prefix="trochoid-test.")
        folder = pathlib.Path(self._folder.name)
        self.key = folder / "key"
        subprocess.run([BIN / "trochoid-ctl", "token", "new-key", self.key], check=True, stdout=subprocess.DEVNULL)
        self.log_file = folder / "log"
        port_file = folder / "port"
        with open(self.log_file, "wb") as log:
            self.process = subprocess.Popen(
                [BIN / "trochoid-server", "--scene", SOURCE / "server/scenes" / scene / "scene.toml", "--port", "0", "--port-file", port_file,
                 "--token-key", f"{self.key}.pub", "--logins-per-address", "0", *options], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        deadline = time.monotonic() + PATIENCE_S
        while not (port_file.exists() and port_file.read_text().strip()):
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise AssertionError(f"the server did not start:\n{self.log_file.read_text()}")
            time.sleep(0.02)
        self.address = f"127.0.0.1:{re.search(r'[0-9]+', port_file.read_text()).group()}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(timeout=PATIENCE_S)
        self._folder.cleanup()
        assert status == 0, f"the server ended with {status}"


class OwnServer(unittest.TestCase):
    def passes(self, scene):
        with Server(scene) as server, tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            done = kit("server", "--connect", server.address, "--sign-with", server.key, "--quiet", "--junit", folder / "r.xml",
                       "--json", folder / "r.json", "--html", folder / "r.html")
            self.assertEqual(done.returncode, 0, done.stdout[-8000:] + done.stderr)
            self.assertIn("conforms", done.stdout)
            return (xml.etree.ElementTree.parse(folder / "r.xml").getroot(), json.loads((folder / "r.json").read_text()),
                    (folder / "r.html").read_text())

    def test_open_sea_and_the_reports(self):
        listed = kit("server", "--list").stdout.split()
        self.assertEqual(len(set(listed)), len(listed), "ids are unique")
        self.assertGreaterEqual(len(listed), 300)
        junit, as_json, html = self.passes("open-sea")
        cases = junit.findall("testsuite/testcase")
        self.assertEqual(sorted(f"{c.get('classname')}/{c.get('name')}" for c in cases), sorted(listed))
        self.assertEqual(int(junit.get("tests")), len(listed))
        self.assertEqual(int(junit.get("failures")), 0)
        self.assertEqual(int(junit.get("skipped")), len(junit.findall("testsuite/testcase/skipped")))
        self.assertTrue(as_json["conforms"])
        self.assertEqual(as_json["format"], "trochoid-conformance 1")
        self.assertEqual(sorted(c["id"] for c in as_json["cases"]), sorted(listed))
        self.assertEqual(sum(as_json["verdicts"].values()), len(listed))
        closed = [c for c in as_json["cases"] if c["close"]["verdict"] == "clean"]
        self.assertGreater(len(closed), 300, "cases that end in a goodbye have a close verdict of their own")
        self.assertTrue(all(c["close"]["goodbye_us"] >= 0 and c["close"]["end_us"] >= 0 for c in closed))
        for word in ("<!doctype html>", "R-117", "conforms", "By requirement"):
            self.assertIn(word, html)
        self.assertNotIn("http://", html, "the page needs nothing from elsewhere")
        self.assertNotIn("https://", html)

    def test_a_scene_with_land(self):
        self.passes("harbour")


class Transports(unittest.TestCase):
    """The same cases over each way to a server."""

    def test_every_way(self):
        with tempfile.TemporaryDirectory() as folder:
            certificate, key = f"{folder}/cert.pem", f"{folder}/key.pem"
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2",
                            "-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1,DNS:localhost", "-keyout", key, "-out",
                            certificate], check=True, capture_output=True)
            with Server("open-sea", "--tls-cert", certificate, "--tls-key", key) as server:
                for scheme, trust in (("tls", ("--ca", certificate)), ("ws", ()), ("wss", ("--ca", certificate))):
                    with self.subTest(scheme=scheme):
                        self.passes(f"{scheme}://{server.address}", trust, server.key)
                nobody = kit("server", "--connect", f"tls://{server.address}", "--only", "R-106/*")
                self.assertEqual(nobody.returncode, 2, "a certificate of our own is trusted by nobody else")
                self.assertIn("self-signed", nobody.stderr)

    def passes(self, address, trust, key):
        chosen = [word for glob in ("R-10*", "R-121/*", "R-133/*", "R-142/*", "R-204/place") for word in ("--only", glob)]
        with tempfile.TemporaryDirectory() as folder:
            report = pathlib.Path(folder) / "r.json"
            done = kit("server", "--connect", address, *trust, "--sign-with", key, "--quiet", "--json", report, *chosen)
            self.assertEqual(done.returncode, 0, done.stdout[-4000:] + done.stderr)
            cases = json.loads(report.read_text())["cases"]
        skipped = [c for c in cases if c["verdict"] == "skipped"]
        for word, count in (("frames of a plain stream", 10 if address.startswith("ws") else 0), ("needs TLS", 0 if trust else 10)):
            found = [c["id"] for c in skipped if word in c["reason"]]
            self.assertGreaterEqual(len(found), count, address)
            self.assertTrue(count or not found, found)
        self.assertGreater(sum(c["verdict"] == "passed" for c in cases), 80)


class Vectors(unittest.TestCase):
    """Golden vectors out of the program alone, and the second client as the stranger that reproduces them."""
    STRANGER = SOURCE / "tests/conformance/python/golden_check.py"

    def answers(self, *groups):
        questions = kit("vectors", "--questions", *groups).stdout
        done = subprocess.run(["/usr/bin/python3", "-B", self.STRANGER], input=questions, capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def judged(self, answers, *arguments):
        return subprocess.run([KIT, "check-vectors", "-", *map(str, arguments)], input=answers, capture_output=True, text=True,
                              timeout=PATIENCE_S)

    def test_they_are_the_files(self):
        printed = kit("vectors").stdout
        for name in ("wire_messages", "sea", "edges", "fields", "wire_clock"):
            self.assertIn((SOURCE / f"tests/golden/{name}.txt").read_text(), printed)
        self.assertEqual(kit("vectors", "clock").stdout, "vectors clock\n" + (SOURCE / "tests/golden/wire_clock.txt").read_text())

    def test_the_second_client_reproduces_them(self):
        groups = ["evaluation", "fields", "clock"]
        if subprocess.run(["/usr/bin/python3", "-c", "import flatbuffers"], capture_output=True).returncode == 0:
            groups.append("encoding")
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            done = self.judged(self.answers(*groups), *groups, "--json", folder / "r.json", "--junit", folder / "r.xml", "--html",
                               folder / "r.html")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            report = json.loads((folder / "r.json").read_text())
            self.assertEqual(report["side"], "vectors")
            self.assertTrue({"R-142", "R-201", "R-202", "R-203", "R-204", "R-205"} <= set(report["requirements"]))
            listed = kit("check-vectors", "-", *groups, "--list").stdout.split()
            self.assertEqual(sorted(c["id"] for c in report["cases"]), sorted(listed))
            self.assertEqual(int(xml.etree.ElementTree.parse(folder / "r.xml").getroot().get("tests")), len(listed))
            self.assertIn("R-205/fields-land", (folder / "r.html").read_text())

    def test_a_wrong_bit_and_a_missing_line(self):
        lines = self.answers("evaluation", "fields", "clock").splitlines()
        bent = next(i for i, line in enumerate(lines) if line.startswith("land "))
        lines[bent] = lines[bent][:-1] + ("0" if lines[bent][-1] != "0" else "1")
        del lines[next(i for i, line in enumerate(lines) if line.startswith("reading "))]
        done = self.judged("\n".join(lines), "evaluation", "fields", "clock", "--quiet")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("R-205/fields-land  failed", done.stdout)
        self.assertIn("R-142/clock-reading  failed", done.stdout)
        self.assertIn("2 failed", done.stdout)

    def test_what_is_no_answer(self):
        for answers in ("sincos 0 0 0\n", "vectors nothing\n", "vectors sea\nsincos 77 0 0\n", "vectors fields\nland 1 0\n",
                        "vectors messages\nserver nosuch 00\n", "vectors sea\nsincoss 0 1\n"):
            done = self.judged(answers)
            self.assertEqual(done.returncode, 2, answers)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)


class Pretender:
    """A server that answers every connection the same way, whatever comes."""

    def __init__(self, answer):
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._socket.getsockname()[1]}"
        self._answer = answer
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            try:
                peer, _ = self._socket.accept()
            except OSError:
                return
            threading.Thread(target=self._answer, args=(peer,), daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()


class Relay(Pretender):
    """Hands everything on to a real server, and its answers back through `change`, frame by frame."""

    def __init__(self, server, change):
        host, port = server.address.split(":")
        self._to = (host, int(port))
        self._change = change
        super().__init__(self._relay)

    def _relay(self, peer):
        with peer, socket.create_connection(self._to) as server:
            threading.Thread(target=self._pump, args=(peer, server), daemon=True).start()
            stream = server.makefile("rb")
            try:
                while header := stream.read(8):
                    payload = stream.read(struct.unpack("<I", header[:4])[0])
                    peer.sendall(self._change(header, payload))
                peer.shutdown(socket.SHUT_WR)
                while peer.recv(65536):
                    pass
            except OSError:
                pass

    @staticmethod
    def _pump(source, sink):
        try:
            while data := source.recv(65536):
                sink.sendall(data)
            sink.shutdown(socket.SHUT_WR)
        except OSError:
            pass


class BadServers(unittest.TestCase):
    def judged(self, relay, *arguments):
        """Ids that failed."""
        with tempfile.TemporaryDirectory() as folder:
            report = pathlib.Path(folder) / "r.json"
            done = kit("server", "--connect", relay.address, "--timeout", 1, "--json", report, "--quiet", *arguments)
            self.assertEqual(done.returncode, 1, done.stdout[-3000:] + done.stderr)
            return {c["id"]: c for c in json.loads(report.read_text())["cases"] if c["verdict"] == "failed"}

    def test_an_echo_is_no_server(self):
        def echo(peer):
            with peer:
                while data := peer.recv(65536):
                    peer.sendall(data)

        with Pretender(echo) as server:
            done = kit("server", "--connect", server.address, "--timeout", 1)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn("no session", done.stderr)

    def test_nobody_there(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            done = kit("server", "--connect", f"127.0.0.1:{taken.getsockname()[1]}")
            self.assertEqual(done.returncode, 2)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_goodbyes_swallowed(self):
        def without_goodbyes(header, payload):
            return b"" if self.is_goodbye(payload) else header + payload

        with Server("open-sea") as server, Relay(server, without_goodbyes) as relay:
            failed = self.judged(relay, "--only", "R-116/view-v*", "--only", "R-124/r*")
            self.assertEqual(len(failed), 9, failed.keys())
            self.assertEqual({c["close"]["verdict"] for c in failed.values()}, {"no goodbye"})

    @staticmethod
    def is_goodbye(payload):
        """The tag of the envelope's body: its second field, behind the vtable."""
        root = struct.unpack_from("<I", payload)[0]
        vtable = root - struct.unpack_from("<i", payload, root)[0]
        tag = struct.unpack_from("<H", payload, vtable + 6)[0]
        return tag != 0 and payload[root + tag] == 9

    def test_a_byte_changed_in_each_result(self):
        def bent(header, payload):
            if len(payload) < 400 or self.is_goodbye(payload):
                return header + payload
            return header + payload[:-40] + bytes([payload[-40] ^ 1]) + payload[-39:]

        with Server("open-sea") as server, Relay(server, bent) as relay:
            done = kit("server", "--connect", relay.address, "--timeout", 1, "--only", "R-204/place", "--only", "R-134/ascending")
            self.assertNotEqual(done.returncode, 0, done.stdout)

    def test_expected_failures(self):
        with Server("open-sea") as server, tempfile.TemporaryDirectory() as folder:
            listed = pathlib.Path(folder) / "expected"
            listed.write_text("# known\nR-124/rig* passes, so this line is out of date\n")
            arguments = ("server", "--connect", server.address, "--only", "R-124/*", "--expect-failures", listed)
            done = kit(*arguments)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("unexpected pass", done.stdout)
            self.assertEqual(kit(*arguments, "--forgive-passes").returncode, 0)
            listed.write_text("R-124/right\n")
            done = kit(*arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(f"{listed}:1: say why", done.stderr)

    def test_options(self):
        self.assertEqual(kit("--help").returncode, 0)
        self.assertEqual(kit("--version").returncode, 0)
        for arguments in ((), ("server", "--frobnicate"), ("server", "--only", "R-999/*", "--list"), ("server", "--connect", "nowhere"),
                          ("server", "--sign-with", "/nowhere/key")):
            done = kit(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertTrue(done.stderr.startswith("trochoid-conformance: "), done.stderr)


if __name__ == "__main__":
    if not KIT.exists():
        sys.exit(f"{KIT} is missing: build it, or set TROCHOID_BIN")
    unittest.main()
