"""The client half of bar R8: a real client behind trochoid-mutant, and the kit as its server. What mutants.py runs for --side client."""
import json
import pathlib
import re
import shlex
import subprocess
import tempfile

# Mutants that CI can afford, of each family one.
QUICK = ("honest", "client-forgives-116", "client-forgives-134", "client-no-magic", "client-two-hellos", "client-same-sequence",
         "client-other-sea", "client-forgives-105")
# What is spoilt below the messages needs the transport that has it; all others come by tcp.
TRANSPORT = {"client-small-letters": "ws", "client-no-subprotocol": "ws", "client-other-path": "ws", "client-no-mask": "ws", "client-text": "ws",
             "client-no-close-frame": "ws", "client-no-pong": "ws", "client-forgives-105": "ws", "client-split-hello": "tls",
             "client-no-close-notify": "tls"}
# What they break is a SHOULD: the kit tells, but nobody has to.
SHOULD = frozenset(("client-no-rhythm", "client-tells-no-difference", "client-tells-another-part"))
# Requirements that clients keep too and that no mutant of a client breaks, and why.
WITHOUT = {
    "R-151": "a client keeps it with R-127", "R-153": "a server decides it", "R-154": "a server decides it", "R-156": "a server decides it",
    "R-172": "no session shows it: tests/evolution", "R-173": "no session shows it: tests/evolution",
    "R-174": "no session shows it: tests/evolution", "R-201": "its results are those of R-205", "R-202": "its results are those of R-205",
    "R-203": "its results are those of R-205", "R-204": "its results are those of R-205"}
PATIENCE_S = 900
# Each of its cases waits for 5 s and does nothing: so many side by side.
JOBS = {"client-late": 64}
QUIET_JOBS = 4


def broken_of(case):
    named = re.match(r"R-\d+", case.get("reason", ""))
    return named.group() if named else case["requirement"]


def command_of(folder, name, transport):
    """What the kit starts: the relay, and by it the client."""
    trust = " --ca {ca}" if transport in ("tls", "wss") else ""
    client = f"exec {shlex.quote(str(folder / 'trochoid-probe'))} --connect {{here}}{trust} --point 0,0 --watch --every 0.5"
    return f"exec {shlex.quote(str(folder / 'trochoid-mutant'))} {name} --to {{address}} --run {shlex.quote(client)}"


def test(folder, name, only, timeout_s, jobs, transport):
    """The kit's report."""
    with tempfile.TemporaryDirectory(prefix="trochoid-mutant.") as scratch:
        file = pathlib.Path(scratch) / "json"
        done = subprocess.run(
            [folder / "trochoid-conformance", "client", "--transport", transport, "--run", command_of(folder, name, transport), "--quiet",
             "--json", file, "--timeout", str(timeout_s), "--longest-wait", "4", "--jobs", str(jobs), *(word for pattern in only for word in ("--only", pattern))],
            stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE_S)
        if not file.exists():
            raise RuntimeError(f"the kit did not test {name}: {done.stderr}")
        return json.loads(file.read_text())


def judge(folder, name, requirement, only=(), timeout_s=2.0, jobs=24, transport=None):
    """The kit's report of the client that this mutant makes. What fails beside the mutant's own requirement is tried once more with
    few others beside it: a busy machine is late too."""
    transport = transport or TRANSPORT.get(name, "tcp")
    report = test(folder, name, only, timeout_s, JOBS.get(name, jobs), transport)
    others = [c["id"] for c in report["cases"] if c["verdict"] == "failed" and broken_of(c) != requirement]
    if others and len(others) < 100:
        again = {c["id"]: c for c in test(folder, name, others, 2 * timeout_s, QUIET_JOBS, transport)["cases"]}
        report["cases"] = [again.get(c["id"], c) for c in report["cases"]]
    return report
