"""Reads FlatBuffers schemas (.fbs) as far as the standard's use them: structs, tables, enums, unions.

Python's FlatBuffers runtime has no verifier; reading.py verifies buffers by what is read here.
"""
import collections
import pathlib
import re
import struct

SCALARS = {  # name: (struct format, size)
    "bool": ("B", 1), "byte": ("b", 1), "int8": ("b", 1), "ubyte": ("B", 1), "uint8": ("B", 1), "short": ("h", 2),
    "int16": ("h", 2), "ushort": ("H", 2), "uint16": ("H", 2), "int": ("i", 4), "int32": ("i", 4), "uint": ("I", 4),
    "uint32": ("I", 4), "float": ("f", 4), "float32": ("f", 4), "long": ("q", 8), "int64": ("q", 8), "ulong": ("Q", 8),
    "uint64": ("Q", 8), "double": ("d", 8), "float64": ("d", 8)}
TOKEN = re.compile(r"\w+|\"[^\"]*\"|[-+]?\d+|[{}\[\]:;=,]")


class Scalar:
    """A number, perhaps an enum's."""

    def __init__(self, name, base, values=None):
        self.name = name
        self.form, self.size = SCALARS[base]
        self.align = self.size
        self.values = values  # by name; None: any number
        self.is_float = self.form in "fd"
        self.unpack = struct.Struct("<" + self.form).unpack_from


class Struct:
    """A struct, flat: members of a struct in it are named outer_inner."""

    def __init__(self, name, members):
        self.name = name
        self.align = 1
        form, at = "<", 0
        self.members = []  # (name, Scalar)
        for member, kind in members:
            gap = -at % kind.align
            parts = [(member, kind)] if isinstance(kind, Scalar) else [(f"{member}_{n}", k) for n, k in kind.members]
            form += "x" * gap + (kind.form if isinstance(kind, Scalar) else kind.body)
            self.members += parts
            at += gap + kind.size
            self.align = max(self.align, kind.align)
        form += "x" * (-at % self.align)
        self.body = form[1:]
        self.size = at + -at % self.align
        self.value = collections.namedtuple(name, [n for n, _ in self.members])
        self.value.within = {member: kind.name for member, kind in members if isinstance(kind, Struct)}
        self.layout = struct.Struct(form)
        self.floats = [n for n, (_, kind) in enumerate(self.members) if kind.is_float]


class Vector:
    """[element]; a string is a vector of characters."""

    def __init__(self, element):
        self.element = element


class Field:
    """A field of a table; slot is its place in the vtable."""

    def __init__(self, name, kind, slot, default):
        self.name, self.kind, self.slot, self.default = name, kind, slot, default


class Table:
    """A table: its fields in order."""

    def __init__(self, name):
        self.name = name
        self.fields = []


class Union:
    """A union: tables[tag - 1]."""

    def __init__(self, name, tables):
        self.name, self.tables = name, tables


class Value:
    """A table that has been read: a field that is absent is None, or its default where it is a number."""

    def __init__(self, table, fields):
        self.of = table
        self.__dict__.update(fields)

    def __repr__(self):
        return f"{self.of.name}({', '.join(f'{f.name}={getattr(self, f.name)!r}' for f in self.of.fields)})"


STRING = Vector(None)


class Schema:
    """All types of some schema files; roots[file identifier] is a table."""

    def __init__(self, folder, files=("client.fbs", "server.fbs", "event.fbs")):
        self.types = {name: Scalar(name, name) for name in SCALARS}
        self.types["string"] = STRING
        self.roots = {}
        self._folder = pathlib.Path(folder)
        self._read = set()
        self._tables = []
        for name in files:
            self._file(name)
        for table, fields in self._tables:
            self._lay_out(table, fields)

    def codes(self):
        return self.types["Code"].values

    def _file(self, name):
        if name in self._read:
            return
        self._read.add(name)
        text = re.sub(r"//[^\n]*", "", (self._folder / name).read_text(encoding="utf-8"))
        words = collections.deque(TOKEN.findall(text))
        root = None
        while words:
            word = words.popleft()
            if word == "include":
                self._file(words.popleft().strip('"'))
            elif word == "root_type":
                root = words.popleft()
            elif word == "file_identifier":
                self.roots[words.popleft().strip('"').encode()] = self.types[root]
            elif word in ("struct", "table"):
                self._record(word, words)
            elif word in ("enum", "union"):
                self._choice(word, words)

    def _record(self, word, words):
        name = words.popleft()
        fields = []
        assert words.popleft() == "{"
        while words[0] != "}":
            field, colon, kind = (words.popleft() for _ in range(3))
            assert colon == ":"
            if kind == "[":
                kind = [words.popleft()]
                assert words.popleft() == "]"
            default = 0
            if words[0] == "=":
                words.popleft()
                default = int(words.popleft())
            assert words.popleft() == ";"
            fields.append((field, kind, default))
        words.popleft()
        if word == "struct":
            self.types[name] = Struct(name, [(field, self.types[kind]) for field, kind, _ in fields])
        else:
            self.types[name] = Table(name)
            self._tables.append((self.types[name], fields))

    def _choice(self, word, words):
        name = words.popleft()
        base = "ubyte"
        if words[0] == ":":
            words.popleft()
            base = words.popleft()
        assert words.popleft() == "{"
        entries, following = {}, 0
        while words[0] != "}":
            entry = words.popleft()
            if words[0] == "=":
                words.popleft()
                following = int(words.popleft())
            entries[entry] = following
            following += 1
            if words[0] == ",":
                words.popleft()
        words.popleft()
        self.types[name] = Union(name, list(entries)) if word == "union" else Scalar(name, base, entries)

    def _lay_out(self, table, fields):
        slot = 0
        for name, kind, default in fields:
            kind = Vector(self.types[kind[0]]) if isinstance(kind, list) else self.types[kind]
            if isinstance(kind, Union):
                kind.tables = [self.types.get(t, t) if isinstance(t, str) else t for t in kind.tables]
                slot += 1  # the tag has the slot before
            if default == 0 and isinstance(kind, Scalar) and kind.is_float:
                default = 0.0
            table.fields.append(Field(name, kind, slot, default))
            slot += 1
