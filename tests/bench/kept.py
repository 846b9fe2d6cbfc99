"""The results that are kept in the tree: results/ID.json, results/ID.svg where there is something to see, and one table of all."""
import json
import pathlib

import plot

FOLDER = pathlib.Path(__file__).resolve().parent / "results"


def keep(about, results, fail):
    FOLDER.mkdir(exist_ok=True)
    for result in results:
        (FOLDER / f"{result['id']}.json").write_text(json.dumps({**about, "results": [result]}, indent=1) + "\n")
        if result.get("plots"):
            plot.draw(result, FOLDER / f"{result['id']}.svg", fail)
    write_table()


def write_table():
    """README.md: a line for each file."""
    lines = ["# tests/bench/results", "Written by `tests/bench/run --keep ID…`; figures and curves are in the files. Load is the machine's when the run began (? = not "
             "noted): times taken on a busy one are too long, ratios and shares less so.", "",
             "| bench | figure | checks that hold | on | load | by | date |", "|---|---|---|---|---|---|---|"]
    for file in sorted(FOLDER.glob("*.json")):
        about = json.loads(file.read_text())
        for result in about["results"]:
            checks = result.get("checks", [])
            short = [f"{check['name']}: {check['value']} (bar {check['bar']})" for check in checks if not check["holds"]]
            held = f"{len(checks) - len(short)} of {len(checks)}" + ("; short: " + "; ".join(short) if short else "")
            drawn = f" [curves]({file.stem}.svg)" if file.with_suffix(".svg").exists() else ""
            machine = about["machine"]
            lines.append(f"| [{result['id']}]({file.name}){drawn} | {result['figure'].rstrip(';')} | {held} | {machine['cpu']}, "
                         f"{machine['cores']} cores, {machine['architecture']} | {machine.get('load', '?')} | {', '.join(about['compiler'])} | {about['date']} |")
    (FOLDER / "README.md").write_text("\n".join(lines) + "\n")
