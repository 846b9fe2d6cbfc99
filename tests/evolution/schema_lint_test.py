#!/usr/bin/python3 -B
"""schema_lint.py names every kind of violation, and lets pass what may change. `flatc --conform` beside it: what it misses.

usage: schema_lint_test.py [--flatc PROGRAM]
"""
import argparse
import contextlib
import io
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest.mock

import schema_lint

ROOT = pathlib.Path(__file__).resolve().parents[2]

# file, text in it, what takes its place, words of the reason (empty: legal)
CHANGES = (
    ("client", "  world:string;\n", "  fresh_between:int32;\n  world:string;\n", "no longer field"),
    ("client", "  patches_per_second:uint32;\n", "", "no longer field"),
    ("client", "  towards_degrees:float;\n  speed:float; ", "  speed:float; ", "Steer.towards_degrees"),
    ("client", "  has_known_answer:bool;\n  known_answer:uint64;\n", "  has_known_answer:bool;\n", "known_answer: dropped"),
    ("client", "  model:uint16;\n", "  sea_model:uint16;\n", "renamed or replaced by sea_model"),
    ("client", "  protocol_min:uint16;\n  protocol_max:uint16;\n", "  protocol_max:uint16;\n  protocol_min:uint16;\n",
     "protocol_min: no longer field 0"),
    ("client", "  token:string;\n", "  token:[ubyte];\n", "type string became [ubyte]"),
    ("client", "  client_sent_us:int64;\n", "  client_sent_us:uint64;\n", "type long became ulong"),
    ("client", "  rate_q16:uint32;\n", "  rate_q16:uint32 = 65536;\n", "default none became 65536"),
    ("client", "  token:string;\n", "  token:string (required);\n", "attribute 'required'"),
    ("client", "  token:string;\n", "  token:string (deprecated);\n", "attribute 'deprecated'"),
    ("client", "  known_answer:uint64;\n", "  known_answer:uint64;\n  must:string (required);\n", "attribute 'required'"),
    ("client", "  StopWind,\n", "", "Action.StopWind: tag 2"),
    ("client", "  StartWind,\n  StopWind,\n", "  StopWind,\n  StartWind,\n", "Action.StartWind: tag 1"),
    ("client", "  Goodbye,\n  Probe", "  Probe,\n  Goodbye", "ClientBody.Goodbye: tag 9"),
    ("client", "table RaysRequest", "table RayRequest", "RaysRequest: removed or renamed"),
    ("client", 'file_identifier "TRCC"', 'file_identifier "TRCX"', "file identifier TRCC became TRCX"),
    ("client", "root_type ClientEnvelope", "root_type Command", "root type ClientEnvelope became Command"),
    ("values", "  radius:uint32; ", "  radius:uint32;\n  depth:uint32; ", "Region: a struct never changes"),
    ("values", "  qx:float;\n  qy:float;\n", "  qy:float;\n  qx:float;\n", "View: a struct never changes"),
    ("values", "  amplitude:float;         // m\n  choppiness:float;\n", "  amplitude:float;\n  chop:float;\n",
     "Train: a struct never changes"),
    ("values", "struct Hull", "table Hull", "Hull: was a struct and is a table"),
    ("values", "  too_late = 604,\n", "", "Code.too_late: removed"),
    ("values", "  too_late = 604,\n", "  later = 604,\n", "Code.too_late: renamed to later"),
    ("values", "  too_late = 604,\n", "  too_late = 644,\n", "Code.too_late: was 604 and is 644"),
    ("values", "enum Code : uint16", "enum Code : uint32", "its numbers were ushort and are uint"),
    ("server", "  viewer = 0,\n  director = 1", "  director = 0,\n  viewer = 1", "Role.viewer: was 0"),
    ("event", " = 2305843009213693952;", ";", "present_us: default 2305843009213693952 became none"),
    # What may change.
    ("client", "  known_answer:uint64;\n", "  known_answer:uint64;\n  later_one:uint64;\n", ""),
    ("client", "  Desync\n", "  Desync,\n  Ship2\n", ""),
    ("client", "table ListBoxes {\n", "table Ship2 { a:int; }\ntable ListBoxes {\n  filter:string;\n", ""),
    ("values", "  internal_error = 702\n", "  internal_error = 702,\n  out_of_room = 703\n", ""),
    ("client", "  rate_q16:uint32;\n", "  rate_q16 : uint ;  // now with a comment\n", ""),
)


