"""What tests of streamed pages share: sites that `vog page -o FOLDER/` writes, served on loopback, in a browser or in Node.js."""
import base64
import contextlib
import json
import os
import random
import re
import shutil
import socket
import subprocess
import sys
import time
import unittest

from node import Node, NodePage, find_node
from page_test_case import FolderTest, PageTest, vog, write_model
from site_server import SiteServer

# Pixels of a page whose picture is not the subject: a GPU in software takes long for them.
SMALL = (120, 90)
# Gaussians of a model of seven chunks in three depths, since a chunk has 16,384 at most, the coarsest 8,192.
DUST = 60000
# A picture whose coarse parts err by a pixel at most, against that of the whole model (issue 24). Measured: 50.2 dB of dust from near; rounding,
# at 73 dB, moves that by a hundredth. Pages without coarse parts in view have bounds of their own.
LEAST_PSNR_DB = 50


def write_dust(path, count=DUST, seed=1, shift=0.0):
    """Writes a PLY of small Gaussians in clusters: several chunks, of which a near view needs few."""
    rng, rows = random.Random(seed), []
    clusters = [[rng.uniform(-1, 1) for _ in range(3)] for _ in range(40)]
    for n in range(count):
        center = clusters[n % len(clusters)]
        s = rng.uniform(0.004, 0.012)
        rows += [c + shift + rng.gauss(0, 0.08) for c in center] + [s, s, s, rng.uniform(5, 50)]
    write_model(path, rows)


