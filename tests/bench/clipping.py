"""A10: what a box of 256 trains costs by the share of it that is in view, mesher by mesher, as clipping_cost measures it.

The work (trains that the vertices evaluate) is counted and has the bars; times are told beside it.
"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys

PROGRAM = pathlib.Path(os.environ["TROCHOID_BUILD"]) / "tests" / "clipping_cost"


def rows_of(quick):
    """Rows by mesher; the coherent mesher once more with the view as a criterion (Refinement::frustum)."""
    size = ["steps=6", "repeats=1", "cells=256"] if quick else ["steps=12", "repeats=3"]
    meshers = {}
    for more, suffix in (([], ""), (["meshers=coherent", "refinement=frustum"], ", by frustum")):
        command = [str(PROGRAM), *size, *more]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit(f"clipping.py: {' '.join(command)} ended with status {done.returncode}")
        for row in csv.DictReader(done.stdout.splitlines()):
            kept = {name: float(row[name]) for name in ("visible_share", "work", "cost")}
            meshers.setdefault(row["mesher"] + suffix, []).append(kept)
    return meshers


def near(rows, share):
    return min(rows, key=lambda row: abs(row["visible_share"] - share))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--figures", required=True)
    parser.add_argument("--quick", action="store_true")
    wanted = parser.parse_args()
    meshers = rows_of(wanted.quick)
    result = {"checks": [], "figures": {}, "plots": []}
    print(f"{'mesher':<22} {'in view':>8} {'work':>8} {'time':>8}")
    for mesher, rows in meshers.items():
        for row in rows:
            print(f"{mesher:<22} {row['visible_share']:>7.0%} {row['work']:>7.1%} {row['cost']:>7.1%}")
        half, none = near(rows, 0.5), near(rows, 0.0)
        for name, row in (("half", half), ("least", none)):
            result["figures"][f"{mesher}: share in view, {name}"] = row["visible_share"]
            result["figures"][f"{mesher}: work, {name} in view"] = row["work"]
            result["figures"][f"{mesher}: time, {name} in view"] = row["cost"]
        # Tiles and patches at the picture's border are drawn whole.
        for name, row, bar in (("half", half, 0.8), ("least", none, 0.5)):
            result["checks"].append({"name": f"{mesher}: work with {name} of the box in view ({row['visible_share']:.0%})",
                                     "value": f"{row['work']:.2f}", "bar": f"<= {bar}", "holds": row["work"] <= bar})
    curves = [{"name": "in proportion", "x": [0, 1], "y": [0, 1], "dashed": True}]
    curves += [{"name": mesher, "x": [row["visible_share"] for row in rows], "y": [row["work"] for row in rows]}
               for mesher, rows in meshers.items()]
    result["plots"].append({"title": "A10: trains evaluated by the share of a box in view", "x": "share of the box in view",
                            "y": "trains evaluated, over those of the whole box", "curves": curves})
    worst = max(result["figures"][f"{mesher}: work, half in view"] for mesher in meshers)
    result["figure"] = f"{worst:.0%} of the work at most with half a box in view;"
    pathlib.Path(wanted.figures).write_text(json.dumps(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
