#!/usr/bin/env python3
"""Streamed pages end to end, in Chromium: folders that `vog page -o FOLDER/` writes and single files by ranges, from several servers and
origins; pictures at rest against `vog render` of the whole model, quantities, steps in time. Plans and failures need no browser:
streaming_plans_test.py, streaming_failures_test.py, ranges_test.py.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Chromium.
"""
import itertools
import json
import shutil
import subprocess
import threading

from page_test_case import COARSE, FACTOR_DB, VOG, run, vog
from quantity_test_case import write_flow
from site_server import SiteServer
from streaming_test_case import LEAST_PSNR_DB, SMALL, SiteTest, write_dust

FINE = "#subframes=1&error=0.5"  # at few pixels the coarsest chunk errs by one
FEW = 20000  # Gaussians of three chunks


class Streaming(SiteTest):
    @classmethod
    def make(cls):
        write_dust(cls.folder / "dust.ply", FEW)
        vog("page", "dust.ply", "-o", "site/", "--tf", "gray")

    def test_the_picture_at_rest_is_that_of_the_whole_model(self):
        self.start(size=(160, 120))
        self.assertEqual(self.value("vog.decodes().page"), 0)
        for view in ("{}", self.near(0.2), "{pixelError: 0.5}"):
            self.change(view)
            self.expect_same("dust.ply", least=LEAST_PSNR_DB)
        self.browser.key("5", "Digit5")  # parallel rays
        self.browser.settle()
        self.expect_same("dust.ply", least=LEAST_PSNR_DB)

    def test_from_inside_and_clipped(self):
        self.start(size=(160, 120))
        self.change(self.near(0.05))
        self.expect_same("dust.ply", least=LEAST_PSNR_DB)
        self.change("{clip: {lower: [-0.5, -2, -2], upper: [0.5, 2, 2]}}")
        self.expect_same("dust.ply", "--clip=-0.5,-2,-2,0.5,2,2", least=LEAST_PSNR_DB)

    def test_detail_is_chosen_by_keys_and_shown(self):
        self.start(fragment="#subframes=1&error=32")
        coarse = self.drawn
        self.assertLess(coarse, FEW)
        self.assertEqual(self.value("level.valueAsNumber"), 0)
        self.assertIn("error=32", self.value("vog.link()"))
        for _ in range(12):
            self.browser.key("]", "BracketRight")
        self.browser.settle()
        self.assertEqual(self.value("vog.state.pixelError"), 0.5)
        self.assertEqual(self.value("level.valueAsNumber"), self.value("Number(level.max)"))
        self.assertGreater(self.drawn, coarse)
        self.assertEqual(self.value("count.textContent"), f"{self.drawn:,} Gaussians")

    def test_a_lost_context_is_filled_again_without_requests(self):
        server = self.start()
        drawn, asked = self.drawn, len(server.paths)
        self.value("""new Promise((done) => {
            const loss = vog.canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
            vog.canvas.addEventListener('webglcontextrestored', () => setTimeout(done), {once: true});
            vog.canvas.addEventListener('webglcontextlost', () => setTimeout(() => loss.restoreContext()), {once: true});
            loss.loseContext();
        })""")
        self.browser.settle()
        self.assertEqual(self.drawn, drawn)
        self.assertEqual(len(server.paths), asked)
        self.expect_same("dust.ply", least=LEAST_PSNR_DB)

    def test_from_another_origin(self):
        chunks = self.serve(origin="*")
        page = (self.folder / "site/index.html").read_text()
        self.assertIn("connect-src 'self'", page)
        page = page.replace("connect-src 'self'", f"connect-src {chunks.url}")
        page = page.replace('"base":""', f'"base":"{chunks.url}"').replace('"base": ""', f'"base": "{chunks.url}"')
        (self.folder / "elsewhere").mkdir()
        (self.folder / "elsewhere/index.html").write_text(page)
        self.browser.viewport(*SMALL)
        server = self.serve("elsewhere")
        self.open(server.url)
        self.assertGreater(self.drawn, 0)
        self.assertEqual(server.paths, ["/"])
        self.assertGreater(len(chunks.chunks()), 0)

    def test_from_pythons_own_server(self):
        with self.pythons_server("site") as address:
            self.browser.viewport(*SMALL)
            self.open(address)
            self.expect_same("dust.ply", least=LEAST_PSNR_DB)

    def test_behind_nginx(self):
        with self.nginx("site") as (address, _):
            self.browser.viewport(*SMALL)
            self.open(address)
            self.expect_same("dust.ply", least=LEAST_PSNR_DB)

    def test_a_slow_network_shows_the_coarse_model_and_goes_on(self):
        self.begin()
        self.browser.settle()
        whole = self.drawn
        # The first chunk is the coarsest; the others wait until what is seen meanwhile has been looked at.
        numbers, looked_at = itertools.count(), threading.Event()

        def late(chunk):
            if next(numbers) > 0:
                looked_at.wait(60)
            return chunk
        self.begin(answers={".vogz": late})
        self.until("vog.source.drawn && vog.source.drawn.count > 0")
        first = self.value("[vog.source.drawn.count, vog.source.requests.toCome.length, stream.textContent, document.documentElement.dataset.drawn ?? '']")
        self.assertLess(first[0], whole)
        self.assertGreater(first[1], 0)
        self.assertIn("to come", first[2])
        self.assertEqual(first[3], "")
        # Frames go on while files are under way.
        self.assertEqual(self.value("""new Promise((done) => {
            let frames = 0;
            const next = () => {
                if (frames === 3) return done(frames);
                ++frames;
                requestAnimationFrame(next);
            };
            next();
        })"""), 3)
        self.until("!document.getElementById('progress').hidden")
        looked_at.set()
        self.browser.settle()
        self.assertEqual(self.drawn, whole)
        self.assertTrue(self.value("document.getElementById('progress').hidden"))

    def test_without_a_connection_the_page_says_so_and_waits(self):
        self.begin(fragment="#subframes=1&error=32")
        self.browser.settle()
        coarse = self.drawn

        def offline(is_off):
            self.browser.call("Network.emulateNetworkConditions", offline=is_off, latency=0, downloadThroughput=-1, uploadThroughput=-1)
        offline(True)
        try:
            self.value("vog.change({pixelError: 0.5})")
            self.until("!notice.hidden")
            self.assertIn("No answer from 127.0.0.1", self.notice())
            self.assertEqual(self.value("vog.source.drawn.count"), coarse)
        finally:
            offline(False)
        self.until("vog.source.requests.toCome.length === 0 && vog.source.drawn.count > " + str(coarse))
        self.assertEqual(self.notice(), "")

    def test_a_page_opened_as_a_file_says_what_to_do(self):
        self.browser.open(self.folder / "site/index.html")
        self.until("!failure.hidden")
        self.assertIn("vog serve", self.failure())


