#!/usr/bin/env python3
"""Pages that stream a compact file by ranges: what is requested, servers without ranges, files that change, are cut, are of another
kind or hostile; checksums of sites. In Node.js, without a browser: streaming_test.py has that, and other origins.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Node.js.
"""
import base64
import json

from page_test_case import FACTOR_DB, FolderTest, run, vog
from quantity_test_case import write_flow
from site_server import DROP
from streaming_test_case import DUST, SMALL, NodeSiteTest, NodeTest, write_dust

FINE = "#subframes=1&error=0.5"  # at few pixels the coarsest chunk errs by one
FIRST_BYTES = 24576  # of the first request
BEHIND_ROOT = 65536  # where the coarsest chunk has ended


class Addresses(NodeTest):
    modules = ("stream/source.js",)

    def site(self, address, base="https://here/page/", at="https:"):
        return self.value(f"(Object.assign(globalThis, {{ document: {{ baseURI: {json.dumps(base)} }}, location: {{ protocol: {json.dumps(at)} }} }}), (() => {{"
                          f"try {{ return siteOf({json.dumps(address)}); }} catch (error) {{ return error.message; }} }})())")

    def test_addresses_are_those_of_files_and_folders(self):
        for address, file in (("a/flow.vogz", "https://here/page/a/flow.vogz"), ("FLOW.VOGZ?1", "https://here/page/FLOW.VOGZ?1"), ("blob:https://here/0-1", "blob:https://here/0-1"),
                              ("file:///a.vogz", "file:///a.vogz")):
            self.assertEqual(self.site(address), {"file": file})
        self.assertEqual(self.site("site/"), {"manifest": "manifest.json", "base": "https://here/page/site/"})
        self.assertEqual(self.site("site/other.json"), {"manifest": "other.json", "base": "https://here/page/site/"})
        # Where a program's own protocol has the page, that has its models, too.
        self.assertEqual(self.site("a.vogz", "app://local/page/", "app:"), {"file": "app://local/page/a.vogz"})

    def test_addresses_that_no_page_reads_are_refused_at_once(self):
        for address in ("data:,x", "ftp://host/flow.vogz", "ftp://host/folder/", "javascript:1", "app://local/a.vogz"):
            self.assertEqual(self.site(address), f"{address}: expected an address with http: or https:, not {address.split(':')[0]}:")
        self.assertEqual(self.site("data:,x", at="data:"), "data:,x: expected an address with http: or https:, not data:")
        for address in ("http://[", "http://"):
            self.assertEqual(self.site(address), f"{address}: expected an address with https:, or relative to the page")


