"""Starts Trochoid's programs for tests, and ends them whatever happens."""
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("TROCHOID_BIN", SOURCE / "build/release/bin")).resolve()
# Sanitizers and busy machines are slow: no wait is longer than needed, and all end here.
PATIENCE_S = 120


def scene(name):
    return SOURCE / "server/scenes" / name / "scene.toml"


def run(program, *arguments, **options):
    """Runs a program to its end; gives CompletedProcess with text output."""
    return subprocess.run([BIN / program, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=PATIENCE_S, **options)


class Server:
    """A trochoid-server on a free port, with a key that signs tokens."""

    def __init__(self, scene_file, *options):
        self._folder = tempfile.TemporaryDirectory(prefix="trochoid-test.")
        self._probes = []
        folder = pathlib.Path(self._folder.name)
        self.key_file = folder / "key"
        made = run("trochoid-ctl", "token", "new-key", self.key_file)
        assert made.returncode == 0, made.stderr
        self.log_file = folder / "log"
        port_file = folder / "port"
        with open(self.log_file, "wb") as log:
            self.process = subprocess.Popen(
                [BIN / "trochoid-server", "--scene", scene_file, "--port", "0", "--port-file", port_file,
                 "--token-key", f"{self.key_file}.pub", *map(str, options)],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        deadline = time.monotonic() + PATIENCE_S
        while not (port_file.exists() and port_file.read_text().strip()):
            if self.process.poll() is not None or time.monotonic() > deadline:
                text = self.log()
                self.close()
                raise AssertionError(f"the server did not start:\n{text}")
            time.sleep(0.02)
        self.port = int(re.search(r"\d+", port_file.read_text()).group())
        self.address = f"127.0.0.1:{self.port}"

    def log(self):
        return self.log_file.read_text(errors="replace")

    def ctl(self, *arguments, token=True):
        login = ("--sign-with", self.key_file) if token else ()
        return run("trochoid-ctl", "--connect", self.address, *login, *arguments)

    def token(self, role, world, *options):
        """The file of a new token."""
        file = self.key_file.with_name("token")
        made = run("trochoid-ctl", "token", "make", "--key", self.key_file, "--role", role, "--world", world, "--out", file, *options)
        assert made.returncode == 0, made.stderr
        return file

    def ctl_json(self, *arguments):
        done = self.ctl("--json", *arguments)
        if done.returncode != 0:
            raise AssertionError(f"ctl {arguments}: {done.stderr}")
        return json.loads(done.stdout)

    def sea_time_s(self):
        return self.ctl_json("time")["sea_time_s"]

    def probe(self, *arguments):
        return run("trochoid-probe", "--connect", self.address, *arguments)

    def start_probe(self, *arguments):
        probe = subprocess.Popen([BIN / "trochoid-probe", "--connect", self.address, *map(str, arguments)],
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self._probes.append(probe)
        return probe

    def stop(self):
        """SIGTERM; gives the exit status."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(timeout=PATIENCE_S)

    def close(self):
        for probe in self._probes:
            if probe.poll() is None:
                probe.kill()
                probe.communicate()
            probe.stdout.close()
            probe.stderr.close()
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._folder.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class ProgramTest(unittest.TestCase):
    """Assertions about programs."""

    maxDiff = 2000

    def assert_ends(self, done, status, *words, stream="stderr"):
        """Exit status, and words that the message has to hold; an operator's error is one line, after what the log says."""
        text = getattr(done, stream)
        self.assertEqual(done.returncode, status, f"stdout: {done.stdout[-2000:]}\nstderr: {done.stderr[-2000:]}")
        for word in words:
            self.assertIn(word, text)
        if status == 2:
            lines = done.stderr.splitlines()
            self.assertTrue(lines[-1].startswith(f"{pathlib.Path(done.args[0]).name}: "), done.stderr)
            self.assertEqual(sum(line.startswith("trochoid-") for line in lines), 1, done.stderr)

    def finish(self, process):
        """Output of a started process, which has to succeed."""
        try:
            out, err = process.communicate(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            self.fail(f"{process.args} did not end\n{out[-500:]}\n{err[-500:]}")
        self.assertEqual(process.returncode, 0, err)
        return out, err