class Quantities(SiteTest):
    """Two fields."""

    @classmethod
    def make(cls):
        write_flow(cls.folder / "flow.ply", 9000)
        vog("page", "flow.ply", "-o", "flow/", "--precise")

    measured = {"column": 75.6, "mean": 60.2, "volume": 71.9, "maximum": 68.3}  # PSNR [dB]

    def expect_page_is(self, *options):
        self.picture()
        width, height = self.write_camera()
        if "volume" in options:  # pages draw every pixel
            options += ("--set", "precision=0")
        vog("render", "flow.ply", "-o", "cpu.png", "--camera", "camera.json", "--size", f"{width}x{height}", *options)
        self.hold(f"-PSNR of {options[1]} [dB]", -self.psnr("cpu.png", "web.png"), FACTOR_DB - self.measured[options[1]])

    def test_pictures_of_quantities_are_those_of_the_whole_model(self):
        self.start("flow", size=(100, 80))
        self.change({"show": "column", "scale": {"low": 0, "high": 3, "log": False}, "map": "viridis"})
        self.expect_page_is("--show", "column", "--tf", "viridis", "--range", "0,3")
        self.value("vog.page.models[0].mostColumn = 0")  # a colour for every pixel, as --set least-column=0
        self.change({"show": "mean", "field": 0, "part": "", "scale": {"low": 280, "high": 320, "log": False}})
        self.expect_page_is("--show", "mean", "--field", "temperature", "--tf", "viridis", "--range", "280,320", "--set", "least-column=0")
        self.change({"field": 1, "part": "x", "scale": {"low": -20, "high": 20, "log": False}})
        self.expect_page_is("--show", "mean", "--field", "velocity.x", "--tf", "viridis", "--range=-20,20", "--set", "least-column=0")

    def test_volumes_by_value_and_maxima(self):
        self.start("flow", size=(60, 50))
        transfer = {"name": "own", "colors": [[280, 0, 0, 1], [320, 1, 0.5, 0]], "opacity": [[280, 0], [320, 1]], "unit": 1}
        (self.folder / "tf.json").write_text(json.dumps(
            {"name": "own", "domain": [280, 320], "unit_distance": 1, "colors": transfer["colors"], "opacity": transfer["opacity"]}))
        self.value("vog.page.slabs = [8, 16]")
        self.change({"show": "volume", "field": 0, "part": "", "transfers": {"0": transfer}})
        self.expect_page_is("--show", "volume", "--field", "temperature", "--tf", "tf.json", "--slabs", 8)
        # What another transfer function hides is planned when the edits rest.
        turns = self.value("""(() => {
            const { turn } = vog.source, edited = { ...vog.state.transfers[0], unit: 2 };
            vog.change({ transfers: { 0: edited } });
            vog.source.now(false);
            return [turn, vog.source.turn];
        })()""")
        self.assertEqual(turns[0], turns[1])
        self.browser.settle()
        self.assertGreater(self.value("vog.source.turn"), turns[1])
        self.change({"show": "maximum", "scale": {"low": 270, "high": 330, "log": False}, "map": "viridis"})
        self.expect_page_is("--show", "maximum", "--field", "temperature", "--slabs", 16, "--tf", "viridis", "--range", "270,330")

    def test_the_probe_reads_chunks_that_are_drawn(self):
        self.start("flow", fragment="#subframes=1", size=(500, 300, COARSE))
        transfer = {"name": "own", "colors": [[280, 0, 0, 1], [320, 1, 0.5, 0]], "opacity": [[270, 0.9], [330, 0.9]], "unit": 0.1}
        self.value("vog.page.slabs[0] = 4")
        self.change({"show": "volume", "field": 0, "part": "", "transfers": {"0": transfer}})
        self.browser.mouse("mouseMoved", 250, 150)
        text = self.value("probe.textContent")
        self.assertIn("temperature", text)
        self.assertIn("opacity 1", text)


