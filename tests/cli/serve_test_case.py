"""What tests of vog serve share: a site, a server on 127.0.0.1 at a free port, requests as browsers and others send them."""
import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

VOG = os.environ.get("VOG_COMMAND", "vog")
CHUNK = "0123456789abcdef0123456789abcdef"
SECONDS = 60  # until a test gives up, on a busy machine


class Server:
    """vog serve, until stop()."""

    def __init__(self, *words, **settings):
        settings.setdefault("stderr", subprocess.PIPE)
        self.process = subprocess.Popen([VOG, "serve", *map(str, words)], stdout=subprocess.PIPE, text=True, **settings)
        self.url = self.process.stdout.readline().strip()
        self.port = int(self.url.split(":")[-1].split("/")[0]) if self.url else 0

    def stop(self, number=signal.SIGINT):
        """Exit code, rest of standard output and standard error."""
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=SECONDS)
        return self.process.returncode, out, err

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=SECONDS)

    def raw(self, request):
        """All bytes that come back for these bytes."""
        with self.connect() as client:
            client.sendall(request)
            return received(client)

    def status(self, path, *fields, method=b"GET"):
        path = path if isinstance(path, bytes) else path.encode()
        lines = [method + b" " + path + b" HTTP/1.1", b"Host: localhost", b"Connection: close", *fields, b"", b""]
        answer = self.raw(b"\r\n".join(lines))
        return int(answer.split(b" ")[1]), answer.partition(b"\r\n\r\n")[2]

    def get(self, path, method="GET", **fields):
        client = http.client.HTTPConnection("127.0.0.1", self.port, timeout=SECONDS)
        client.request(method, path, headers={name.replace("_", "-"): value for name, value in fields.items()})
        answer = client.getresponse()
        body = answer.read()
        client.close()
        return answer, body


def received(client):
    data = b""
    while True:
        try:
            piece = client.recv(1 << 16)
        except ConnectionResetError:
            return data
        if not piece:
            return data
        data += piece


def make_site(folder):
    (folder / "chunks").mkdir(parents=True)
    (folder / "index.html").write_text("<!DOCTYPE html><title>a site</title>")
    (folder / "manifest.json").write_text('{"format": "vog site", "version": 1}')
    (folder / "chunks" / f"{CHUNK}.vogz").write_bytes(bytes(n * n % 251 for n in range(200_000)))
    (folder / "chunks" / f"{CHUNK}.0").write_bytes(b"VOGF")
    (folder / "chunks" / f"{CHUNK}.json").write_text('{"parts": []}')
    (folder / "chunks" / "other.vogz").write_bytes(b"named by hand")
    (folder / "a b+ü.txt").write_text("spaces")
    (folder / "empty.css").write_text("")
    (folder / ".hidden").write_text("secret")
    (folder / ".folder").mkdir()
    (folder / ".folder" / "x.txt").write_text("secret")
    (folder.parent / "secret.txt").write_text("secret")
    (folder.parent / (folder.name + "-beside")).mkdir()  # begins like the site
    (folder.parent / (folder.name + "-beside") / "x.txt").write_text("secret")


class ServeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.made.name)
        cls.site = cls.folder / "site"
        make_site(cls.site)
        cls.server = Server(cls.site, "--port", "0")

    @classmethod
    def tearDownClass(cls):
        code, out, err = cls.server.stop()
        cls.made.cleanup()
        assert (code, out, err) == (0, "", ""), (code, out, err)

    def serve(self, *words, **settings):
        """Another server, ended with the test."""
        server = Server(*words, **settings)

        def end():
            if server.process.poll() is None:
                server.process.kill()
                server.process.communicate()

        self.addCleanup(end)
        self.assertTrue(server.url, "no address printed")
        return server


def run():
    """Runs the tests of the program. Exits with 77, which ctest takes as skipped, where the build has no HTTP library."""
    parts = json.loads(subprocess.run([VOG, "doctor", "--json"], capture_output=True, text=True, check=True).stdout)["libraries"]
    if not next(part["found"] for part in parts if part["name"] == "cpp-httplib"):
        print("vog serve is not tested: this build has no cpp-httplib", file=sys.stderr)
        sys.exit(77)
    unittest.main()
