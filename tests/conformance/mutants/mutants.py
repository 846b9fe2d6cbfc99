"""Bar R8: the kit against mutants, each of which breaks one requirement. mutants.py [--side server|client] [--quick] [--figures FILE] [NAME...]

A mutant is an honest program behind trochoid-mutant. Of each the kit has to fail cases, and of its requirement alone: a failed case belongs to
the requirement that its reason names first ("R-134: result 4 came after result 2"), else to that of its id. Verdicts: exact; also (others fail,
named); survives (none of its own fails). AS says whose cases cannot but fail with a requirement's own."""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import client_mutants

SOURCE = pathlib.Path(__file__).resolve().parents[3]
BIN = pathlib.Path(os.environ.get("TROCHOID_BIN", pathlib.Path(os.environ.get("TROCHOID_BUILD", SOURCE / "build/release")) / "bin")).resolve()
PATIENCE_S = 60
# Mutants that CI can afford, of each kind one: what reads, who may, what is sent, what is computed.
QUICK = ("honest", "size-field", "any-world", "any-sequence", "late-anyway", "pieces-miscounted", "last-bit")
# Another arithmetic shows in every sample: the cases of R-204 fail as well, beside those that say which it is.
AS = {"R-201": "R-204", "R-202": "R-204", "R-203": "R-204"}
# What a mutant leaves out has to be in the scene.
SCENES = {"no-wakes": "ship-wakes", "no-irregular-heights": "irregular-heights", "no-round-waves": "round-waves", "no-noise": "gradient-noise",
          "no-orbits": "plane-beach"}
# Requirements that servers keep too and that no mutant of a server breaks, and why.
WITHOUT = {
    "R-156": "whether viewers need a token is the server's choice, and on its own machine ours wants none",
    "R-157": "a client's MAY; what a server makes of it is R-158 and R-159",
    "R-171": "no session shows it: tests/evolution", "R-172": "no session shows it: tests/evolution",
    "R-173": "no session shows it: tests/evolution"}
# Mutants that only show after the server's patience, by which the kit has to wait longer.
LONG = {"no-patience-ends": 130}

Mutant = collections.namedtuple("Mutant", "name requirement side what")


def mutants(side):
    listed = subprocess.run([BIN / "trochoid-mutant", "--list"], check=True, capture_output=True, text=True).stdout
    found = [Mutant(*line.split("\t")) for line in listed.splitlines()]
    if side == "client":
        found = [m._replace(side=side, what="A client that breaks nothing") if m.name == "honest" else m for m in found]
    return [m for m in found if m.side == side]


def port_of(file, process, log):
    deadline = time.monotonic() + PATIENCE_S
    while not (file.exists() and file.read_text().strip()):
        if process.poll() is not None or time.monotonic() > deadline:
            raise SystemExit("it did not start:\n" + pathlib.Path(log.name).read_text())
        time.sleep(0.02)
    return re.search(r"[0-9]+", file.read_text()).group()