def copy_of(folder):
    root = pathlib.Path(folder)
    shutil.copytree(ROOT / "protocol/schema", root / "protocol/schema")
    (root / "protocol/units").mkdir()
    shutil.copy(ROOT / "protocol/units/version.hpp", root / "protocol/units")
    return root


def flatc_objects(flatc, root):
    """Whether `flatc --conform` sees anything wrong."""
    return any(subprocess.run((flatc, "--conform", root / f"protocol/schema/history/v2/{name}.fbs",
                               root / f"protocol/schema/{name}.fbs"), capture_output=True).returncode for name in schema_lint.ROOTS)


def change(root, name, old, new):
    path = root / f"protocol/schema/{name}.fbs"
    text = path.read_text()
    assert old in text, f"{name}.fbs no longer has {old!r}: give this test another place to change"
    path.write_text(text.replace(old, new, 1))


def check_changes(flatc):
    wrong, illegal, seen_by_flatc = [], 0, 0
    for name, old, new, words in CHANGES:
        with tempfile.TemporaryDirectory() as folder:
            root = copy_of(folder)
            change(root, name, old, new)
            if new.endswith("Ship2\n"):
                change(root, name, "union ClientBody", "table Ship2 { a:int; }\nunion ClientBody")
            reasons = list(schema_lint.lint(root))
            if words:
                illegal += 1
                seen_by_flatc += bool(flatc) and flatc_objects(flatc, root)
            if bool(words) != bool(reasons) or (words and not any(words in reason for reason in reasons)):
                wrong.append(f"{name}.fbs {old!r} -> {new!r}: wanted '{words or 'nothing'}', got {reasons}")
    print(f"{illegal} kinds of violations; flatc --conform sees {seen_by_flatc if flatc else '(not tried)'}")
    return wrong


def check_frozen():
    """A frozen version that changes, goes, or is missing."""
    wrong = []
    spoils = (("not as it was frozen", lambda root: (root / "protocol/schema/history/v2/client.fbs").open("a").write("\n")),
              ("gone", lambda root: (root / "protocol/schema/history/v2/messages.txt").unlink()),
              ("missing, but programs of version", lambda root: shutil.rmtree(root / "protocol/schema/history/v2")))
    for words, spoil in spoils:
        with tempfile.TemporaryDirectory() as folder:
            root = copy_of(folder)
            spoil(root)
            reasons = list(schema_lint.lint(root))
            if not any(words in reason for reason in reasons):
                wrong.append(f"frozen versions: wanted '{words}', got {reasons}")
    return wrong


def check_exit_codes():
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        root = copy_of(folder)
        for status, spoil in ((0, lambda: None), (1, lambda: change(root, "client", "  token:string;\n", "")),
                              (2, lambda: (root / "protocol/schema/event.fbs").unlink())):
            spoil()
            said = io.StringIO()
            with unittest.mock.patch.object(sys, "argv", ["schema_lint.py", "--root", folder]), contextlib.redirect_stdout(said), \
                    contextlib.redirect_stderr(said):
                got = schema_lint.main()
            if got != status:
                wrong.append(f"exit code {got} where {status} was due: {said.getvalue()}")
    return wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--flatc")
    wrong = check_changes(parser.parse_args().flatc) + check_frozen() + check_exit_codes()
    for line in wrong:
        print(f"schema_lint_test: {line}", file=sys.stderr)
    print(f"schema_lint_test: {len(CHANGES)} changes tried, {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
