"""One port, four ways in: every program's --connect, with and without TLS, against the real server."""
import pathlib
import socket
import subprocess
import tempfile
import unittest

from sea_programs import PATIENCE_S, ProgramTest, Server, run, scene


def make_certificate(folder, hosts):
    """A self-signed certificate for these names and addresses; its file and its key's."""
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2",
                    "-subj", "/CN=Trochoid test", "-addext", "subjectAltName=" + ",".join(hosts),
                    "-keyout", key, "-out", certificate], check=True, capture_output=True, timeout=PATIENCE_S)
    return certificate, key


def own_address():
    """An address of this machine that is not loopback; None where it has none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: only chooses the route
        except OSError:
            return None
        address = probe.getsockname()[0]
    return None if address.startswith("127.") else address


class WithCertificate(ProgramTest):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="trochoid-test.")
        cls.addClassCleanup(folder.cleanup)
        cls.certificate, cls.key = make_certificate(pathlib.Path(folder.name), ["DNS:localhost", "IP:127.0.0.1"])

    def serve(self, *options):
        server = Server(scene("open-sea"), *options)
        self.addCleanup(server.close)
        return server


class FourForms(WithCertificate):
    def test_all_lead_to_the_same_sea(self):
        server = self.serve("--tls-cert", self.certificate, "--tls-key", self.key)
        for scheme, trust in (("tcp", ()), ("ws", ()), ("tls", ("--ca", self.certificate)), ("wss", ("--ca", self.certificate))):
            for host in ("localhost", "127.0.0.1"):
                with self.subTest(scheme=scheme, host=host):
                    address = f"{scheme}://{host}:{server.port}"
                    listed = run("trochoid-ctl", "--connect", address, *trust, "list")
                    self.assert_ends(listed, 0, "trade wind", "squall", stream="stdout")
            with self.subTest(scheme=scheme, what="the same bits, the land and a change"):
                probed = run("trochoid-probe", "--connect", address, *trust, "--region", "0,0,300", "--points", 50, "--compare")
                self.assert_ends(probed, 0, "50 of 50 identical", stream="stdout")
                wind = run("trochoid-ctl", "--connect", address, *trust, "--sign-with", server.key_file, "start-wind", "--speed", 8,
                           "--towards", 30, "--origin", "-100,200", "--fetch-km", 1, "--width-km", 0.5)
                self.assert_ends(wind, 0, "the wind starts", stream="stdout")

    def test_trust_is_asked_for(self):
        server = self.serve("--tls-cert", self.certificate, "--tls-key", self.key)
        for scheme in ("tls", "wss"):
            done = run("trochoid-ctl", "--connect", f"{scheme}://localhost:{server.port}", "list")
            self.assert_ends(done, 2, "is not trusted", "--ca FILE")
            done = run("trochoid-ctl", "--connect", f"{scheme}://[::1]:{server.port}", "--ca", self.certificate, "list")
            self.assert_ends(done, 2, "made out to localhost, 127.0.0.1, not to ::1")

    def test_a_server_without_tls(self):
        server = self.serve()
        for scheme, plain in (("tls", "127.0.0.1"), ("wss", "ws://127.0.0.1")):
            done = run("trochoid-ctl", "--connect", f"{scheme}://127.0.0.1:{server.port}", "list")
            self.assert_ends(done, 2, "TLS", f"use --connect {plain}:{server.port}")


class OffLoopback(WithCertificate):
    def setUp(self):
        self.address = own_address()
        if self.address is None:
            self.skipTest("this machine has no address but loopback's")

    def test_plain_text_is_refused_with_the_address_to_use(self):
        server = self.serve("--bind", self.address, "--tls-cert", self.certificate, "--tls-key", self.key, "--viewer-tokens", "never")
        done = run("trochoid-ctl", "--connect", f"{self.address}:{server.port}", "list")
        self.assert_ends(done, 1, f"--connect tls://{self.address}:{server.port}")
        done = run("trochoid-ctl", "--connect", f"ws://{self.address}:{server.port}", "list")
        self.assertIn(f"--connect wss://{self.address}:{server.port}", done.stderr)
        self.assertIn(done.returncode, (1, 2), done.stderr)


if __name__ == "__main__":
    unittest.main()
