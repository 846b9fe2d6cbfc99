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
                 "--token-key", f"{self.key}.pub", *options], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
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