class Steps(SiteTest):
    @classmethod
    def make(cls):
        for n in range(4):
            write_dust(cls.folder / f"step{n}.ply", 3000, seed=3, shift=0.02 * n)
        vog("page", "step?.ply", "-o", "steps/", "--site", "--tf", "gray")

    def test_playing_goes_through_all_steps(self):
        self.start("steps", fragment="#subframes=1")
        self.value("vog.met = new Set(); vog.watch = setInterval(() => vog.met.add(vog.state.model), 5)")
        self.value("speed.value = '20'; play.click()")
        self.until("vog.met.size === 4")
        self.value("play.click(); clearInterval(vog.watch)")
        self.browser.settle()
        self.assertGreater(self.drawn, 0)


class Elsewhere(SiteTest):
    """Pages without models, in folders of their own."""

    def page_of(self, model, url, *options):
        """Writes page/index.html, whose model lies at an address."""
        folder = self.folder / "page"
        folder.mkdir(exist_ok=True)
        vog("page", model, "-o", "page/index.html", "--from", url, "--tf", "gray", *options)
        return (folder / "index.html").read_text()

    def begin_page(self, folder="page", **served):
        """Opens a page; does not wait for the picture."""
        return self.begin(folder, FINE, served=served)

    def expect_model(self, model):
        """Expects the picture at rest to be that of the whole model, without nodes."""
        self.expect_same(model, "--pixel-error", "0", least=LEAST_PSNR_DB)

    def other_server(self, folder, **settings):
        server = SiteServer(self.folder / folder, **settings).__enter__()
        self.addCleanup(server.__exit__)
        return server


