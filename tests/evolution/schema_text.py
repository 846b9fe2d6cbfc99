"""Reads FlatBuffers schemas as far as ours go: namespace, include, table, struct, enum, union, root_type, file_identifier."""
import dataclasses
import re


class SchemaError(Exception):
    pass


@dataclasses.dataclass
class Field:
    name: str
    type: str
    default: str
    attributes: str


@dataclasses.dataclass
class Member:
    name: str
    value: int


@dataclasses.dataclass
class Type:
    kind: str  # table, struct, enum or union
    attributes: str = ""
    fields: list = dataclasses.field(default_factory=list)   # of tables and structs
    members: list = dataclasses.field(default_factory=list)  # of enums and unions
    type: str = ""                                           # of an enum's numbers


@dataclasses.dataclass
class Schema:
    types: dict = dataclasses.field(default_factory=dict)
    root: str = ""
    identifier: str = ""


# Two names of one type.
ALIASES = {"uint8": "ubyte", "int8": "byte", "uint16": "ushort", "int16": "short", "uint32": "uint", "int32": "int",
           "uint64": "ulong", "int64": "long", "float32": "float", "float64": "double"}
FIELD = re.compile(r"^(\w+)\s*:\s*(\[?\s*[\w.]+\s*(?::\d+)?\]?)\s*(?:=\s*([-\w.]+))?\s*(?:\(([^)]*)\))?$")
BLOCK = re.compile(r"\b(table|struct|enum|union)\s+(\w+)\s*(?::\s*(\w+))?\s*(?:\(([^)]*)\))?\s*\{([^}]*)\}")


def plain_type(text):
    text = re.sub(r"\s", "", text)
    return re.sub(r"\w+", lambda word: ALIASES.get(word[0], word[0]), text)


def read_fields(name, body):
    for line in filter(None, (part.strip() for part in body.split(";"))):
        found = FIELD.match(line)
        if not found:
            raise SchemaError(f"{name}: cannot read the field '{line}'")
        yield Field(found[1], plain_type(found[2]), found[3] or "", (found[4] or "").strip())


def read_members(name, body):
    value = -1
    for part in filter(None, (part.strip() for part in body.split(","))):
        found = re.match(r"^(\w+)\s*(?:=\s*(-?\d+))?$", part)
        if not found:
            raise SchemaError(f"{name}: cannot read the member '{part}'")
        value = int(found[2]) if found[2] else value + 1
        yield Member(found[1], value)


def read(path):
    """The schema of a file and of what it includes."""
    text = re.sub(r"//[^\n]*", "", path.read_text())
    schema = Schema()
    for name in re.findall(r'include\s+"([^"]+)"\s*;', text):
        schema.types.update(read(path.parent / name).types)
    for kind, name, numbers, attributes, body in BLOCK.findall(text):
        if name in schema.types:
            raise SchemaError(f"{path}: {name} comes twice")
        made = Type(kind, (attributes or "").strip(), type=plain_type(numbers or ""))
        if kind in ("table", "struct"):
            made.fields = list(read_fields(name, body))
        else:
            made.members = list(read_members(name, body))
        schema.types[name] = made
    rest = BLOCK.sub("", text)
    for word, value in re.findall(r"(\w+)\s+\"?([\w.]+)\"?\s*;", rest):
        if word == "root_type":
            schema.root = value
        elif word == "file_identifier":
            schema.identifier = value
        elif word not in ("namespace", "include"):
            raise SchemaError(f"{path}: cannot read '{word} {value}'")
    left = re.sub(r'\w+\s+"?[\w.]+"?\s*;', "", rest).strip()
    if left:
        raise SchemaError(f"{path}: cannot read '{left[:60]}'")
    return schema
