#!/usr/bin/python3 -B
"""Compares the message schemas of earlier protocol versions with today's, for what `flatc --conform` lets through.

usage: schema_lint.py [--root DIR]        lint protocol/schema against protocol/schema/history
       schema_lint.py --added VERSION     print what today's schema has beyond that version

Exit: 0 today's messages can be read by every program of an earlier version and theirs by ours; 1 not so, each reason on
a line of its own; 2 a file cannot be read. The rules are R-171 to R-174 of protocol/README.md.
"""
import argparse
import hashlib
import pathlib
import re
import sys

import schema_text

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOTS = ("client", "server", "event")  # values.fbs is included by all three


def of_tables(old, new, name):
    """Fields of a table: all there, in their places, unchanged; new ones behind them."""
    for place, field in enumerate(old.fields):
        if place >= len(new.fields):
            yield f"{name}.{field.name}: dropped (a field stays, even where nobody reads it any more)"
            continue
        now = new.fields[place]
        if now.name != field.name:
            if any(other.name == field.name for other in new.fields):
                yield f"{name}.{field.name}: no longer field {place} (new fields go to the end)"
            else:
                yield f"{name}.{field.name}: renamed or replaced by {now.name}"
            continue
        if now.type != field.type:
            yield f"{name}.{field.name}: type {field.type} became {now.type}"
        if now.default != field.default:
            yield f"{name}.{field.name}: default {field.default or 'none'} became {now.default or 'none'}"


def of_structs(old, new, name):
    if [(f.name, f.type) for f in old.fields] != [(f.name, f.type) for f in new.fields]:
        yield f"{name}: a struct never changes (make another one, and a new field of a table that holds it)"


def of_enums(old, new, name):
    if old.type != new.type:
        yield f"{name}: its numbers were {old.type} and are {new.type}"
    now = {member.name: member.value for member in new.members}
    numbers = {member.value: member.name for member in new.members}
    for member in old.members:
        if member.name not in now:
            if member.value in numbers:
                yield f"{name}.{member.name}: renamed to {numbers[member.value]}"
            else:
                yield f"{name}.{member.name}: removed"
        elif now[member.name] != member.value:
            yield f"{name}.{member.name}: was {member.value} and is {now[member.name]}"


def of_unions(old, new, name):
    for place, member in enumerate(old.members):
        now = new.members[place].name if place < len(new.members) else "nothing"
        if now != member.name:
            yield f"{name}.{member.name}: tag {place + 1} is {now} now (new members go to the end)"


RULES = {"table": of_tables, "struct": of_structs, "enum": of_enums, "union": of_unions}


def compare(old, new):
    """Reasons why programs of schema `old` and `new` do not understand each other."""
    for name, before in old.types.items():
        after = new.types.get(name)
        if after is None:
            yield f"{name}: removed or renamed"
        elif after.kind != before.kind:
            yield f"{name}: was a {before.kind} and is a {after.kind}"
        else:
            yield from RULES[before.kind](before, after, name)
    if old.root != new.root:
        yield f"root type {old.root} became {new.root}"
    if old.identifier != new.identifier:
        yield f"file identifier {old.identifier} became {new.identifier}"


def house_rules(schema):
    """What no version may have at all: it would bind every later one."""
    for name, kind in schema.types.items():
        if kind.attributes:
            yield f"{name}: attribute '{kind.attributes}' (none is used)"
        if kind.kind not in ("table", "struct"):
            continue
        for field in kind.fields:
            if field.attributes:
                yield (f"{name}.{field.name}: attribute '{field.attributes}' (required: older programs leave it out; id, "
                       "deprecated, key, …: places alone count)")


def added(old, new):
    """Names that the newer schemas have beyond the older ones."""
    before = {name: kind for schema in old for name, kind in schema.types.items()}
    names = set()
    for schema in new:
        for name, after in schema.types.items():
            if name not in before:
                names.add(f"{after.kind} {name}")
                continue
            parts = "fields" if after.kind in ("table", "struct") else "members"
            known = {part.name for part in getattr(before[name], parts)}
            names.update(f"{name}.{part.name}" for part in getattr(after, parts) if part.name not in known)
    return sorted(names)


def versions(root):
    """The frozen ones: (number, folder), ascending."""
    folders = (root / "protocol/schema/history").glob("v*")
    return sorted((int(folder.name[1:]), folder) for folder in folders if folder.is_dir())


def frozen_rules(root):
    """Every version that is still spoken is there, and none has changed since it was frozen."""
    header = (root / "protocol/units/version.hpp").read_text()
    least, most = (int(re.search(rf"protocol_version_{which} = (\d+)", header)[1]) for which in ("min", "max"))
    have = [number for number, _ in versions(root)]
    for number in range(least, most):
        if number not in have:
            yield f"protocol/schema/history/v{number}: missing, but programs of version {number} are still answered"
    stated = {}
    for line in (root / "protocol/schema/history/frozen.txt").read_text().splitlines():
        digest, name = line.split()
        stated[name] = digest
    for number, folder in versions(root):
        for file in sorted(folder.iterdir()):
            name = f"{folder.name}/{file.name}"
            if stated.pop(name, "") != hashlib.sha256(file.read_bytes()).hexdigest():
                yield f"protocol/schema/history/{name}: not as it was frozen (see the README there)"
    yield from (f"protocol/schema/history/{name}: gone" for name in stated)


def lint(root):
    for name in ROOTS:
        today = schema_text.read(root / "protocol/schema" / f"{name}.fbs")
        yield from house_rules(today)
        for number, folder in versions(root):
            old = schema_text.read(folder / f"{name}.fbs")
            for reason in compare(old, today):
                yield f"{name}.fbs against version {number}: {reason}"
    yield from frozen_rules(root)


def main():
    parser = argparse.ArgumentParser(prog="schema_lint.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=ROOT)
    parser.add_argument("--added", type=int, metavar="VERSION")
    options = parser.parse_args()
    try:
        if options.added is not None:
            folders = (options.root / f"protocol/schema/history/v{options.added}", options.root / "protocol/schema")
            old, new = ([schema_text.read(folder / f"{name}.fbs") for name in ROOTS] for folder in folders)
            print("\n".join(added(old, new)))
            return 0
        reasons = list(dict.fromkeys(lint(options.root)))
    except (OSError, schema_text.SchemaError) as error:
        print(f"schema_lint: {error}", file=sys.stderr)
        return 2
    for reason in reasons:
        print(f"schema_lint: {reason}")
    print(f"schema_lint: {len(versions(options.root))} frozen versions, {len(reasons)} violations")
    return 1 if reasons else 0


if __name__ == "__main__":
    sys.exit(main())