class Ranges(Elsewhere):
    @classmethod
    def make(cls):
        write_dust(cls.folder / "dust.ply", FEW)
        (cls.folder / "files").mkdir()
        vog("pack", "dust.ply", "-o", "files/dust.vogz", "--hierarchy", "--deflate")
        vog("page", "files/dust.vogz", "-o", "files/index.html", "--from", "dust.vogz", "--tf", "gray")

    @property
    def size(self):
        return (self.folder / "files/dust.vogz").stat().st_size

    def expect_pictures(self):
        for view in ("{}", self.near(0.4), self.near(0.2)):
            self.change(view)
            self.expect_model("files/dust.vogz")

    def test_vog_serve_shows_a_compact_file_by_ranges(self):
        server = subprocess.Popen([VOG, "serve", self.folder / "files/dust.vogz", "--port", "0"], stdout=subprocess.PIPE, text=True)
        try:
            address = server.stdout.readline().strip()
            self.browser.viewport(160, 120)
            self.open(address)
            self.value("vog.change({map: 'gray'})")
            self.expect_pictures()
            self.assertEqual(self.value("vog.decodes().page"), 0)
            self.assertGreater(self.value("vog.source.root.parts.length"), 0)
        finally:
            server.terminate()
            server.wait()
            server.stdout.close()

    def test_from_pythons_own_server(self):
        with self.pythons_server("files") as address:
            self.browser.viewport(*SMALL)
            self.open(address, FINE)
            self.expect_model("files/dust.vogz")

    def test_behind_nginx(self):
        with self.nginx("files") as (address, log):
            self.browser.viewport(*SMALL)
            self.open(address, FINE)
            self.expect_model("files/dust.vogz")
        self.assertEqual({line.split()[0] for line in log() if "dust.vogz" in line}, {"206"})

    def test_from_another_origin(self):
        for fields in ({}, {"Access-Control-Expose-Headers": "Content-Range, ETag"}):
            files = self.other_server("files", origin="*", ranges=True)
            files.tag = '"1"'
            files.part = lambda first, body, now, fields=fields: (now.update(fields), body)[1]
            page = self.page_of("files/dust.vogz", files.url + "dust.vogz")
            self.assertIn(f"connect-src {files.url[:-1]};", page)
            server = self.begin_page()
            self.browser.settle()
            self.assertEqual(server.paths, ["/"])
            self.assertGreater(len(files.asked), 1)
            self.assertEqual(self.value("vog.source.source.marks.size ?? 0"), self.size if fields else 0)
            self.expect_model("files/dust.vogz")

    def test_another_origin_that_does_not_allow_the_page_is_named(self):
        files = self.other_server("files", ranges=True)
        self.page_of("files/dust.vogz", files.url + "dust.vogz")
        page = self.begin_page()
        self.until("!failure.hidden")
        for words in ("dust.vogz: ", "Access-Control-Allow-Origin", page.url[:-1], files.url[7:-1]):
            self.assertIn(words, self.failure())
        self.assertNotIn("\n", self.failure())
        self.browser.complaints = [line for line in self.browser.complaints if "CORS policy" not in line]

    def test_vog_serve_allows_an_origin(self):
        for allowed in (True, False):
            page = self.serve("page") if (self.folder / "page").exists() else None
            (self.folder / "page").mkdir(exist_ok=True)
            page = page or self.serve("page")
            words = ["--set", f"allow-origin={page.url[:-1]}"] if allowed else []
            server = subprocess.Popen([VOG, "serve", self.folder / "files/dust.vogz", "--port", "0", *words], stdout=subprocess.PIPE, text=True)
            try:
                address = server.stdout.readline().strip()
                self.page_of("files/dust.vogz", address + "dust.vogz")
                self.browser.viewport(*SMALL)
                self.browser.open(page.url, FINE)
                if allowed:
                    self.browser.settle()
                    self.expect_model("files/dust.vogz")
                else:
                    self.until("!notice.hidden || !failure.hidden")
                    self.assertIn("Access-Control-Allow-Origin", self.notice() + self.failure())
                    self.browser.complaints.clear()
            finally:
                server.terminate()
                server.wait()
                server.stdout.close()


