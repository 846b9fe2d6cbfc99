#!/usr/bin/env python3
"""Reads every #include of protocol/, server/, client/ and tests/ against the table layers.txt, and keeps the house's other
countable rules: a README.md of at most 20 lines in every folder of the table, no source over 600 lines, no file or
folder named utils, helpers, manager or common, rooted includes, words that deterministic folders must not use.

    layering.py [--root FOLDER] [--table FILE]

Prints one "file:line: rule" for each violation. Exit: 0 none, 1 some, 2 the table cannot be read (it says which line)."""

import argparse
import fnmatch
import pathlib
import re
import sys

TOP = ("protocol", "server", "client", "tests")
CODE = {".hpp", ".cpp", ".h", ".c", ".inl"}
SOURCES = CODE | {".py", ".sh", ".cmake", ".fbs", ".glsl", ".vert", ".frag", ".tesc", ".tese", ".geom", ".comp"}
MOST_LINES = 600
MOST_README_LINES = 20
EMPTY_NAMES = {"util", "utils", "utility", "utilities", "helper", "helpers", "manager", "managers", "common"}

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)"|(\S+))')
STANDARD = re.compile(r"^[a-z_0-9]+$")
# A comment, or a string or character literal: what [words] does not look into.
NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"([^(\s]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'(?![0-9A-Fa-f])', re.DOTALL
)


class TableError(Exception):
    """The table cannot be read; the text says where and why."""


class Table:
    """What layers.txt says: folders (name -> what it may include), libraries and words (lists of rules)."""

    def __init__(self, path):
        self.folders, self.libraries, self.words = {}, [], []
        section = None
        for number, line in logical_lines(path):
            where = f"{path}:{number}"
            if line.startswith("["):
                if line not in ("[folders]", "[libraries]", "[words]"):
                    raise TableError(f"{where}: unknown section {line}: take [folders], [libraries] or [words]")
                section = line
                continue
            left, colon, right = f"{line} ".rpartition(" : ")
            if section is None or not colon:
                raise TableError(f"{where}: want a section and below it lines of the form 'NAME : FOLDERS'")
            left, right = left.strip(), right.split()
            if section == "[folders]":
                if left in self.folders:
                    raise TableError(f"{where}: {left} is already in the table")
                self.folders[left] = right
                continue
            if not right:
                raise TableError(f"{where}: name folders, or 'none'")
            if section == "[libraries]":
                self.libraries.append((left.split(), right, where))
                continue
            try:
                self.words.append((re.compile(left), right, where))
            except re.error as error:
                raise TableError(f"{where}: not a regular expression: {error}") from error

    def folder_of(self, path):
        """The table's folder that covers a file, or None."""
        parent = path.rpartition("/")[0]
        fitting = [f for f in self.folders if f == parent or ("/" in f and parent.startswith(f + "/"))]
        return max(fitting, key=len, default=None)


def logical_lines(path):
    """(number, text) of the lines without comments, with indented lines joined to the one before them."""
    lines = []
    try:
        text = pathlib.Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise TableError(f"{path}: cannot be read: {error}") from error
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if line[0].isspace() and lines:
            lines[-1] = (lines[-1][0], f"{lines[-1][1]} {line.strip()}")
        else:
            lines.append((number, line.rstrip()))
    return lines


def covers(names, path):
    """Whether a list of folders, files and patterns covers a file."""
    return any(n == "*" or path == n or path.startswith(n + "/") or fnmatch.fnmatchcase(path, n) for n in names)


def check_include(table, path, name, quoted):
    """The rule that an include of a file breaks, or None."""
    for headers, users, where in table.libraries:
        pattern = next((h for h in headers if fnmatch.fnmatchcase(name, h)), None)
        if pattern:
            if covers(users, path):
                return None
            allowed = "no file yet" if users == ["none"] else ", ".join(users)
            return f"<{name}> may be included by {allowed} only ({pattern}, {where})"
    if name.partition("/")[0] in TOP and "/" in name:
        if not quoted:
            return f'<{name}> is ours: write "{name}"'
        own, other = table.folder_of(path), table.folder_of(name)
        if other is None:
            return f'"{name}" is in a folder that the table does not name'
        if own == other or covers(table.folders[own], name):
            return None
        allowed = ", ".join(table.folders[own]) or "nothing else of this repository"
        return f'{own} may not include "{name}"; it may include {allowed}'
    if quoted:
        return f'"{name}": includes are rooted at the repository, as in "protocol/units/lattice.hpp"'
    if STANDARD.match(name):
        return None
    return f"<{name}> is not in the table's [libraries]"


