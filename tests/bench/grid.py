"""P1: runs trochoid-bench-grid and holds the kernel against its own bound.

The bound: vector instructions of the inner loop, as objdump counts them in the very program that ran, at the rate at which this core
executes independent vector products and sums, measured in the same run. Loads and stores are not counted: they have ports of
their own, so leaving them out makes the bound the harder one.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys

PROGRAM = pathlib.Path(os.environ["TROCHOID_BUILD"]) / "bin" / "trochoid-bench-grid"
REGISTER = {"AVX3": "zmm", "AVX2": "ymm"}
MOVES = re.compile(r"v?(mov|broadcast|pbroadcast)")


def instructions(target):
    """The function that sums a grid's rows with normals (parts 15) at unit gain on a target: (address, mnemonic, operands) each."""
    found, inside = [], False
    text = subprocess.run(["objdump", "-dC", "--no-show-raw-insn", str(PROGRAM)], capture_output=True, text=True,
                          check=True).stdout
    for line in text.splitlines():
        if line.endswith(">:"):
            inside = f" trochoid::simd::N_{target}::sum_fast<15, true," in line
        elif inside and (match := re.match(r"\s*([0-9a-f]+):\s+(\S+)\s*(.*)", line)):
            found.append((int(match[1], 16), match[2], match[3]))
    return found


def inner_loops(code):
    """Bodies of loops that hold no other loop."""
    place = {address: i for i, (address, _, _) in enumerate(code)}
    loops = []
    for i, (address, name, operands) in enumerate(code):
        match = re.match(r"([0-9a-f]+)", operands)
        if name.startswith("j") and match and int(match[1], 16) in place and int(match[1], 16) < address:
            loops.append((place[int(match[1], 16)], i + 1))
    return [code[a:b] for a, b in loops if not any(a <= c and d <= b and (a, b) != (c, d) for c, d in loops)]


def counted(target):
    """Vector instructions per train of the leanest loop that turns one phase into a sine and a cosine."""
    register = REGISTER[target]
    best = None
    for body in inner_loops(instructions(target)):
        trains = sum(name == "vcvtdq2ps" for _, name, _ in body)
        if trains == 0 or sum(name.startswith("j") for _, name, _ in body) != 1:
            continue  # not a plain loop over trains
        vectors = [(name, operands) for _, name, operands in body if register in operands]
        # A move under a mask is a blend.
        arithmetic = sum(not MOVES.match(name) or "{%k" in operands for name, operands in vectors) / trains
        if best is None or arithmetic < best[0]:
            best = (arithmetic, len(vectors) / trains)
    if best is None:
        sys.exit(f"grid.py: found no inner loop of {target} in {PROGRAM}")
    return best


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--figures", required=True)
    parser.add_argument("--quick", action="store_true")
    wanted = parser.parse_args()
    command = [str(PROGRAM), "--figures", wanted.figures] + (["--quick"] if wanted.quick else [])
    status = subprocess.run(command).returncode
    if status != 0:
        return status
    result = json.loads(pathlib.Path(wanted.figures).read_text())
    print(f"{'inner loop':<10} {'arithmetic':>10} {'with moves':>10} {'taken, in operations':>21} {'of bound':>9}")
    for target in REGISTER:
        taken = result["figures"].get(f"{target} operations per point-train vector")
        if taken is None:
            continue
        arithmetic, vectors = counted(target)
        share = 100 * arithmetic / taken
        print(f"{target:<10} {arithmetic:>10.1f} {vectors:>10.1f} {taken:>21.1f} {share:>8.1f}%")
        result["figures"][f"{target} inner loop"] = arithmetic
        result["checks"].append({"name": f"{target}: share of its own bound", "value": f"{share:.1f}%", "bar": ">= 75%",
                                 "holds": share >= 75})
    pathlib.Path(wanted.figures).write_text(json.dumps(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