class Fields(Elsewhere):
    """Two fields, and steps."""

    @classmethod
    def make(cls):
        write_flow(cls.folder / "flow.ply", 9000)
        (cls.folder / "files").mkdir()
        vog("pack", "flow.ply", "-o", "files/flow.vogz", "--hierarchy", "--deflate", "--set", "rounding=0.001", "--set", "field-rounding=0.0005")
        vog("page", "files/flow.vogz", "-o", "files/index.html", "--from", "flow.vogz")
        vog("page", "flow.ply", "-o", "flow/")

    def test_fields_come_when_they_are_shown(self):
        self.browser.viewport(100, 80)
        server = self.serve("files", ranges=True)
        self.open(server.url)
        before = len(server.asked)
        self.change({"show": "mean", "field": 0, "part": "", "scale": {"low": 280, "high": 320, "log": False}, "map": "viridis"})
        self.assertGreater(len(server.asked), before)
        self.value("vog.page.models[0].mostColumn = 0")  # a colour for every pixel, as --set least-column=0
        self.change({})
        for field, part, name, scale in ((0, "", "temperature", "280,320"), (1, "x", "velocity.x", "-20,20")):
            low, high = map(int, scale.split(","))
            self.change({"field": field, "part": part, "scale": {"low": low, "high": high, "log": False}})
            self.picture()
            width, height = self.write_camera()
            vog("render", "files/flow.vogz", "-o", "cpu.png", "--camera", "camera.json", "--size", f"{width}x{height}", "--show", "mean",
                "--field", name, "--tf", "viridis", f"--range={scale}", "--set", "least-column=0")
            self.hold("-PSNR of fields by ranges [dB]", -self.psnr("cpu.png", "web.png"), FACTOR_DB - 76.0)

    def test_a_site_elsewhere(self):
        files = self.other_server("flow", origin="*")
        page = self.page_of("flow", files.url[:-1])
        self.assertIn(f"connect-src {files.url[:-1]};", page)
        server = self.begin_page()
        self.browser.settle()
        self.assertEqual(server.paths, ["/"])
        self.assertIn("/manifest.json", files.paths)
        self.expect_model("flow")
        self.change({"show": "mean"})
        self.assertGreater(len(files.chunks(".0")), 0)

    def test_a_site_elsewhere_that_does_not_allow_the_page(self):
        files = self.other_server("flow")
        self.page_of("flow", files.url)
        self.begin_page()
        self.until("!failure.hidden")
        self.assertIn("manifest.json: ", self.failure())
        self.assertIn("Access-Control-Allow-Origin", self.failure())
        self.browser.complaints = [line for line in self.browser.complaints if "CORS policy" not in line]

    def test_a_site_in_a_folder_beside_the_page(self):
        (self.folder / "both").mkdir()
        shutil.copytree(self.folder / "flow", self.folder / "both/data")
        vog("page", "flow", "-o", "both/index.html", "--from", "data", "--tf", "gray")
        self.assertIn("connect-src 'self';", (self.folder / "both/index.html").read_text())
        self.begin_page("both")
        self.browser.settle()
        self.expect_model("flow")

    def test_a_page_opened_as_a_file_reads_another_origin(self):
        files = self.other_server("flow", origin="*")
        self.page_of("flow", files.url)
        self.open("page/index.html")
        self.assertGreater(self.drawn, 0)

    def test_a_page_opened_as_a_file_beside_its_file_says_what_to_do(self):
        self.browser.open(self.folder / "files/index.html")
        self.until("!failure.hidden")
        self.assertIn("python3 -m http.server", self.failure())


if __name__ == "__main__":
    run()