def check_code(table, path, text):
    """(line, rule) for each violation inside one C++ file."""
    found = []
    if table.folder_of(path) is None:
        found.append((1, f"the table names no folder that covers {path}"))
        return found, 0
    includes = 0
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        includes += 1
        angled, quoted, other = match.groups()
        if other:
            found.append((number, f"include of {other}: name the file itself"))
            continue
        rule = check_include(table, path, angled or quoted, quoted is not None)
        if rule:
            found.append((number, rule))
    words = [(pattern, where) for pattern, users, where in table.words if covers(users, path)]
    if words:
        code = NOT_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), text)
        for number, line in enumerate(code.splitlines(), 1):
            for pattern, where in words:
                match = pattern.search(line)
                if match:
                    found.append((number, f"'{match.group().strip()}' must not be used here ({where})"))
    return found, includes


def check_name(path):
    """(line, rule) when a part of the path names nothing."""
    for part in pathlib.PurePosixPath(path).parts:
        empty = EMPTY_NAMES.intersection(re.split(r"[_.\-]", part.lower()))
        if empty:
            return [(1, f"'{part}' names nothing ({empty.pop()}): name it after the one concept in it")]
    return []


def check_readmes(table, root):
    """(path, line, rule) for the table's folders without README.md, and for READMEs that are too long."""
    for folder in table.folders:
        readme = root / folder / "README.md"
        filled = (root / folder).is_dir() and any(f.is_file() for f in (root / folder).rglob("*"))
        # 'tests' and the like, without '/', may leave the telling to their parts, and the schemata to the standard.
        if filled and "/" in folder and not readme.is_file():
            yield f"{folder}/README.md", 1, "missing: Knows, May include, Hands on, Start reading at"
    for top in TOP + ("docker",):
        for readme in sorted((root / top).rglob("README.md")):
            path = readme.relative_to(root).as_posix()
            count = len(readme.read_text(encoding="utf-8").splitlines())
            # protocol/README.md is the wire standard.
            if count > MOST_README_LINES and path != "protocol/README.md":
                yield path, count, f"{count} lines: a folder's README.md has at most {MOST_README_LINES}"


def check_tree(table, root):
    """All violations below root as (path, line, rule), and how many files and includes were read."""
    violations, files, includes = [], 0, 0
    for top in TOP:
        for file in sorted((root / top).rglob("*")):
            path = file.relative_to(root).as_posix()
            if not file.is_file() or "__pycache__" in path or "/." in path:
                continue
            violations += [(path, *found) for found in check_name(path)]
            if file.suffix not in SOURCES and file.name != "CMakeLists.txt":
                continue
            files += 1
            text = file.read_text(encoding="utf-8", errors="replace")
            count = len(text.splitlines())
            if count > MOST_LINES:
                violations.append((path, count, f"{count} lines: a source has at most {MOST_LINES}"))
            if file.suffix in CODE:
                found, read = check_code(table, path, text)
                includes += read
                violations += [(path, *one) for one in found]
    violations += check_readmes(table, root)
    return violations, files, includes


def main(arguments=None):
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--root", type=pathlib.Path, default=here.parent.parent, help="the repository")
    options.add_argument("--table", default=here / "layers.txt", help="the table of layers")
    chosen = options.parse_args(arguments)
    try:
        table = Table(chosen.table)
    except TableError as error:
        print(error, file=sys.stderr)
        return 2
    violations, files, includes = check_tree(table, chosen.root)
    for path, line, rule in violations:
        print(f"{path}:{line}: {rule}")
    if files == 0:
        print(f"layering: no sources below {chosen.root}", file=sys.stderr)
        return 2
    print(f"layering: {files} files, {includes} includes, {len(violations)} violations")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
