"""The program against servers that are wrong: what it tells them, and its exit status."""
import json
import pathlib
import socket
import struct
import subprocess
import sys
import threading
import unittest

from fbs import Schema
from reading import read
from transport import MAGIC
from wire_test import SCHEMA, golden_messages
from writing import Writer

PROGRAM = pathlib.Path(__file__).resolve().parent / "trochoid_client.py"
PATIENCE_S = 60


def read_frames(stream, count):
    """The payloads of so many frames; fewer where the stream ends."""
    payloads = []
    while len(payloads) < count and len(head := stream.read(8)) == 8:
        payloads.append(stream.read(struct.unpack("<II", head)[0]))
    return payloads


class ProgramTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema, cls.writer = Schema(SCHEMA), Writer(SCHEMA)
        cls.golden = {name: data for direction, name, data in golden_messages() if direction == "server"}

    @classmethod
    def tearDownClass(cls):
        cls.writer.close()

    def hello(self, request, **changes):
        data = self.golden["hello"]
        body = self.writer.generated("ServerEnvelope").ServerEnvelopeT.InitFromBuf(data, int.from_bytes(data[:4], "little")).body
        body.clientStampUs = request.clock_stamp_us
        for name, value in changes.items():
            setattr(body, name, value)
        return self.writer.envelope(body, "Server")

    def serve(self, listener, answer, heard):
        """One session: `answer` makes bytes of the client's hello; all that comes is heard."""
        listener.settimeout(PATIENCE_S)
        sock, _ = listener.accept()
        sock.settimeout(PATIENCE_S)
        with sock, sock.makefile("rb") as stream:
            heard.append(stream.read(8))
            request = read(self.schema, read_frames(stream, 1)[0], b"TRCC").body
            heard.append(request)
            data = answer(request)
            if data is None:
                return
            sock.sendall(data)
            heard += [read(self.schema, payload, b"TRCC").body for payload in read_frames(stream, 1000)]

    def run_against(self, answer):
        """(exit status, report, what the server heard)."""
        heard = []
        with socket.create_server(("127.0.0.1", 0)) as listener:
            server = threading.Thread(target=self.serve, args=(listener, answer, heard))
            server.start()
            command = [sys.executable, "-B", str(PROGRAM), "--json", "--connect", f"127.0.0.1:{listener.getsockname()[1]}"]
            done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, stdin=subprocess.DEVNULL)
            server.join()
        self.assertEqual(done.stderr, "")
        return done.returncode, json.loads(done.stdout), heard

    @staticmethod
    def frame(payload):
        return struct.pack("<II", len(payload), 0) + payload

    def assert_told(self, answer, code, requirement):
        status, report, heard = self.run_against(answer)
        self.assertEqual(status, 3, report)
        self.assertEqual(heard[0], MAGIC)
        goodbye = heard[-1]
        self.assertEqual(goodbye.of.name, "Goodbye")
        self.assertEqual((goodbye.code, goodbye.requirement), (code, requirement), goodbye.message)
        self.assertEqual([body.of.name for body in heard[1:]].count("ClientHello"), 1)

    def test_a_frame_that_is_too_long(self):
        self.assert_told(lambda _: struct.pack("<II", 1 << 20, 0), 101, 103)

    def test_a_frame_without_its_zero(self):
        self.assert_told(lambda _: struct.pack("<II", 8, 1), 102, 102)

    def test_another_model(self):
        self.assert_told(lambda request: self.frame(self.hello(request, model=3)), 202, 141)

    def test_a_version_that_was_not_offered(self):
        self.assert_told(lambda request: self.frame(self.hello(request, protocol=9)), 201, 123)

    def test_two_hellos(self):
        self.assert_told(lambda request: 2 * self.frame(self.hello(request)), 110, 121)

    def test_a_result_out_of_order(self):
        self.assert_told(lambda request: self.frame(self.hello(request)) + self.frame(self.golden["delta"]), 109, 134)

    def test_a_server_that_refuses(self):
        status, report, heard = self.run_against(lambda _: self.frame(self.golden["goodbye"]))
        self.assertEqual(status, 1)
        self.assertIn("701", report["end"])
        self.assertNotIn("Goodbye", [body.of.name for body in heard[1:]])

    def test_a_server_that_goes_away(self):
        status, report, _ = self.run_against(lambda _: None)
        self.assertEqual(status, 1)
        self.assertIn("connection lost", report["end"])

    def test_wrong_options(self):
        nobody = ["--connect", "127.0.0.1:1"]
        for options in (["--connect", "nowhere"], nobody, [*nobody, "--schema", "/nowhere"]):
            done = subprocess.run([sys.executable, "-B", PROGRAM, *options], capture_output=True, text=True, timeout=PATIENCE_S)
            self.assertEqual(done.returncode, 2)
            self.assertIn("trochoid_client.py: ", done.stderr)


if __name__ == "__main__":
    unittest.main()
