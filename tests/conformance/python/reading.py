"""Verifies a buffer and reads it (R-111 to R-114): FlatBuffers' layout, by the schema's types."""
import struct

from fbs import STRING, Scalar, Struct, Table, Union, Value
from refusal import Refusal

MAX_DEPTH = 16
MAX_TABLES = {b"TRCC": 16, b"TRCS": 2048, b"TRLE": 4096}

_u16 = struct.Struct("<H").unpack_from
_u32 = struct.Struct("<I").unpack_from
_i32 = struct.Struct("<i").unpack_from


class _Broken(Exception):
    """The buffer's layout is broken."""


class _Buffer:
    """One buffer being verified and read."""

    def __init__(self, data, max_tables):
        self.data = data
        self.left = max_tables
        self.unknown = None  # the first union with a tag that is not known

    def extent(self, at, size, align):
        if at < 0 or at % align or at + size > len(self.data):
            raise _Broken(f"{size} bytes at {at} are misaligned or outside of the buffer")

    def follow(self, at):
        self.extent(at, 4, 4)
        offset = _u32(self.data, at)[0]
        if offset == 0 or offset >= 1 << 31 or at + offset >= len(self.data):
            raise _Broken(f"the offset at {at} leads nowhere")
        return at + offset

    def table(self, kind, at, depth):
        """The Value of the table at `at`."""
        self.left -= 1
        if depth > MAX_DEPTH or self.left < 0:
            raise _Broken("too many tables, or nested too deep")
        self.extent(at, 4, 4)
        vtable = at - _i32(self.data, at)[0]
        self.extent(vtable, 2, 2)
        size = _u16(self.data, vtable)[0]
        if size % 2:
            raise _Broken(f"the vtable at {vtable} has an odd size")
        self.extent(vtable, size, 2)
        fields = {}
        for field in kind.fields:
            place = self.place(vtable, size, at, field.slot)
            if isinstance(field.kind, Union):
                tag_at = self.place(vtable, size, at, field.slot - 1)
                fields[field.name] = self.union(field.kind, tag_at, place, depth)
            elif place is None:
                fields[field.name] = field.default if isinstance(field.kind, Scalar) else None
            else:
                fields[field.name] = self.field(field.kind, place, depth)
        return Value(kind, fields)

    def place(self, vtable, size, at, slot):
        entry = 4 + 2 * slot
        offset = _u16(self.data, vtable + entry)[0] if entry + 2 <= size else 0
        return at + offset if offset else None

    def field(self, kind, at, depth):
        if isinstance(kind, Scalar):
            self.extent(at, kind.size, kind.align)
            return kind.unpack(self.data, at)[0]
        if isinstance(kind, Struct):
            self.extent(at, kind.size, kind.align)
            return kind.value._make(kind.layout.unpack_from(self.data, at))
        at = self.follow(at)
        return self.table(kind, at, depth + 1) if isinstance(kind, Table) else self.vector(kind, at, depth)

    def vector(self, kind, at, depth):
        self.extent(at, 4, 4)
        count, start = _u32(self.data, at)[0], at + 4
        element = kind.element
        if kind is STRING:
            self.extent(start, count + 1, 1)
            if self.data[start + count] != 0:
                raise _Broken(f"the string at {at} has no end")
            return bytes(self.data[start:start + count])
        if isinstance(element, Table) or element is STRING:
            self.extent(start, 4 * count, 4)
            places = [self.follow(start + 4 * n) for n in range(count)]
            return [self.table(element, p, depth + 1) if isinstance(element, Table) else self.vector(element, p, depth)
                    for p in places]
        # R-112 wants elements aligned; where there are none, nothing is.
        self.extent(start, element.size * count, element.align if count else 4)
        if isinstance(element, Struct):
            view = self.data[start:start + element.size * count]
            return [element.value._make(values) for values in element.layout.iter_unpack(view)]
        if element.form == "B":
            return bytes(self.data[start:start + count])
        return list(struct.unpack_from(f"<{count}{element.form}", self.data, start))

    def union(self, kind, tag_at, at, depth):
        """A Value, or None; a tag that is not known is remembered."""
        tag = 0
        if tag_at is not None:
            self.extent(tag_at, 1, 1)
            tag = self.data[tag_at]
        if not 1 <= tag <= len(kind.tables):
            self.unknown = self.unknown or f"{kind.name} {tag}"
            return None
        return None if at is None else self.table(kind.tables[tag - 1], self.follow(at), depth + 1)


def read(schema, data, identifier):
    """The envelope in a buffer as a Value; Refusal where R-111 to R-114 say so."""
    if len(data) < 8:
        raise Refusal("verification_failed", 111, f"{len(data)} bytes are no message")
    if bytes(data[4:8]) != identifier:
        raise Refusal("unknown_message", 111, f"the file identifier is {bytes(data[4:8])!r}")
    buffer = _Buffer(data, MAX_TABLES[identifier])
    try:
        envelope = buffer.table(schema.roots[identifier], buffer.follow(0), 1)
    except _Broken as broken:
        raise Refusal("verification_failed", 112, str(broken)) from None
    if envelope.size != len(data):
        raise Refusal("trailing_bytes", 113, f"{len(data)} bytes, the envelope says {envelope.size}")
    if buffer.unknown:
        raise Refusal("unknown_message", 114, f"there is no {buffer.unknown}")
    return envelope