class Served:
    """Servers of a test's own, and what pages say, whatever runs them: value() evaluates an expression there, begin() opens an address."""

    def serve(self, site="site", **settings):
        server = SiteServer(self.folder / site, **settings).__enter__()
        self.addCleanup(server.__exit__)
        self.server = server
        return server

    def begin(self, site="site", fragment="#subframes=1&embed", size=SMALL, served={}, **hooks):
        """Opens a served folder with hooks of the server; does not wait for the picture. served: arguments of SiteServer."""
        server = self.serve(site, **served)
        for name, value in hooks.items():
            setattr(server, name, value)
        self.begin_at(server.url, fragment, size)
        return server

    def start(self, *arguments, **more):
        """The same, and waits for the whole picture."""
        server = self.begin(*arguments, **more)
        self.settle()
        return server

    def settle(self):
        self.value("vog.settled()")

    def change(self, state):
        """Changes the state, given as JavaScript or values; waits for the whole picture."""
        self.value(f"vog.change({state if isinstance(state, str) else json.dumps(state)})")
        self.settle()

    def near(self, share):
        """A view from nearer, at a share of the first distance."""
        return ("{camera: {...vog.state.camera, eye: vog.state.camera.at.map((a, k) => "
                f"a + {share} * (vog.state.camera.eye[k] - a))}}}}")

    @property
    def drawn(self):
        return int(self.value("document.documentElement.dataset.drawn"))

    @property
    def loaded(self):
        return int(self.value("document.documentElement.dataset.loaded"))

    def notice(self):
        return self.value("notice.hidden ? '' : notice.textContent")

    def failure(self):
        return self.value("document.getElementById('failure-text').textContent")

    def watch_notices(self):
        """Has vog.lines collect what the page says from now on."""
        self.value("vog.lines = []; new MutationObserver(() => notice.textContent && vog.lines.push(notice.textContent))"
                   ".observe(notice, {childList: true})")

    def manifest(self, site="site"):
        return json.loads((self.folder / site / "manifest.json").read_text())

    def root(self, site="site"):
        return self.manifest(site)["models"][0]["root"]

    def parts_of_root(self, site="site"):
        """Rows below the root, from the manifest or its table."""
        root = self.root(site)
        if "parts" in root:
            return root["parts"]
        return json.loads((self.folder / site / "chunks" / f"{root['table']}.json").read_text())["parts"]

    @contextlib.contextmanager
    def pythons_server(self, folder):
        """python3 -m http.server of a folder; gives its address."""
        server = subprocess.Popen([sys.executable, "-u", "-m", "http.server", "0", "--bind", "127.0.0.1", "--directory", self.folder / folder],
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        try:
            yield re.search(r"http://[0-9.:]+/", server.stdout.readline()).group()
        finally:
            server.terminate()
            server.wait()
            server.stdout.close()

    @contextlib.contextmanager
    def nginx(self, served):
        """nginx of a folder; gives its address and a function that returns the lines of its log: status, path, bytes sent."""
        if not shutil.which("nginx"):
            print("skipped: no nginx here", file=sys.stderr)
            raise unittest.SkipTest("no nginx")
        folder = self.folder / f"nginx-{served}"
        folder.mkdir()
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        places = "".join(f"{kind}_temp_path {folder}/{kind}; " for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        (folder / "nginx.conf").write_text(
            # The folder is the test's user's own; others than root may not set one.
            ("user root; " if os.getuid() == 0 else "")
            + f"daemon off; pid {folder}/pid; error_log {folder}/error.log; events {{}} http {{ {places}"
            f"log_format sizes '$status $request_uri $bytes_sent'; access_log {folder}/access.log sizes; "
            f"types {{ text/html html; application/json json; }} gzip on; gzip_types *; "
            f"server {{ listen 127.0.0.1:{port}; root {self.folder}/{served}; }} }}")
        nginx = subprocess.Popen(["nginx", "-e", f"{folder}/error.log", "-c", f"{folder}/nginx.conf"])
        try:
            for _ in range(100):
                if (folder / "pid").exists():
                    break
                time.sleep(0.1)
            yield f"http://127.0.0.1:{port}/", lambda: (folder / "access.log").read_text().splitlines()
        finally:
            nginx.terminate()
            nginx.wait()


class SiteTest(Served, PageTest):
    """Streamed pages in the browser."""

    def tearDown(self):
        # The browser's own line on each answer that it did not get.
        self.browser.complaints = [line for line in self.browser.complaints if "Failed to load resource" not in line]
        super().tearDown()

    def begin_at(self, url, fragment="#subframes=1&embed", size=SMALL):
        self.browser.viewport(*size)
        self.browser.open(url, fragment)

    def open(self, page, fragment="#subframes=1&embed"):
        if str(page).startswith("http"):
            self.browser.open(page, fragment)
            self.browser.settle()
        else:
            super().open(page, fragment)


class NodeTest(FolderTest):
    """Modules of the page in Node.js: their exports are global for value()."""

    modules = ()
    node = None

    @classmethod
    def setUpClass(cls):
        if not find_node():
            raise unittest.SkipTest("no Node.js here (scripts/install-deps.sh installs it)")
        super().setUpClass()
        if cls.modules:
            cls.node = cls.enterClassContext(Node(*cls.modules))

    def value(self, expression):
        return self.node.evaluate(expression)


class NodeSiteTest(Served, NodeTest):
    """Streamed pages in Node.js: requests, plans, memory and messages, without a picture (node/page.mjs)."""

    # Modules, as of Node: a tenth of the pauses between tries, which would be 4.5 s before a server counts as gone.
    changed = {"stream/requests.js": ("firstPause = 300", "firstPause = 30")}

    def tearDown(self):
        self.close()

    def close(self):
        page, self.node = self.node, None
        if page:
            complaints = page.evaluate("complaints")
            page.__exit__()
            self.assertEqual(complaints, [], "the page's console is not silent")

    def begin_at(self, url, fragment="#subframes=1&embed", size=SMALL):
        self.close()
        self.node = NodePage(url, fragment, size, changed=self.changed)

    def resize(self, width, height):
        self.value(f"vog.resize({width}, {height})")
        self.settle()

    def expect_whole(self, model="dust.ply", least=LEAST_PSNR_DB):
        """Expects what is drawn to look like all of a model (node/likeness.mjs)."""
        vog("pack", model, "-o", "whole.vogz", "--deflate", "--set", "rounding=0.001")
        data = base64.b64encode((self.folder / "whole.vogz").read_bytes()).decode()
        self.settle()
        found = self.value(f"likeness('{data}')")
        self.assertGreater(found["most"], 0.2, "a view of nothing")
        self.hold("-PSNR of V [dB]", -found["psnr"], -least)
