"""Bar R3: the fuzzers, each for a while (60 s, --quick: 10 s), and the hostile vectors. fuzzing.py --figures FILE [--quick]"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HOSTILE = pathlib.Path(os.environ["TROCHOID_BUILD"]) / "bin" / "trochoid-bench-hostile"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--figures", required=True)
    parser.add_argument("--quick", action="store_true")
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        hostile, rows = pathlib.Path(folder) / "hostile.json", pathlib.Path(folder) / "fuzz.json"
        if subprocess.run([HOSTILE, "--figures", hostile]).returncode != 0:
            return 2
        print(flush=True)
        seconds = "10" if wanted.quick else "60"
        if subprocess.run([ROOT / "tests/fuzz/run", "--seconds", seconds, "--figures", rows]).returncode not in (0, 1):
            return 2
        result, rows = json.loads(hostile.read_text()), json.loads(rows.read_text())
    sound = sum(row["verdict"] == "holds" for row in rows)
    result["figure"] += f"; {len(rows)} parsers fuzzed for {seconds} s each, {len(rows) - sound} broken"
    result["checks"] += [{"name": "parsers fuzzed", "value": len(rows), "bar": 8, "holds": len(rows) >= 8},
                         {"name": "parsers that nothing broke", "value": sound, "bar": len(rows), "holds": sound == len(rows)}]
    result["figures"].update({f"{row['target']}_{key}": row[key] for row in rows for key in ("runs", "edges", "corpus")})
    pathlib.Path(wanted.figures).write_text(json.dumps(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
