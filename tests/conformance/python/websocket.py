"""A WebSocket client (RFC 6455): one binary message is one payload."""
import base64
import hashlib
import os
import struct

from refusal import Refusal
from transport import Closed, Connection

GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
SUBPROTOCOL = "trochoid"
CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0, 1, 2, 8, 9, 10
LONGEST_ANSWER = 16384  # of HTTP


class WebSocket(Connection):
    """Payloads in binary messages, over a socket that is connected."""

    def __init__(self, sock, host):
        self._host = host
        self._message = None  # parts of a message that is not whole
        self._close = struct.pack(">H", 1000)  # what our close frame says
        super().__init__(sock)

    def begin(self):
        key = base64.b64encode(os.urandom(16))
        lines = ["GET / HTTP/1.1", f"Host: {self._host}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key.decode()}", "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Protocol: {SUBPROTOCOL}"]
        self._socket.sendall("".join(line + "\r\n" for line in lines + [""]).encode())
        status, fields = self._answer()
        if status != "101":
            raise Closed(f"the server answers HTTP {status} to the upgrade")
        expected = base64.b64encode(hashlib.sha1(key + GUID).digest()).decode()
        right = (fields.get("upgrade", "").lower() == "websocket" and fields.get("connection", "").lower() == "upgrade"
                 and fields.get("sec-websocket-accept") == expected and fields.get("sec-websocket-protocol") == SUBPROTOCOL
                 and "sec-websocket-extensions" not in fields)
        if not right:
            raise Closed(f"the server's answer to the upgrade is wrong: {fields}")

    def _answer(self):
        """Status and fields of the HTTP answer; what follows it stays."""
        while b"\r\n\r\n" not in self._arrived:
            data = self._socket.recv(4096)
            if not data or len(self._arrived) > LONGEST_ANSWER:
                raise Closed("the server does not answer the upgrade")
            self._arrived += data
        head, _, rest = bytes(self._arrived).partition(b"\r\n\r\n")
        self._arrived = bytearray(rest)
        first, *lines = head.decode("latin-1").split("\r\n")
        words = first.split()
        fields = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
        return (words[1] if len(words) > 1 else "?"), fields

    def send(self, payload):
        self._frame(BINARY, payload)

    def _frame(self, opcode, payload):
        size = len(payload)
        if size < 126:
            head = struct.pack(">BB", 128 | opcode, 128 | size)
        elif size < 65536:
            head = struct.pack(">BBH", 128 | opcode, 128 | 126, size)
        else:
            head = struct.pack(">BBQ", 128 | opcode, 128 | 127, size)
        mask = os.urandom(4)
        masked = (int.from_bytes(payload, "big") ^ int.from_bytes((mask * (size // 4 + 1))[:size], "big")).to_bytes(size, "big")
        self._socket.sendall(head + mask + masked)

    def next(self):
        while (frame := self._next_frame()) is not None:
            final, opcode, payload = frame
            if opcode == PING:
                self._frame(PONG, payload)
            elif opcode == CLOSE:
                self._close = payload[:2]
                code = struct.unpack(">H", payload[:2])[0] if len(payload) >= 2 else 0
                raise Closed(f"the server closes the WebSocket: {code} {payload[2:].decode(errors='replace')}")
            elif opcode in (CONTINUATION, BINARY):
                if (self._message is None) == (opcode == CONTINUATION):
                    self._break_off("fragments out of order")
                self._message = (self._message or b"") + payload
                if len(self._message) > self.limit:
                    raise Refusal("frame_too_long", 103, f"a WebSocket message of more than {self.limit} bytes")
                if final:
                    whole, self._message = self._message, None
                    return whole
            elif opcode == TEXT:
                raise Refusal("malformed_frame", 102, "a text message")
            elif opcode != PONG:
                self._break_off(f"a frame with opcode {opcode}")
        return None

    def _next_frame(self):
        """(final, opcode, payload), or None where it is not there whole."""
        data = self._arrived
        if len(data) < 2:
            return None
        size, at = data[1] & 127, 2
        if size >= 126:
            wide = 2 if size == 126 else 8
            if len(data) < 2 + wide:
                return None
            size, at = int.from_bytes(data[2:2 + wide], "big"), 2 + wide
        opcode = data[0] & 15
        if data[0] & 0x70 or data[1] & 128 or opcode >= CLOSE and (size > 125 or not data[0] & 128):
            self._break_off("a frame that no server may send")
        if size > self.limit:
            raise Refusal("frame_too_long", 103, f"a WebSocket frame of {size} bytes; the limit is {self.limit}")
        if len(data) < at + size:
            return None
        final, payload = bool(data[0] & 128), bytes(data[at:at + size])
        del data[:at + size]
        return final, opcode, payload

    def _break_off(self, what):
        """RFC 6455 is broken: a close frame is all that is left to say (R-105)."""
        self._close = struct.pack(">H", 1002)
        raise Closed(f"the server breaks RFC 6455: {what}")

    def close(self):
        try:
            self._frame(CLOSE, self._close)
        except OSError:
            pass
        super().close()
