#!/usr/bin/env python3
"""Runs the README's commands as they stand, against a server of their own: an example that stopped working fails here.

usage: TROCHOID_BIN=build/release/bin readme_test.py
"""
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time


# Where the README starts a server of its own: here on any port, and what follows talks to ours, which lives longer.
OWN_PORT = "9300"
OWN_ADDRESS = "127.0.0.1:" + OWN_PORT


def starts_and_stops(words):
    """A server that the README leaves running: whether it comes up, serves and ends well."""
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as server:
        said = ""
        for line in server.stdout:
            said += line
            if "listening" in line:
                server.send_signal(signal.SIGTERM)
        return subprocess.CompletedProcess(words, server.wait(60), said if "listening" in said else "", said)


def commands(readme):
    """Lines of the README's sh blocks, comments taken off."""
    text = open(readme, encoding="utf-8").read()
    for block in re.findall(r"```sh\n(.*?)```", text, re.S):
        for line in block.splitlines():
            if words := shlex.split(line, comments=True):
                yield words


def start_server(bin_dir, source, folder):
    key, port_file = os.path.join(folder, "key"), os.path.join(folder, "port")
    subprocess.run([os.path.join(bin_dir, "trochoid-ctl"), "token", "new-key", key], check=True, stdout=subprocess.DEVNULL)
    scene = os.path.join(source, "server/scenes/scilly/scene.toml")
    server = subprocess.Popen([os.path.join(bin_dir, "trochoid-server"), "--scene", scene, "--port", "0",
                               "--port-file", port_file, "--token-key", key + ".pub"])
    for _ in range(1200):
        if os.path.exists(port_file):
            return server, "127.0.0.1:" + open(port_file, encoding="ascii").read().strip(), key
        if server.poll() is not None:
            sys.exit(f"the server ended with {server.returncode}")
        time.sleep(0.1)
    server.kill()
    sys.exit("the server opened no port within two minutes")


def translated(words, bin_dir, address, key, folder):
    fixed = []
    for word in words:
        word = word.replace("/tmp/", folder + "/").replace("build/release/bin", bin_dir)
        fixed.append({"HOST:PORT": address, "FILE": key, OWN_ADDRESS: address, OWN_PORT: "0"}.get(word, word))
    # All of its cases are another test's, and it asks our server.
    if fixed[0].endswith("trochoid-conformance"):
        fixed = [key if word == os.path.join(folder, "my-key") else word for word in fixed] + ["--only", "R-101/*"]
    # The scripts would build and test all over again; their help shows that they start and know their options.
    if fixed[0] in ("./demo.sh", "./test.sh", "tests/determinism/matrix"):
        known = subprocess.run([fixed[0], "--help"], capture_output=True, text=True, check=True).stdout
        own = fixed[1:fixed.index("--")] if "--" in fixed else fixed[1:]
        for before, option in zip([""] + own, own):
            if option.startswith("-") and option not in known:
                sys.exit(f"the README says {' '.join(words)}, but {fixed[0]} --help knows no {option}")
            if before == "--preset":
                listed = subprocess.run([os.path.join(bin_dir, "trochoid-viewer"), "--list-presets"], capture_output=True,
                                        text=True, check=True).stdout
                if option not in [line.split("\t")[0] for line in listed.splitlines()]:
                    sys.exit(f"the README says {' '.join(words)}, but the viewer has no preset {option}")
            elif not option.startswith("-") and not os.path.exists(option):
                sys.exit(f"the README says {' '.join(words)}, but there is no {option}")
        # What follows -- is for the viewer.
        fixed = [fixed[0], "--help"]
        if own != words[1:]:
            viewer = subprocess.run([os.path.join(bin_dir, "trochoid-viewer"), "--help"], capture_output=True, text=True,
                                    check=True).stdout
            for option in words[words.index("--") + 1:]:
                if option.split("=")[0] not in viewer:
                    sys.exit(f"the README says {' '.join(words)}, but trochoid-viewer --help knows no {option}")
    return fixed


def main():
    bin_dir = os.path.abspath(os.environ["TROCHOID_BIN"])
    source = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    os.chdir(source)
    failed = ran = 0
    with tempfile.TemporaryDirectory() as folder:
        server, address, key = start_server(bin_dir, source, folder)
        try:
            for words in commands("README.md"):
                fixed = translated(words, bin_dir, address, key, folder)
                run = starts_and_stops(fixed[:-1]) if fixed[-1] == "&" else subprocess.run(
                    fixed, capture_output=True, text=True, timeout=120, check=False)
                ran += 1
                good = run.returncode == 0 and run.stdout.strip() != ""
                failed += not good
                print("ok  " if good else "FAIL", " ".join(words), flush=True)
                if not good:
                    print(f"exit {run.returncode}\n{run.stdout}{run.stderr}", flush=True)
        finally:
            server.send_signal(signal.SIGTERM)
            status = server.wait(30)
    print(f"{ran} commands, {failed} failed; the server ended with {status}")
    sys.exit(1 if failed or status != 0 or ran < 10 else 0)


main()