class Process:
    def __init__(self, *command, log):
        self.process = subprocess.Popen(list(map(str, command)), stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def __enter__(self):
        return self.process

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def broken_of(case):
    """The requirement that a failed case found broken."""
    named = re.match(r"R-\d+", case.get("reason", ""))
    return named.group() if named else case["requirement"]


def kit(folder, name, here, only, timeout_s, jobs):
    file = folder / "json"
    file.unlink(missing_ok=True)
    done = subprocess.run(
        [BIN / "trochoid-conformance", "server", "--connect", here, "--sign-with", folder / "key", "--quiet", "--json", file, "--timeout",
         str(timeout_s), "--jobs", str(jobs), "--connections", str(jobs + 10), "--longest-wait", str(LONG.get(name, 8)),
         *(word for pattern in only for word in ("--only", pattern))],
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=900)
    if not file.exists():
        raise RuntimeError(f"the kit did not test {name}: {done.stderr}")
    return json.loads(file.read_text())


def judge_server(mutant, scene, only, timeout_s, jobs):
    """The kit's report of a server that this mutant spoils. What fails beside the mutant's own requirement is tried once more with few
    others beside it: a busy machine is late too."""
    if mutant.name in LONG and not only:
        only = [f"{mutant.requirement}/*"]
    with tempfile.TemporaryDirectory(prefix="trochoid-mutant.") as folder:
        folder = pathlib.Path(folder)
        subprocess.run([BIN / "trochoid-ctl", "token", "new-key", folder / "key"], check=True, stdout=subprocess.DEVNULL)
        with open(folder / "log", "wb") as log, \
                Process(BIN / "trochoid-server", "--scene", SOURCE / "server/scenes" / scene / "scene.toml", "--port", 0, "--port-file",
                        folder / "server", "--token-key", folder / "key.pub", "--connections-per-address", 200, "--logins-per-address", 0,
                        log=log) as server:
            to = f"127.0.0.1:{port_of(folder / 'server', server, log)}"
            with Process(BIN / "trochoid-mutant", mutant.name, "--to", to, "--port-file", folder / "relay", log=log) as relay:
                here = f"127.0.0.1:{port_of(folder / 'relay', relay, log)}"
                report = kit(folder, mutant.name, here, only, timeout_s, jobs)
                mine = (mutant.requirement, AS.get(mutant.requirement))
                others = [c["id"] for c in report["cases"] if c["verdict"] == "failed" and broken_of(c) not in mine]
                if others and len(others) < 100:
                    again = {c["id"]: c for c in kit(folder, mutant.name, here, others, 2 * timeout_s, 4)["cases"]}
                    report["cases"] = [again.get(c["id"], c) for c in report["cases"]]
                return report


def verdict_of(mutant, report):
    failed = [c for c in report["cases"] if c["verdict"] == "failed"]
    counts = collections.Counter(map(broken_of, failed))
    own = counts.pop(mutant.requirement, 0)
    beside = counts.pop(AS.get(mutant.requirement), 0)
    others = dict(sorted(counts.items()))
    row = {"name": mutant.name, "side": mutant.side, "requirement": mutant.requirement, "what": mutant.what, "own": own, "beside": beside,
           "others": others, "cases": {c["id"]: c["reason"] for c in failed}, "took_s": round(report["took_us"] * 1e-6, 1)}
    if mutant.name.startswith("honest"):
        row["verdict"] = "exact" if not failed else "also"
    else:
        row["verdict"] = "survives" if own == 0 else "also" if others else "exact"
    return row


def line_of(row):
    others = " ".join(f"{r} ({n})" for r, n in row["others"].items())
    if row["beside"] > 0:
        others = f"(beside {row['beside']} of {AS[row['requirement']]}) {others}"
    return f"{row['requirement']:<6} {row['name']:<24} {row['own']:>4} {row['verdict']:<9} {row['took_s']:>6.1f} s  {others}"


def forgotten():
    """Requirements of the standard that neither a mutant breaks nor WITHOUT explains: all of either side, and of both what both keep."""
    text = (SOURCE / "protocol/README.md").read_text()
    numbered = set(re.findall(r"\*\*(R-\d+)\*\*", text))
    covered = {side: {m.requirement for m in mutants(side)} | set(without)
               for side, without in (("server", WITHOUT), ("client", client_mutants.WITHOUT))}
    both = set()
    for numbers in re.findall(r"^\| (R-[^|]*) \| CS \|", text, re.MULTILINE):
        for first, last in re.findall(r"R-(\d+)(?: to R-(\d+))?", numbers):
            both |= {f"R-{number}" for number in range(int(first), int(last or first) + 1)}
    missing = numbered - covered["server"] - covered["client"]
    return sorted(missing | (both & numbered) - (covered["server"] & covered["client"]))


def required(rows):
    """Requirement by requirement the best verdict of its mutants."""
    order = ("survives", "also", "exact")
    best = {}
    for row in rows:
        key = row["side"], row["requirement"]
        if row["requirement"] != "R-0" and row["name"] not in client_mutants.SHOULD:
            best[key] = max(best.get(key, "survives"), row["verdict"], key=order.index)
    return best


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", help="mutants (all)")
    parser.add_argument("--side", choices=("server", "client"), help="what is spoilt (both)")
    parser.add_argument("--scene", default="harbour")
    parser.add_argument("--only", action="append", default=[], help="cases, as the kit's --only")
    parser.add_argument("--quick", action="store_true", help="a few mutants, less than a minute")
    parser.add_argument("--parallel", type=int, default=4, help="mutants side by side")
    parser.add_argument("--jobs", type=int, default=24, help="cases side by side")
    parser.add_argument("--timeout", type=float, default=2.0, help="the kit's patience")
    parser.add_argument("--cases", action="store_true", help="print the failed cases and why")
    parser.add_argument("--json", help="write all rows")
    parser.add_argument("--figures", help="for tests/bench/run")
    wanted = parser.parse_args()
    all_of_them = [m for side in ("server", "client") if wanted.side in (side, None) for m in mutants(side)]
    chosen = wanted.names or (QUICK + client_mutants.QUICK if wanted.quick else [m.name for m in all_of_them])
    unknown = set(chosen) - {m.name for m in all_of_them}
    if unknown and wanted.names:
        sys.exit(f"there is no mutant {', '.join(sorted(unknown))}: see trochoid-mutant --list")
    run = [m for m in all_of_them if m.name in chosen]
    run.sort(key=lambda m: m.name not in LONG)
    rows = []

    def judged(mutant):
        if mutant.side == "server":
            return verdict_of(mutant, judge_server(mutant, SCENES.get(mutant.name, wanted.scene), wanted.only, wanted.timeout, wanted.jobs))
        return verdict_of(mutant, client_mutants.judge(BIN, mutant.name, mutant.requirement, wanted.only, wanted.timeout, wanted.jobs))

    print(f"{'':<6} {'mutant':<24} {'fail':>4} verdict             others that fail, cases", flush=True)
    with concurrent.futures.ThreadPoolExecutor(wanted.parallel) as pool:
        for row in pool.map(judged, run):
            rows.append(row)
            print(line_of(row), flush=True)
            if wanted.cases or row["verdict"] == "also":
                for name, reason in row["cases"].items():
                    if wanted.cases or broken_of({"requirement": name.split("/")[0], "reason": reason}) in row["others"]:
                        print(f"         {name}: {reason}", flush=True)
    best = required(rows)
    if not wanted.names and not wanted.quick:
        for side, without in (("server", WITHOUT), ("client", client_mutants.WITHOUT)):
            if wanted.side in (side, None):
                print(*(f"{requirement:<6} no mutant of a {side}: {why}" for requirement, why in sorted(without.items())), sep="\n")
    left = forgotten()
    if left:
        print("neither a mutant nor a reason why there is none:", *left)
    exact = sum(v == "exact" for v in best.values())
    honest = all(r["verdict"] == "exact" for r in rows if r["requirement"] == "R-0")
    print(f"{exact} of {len(best)} requirements have a mutant that fails exactly their cases; {sum(r['verdict'] == 'exact' for r in rows)} of {len(rows)} "
          f"mutants are exact, {sum(r['verdict'] == 'survives' for r in rows)} survive")
    if wanted.json:
        pathlib.Path(wanted.json).write_text(json.dumps(rows, indent=1))
    if wanted.figures:
        pathlib.Path(wanted.figures).write_text(json.dumps({
            "figure": f"{exact} of {len(best)} requirements have a mutant that fails exactly their cases",
            "checks": [{"name": "requirements with an exact mutant", "value": exact, "bar": len(best), "holds": exact == len(best)},
                       {"name": "requirements without a mutant or a reason", "value": len(left), "bar": 0, "holds": not left},
                       {"name": "the honest relay passes", "value": int(honest), "bar": 1, "holds": honest}],
            "figures": {f"{r['side']} {r['name']}": r["own"] for r in rows}}))
        return 0
    return 0 if honest and exact == len(best) and not left else 1


if __name__ == "__main__":
    sys.exit(main())