class Ranges(NodeSiteTest):
    @classmethod
    def make(cls):
        write_dust(cls.folder / "dust.ply")
        (cls.folder / "files").mkdir()
        vog("pack", "dust.ply", "-o", "files/dust.vogz", "--hierarchy", "--deflate")
        vog("page", "files/dust.vogz", "-o", "files/index.html", "--from", "dust.vogz", "--tf", "gray")

    @property
    def size(self):
        return (self.folder / "files/dust.vogz").stat().st_size

    def begin(self, fragment=FINE, ranges=True, size=SMALL, **hooks):
        return super().begin("files", fragment, size, {"ranges": ranges}, **hooks)

    def expect_pictures(self):
        for view in ("{}", self.near(0.4), self.near(0.2)):
            self.change(view)
            self.expect_whole()

    # --- Servers. ---

    def test_the_header_comes_first_and_the_picture_is_that_of_the_model(self):
        server = self.begin()
        self.settle()
        self.assertEqual(server.asked[0], (0, FIRST_BYTES - 1))
        self.assertEqual(len(server.asked), len(set(server.asked)))
        self.assertEqual(self.loaded, server.sent - (self.folder / "files/index.html").stat().st_size)
        # The header and the coarsest chunk: what is before the first picture.
        self.assertGreater(self.value("vog.source.root.parts.length"), 1)
        header = self.value("vog.source.source.here.length")
        self.assertEqual(header, FIRST_BYTES)
        self.resize(320, 240)
        self.expect_pictures()
        self.change("{camera: withOtherProjection(vog.state.camera)}")
        self.expect_whole()

    def test_a_small_picture_takes_a_part_of_the_file_and_a_near_view_more(self):
        server = self.begin("#subframes=1&error=16")
        self.settle()
        few = self.loaded
        self.assertLess(few, 0.5 * self.size)
        self.assertLess(self.drawn, DUST)
        self.value(f"vog.change({self.near(0.2)}); vog.change({{pixelError: 0.5}})")
        self.settle()
        self.assertGreater(self.loaded, few)
        asked = len(server.asked)
        self.change(self.near(5))
        self.assertEqual(len(server.asked), asked)

    def test_a_long_header_takes_a_second_request(self):
        self.changed = self.changed | {"stream/range_file.js": ("firstBytes = 3 << 13", "firstBytes = 100")}
        server = self.begin()
        self.settle()
        self.assertEqual(server.asked[0], (0, 99))
        self.assertEqual(server.asked[1][0], 100)
        self.expect_whole()

    def test_a_server_without_ranges_sends_a_small_file_whole(self):
        server = self.begin(ranges=False)
        self.settle()
        self.assertEqual(server.paths.count("/dust.vogz"), 1)
        self.assertEqual(self.loaded, self.size)
        self.expect_pictures()
        self.assertEqual(server.paths.count("/dust.vogz"), 1)

    def test_a_large_file_of_a_server_without_ranges_is_refused(self):
        self.changed = self.changed | {"stream/range_file.js": ("mostWhole = 64e6", "mostWhole = 1e5")}
        server = self.begin(ranges=False)
        self.until("!failure.hidden")
        self.assertIn("answers no ranges", self.failure())
        self.assertIn("-o FOLDER/", self.failure())
        self.assertNotIn("\n", self.failure())
        self.assertEqual(server.paths.count("/dust.vogz"), 1)

    # --- Files that are not what they were. ---

    def test_a_file_that_changes_is_said_and_the_picture_stays(self):
        server = self.begin("#subframes=1&error=32", tag='"1"')
        self.settle()
        coarse = self.drawn
        server.tag = '"2"'
        asked = len(server.asked)
        self.value("vog.change({pixelError: 0.5})")
        self.until("!notice.hidden")
        self.assertIn("has changed on the server, reload this page", self.notice())
        self.settle()
        self.assertGreaterEqual(self.drawn, coarse)
        self.assertLessEqual(len(server.asked), asked + 6)  # those under way

    def expect_coarse(self, words, answer, first=BEHIND_ROOT):
        """Expects the page to go on with the parent of parts whose range has a bad answer, and one line."""
        def bad(begin, body, fields):
            return answer(body, fields) if begin >= first else body
        self.begin(part=bad)
        self.watch_notices()
        self.settle()
        self.assertGreater(self.drawn, 0)
        self.assertLess(self.drawn, DUST)
        self.assertIn(words, self.notice())
        self.assertIn("dust.vogz, bytes from", self.notice())
        self.assertIn("stays coarse there", self.notice())
        self.assertEqual(self.value("vog.lines.length"), 1)
        self.expect_whole(least=39.4 - FACTOR_DB)

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
        self.settle()
        self.assertEqual(self.notice(), "")
        self.expect_whole()

    def test_other_files_are_refused_in_a_line(self):
        vog("pack", "dust.ply", "-o", "zstd.vogz", "--hierarchy")
        vog("pack", "dust.ply", "-o", "flat.vogz", "--deflate")
        whole = (self.folder / "files/dust.vogz").read_bytes()
        for body, words in ((self.folder / "zstd.vogz", "packed by zstd"), (self.folder / "flat.vogz", "--hierarchy --deflate"),
                            (b"<!doctype html>", "no compact model"), (b"", "an empty file, no compact model: vog pack MODEL"), (whole[:8] + b"\x02" + whole[9:], "version 2"),
                            (whole[:60] + bytes([whole[60] ^ 1]) + whole[61:], "damaged"), (whole[:60], "60 bytes, expected a header"),
                            (whole[:-1], f"is {len(whole) - 1} bytes long; its table says {len(whole)} (truncated?)"), (404, "HTTP 404")):
            body = body.read_bytes() if hasattr(body, "read_bytes") else body
            self.begin(answers={"dust.vogz": body})
            self.until("!failure.hidden")
            self.assertIn(words, self.failure())
            self.assertIn("dust.vogz", self.failure())
            self.assertNotIn("\n", self.failure())

    def test_the_command_refuses_other_files_and_addresses(self):
        vog("pack", "dust.ply", "-o", "zstd.vogz", "--hierarchy")
        self.assertIn("zstd", self.refused("page", "zstd.vogz", "-o", "bad.html", "--from", "zstd.vogz"))
        for url in ("ftp://host/a.vogz", "https://user:word@host/a.vogz", "javascript:alert(1)", "//host/a.vogz", "https://host/a b.vogz",
                    'https://host/"a.vogz', "https://host/'a.vogz", "https://ho;st/a.vogz", "https://*/a.vogz", "https://host:x/a", "https:host", "a\\b",
                    "https://host/a/", "#a", "", "https://", "data:,a", "https://h\u00f6st/a"):
            line = self.refused("page", "files/dust.vogz", "-o", "bad.html", "--from", url)
            self.assertIn("expected", line, url)
            self.assertEqual(line.count("\n"), 1, line)
        self.assertFalse((self.folder / "bad.html").exists())


