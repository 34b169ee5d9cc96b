#!/usr/bin/env python3
"""Pages that stream a compact file by ranges, and pages whose models lie elsewhere: pictures at rest against `vog render`, what is
requested, servers without ranges, other origins, files that change, are cut, are of another kind or hostile.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Chromium.
"""
import base64
import json
import shutil
import subprocess

from browser import modules
from page_test_case import VOG, run, vog
from quantity_test_case import write_flow
from site_server import DROP, SiteServer
from streaming_test_case import SMALL, SiteTest, write_dust

DUST = 60000
LEAST_PSNR_DB = 50  # as of sites
FINE = "#subframes=1&error=0.5"  # at few pixels the coarsest chunk errs by one
FIRST_BYTES = 65536  # of the first request


class Elsewhere(SiteTest):
    """Pages without models, in folders of their own."""

    def page_of(self, model, url, *options):
        """Writes page/index.html, whose model lies at an address."""
        folder = self.folder / "page"
        folder.mkdir(exist_ok=True)
        vog("export", model, "-o", "page/index.html", "--from", url, "--tf", "gray", *options)
        return (folder / "index.html").read_text()

    def begin_page(self, folder="page", fragment=FINE, **settings):
        """Opens a page; does not wait for the picture."""
        self.browser.viewport(*SMALL)
        server = self.serve(folder, **settings)
        self.browser.open(server.url, fragment)
        return server

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
        write_dust(cls.folder / "dust.ply", DUST)
        (cls.folder / "files").mkdir()
        vog("export", "dust.ply", "-o", "files/dust.vogz", "--hierarchy", "--deflate")
        vog("export", "files/dust.vogz", "-o", "files/index.html", "--from", "dust.vogz", "--tf", "gray")

    @property
    def size(self):
        return (self.folder / "files/dust.vogz").stat().st_size

    def begin(self, fragment=FINE, ranges=True, **hooks):
        """Opens the page with hooks of the server; does not wait for the picture."""
        self.browser.viewport(*SMALL)
        server = self.serve("files", ranges=ranges)
        for name, value in hooks.items():
            setattr(server, name, value)
        self.browser.open(server.url, fragment)
        return server

    def expect_pictures(self):
        for view in ("{}", self.near(0.4), self.near(0.2)):
            self.change(view)
            self.expect_model("files/dust.vogz")

    # --- Servers. ---

    def test_vog_serve_shows_a_compact_file_by_ranges(self):
        server = subprocess.Popen([VOG, "serve", self.folder / "files/dust.vogz", "--port", "0"], stdout=subprocess.PIPE, text=True)
        try:
            address = server.stdout.readline().strip()
            self.browser.viewport(320, 240)
            self.open(address)
            self.value("vog.change({map: 'gray'})")
            self.expect_pictures()
            self.assertEqual(self.value("vog.decodes().page"), 0)
            self.assertGreater(self.value("vog.source.root.parts.length"), 1)
        finally:
            server.terminate()
            server.wait()
            server.stdout.close()

    def test_the_header_comes_first_and_the_picture_is_that_of_the_model(self):
        server = self.begin()
        self.browser.settle()
        self.assertEqual(server.asked[0], (0, FIRST_BYTES - 1))
        self.assertEqual(len(server.asked), len(set(server.asked)))
        self.assertEqual(self.loaded, server.sent - (self.folder / "files/index.html").stat().st_size)
        # The header and the coarsest chunk: what is before the first picture.
        header = self.value("vog.source.source.here.length")
        self.assertEqual(header, FIRST_BYTES)
        self.browser.viewport(320, 240)
        self.browser.settle()
        self.expect_pictures()
        self.browser.key("5", "Digit5")  # parallel rays
        self.browser.settle()
        self.expect_model("files/dust.vogz")

    def test_a_small_picture_takes_a_part_of_the_file_and_a_near_view_more(self):
        server = self.begin("#subframes=1&error=16")
        self.browser.settle()
        few = self.loaded
        self.assertLess(few, 0.5 * self.size)
        self.assertLess(self.drawn, DUST)
        self.value(f"vog.change({self.near(0.2)}); vog.change({{pixelError: 0.5}})")
        self.browser.settle()
        self.assertGreater(self.loaded, few)
        asked = len(server.asked)
        self.change(self.near(5))
        self.assertEqual(len(server.asked), asked)

    def test_a_long_header_takes_a_second_request(self):
        page = (self.folder / "files/index.html").read_text()
        self.assertIn("firstBytes = 1 << 16", page)
        server = self.begin(answers={"/": page.replace("firstBytes = 1 << 16", "firstBytes = 100").encode()})
        self.browser.settle()
        self.assertEqual(server.asked[0], (0, 99))
        self.assertEqual(server.asked[1][0], 100)
        self.expect_model("files/dust.vogz")

    def test_a_server_without_ranges_sends_a_small_file_whole(self):
        server = self.begin(ranges=False)
        self.browser.settle()
        self.assertEqual(server.paths.count("/dust.vogz"), 1)
        self.assertEqual(self.loaded, self.size)
        self.expect_pictures()
        self.assertEqual(server.paths.count("/dust.vogz"), 1)

    def test_a_large_file_of_a_server_without_ranges_is_refused(self):
        page = (self.folder / "files/index.html").read_text()
        self.assertIn("mostWhole = 64e6", page)
        server = self.begin(ranges=False, answers={"/": page.replace("mostWhole = 64e6", "mostWhole = 1e5").encode()})
        self.until("!failure.hidden")
        self.assertIn("answers no ranges", self.failure())
        self.assertIn("-o FOLDER/", self.failure())
        self.assertNotIn("\n", self.failure())
        self.assertEqual(server.paths.count("/dust.vogz"), 1)

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

    # --- Other origins. ---

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
            words = ["--allow-origin", page.url[:-1]] if allowed else []
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

    # --- Files that are not what they were. ---

    def test_a_file_that_changes_is_said_and_the_picture_stays(self):
        server = self.begin("#subframes=1&error=32", tag='"1"')
        self.browser.settle()
        coarse = self.drawn
        server.tag = '"2"'
        asked = len(server.asked)
        self.value("vog.change({pixelError: 0.5})")
        self.until("!notice.hidden")
        self.assertIn("has changed on the server, reload this page", self.notice())
        self.browser.settle()
        self.assertGreaterEqual(self.drawn, coarse)
        self.assertLessEqual(len(server.asked), asked + 6)  # those under way

    def expect_coarse(self, words, answer, first=FIRST_BYTES):
        """Expects the page to go on with the parent of parts whose range has a bad answer, and one line."""
        def bad(begin, body, fields):
            return answer(body, fields) if begin >= first else body
        self.begin(part=bad)
        self.value("vog.lines = []; new MutationObserver(() => notice.textContent && vog.lines.push(notice.textContent))"
                   ".observe(notice, {childList: true})")
        self.browser.settle()
        self.assertGreater(self.drawn, 0)
        self.assertLess(self.drawn, DUST)
        self.assertIn(words, self.notice())
        self.assertIn("dust.vogz, bytes from", self.notice())
        self.assertIn("stays coarse there", self.notice())
        self.assertEqual(self.value("vog.lines.length"), 1)
        self.assertGreater(self.psnr(self.picture(), self.render("files/dust.vogz", "--pixel-error", "0")), 15)

    def test_cut_ranges(self):
        self.expect_coarse("expected", lambda body, fields: body[:len(body) // 2])

    def test_changed_bytes(self):
        self.expect_coarse("damaged", lambda body, fields: body[:-40] + bytes([body[-40] ^ 1]) + body[-39:])

    def test_ranges_beyond_the_end(self):
        self.expect_coarse("HTTP 416", lambda body, fields: 416)

    def test_other_ranges_than_were_asked_for(self):
        def other(body, fields):
            fields["Content-Range"] = "bytes 5-9/10"
            return body
        self.expect_coarse("has changed" if self.size != 10 else "", other)

        def wrong(body, fields):
            fields["Content-Range"] = f"bytes 5-9/{self.size}"
            return body
        self.expect_coarse("sends bytes 5-9", wrong)

    def test_longer_ranges_than_were_asked_for(self):
        def longer(body, fields):
            del fields["Content-Range"]
            return body + b"x"
        self.expect_coarse("more than the", longer)

    def test_dropped_connections_are_tried_again(self):
        dropped = set()

        def once(first, body, fields):
            if first in dropped:
                return body
            dropped.add(first)
            return DROP
        self.begin(part=once)
        self.browser.settle()
        self.assertEqual(self.notice(), "")
        self.expect_model("files/dust.vogz")

    def test_other_files_are_refused_in_a_line(self):
        vog("export", "dust.ply", "-o", "zstd.vogz", "--hierarchy")
        vog("export", "dust.ply", "-o", "flat.vogz", "--deflate")
        whole = (self.folder / "files/dust.vogz").read_bytes()
        for body, words in ((self.folder / "zstd.vogz", "packed by zstd"), (self.folder / "flat.vogz", "--hierarchy --deflate"),
                            (b"<!doctype html>", "no compact model"), (b"", "HTTP 416"), (whole[:8] + b"\x02" + whole[9:], "version 2"),
                            (whole[:60] + bytes([whole[60] ^ 1]) + whole[61:], "damaged"), (whole[:60], "60 bytes, expected a header"),
                            (whole[:-1], f"{len(whole) - 1} bytes, expected the {len(whole)} of its table"), (404, "HTTP 404")):
            body = body.read_bytes() if hasattr(body, "read_bytes") else body
            self.begin(answers={"dust.vogz": body})
            self.until("!failure.hidden")
            self.assertIn(words, self.failure())
            self.assertIn("dust.vogz", self.failure())
            self.assertNotIn("\n", self.failure())

    def test_the_command_refuses_other_files_and_addresses(self):
        vog("export", "dust.ply", "-o", "zstd.vogz", "--hierarchy")
        self.assertIn("zstd", self.refused("export", "zstd.vogz", "-o", "bad.html", "--from", "zstd.vogz"))
        for url in ("ftp://host/a.vogz", "https://user:word@host/a.vogz", "javascript:alert(1)", "//host/a.vogz", "https://host/a b.vogz",
                    'https://host/"a.vogz', "https://host/'a.vogz", "https://ho;st/a.vogz", "https://*/a.vogz", "https://host:x/a", "https:host", "a\\b",
                    "https://host/a/", "#a", "", "https://", "data:,a", "https://h\u00f6st/a"):
            line = self.refused("export", "files/dust.vogz", "-o", "bad.html", "--from", url)
            self.assertIn("expected", line, url)
            self.assertEqual(line.count("\n"), 1, line)
        self.assertFalse((self.folder / "bad.html").exists())


class Fields(Elsewhere):
    """Two fields, and steps."""

    @classmethod
    def make(cls):
        write_flow(cls.folder / "flow.ply", 9000)
        (cls.folder / "files").mkdir()
        vog("export", "flow.ply", "-o", "files/flow.vogz", "--hierarchy", "--deflate", "--step", "0.001", "--field-step", "0.0005")
        vog("export", "files/flow.vogz", "-o", "files/index.html", "--from", "flow.vogz")
        vog("export", "flow.ply", "-o", "flow/")

    def test_fields_come_when_they_are_shown(self):
        self.browser.viewport(100, 80)
        server = self.serve("files", ranges=True)
        self.open(server.url)
        before = len(server.asked)
        self.change({"show": "mean", "field": 0, "part": "", "scale": {"low": 280, "high": 320, "log": False}, "map": "viridis"})
        self.assertGreater(len(server.asked), before)
        self.value("vog.page.models[0].mostColumn = 0")  # a colour for every pixel, as --least-column 0
        self.change({})
        for field, part, name, scale in ((0, "", "temperature", "280,320"), (1, "x", "velocity.x", "-20,20")):
            low, high = map(int, scale.split(","))
            self.change({"field": field, "part": part, "scale": {"low": low, "high": high, "log": False}})
            self.picture()
            width, height = self.write_camera()
            vog("render", "files/flow.vogz", "-o", "cpu.png", "--camera", "camera.json", "--size", f"{width}x{height}", "--show", "mean",
                "--field", name, "--tf", "viridis", f"--range={scale}", "--least-column", "0")
            self.assertGreater(self.psnr("cpu.png", "web.png"), LEAST_PSNR_DB, name)

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
        vog("export", "flow", "-o", "both/index.html", "--from", "data", "--tf", "gray")
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


CHECKSUM = """const checksum = (bytes) => {
    let crc = ~0;
    for (const byte of bytes) {
        crc ^= byte;
        for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
    }
    return ~crc >>> 0;
};"""


class Checksums(Elsewhere):
    """A changed byte of any file."""

    @classmethod
    def make(cls):
        write_flow(cls.folder / "flow.ply", 300)
        vog("export", "flow.ply", "-o", "flow/")

    def missed(self, call, *files):
        """Places of bytes of the last file whose change a decoder does not notice."""
        texts = [base64.b64encode(file.read_bytes()).decode() for file in files]
        return self.value(f"""(async () => {{
            const files = {json.dumps(texts)}.map((text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0))), missed = [], last = files.pop();
            const frame = {{ center: [0, 0, 0], unit: 1 }}, field = {{ vector: false, reference: 0, scale: 1 }};
            await {call}(...files, last, {'frame, 1' if len(files) == 1 else 'field'});
            for (let at = 0; at < last.length; at += at < 200 ? 1 : 11) {{
                const changed = last.slice();
                changed[at] ^= 1 << at % 8;
                await {call}(...files, changed, {'frame, 1' if len(files) == 1 else 'field'}).then(() => missed.push(at), () => {{}});
            }}
            return missed;
        }})()""")

    def test_a_changed_byte_of_a_chunk_is_noticed(self):
        self.browser.viewport(*SMALL)
        self.open(self.serve("flow").url)
        chunk = self.folder / "flow/chunks" / self.root("flow")["name"]
        # The minor version and a word that is reserved stand for nothing.
        self.assertEqual(self.missed("decodeLevel", chunk.with_suffix(".vogz")), [10, 11, 44, 45, 46, 47])
        self.assertEqual(self.missed("decodeFieldFile", chunk.with_suffix(".vogz"), chunk.with_suffix(".0")), [])

    def test_a_changed_byte_of_a_manifest_or_table_is_noticed(self):
        write_dust(self.folder / "dust.ply", 150_000)
        vog("export", "dust.ply", "-o", "dust/")
        table = next((self.folder / "dust/chunks").glob("*.json"))
        (self.folder / "rows.html").write_text(
            f"<!doctype html><title>rows</title><script>{CHECKSUM}{modules('stream/rows.js')}</script>")
        self.browser.open(self.folder / "rows.html")
        for file in (self.folder / "dust/manifest.json", table):
            found = self.value(f"""(() => {{
                const bytes = new TextEncoder().encode({json.dumps(file.read_text())}), missed = [];
                parsedJson(bytes, '');
                for (let at = 0; at < bytes.length; at += at < bytes.length - 40 ? 13 : 1) {{
                    const changed = bytes.slice();
                    changed[at] ^= 1 << at % 7;
                    try {{ parsedJson(changed, ''); missed.push(bytes.length - at); }} catch {{}}
                }}
                return missed;
            }})()""")
            # But for the checksum's own key.
            digits = len(file.read_text().rsplit('"crc":', 1)[1]) - 2
            self.assertTrue(all(digits + 2 < place <= digits + 9 for place in found), (found, digits))

    def test_a_damaged_table_is_asked_for_again(self):
        write_dust(self.folder / "dust.ply", 150_000)
        vog("export", "dust.ply", "-o", "dust/", "--tf", "gray")
        tables = sorted(path.name for path in (self.folder / "dust/chunks").glob("*.json"))
        self.browser.viewport(*SMALL)
        for answers, notices in ((1, ""), (9, "damaged")):
            left = {name: answers for name in tables}

            def changed(body, name):
                left[name] -= 1
                return body if left[name] < 0 else body.replace(b'"error":0', b'"error":1', 1)
            server = self.serve("dust")
            server.answers = {name: lambda body, name=name: changed(body, name) for name in tables}
            self.browser.open(server.url, "#subframes=1&error=0.5")
            self.value(f"vog.change({self.near(0.2)})")
            self.browser.settle()
            asked = [path for path in server.paths if path.endswith(".json") and "manifest" not in path]
            self.assertTrue(asked)
            self.assertLessEqual(max(asked.count(path) for path in asked), 2)
            if notices:
                self.assertIn("damaged", self.notice())
            else:
                self.assertEqual(self.notice(), "")


class Headers(SiteTest):
    """Trees of headers, without a picture."""

    @classmethod
    def make(cls):
        def wrapped(name, names):  # modules have names of their own
            return f"const {{ {names} }} = (() => {{ {modules(name)} return {{ {names} }}; }})();"
        script = "\n".join([
            "const kinds = { gaussians: 0, nodes: 1, links: 2, field: 3 };",
            wrapped("stream/rows.js", "areNumbers, checkFields, isCount, isObject, refuse"), wrapped("stream/file_tree.js", "treeOf")])
        (cls.folder / "rows.html").write_text(f"<!doctype html><title>rows</title><script>{script}</script>")

    def setUp(self):
        super().setUp()
        self.browser.open(self.folder / "rows.html")

    BOX = [-1, -1, -1, 1, 1, 1]

    def rows(self):
        one = {"field": 0, "depth": 0, "count": 10, "bytes": 100, "crc": 1, "box": self.BOX}
        field = {**one, "kind": 3, "bytes": 50}
        out = []
        for kind, depth, count in ((1, 0, 10), (1, 1, 9000), (0, 1, 8000), (0, 2, 9000), (0, 2, 8000)):
            out.append({**one, "kind": kind, "depth": depth, "count": count, "box": [-1, -1, -1, 1, 1, 1 + depth]})
            if kind == 1:
                out.append({**out[-1], "kind": 2})
            out.append({**field, "depth": depth, "count": count})
        return out

    def file(self, **more):
        return {"gaussians": 25000, "rotated": True, "origin": [1, 2, 3], "corner": [0, 0, 0], "edge": 1, "exponent": [0, 1], "steps": [1, 1, 1],
                "fields": [{"name": "f", "kind": "scalar", "reference": 0, "scale": 1, "step": 1}],
                "tree": {"parents": [-1, 0, 0, 1, 1], "errors": [4, 2, 0, 0, 0]}, **more}

    def answer(self, file, rows):
        page = {"models": [{"fields": [{"name": "f", "vector": False}]}]}
        return self.value(f"""(() => {{
            try {{
                const {{ tree: {{ root }}, end }} = treeOf({{ file: {json.dumps(file)}, rows: {json.dumps(rows)} }}, 1000, 'm.vogz', {json.dumps(page)}, '');
                const told = ({{ nodes, gaussians, bytes, error, ends, parts, runs }}) => [nodes, gaussians, bytes, error, ends[5], runs.map((run) => run.shapes.at), (parts ?? []).map(told)];
                return [end, told(root)];
            }} catch (error) {{ return error.message; }}
        }})()""")

    def test_trees_are_read(self):
        leaf = lambda count, at: [0, count, [100, 50], 0, 3, [at], []]
        self.assertEqual(self.answer(self.file(), self.rows()), [1950, [
            10, 10, [100, 50], 4, 3, [1000], [[9000, 9000, [100, 50], 2, 3, [1250], [leaf(9000, 1650), leaf(8000, 1800)]], [0, 8000, [100, 50], 0, 2, [1500], []]]]])

    def test_few_gaussians_are_one_chunk(self):
        rows = [{**row, "count": max(1, row["count"] // 10)} for row in self.rows()]
        found = self.answer(self.file(gaussians=2500), rows)
        self.assertEqual(found[1][:3], [0, 2500, [300, 150]])
        self.assertEqual(found[1][5], [1500, 1650, 1800])

    def test_a_model_of_one_run_needs_no_tree(self):
        rows = self.rows()[6:8]
        file = self.file(gaussians=8000)
        del file["tree"]
        self.assertEqual(self.answer(file, [{**row, "depth": 0} for row in rows])[1][1], 8000)

    def test_every_wrong_header_is_refused_in_one_line(self):
        tree = self.file()["tree"]
        wrong = [
            None, [], "x", self.file(gaussians=24999), self.file(gaussians=-1), self.file(rotated=1), self.file(origin=[0, 0]), self.file(corner=None),
            self.file(edge=0), self.file(edge="1"), self.file(exponent=[0]), self.file(steps=[1, 1, None]), self.file(fields=[]), self.file(fields=None),
            self.file(fields=[{"name": "g", "kind": "scalar"}]), self.file(fields=[{"name": "f", "kind": "scalar", "reference": 0, "scale": 1}]),
            *(self.file(tree=other) for other in (
                None, [], {}, {**tree, "parents": [-1, 0, 0, 1]}, {**tree, "errors": [4, 2, 0, 0]}, {**tree, "errors": None},
                *({**tree, "parents": parents} for parents in (
                    [-1, -1, 0, 1, 1], [-1, 1, 0, 1, 1], [-1, 0, 0, 0, 1], [-1, 0, 0, 2, 1], [-1, 0, 0, 4, 1], [-1, 0, 0, 1, "1"], [-1, 0, 0, 1, None], [0, 0, 0, 1, 1],
                    [-1, 0, 0, 1, 0.5], [-2, 0, 0, 1, 1], [-1, 0, 0, -1, -1])),
                *({**tree, "errors": errors} for errors in ([4, 5, 0, 0, 0], [-4, 2, 0, 0, 0], [4, 2, 1, 0, 0], [None, 2, 0, 0, 0], ["4", 2, 0, 0, 0])))),
        ]
        for file in wrong:
            self.expect_refused(self.answer(file, self.rows()), file)
        rows = self.rows()
        for n, change in ((0, {"kind": 4}), (0, {"kind": 3}), (1, {"kind": 3}), (2, {"field": 1}), (0, {"count": 0}), (0, {"count": 2 ** 30}), (3, {"depth": 2}),
                          (3, {"depth": 2 ** 31}), (0, {"bytes": 2 ** 31}), (0, {"box": [1, 0, 0, 0, 1, 1]}), (0, {"box": [0, 0, 0, None, 1, 1]})):
            self.expect_refused(self.answer(self.file(), [{**row, **(change if at == n else {})} for at, row in enumerate(rows)]), change)
        for n in range(len(rows)):
            self.expect_refused(self.answer(self.file(), rows[:n]), n)

    def expect_refused(self, message, what):
        self.assertIsInstance(message, str, what)
        self.assertIn("expected", message, what)
        self.assertNotIn("\n", message)
        self.assertLess(len(message), 300)


if __name__ == "__main__":
    run()
