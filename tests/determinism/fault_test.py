#!/usr/bin/env python3
"""An injected fault of one unit in the last place is named by stage, place, sea time, field and both values; thread counts
change nothing. Usage: fault_test.py BIN_DIR"""

import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
BIN = sys.argv[1]
SCENES = {"plane-beach": "world land constants patch displacement vectors", "ship-wakes": "patch displacement",
          "crossing-swells": "world constants patch displacement", "storm-cell": "live-displacement live-vectors"}
# What first_difference has to say, beyond stage, place and time; and which stages after it go wrong too.
NAMED = {
    "world": (r"box 1, sea time [-0-9.]+ s, field train\[1\]\.amplitude", "displacement"),
    "land": (r"box 1 field 1 block -?\d+,-?\d+, sea time [-0-9.]+ s, field gain\[row 8, column 8\]", None),
    "constants": (r"box \d+ train \d+, sea time [-0-9.]+ s, field a\b", "displacement"),
    "patch": (r"view 1 tile \d+/-?\d+,-?\d+, sea time 0\.000000 s, field height_error", None),
    "displacement": (r"tile 16/-?\d+,-?\d+ point -?\d+,-?\d+, sea time 3600\.000000 s, field ay", None),
    "vectors": (r"tile 16/-?\d+,-?\d+ point -?\d+,-?\d+, sea time 3600\.000000 s, field ay", None),
    "live-displacement": (r"tile 16/-?\d+,-?\d+ point -?\d+,-?\d+, sea time 43\.300000 s, field ay", None),
    "live-vectors": (r"tile 16/-?\d+,-?\d+ point -?\d+,-?\d+, sea time 43\.300000 s, field ay", None),
}


def trace(scene, lines, program="determinism-trace", threads=1, fault=None):
    environment = {**os.environ, "TROCHOID_FAULT": fault or "none"}
    command = [os.path.join(BIN, program), "--threads", str(threads), "--lines", lines,
               os.path.join(ROOT, "server/scenes", scene, "scene.toml")]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    # A fast path that errs is caught by the program itself, against the scalar reference.
    caught = re.search(rf"error: scene {scene}, stage {fault}, tile .* field ay: \S+ computes .*, the scalar reference", done.stderr)
    expect(done.returncode == (1 if caught else 0), f"{scene}: exit {done.returncode}: {done.stderr}")
    expect(bool(caught) == ("vectors" in (fault or "") and "faulty" in program), f"{scene}: {fault}: {done.stderr}")
    return {line.split()[1]: line for line in done.stdout.splitlines() if line.startswith(scene)}


def compare(a, b):
    done = subprocess.run([sys.executable, os.path.join(HERE, "first_difference"), a, b], capture_output=True, text=True)
    return done.returncode, done.stdout


def expect(condition, what):
    if not condition:
        print(f"fault_test: {what}")
        sys.exit(1)


with tempfile.TemporaryDirectory() as folder:
    right, wrong = os.path.join(folder, "right"), os.path.join(folder, "wrong")
    for scene, faults in SCENES.items():
        good = trace(scene, right)
        for threads in (2, 7):
            expect(trace(scene, wrong, threads=threads) == good, f"{scene}: {threads} threads change a bit")
            expect(compare(right, wrong) == (0, "first difference: none\n"), f"{scene}: {threads} threads differ")
        # The shipped program cannot be made to err, and the test build errs only when asked.
        expect(trace(scene, wrong, fault="world") == good, f"{scene}: the program takes faults")
        expect(trace(scene, wrong, fault="vectors") == good, f"{scene}: the program takes faults in its fast path")
        expect(trace(scene, wrong, "determinism-trace-faulty") == good, f"{scene}: the test build differs unasked")
        for fault in faults.split():
            bad = trace(scene, wrong, "determinism-trace-faulty", fault=fault)
            differing = [stage for stage in good if bad[stage] != good[stage]]
            status, text = compare(right, wrong)
            pattern, later = NAMED[fault]
            expect(status == 1 and re.search(rf"scene {scene}, stage {fault}, {pattern}", text),
                   f"{scene}: a fault in {fault} is named as: {text}")
            bits = re.findall(r"\(([0-9a-f]+)\) in ", text)
            expect(len(bits) == 2 and abs(int(bits[0], 16) - int(bits[1], 16)) == 1,
                   f"{scene}: {fault}: not both values, one unit apart: {text}")
            expect(differing[0] == fault, f"{scene}: a fault in {fault} shows first in {differing[0]}")
            expect(later is None or later in differing, f"{scene}: a fault in {fault} does not reach {later}")
            print(f"fault_test: {scene}: {fault}: named")
print("fault_test: all named")
