"""Frames, WebSocket and TLS: against the other end of a pair of sockets."""
import base64
import hashlib
import os
import pathlib
import shutil
import socket
import ssl
import struct
import subprocess
import tempfile
import threading
import unittest

from refusal import Refusal
from transport import MAGIC, Closed, Connection, open_socket
from websocket import GUID, WebSocket


class FramesTest(unittest.TestCase):
    def setUp(self):
        self.server, client = socket.socketpair()
        self.server.settimeout(5)
        self.connection = Connection(client)
        self.assertEqual(self.server.recv(8), MAGIC)

    def tearDown(self):
        self.server.close()
        self.connection.close()

    def next_of(self, data):
        self.server.sendall(data)
        self.connection.receive(5)
        return self.connection.next()

    def test_frames_in_parts(self):
        self.assertIsNone(self.next_of(struct.pack("<II", 3, 0) + b"ab"))
        self.assertEqual(self.next_of(b"c" + struct.pack("<II", 1, 0) + b"d"), b"abc")
        self.assertEqual(self.connection.next(), b"d")
        self.connection.send(b"xyz")
        self.assertEqual(self.server.recv(99), struct.pack("<II", 3, 0) + b"xyz")

    def test_bad_frames(self):
        for head, code in (((0, 0), "malformed_frame"), ((5, 1), "malformed_frame"), ((16385, 0), "frame_too_long")):
            with self.assertRaises(Refusal) as caught:
                self.next_of(struct.pack("<II", *head))
            self.assertEqual(caught.exception.code, code)
            self.tearDown()
            self.setUp()


def accept_upgrade(sock, **changes):
    """A server's half of the upgrade; changes replace fields of the answer."""
    request = b""
    while b"\r\n\r\n" not in request:
        request += sock.recv(4096)
    lines = dict(line.split(": ", 1) for line in request.decode().split("\r\n")[1:] if line)
    accept = base64.b64encode(hashlib.sha1(lines["Sec-WebSocket-Key"].encode() + GUID).digest()).decode()
    fields = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Accept": accept, "Sec-WebSocket-Protocol": "trochoid"}
    fields.update(changes)
    head = "".join(f"{name.replace('_', '-')}: {value}\r\n" for name, value in fields.items())
    sock.sendall(f"HTTP/1.1 101 Switching Protocols\r\n{head}\r\n".encode())


def unmasked(sock):
    """(opcode, payload) of a client's frame."""
    first, second = sock.recv(2)
    size = second & 127
    if size == 126:
        size = struct.unpack(">H", sock.recv(2))[0]
    mask = sock.recv(4)
    data = b""
    while len(data) < size:
        data += sock.recv(size - len(data))
    assert second & 128 and first & 0x70 == 0
    return first & 15, bytes(byte ^ mask[n % 4] for n, byte in enumerate(data))


class WebSocketTest(unittest.TestCase):
    def connect(self, **changes):
        self.server, client = socket.socketpair()
        self.server.settimeout(5)
        self.addCleanup(self.server.close)
        self.addCleanup(client.close)
        other = threading.Thread(target=accept_upgrade, args=(self.server,), kwargs=changes)
        other.start()
        try:
            return WebSocket(client, "localhost:1")
        finally:
            other.join()

    def test_messages_both_ways(self):
        web = self.connect()
        for size in (1, 125, 126, 3000):
            payload = os.urandom(size)
            web.send(payload)
            self.assertEqual(unmasked(self.server), (2, payload))
        self.server.sendall(bytes((2, 2)) + b"ab" + bytes((0x89, 1)) + b"p" + bytes((0x80, 126, 0, 200)) + bytes(200))
        web.receive(5)
        self.assertEqual(web.next(), b"ab" + bytes(200))
        self.assertEqual(unmasked(self.server), (10, b"p"))
        self.server.sendall(bytes((0x88, 2, 3, 0xE8)))
        web.receive(5)
        with self.assertRaises(Closed):
            web.next()
        self.server.shutdown(socket.SHUT_WR)
        web.close()
        self.assertEqual(unmasked(self.server)[0], 8)

    def test_frames_that_are_refused(self):
        for data, code in (
                ((0x81, 1, 65), "malformed_frame"), ((0x82, 126, 0x40, 1), "frame_too_long"),
                ((0x82, 127, 0, 0, 0, 1, 0, 0, 0, 0), "frame_too_long")):
            web = self.connect()
            self.server.sendall(bytes(data))
            web.receive(5)
            with self.assertRaises(Refusal) as caught:
                web.next()
            self.assertEqual(caught.exception.code, code, data)

    def test_frames_that_break_rfc_6455(self):
        for data in ((0x80, 1, 65), (0xC2, 1, 65), (0x83, 1, 65), (0x82, 0x81, 0, 0, 0, 0, 65), (0x09, 0), (0x02, 1, 65, 0x82, 1, 65)):
            web = self.connect()
            self.server.sendall(bytes(data))
            web.receive(5)
            with self.assertRaises(Closed):
                web.next()
            self.server.shutdown(socket.SHUT_WR)
            web.close()
            self.assertEqual(unmasked(self.server), (8, struct.pack(">H", 1002)), data)

    def test_upgrades_that_are_wrong(self):
        for changes in ({"Sec_WebSocket_Accept": "x"}, {"Upgrade": "h2c"}, {"Sec-WebSocket-Protocol": "chat"},
                        {"Sec_WebSocket_Extensions": "permessage-deflate"}):
            with self.assertRaises(Closed):
                self.connect(**changes)


@unittest.skipUnless(shutil.which("openssl"), "openssl, which makes the certificate, is missing")
class TlsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="trochoid-tls.")
        self.addCleanup(folder.cleanup)
        self.key, self.certificate = (pathlib.Path(folder.name) / name for name in ("key.pem", "certificate.pem"))
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ed25519", "-nodes", "-keyout", self.key, "-out", self.certificate,
                        "-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"],
                       check=True, capture_output=True)

    def serve(self, listener, newest):
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(self.certificate, self.key)
        context.maximum_version = newest
        try:
            with context.wrap_socket(listener.accept()[0], server_side=True) as sock:
                self.heard = sock.recv(8)
                sock.sendall(struct.pack("<II", 3, 0) + b"abc")
        except OSError:
            self.heard = b""

    def open(self, ca, newest=ssl.TLSVersion.TLSv1_3):
        with socket.create_server(("localhost", 0)) as listener:
            server = threading.Thread(target=self.serve, args=(listener, newest))
            server.start()
            try:
                connection = Connection(open_socket("localhost", listener.getsockname()[1], True, ca, 5))
                self.addCleanup(connection.close)
                while (payload := connection.next()) is None:
                    connection.receive(5)
                return payload
            finally:
                server.join()

    def test_a_server_that_is_trusted(self):
        self.assertEqual(self.open(self.certificate), b"abc")
        self.assertEqual(self.heard, MAGIC)

    def test_servers_that_are_not(self):
        with self.assertRaises(ssl.SSLError):
            self.open(None)
        with self.assertRaises(ssl.SSLError):
            self.open(self.certificate, ssl.TLSVersion.TLSv1_2)


if __name__ == "__main__":
    unittest.main()
