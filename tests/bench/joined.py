"""Runs several benchmark programs as one: joined.py --figures FILE [--quick] PROGRAM… (names in the build's bin, or scripts here).

Checks, figures and plots follow each other; the words of the last line are those of the first.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

BIN = pathlib.Path(os.environ["TROCHOID_BUILD"]) / "bin"
HERE = pathlib.Path(__file__).resolve().parent


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--figures", required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("program", nargs="+")
    wanted = parser.parse_args()
    joined = {}
    for name in wanted.program:
        command = [sys.executable, "-B", str(HERE / name)] if name.endswith(".py") else [str(BIN / name)]
        with tempfile.TemporaryDirectory() as folder:
            found = pathlib.Path(folder) / "found.json"
            status = subprocess.run(command + ["--figures", str(found)] + (["--quick"] if wanted.quick else [])).returncode
            if status != 0:
                return status
            result = json.loads(found.read_text())
        print(flush=True)
        if not joined:
            joined = result
            continue
        for key in ("checks", "plots"):
            joined.setdefault(key, []).extend(result.get(key, []))
        joined.setdefault("figures", {}).update(result.get("figures", {}))
    pathlib.Path(wanted.figures).write_text(json.dumps(joined))
    return 0


if __name__ == "__main__":
    sys.exit(main())
