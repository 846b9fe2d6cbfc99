"""Writes messages with the code that `flatc --python` makes of the schema; nothing of that code is kept."""
import importlib
import pathlib
import shutil
import subprocess
import sys
import tempfile

from fbs import Union, Value


def camel(name):
    """A field's name in the generated code."""
    head, *tail = name.split("_")
    return head + "".join(word.capitalize() for word in tail)


class Writer:
    """Generates the code and packs messages with it."""

    def __init__(self, schema_folder):
        if shutil.which("flatc") is None:
            raise FileNotFoundError("flatc is missing: install flatbuffers-compiler")
        import flatbuffers  # the Debian package python3-flatbuffers
        self._runtime = flatbuffers
        self._folder = tempfile.TemporaryDirectory(prefix="trochoid-schema.")
        files = sorted(map(str, pathlib.Path(schema_folder).glob("*.fbs")))
        if not files:
            raise FileNotFoundError(f"{schema_folder} holds no .fbs files")
        subprocess.run(["flatc", "--python", "--gen-object-api", "-I", str(schema_folder), "-o", self._folder.name, *files],
                       check=True, stdout=subprocess.DEVNULL)
        sys.path.insert(0, self._folder.name)

    def close(self):
        """Deletes the generated code."""
        if self._folder.name in sys.path:
            sys.path.remove(self._folder.name)
        self._folder.cleanup()

    def generated(self, name):
        """The module that flatc made of a type."""
        return importlib.import_module(f"trochoid.wire_fb.{name}")

    def make(self, name, /, **fields):
        """A struct or table; text may be given as str, names are those of the schema."""
        value = getattr(self.generated(name), f"{name}T")()
        for field, own in fields.items():
            if not hasattr(value, camel(field)):
                raise AttributeError(f"{name} has no {field}")
            setattr(value, camel(field), own)
        return value

    def again(self, value):
        """What has been read, as it was: a table or a struct."""
        if isinstance(value, Value):
            made = self.make(value.of.name, **{field.name: self.again(getattr(value, field.name)) for field in value.of.fields})
            for field in value.of.fields:
                if isinstance(field.kind, Union):
                    tags = getattr(self.generated(field.kind.name), field.kind.name)
                    setattr(made, camel(f"{field.name}_type"), getattr(tags, getattr(value, field.name).of.name))
            return made
        if hasattr(value, "_asdict"):
            return self._struct(type(value).__name__, value._asdict(), value.within)
        return [self.again(element) for element in value] if isinstance(value, list) else value

    def _struct(self, name, members, within=()):
        """A struct; members of structs `within` it are named outer_inner."""
        for outer in within:
            inner = {member: members.pop(member) for member in list(members) if member.startswith(outer + "_")}
            members[outer] = self._struct(within[outer], {member[len(outer) + 1:]: own for member, own in inner.items()})
        return self.make(name, **members)

    def envelope(self, body, direction="Client"):
        """The buffer of a message."""
        name = type(body).__name__[:-1]
        tag = getattr(getattr(self.generated(f"{direction}Body"), f"{direction}Body"), name)
        envelope = self.make(f"{direction}Envelope", body_type=tag, body=body, size=1)
        identifier = {"Client": b"TRCC", "Server": b"TRCS"}[direction]
        # `size` is that of the whole buffer, which does not depend on its value.
        envelope.size = len(self.pack(envelope, identifier))
        return self.pack(envelope, identifier)

    def message(self, name, /, **fields):
        """The buffer of a message to the server."""
        return self.envelope(self.make(name, **fields))

    def pack(self, envelope, identifier):
        """The buffer of an envelope as it is."""
        builder = self._runtime.Builder(256)
        builder.Finish(envelope.Pack(builder), file_identifier=identifier)
        return bytes(builder.Output())
