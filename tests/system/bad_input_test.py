"""Bad files, options, ports, bytes and endings: each gives one clear message or code; nothing crashes, nothing hangs."""
import os
import pathlib
import random
import signal
import socket
import struct
import subprocess
import tempfile
import time
import unittest

from sea_programs import BIN, PATIENCE_S, ProgramTest, Server, run, scene

MAGIC = b"TROCHOID"


class BadStart(ProgramTest):
    def start(self, *arguments):
        return run("trochoid-server", "--port", 0, *arguments)

    def test_options(self):
        self.assert_ends(run("trochoid-server"), 2, "--scene")
        self.assert_ends(self.start("--scene", scene("open-sea"), "--frobnicate"), 2, "--frobnicate", "--help")
        self.assert_ends(run("trochoid-server", "--scene", scene("open-sea"), "--port", 99999), 2, "--port")

    def test_scene_files(self):
        self.assert_ends(self.start("--scene", "/nowhere/scene.toml"), 2, "/nowhere/scene.toml")
        with tempfile.TemporaryDirectory() as folder:
            bad = pathlib.Path(folder) / "scene.toml"
            for text, word in (('name = "x', "scene.toml:1"), ('name = "x"\nwinds = 3\n', "winds"),
                               ('name = "x"\nterrain = "none.terrain"\n', "none.terrain"),
                               ('name = "x"\n[[wind]]\nname = "w"\nspeed = 900\n', "speed"), ("\0\xff\x01", str(bad))):
                bad.write_text(text, encoding="latin-1")
                self.assert_ends(self.start("--scene", bad), 2, word)
            (pathlib.Path(folder) / "none.terrain").write_bytes(os.urandom(4096))
            bad.write_text('name = "x"\nterrain = "none.terrain"\n')
            self.assert_ends(self.start("--scene", bad), 2, "none.terrain")

    def test_a_port_that_is_taken(self):
        with Server(scene("open-sea")) as server:
            self.assert_ends(run("trochoid-server", "--scene", scene("open-sea"), "--port", server.port), 2, str(server.port))

    def test_other_addresses_than_loopback_are_refused(self):
        for address in ("0.0.0.0", "::", "192.0.2.1"):
            self.assert_ends(self.start("--scene", scene("open-sea"), "--bind", address), 2, address, "loopback")

    def test_key_files(self):
        sea = ("--scene", scene("open-sea"))
        self.assert_ends(self.start(*sea, "--token-key", "/nowhere/key"), 2, "--token-key /nowhere/key")
        self.assert_ends(self.start(*sea, "--ticket-key", "/nowhere/key"), 2, "--ticket-key /nowhere/key")
        self.assert_ends(self.start(*sea, "--token-key", scene("open-sea")), 2, "no public Ed25519 key", "new-key")
        self.assert_ends(self.start(*sea, "--ticket-key", scene("open-sea")), 2, "openssl rand -hex 32")
        self.assert_ends(self.start(*sea, "--viewer-tokens", "always"), 2, "--token-key")