class Checksums(NodeTest):
    """A changed byte of any file."""

    modules = ("model/gaussians.js", "model/fields.js", "stream/rows.js")

    @classmethod
    def make(cls):
        write_flow(cls.folder / "flow.ply", 300)
        vog("page", "flow.ply", "-o", "flow/")
        write_dust(cls.folder / "dust.ply", 150_000)
        vog("page", "dust.ply", "-o", "dust/")

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
        root = json.loads((self.folder / "flow/manifest.json").read_text())["models"][0]["root"]
        chunk = self.folder / "flow/chunks" / root["name"]
        # The minor version and a word that is reserved stand for nothing.
        self.assertEqual(self.missed("decodeLevel", chunk.with_suffix(".vogz")), [10, 11, 44, 45, 46, 47])
        self.assertEqual(self.missed("decodeFieldFile", chunk.with_suffix(".vogz"), chunk.with_suffix(".0")), [])

    def test_a_changed_byte_of_a_manifest_or_table_is_noticed(self):
        table = next((self.folder / "dust/chunks").glob("*.json"))
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


class Tables(NodeSiteTest):
    @classmethod
    def make(cls):
        write_dust(cls.folder / "dust.ply", 150_000)
        vog("page", "dust.ply", "-o", "dust/", "--tf", "gray")

    def test_a_damaged_table_is_asked_for_again(self):
        tables = sorted(path.name for path in (self.folder / "dust/chunks").glob("*.json"))
        for answers, notices in ((1, ""), (9, "damaged")):
            left = {name: answers for name in tables}

            def changed(body, name):
                left[name] -= 1
                return body if left[name] < 0 else body.replace(b'"error":0', b'"error":1', 1)
            server = self.begin("dust", "#subframes=1&error=0.5", answers={name: lambda body, name=name: changed(body, name) for name in tables})
            self.value(f"vog.change({self.near(0.2)})")
            self.settle()
            asked = [path for path in server.paths if path.endswith(".json") and "manifest" not in path]
            self.assertTrue(asked)
            self.assertLessEqual(max(asked.count(path) for path in asked), 2)
            if notices:
                self.assertIn("damaged", self.notice())
            else:
                self.assertEqual(self.notice(), "")


class Headers(NodeTest):
    """Trees of headers, without a picture."""

    modules = ("stream/file_tree.js",)
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
