"""Connections: frames over TCP or TLS (R-101 to R-103)."""
import select
import socket
import ssl
import struct
import time

from refusal import Refusal

MAGIC = b"TROCHOID"
DEFAULT_LIMIT = 16384  # payload towards a client, until the hello says another

LINGER_S = 1.0


class Closed(Exception):
    """The other end has closed."""


def open_socket(host, port, tls, ca, patience_s):
    """A connected socket; tls and ca as the address says."""
    plain = socket.create_connection((host, port), timeout=patience_s)
    plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    if not tls:
        return plain
    context = ssl.create_default_context(cafile=ca)
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    return context.wrap_socket(plain, server_hostname=host)


class Connection:
    """Payloads in frames."""

    def __init__(self, sock):
        self.limit = DEFAULT_LIMIT
        self._socket = sock
        self._arrived = bytearray()
        self.begin()

    def begin(self):
        """What a client sends first."""
        self._socket.sendall(MAGIC)

    def send(self, payload):
        self._socket.sendall(struct.pack("<II", len(payload), 0) + payload)

    def receive(self, wait_s):
        """Waits at most so long for bytes; False where none came."""
        pending = isinstance(self._socket, ssl.SSLSocket) and self._socket.pending()
        if not pending and not select.select([self._socket], [], [], wait_s)[0]:
            return False
        try:
            data = self._socket.recv(65536)
        except ssl.SSLWantReadError:
            return False
        except OSError as error:
            raise Closed(str(error)) from None
        if not data:
            raise Closed("the server has closed the connection")
        self._arrived += data
        return True

    def next(self):
        """The next payload that is there whole, or None."""
        if len(self._arrived) < 8:
            return None
        length, zero = struct.unpack_from("<II", self._arrived)
        if zero or not length:
            raise Refusal("malformed_frame", 102, f"a frame of length {length} with {zero} after it")
        if length > self.limit:
            raise Refusal("frame_too_long", 103, f"a frame of {length} bytes; the limit is {self.limit}")
        if len(self._arrived) < 8 + length:
            return None
        payload = bytes(self._arrived[8:8 + length])
        del self._arrived[:8 + length]
        return payload

    def _say_close_notify(self):
        """R-106; what still comes counts no more."""
        try:
            self._socket = self._socket.unwrap()
        except OSError:
            pass

    def close(self):
        """Says that nothing more comes, and lets what was sent arrive: an end with bytes unread would throw it away."""
        deadline = time.monotonic() + LINGER_S
        try:
            self._socket.settimeout(LINGER_S)
            if isinstance(self._socket, ssl.SSLSocket):
                self._say_close_notify()
            self._socket.shutdown(socket.SHUT_WR)
            while time.monotonic() < deadline and self._socket.recv(65536):
                pass
        except OSError:
            pass
        self._socket.close()