class NobodyThere(ProgramTest):
    def test_clients_say_so(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))  # bound, but nobody listens
            address = f"127.0.0.1:{taken.getsockname()[1]}"
            self.assert_ends(run("trochoid-ctl", "--connect", address, "list"), 2, f"nothing listens at {address}")
            self.assert_ends(run("trochoid-probe", "--connect", address, "--point", "0,0"), 2, f"nothing listens at {address}")

    def test_another_program_on_the_port(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            client = subprocess.Popen([BIN / "trochoid-ctl", "--connect", f"127.0.0.1:{other.getsockname()[1]}", "list"],
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            other.settimeout(PATIENCE_S)
            peer, _ = other.accept()
            with peer:
                peer.sendall(b"SSH-2.0-OpenSSH_9.2p1 Debian-2\r\n")
                _, err = client.communicate(timeout=PATIENCE_S)
            self.assertEqual(client.returncode, 1, err)
            self.assertIn("does not speak Trochoid's protocol", err)


class Hostile(ProgramTest):
    """Whatever bytes arrive, the server goes on serving others."""

    @classmethod
    def setUpClass(cls):
        cls.server = Server(scene("open-sea"))

    @classmethod
    def tearDownClass(cls):
        status = cls.server.stop()
        cls.server.close()
        assert status == 0, status

    def tearDown(self):
        self.assertIsNone(self.server.process.poll(), self.server.log()[-3000:])
        self.assert_ends(self.server.probe("--point", "0,0", "--compare"), 0, "1 of 1 identical", stream="stdout")

    def answer_to(self, data):
        """What the server says before it closes."""
        with socket.create_connection(("127.0.0.1", self.server.port), timeout=PATIENCE_S) as peer:
            try:
                peer.sendall(data)
                peer.shutdown(socket.SHUT_WR)
            except OSError:
                pass
            said = b""
            try:
                while True:
                    more = peer.recv(65536)
                    if not more:
                        break
                    said += more
            except ConnectionError:
                pass
            return said

    def test_garbage(self):
        dice = random.Random(4)
        for size in (1, 7, 8, 9, 100, 5000, 200_000):
            self.answer_to(dice.randbytes(size))

    def test_garbage_after_the_magic_gets_a_goodbye(self):
        dice = random.Random(5)
        for body in (dice.randbytes(64), dice.randbytes(4096), b"\xff" * 32):
            said = self.answer_to(MAGIC + struct.pack("<II", len(body), 0) + body)
            self.assertEqual(said[12:16], b"TRCS", said[:40])
        self.assertEqual(self.answer_to(MAGIC + struct.pack("<II", 0xFFFFFFF0, 0))[12:16], b"TRCS", "an endless frame")
        self.assertEqual(self.answer_to(MAGIC + struct.pack("<II", 8, 1) + b"12345678")[12:16], b"TRCS", "a bad header")

    def test_truncated(self):
        for data in (MAGIC[:3], MAGIC, MAGIC + b"\x10", MAGIC + struct.pack("<II", 100, 0) + b"x" * 50):
            self.answer_to(data)

    def test_silence_ends_at_the_deadline(self):
        with socket.create_connection(("127.0.0.1", self.server.port), timeout=15) as peer:
            said = peer.recv(65536)
            self.assertEqual(said[12:16], b"TRCS", "the goodbye that names the hello deadline")

    def test_many_who_come_and_go(self):
        peers = [socket.create_connection(("127.0.0.1", self.server.port), timeout=PATIENCE_S) for _ in range(200)]
        for i, peer in enumerate(peers):
            if i % 2:
                peer.sendall(MAGIC)
            peer.close()


class Ending(ProgramTest):
    def test_term_says_goodbye_and_ends_with_0(self):
        with Server(scene("open-sea")) as server:
            watchers = [server.start_probe("--point", "0,0", "--watch", "--every", 0.1) for _ in range(2)]
            for watcher in watchers:
                watcher.stdout.readline()
            begin = time.monotonic()
            self.assertEqual(server.stop(), 0, server.log())
            self.assertLess(time.monotonic() - begin, 10)
            time.sleep(1)
            for watcher in watchers:
                watcher.send_signal(signal.SIGTERM)
                out, err = self.finish(watcher)
                self.assertIn("server gone (the server says:", err)
                self.assertIn("trying again in", err)
                self.assertGreater(len(out.splitlines()), 3, "the water did not go on from what was known")

    def test_a_server_that_comes_back_is_found_again(self):
        with Server(scene("open-sea")) as first:
            watcher = first.start_probe("--point", "0,0", "--watch", "--every", 0.2)
            watcher.stdout.readline()
            first.process.kill()
            first.process.wait()
            with tempfile.TemporaryDirectory() as folder:
                second = subprocess.Popen([BIN / "trochoid-server", "--scene", scene("open-sea"), "--port", str(first.port)],
                                          stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder)
                try:
                    time.sleep(6)
                    watcher.send_signal(signal.SIGTERM)
                    out, err = self.finish(watcher)
                    self.assertIn("server gone", err)
                    self.assertIn("| exact |", out.splitlines()[-1])
                    self.assertIn("exact, ", out.splitlines()[-2])
                finally:
                    second.terminate()
                    self.assertEqual(second.wait(timeout=PATIENCE_S), 0)


if __name__ == "__main__":
    unittest.main()
