#!/usr/bin/env python3
"""A client and a server in a network of their own, where the kernel itself delays and drops packets: TCP's losses and
repetitions are real. Exit 77 (skipped) where such a network cannot be made."""
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[2] / "system"))

SKIPPED = 77
# A bucket of 2 KB in 10 ms holds little: what a burst sends beyond it is dropped.
NETWORK = ("ip link set lo mtu 1500 up && "
           "tc qdisc add dev lo root tbf rate 400kbit burst 3kb latency 10ms")


def dropped():
    shown = subprocess.run(["tc", "-s", "qdisc", "show", "dev", "lo"], capture_output=True, text=True, check=True).stdout
    return int(shown.split("(dropped ")[1].split(",")[0])


def inside():
    import sea_programs
    with sea_programs.Server(sea_programs.scene("crossing-swells")) as server:
        for x in (0, 3000, -3000):
            done = server.probe("--region", f"{x},0,800", "--points", "200", "--compare")
            if done.returncode != 0:
                print(done.stdout, done.stderr)
                return 1
    print(f"three probes over a network that dropped {dropped()} packets: bit for bit the server's sea")
    return 0 if dropped() > 0 else 1


def main():
    if sys.argv[1:] == ["--inside"]:
        return inside()
    try:
        made = subprocess.run(["unshare", "-rn", "sh", "-c", NETWORK], capture_output=True, text=True, timeout=20)
    except OSError as missing:
        print(f"skipped: {missing}")
        return SKIPPED
    if made.returncode != 0:
        print(f"skipped: no network of our own can be made here: {made.stderr.strip()}")
        return SKIPPED
    return subprocess.run(["unshare", "-rn", "sh", "-c", f"{NETWORK} && exec {sys.executable} -B {HERE} --inside"]).returncode


if __name__ == "__main__":
    sys.exit(main())
