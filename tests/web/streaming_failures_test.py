#!/usr/bin/env python3
"""Streamed pages where something fails: dropped connections, missing, damaged and cut files, hostile descriptions; and the cut through
the tree, in itself. In Node.js, without a browser: streaming_test.py has that.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Node.js.
"""
import json
import math
import random

from node import Node
from page_test_case import FACTOR_DB, FolderTest, run, vog
from quantity_test_case import write_flow
from site_server import DROP
from streaming_test_case import NodeSiteTest, NodeTest, write_dust


class Failures(NodeSiteTest):
    @classmethod
    def make(cls):
        write_dust(cls.folder / "dust.ply")
        vog("page", "dust.ply", "-o", "site/", "--tf", "gray")

    def a_part(self):
        """A chunk below the root."""
        return max(self.parts_of_root(), key=lambda row: row["gaussians"])

    # --- The network. ---

    def test_requests_of_a_view_that_is_left_are_cancelled(self):
        server = self.begin(fragment="#subframes=1&error=32")
        self.settle()
        server.bytes_per_s = 4000
        self.value("(globalThis.first = vog.state.camera, vog.change({pixelError: 0.5}))")
        self.until("vog.source.requests.flying.size > 0")
        # All of the model lies behind.
        self.value("vog.change({camera: {...vog.state.camera, at: vog.state.camera.eye, "
                   "eye: vog.state.camera.eye.map((e, k) => e + 0.01 * (vog.state.camera.at[k] - e))}})")
        self.until("vog.source.requests.flying.size === 0", 5)
        self.settle()
        self.assertEqual(self.drawn, 0)
        server.bytes_per_s = None
        self.value("vog.change({camera: first})")
        self.settle()
        self.assertGreater(self.drawn, 0)
        self.assertGreater(server.cut_off, 0)

    def test_a_flight_over_a_slow_network_ends_in_the_whole_picture(self):
        server = self.begin(bytes_per_s=60_000)
        self.until("vog.source.drawn && vog.source.drawn.count > 0")
        fly = ["flown(c, 0, 0, 0.1)", "orbited(c, -0.1, 0)", "flown(c, 0.1, 0, 0)", "orbited(c, 0, 0.1)", "flown(c, 0, 0, -0.1)", "rolled(c, -0.1)"]
        for turn in fly * 3:
            self.value(f"{{ const c = vog.state.camera; vog.change({{camera: {turn}}}); }} new Promise((done) => setTimeout(done, 30))")
        server.bytes_per_s = None
        self.settle()
        self.assertEqual(self.notice(), "")
        self.assertLessEqual(self.value("vog.source.drawn.error"), 1)
        self.expect_whole()

    def test_dropped_connections_are_tried_again(self):
        dropped = set()

        def once(name):
            def answer(body):
                if name in dropped:
                    return body
                dropped.add(name)
                return DROP
            return answer
        names = [row["name"] for row in self.parts_of_root()] + [self.root()["name"]]
        self.begin(answers={name + ".vogz": once(name) for name in names})
        self.settle()
        self.assertIn(self.root()["name"], dropped)
        self.assertEqual(self.notice(), "")
        self.expect_whole()

    def test_busy_servers_are_asked_later(self):
        answers = iter([503, 429, 503])
        self.begin(answers={"manifest.json": lambda body: next(answers, body)})
        self.settle()
        self.assertEqual(self.server.paths.count("/manifest.json"), 4)
        self.assertGreater(self.drawn, 0)

    def test_a_server_that_goes_away_is_said_once_and_the_picture_stays(self):
        server = self.begin(fragment="#subframes=1&error=32")
        self.settle()
        coarse = self.drawn
        server.answers[".vogz"] = DROP
        self.watch_notices()
        self.value("vog.change({pixelError: 0.5})")
        self.until("!notice.hidden")  # after five tries
        self.settle()
        self.assertEqual(self.drawn, coarse)
        self.assertEqual(self.value("vog.lines.length"), 1)
        self.assertIn("No answer from 127.0.0.1", self.notice())
        server.answers.clear()
        self.value("dispatchEvent(new Event('online'))")
        self.until(f"vog.source.drawn.count > {coarse}")
        self.assertEqual(self.notice(), "")

    # --- Files. ---

    def expect_coarse_there(self, words, asked, **hooks):
        """Expects the page to go on with the parent of a part that fails, and one line that names it."""
        self.begin()
        self.settle()
        whole = self.drawn
        part = self.a_part()
        server = self.begin(answers={f"{part['name']}.vogz": hooks["answer"]})
        self.watch_notices()
        self.settle()
        self.assertNotEqual(self.drawn, whole)
        self.assertGreater(self.drawn, 0)
        self.assertIn(words, self.notice())
        self.assertIn(part["name"], self.notice())
        self.assertIn("stays coarse there", self.notice())
        self.assertEqual(server.paths.count(f"/chunks/{part['name']}.vogz"), asked)
        self.value("vog.change({pixelError: 0.5})")
        self.settle()
        self.assertLessEqual(self.value("vog.lines.length"), 1)
        self.assertEqual(server.paths.count(f"/chunks/{part['name']}.vogz"), asked)
        # The coarse nodes have the mass of what is missing: the picture is a blurred one, not one with a hole.
        self.expect_whole(least=39.4 - FACTOR_DB)

    def test_a_missing_chunk(self):
        self.expect_coarse_there("HTTP 404", 1, answer=404)

    def test_a_truncated_chunk(self):
        self.expect_coarse_there("expected", 2, answer=lambda body: body[:len(body) // 2])

    def test_a_changed_chunk(self):
        self.expect_coarse_there("damaged", 2, answer=lambda body: body[:-40] + bytes([body[-40] ^ 1]) + body[-39:])

    def test_another_chunk_in_its_place(self):
        root = (self.folder / "site/chunks" / f"{self.root()['name']}.vogz").read_bytes()
        self.expect_coarse_there("expected", 2, answer=root)

    def test_a_root_that_cannot_be_read(self):
        for answer, words in ((404, "HTTP 404"), (lambda body: body[:100], "100 bytes, expected")):
            self.begin(answers={f"{self.root()['name']}.vogz": answer})
            self.until("!failure.hidden")
            self.assertIn(words, self.failure())
            self.assertEqual(self.failure().count("\n"), 0)

    def test_a_manifest_that_is_none(self):
        whole = self.manifest()
        for answer, words in ((404, "manifest.json: HTTP 404"), (b"<html>", "not valid JSON"), (b"{}", "format"),
                              (json.dumps({**whole, "version": 2}).encode(), "version: 2, expected 1"),
                              (json.dumps({**whole, "models": []}).encode(), "models: 0, expected 1 to"),
                              (json.dumps({**whole, "models": 2 * whole["models"]}).encode(), "models: 2, expected the 1 of the page"),
                              (json.dumps(whole).encode()[:-20], "not valid JSON")):
            self.begin(answers={"manifest.json": answer})
            self.until("!failure.hidden")
            self.assertIn(words, self.failure())

    def test_a_field_that_is_missing(self):
        write_flow(self.folder / "flow.ply", 500)
        vog("page", "flow.ply", "-o", "flow/")
        self.start("flow", answers={".0": 404})
        self.value("vog.change({show: 'mean'})")
        self.until("vog.state.show === 'T'")
        self.settle()
        self.assertIn("HTTP 404", self.notice())
        self.assertIn("cannot be shown", self.notice())


class Rows(NodeTest):
    """Descriptions and cuts, without a picture."""

    modules = ("picture/clip.js", "stream/rows.js", "stream/cut.js", "stream/visibility.js", "stream/site.js", "model/gaussians.js")

    def row(self, **more):
        part = {"name": "1" * 32, "nodes": 0, "gaussians": 5, "error": 0, "box": [-1, -1, -1, 0, 1, 1], "bytes": [100, 50]}
        return {"name": "0" * 32, "nodes": 3, "gaussians": 4, "error": 0.5, "box": [-1, -1, -1, 1, 1, 1], "bytes": [90, 40],
                "parts": [part, {**part, "name": "2" * 32, "box": [0, -1, -1, 1, 1, 1]}], **more}

    def answer(self, root, **model):
        text = json.dumps({"format": "vog site", "version": 1, "models": [
            {"gaussians": 10, "origin": [1, 2, 3], "fields": [{"name": "f", "kind": "scalar"}], "root": root, **model}]})
        page = {"models": [{"fields": [{"name": "f", "vector": False}]}]}
        return self.value(f"""(() => {{
            try {{ return treesOf(new TextEncoder().encode({json.dumps(text)}), 'manifest.json', {json.dumps(page)})[0].root.parts.length; }}
            catch (error) {{ return error.message; }}
        }})()""")

    def test_gradient_opacity_hides_nothing(self):
        """A chunk behind an opaque wall: hidden under its transfer function, and whole where gradients may leave the wall clear."""
        seen = self.value("""[[], [[0, 0], [1, 1]]].map((gradient) => {
            // A wall, and a small thing behind it.
            const box = { center: [0, 0, 0], half: [1, 1, 1] }, side = 32, all = new Float32Array((side * side + 1) * instanceFloats), data = new Float32Array((side * side + 1) * 18);
            for (let n = 0; n < side * side; ++n)
              all.set([(2 * (n % side) + 1) / side - 1, (2 * Math.floor(n / side) + 1) / side - 1, 0, 1e4, 0.01, 0.01, 0.01, 1], n * instanceFloats);
            all.set([0, 0, -0.8, 1e-3, 0.05, 0.05, 0.05, 1], side * side * instanceFloats);
            const state = { show: 'volume', model: 0, field: 0, camera: {} }, field = { reference: 0, scale: 1, isMeasure: false, background: 0 };
            const model = { box: { center: [0, 0, 0], half: [1, 1, 1] }, center: [0, 0, 0], unit: 1, extinction: 1, cutoff: 2.25, fields: [field] };
            const transfer = { colors: [[-1, 1, 1, 1], [1, 1, 1, 1]], opacity: [[-1, 0.99], [1, 0.99]], unit: 0.1, ...(gradient.length && { gradient }) };
            const site = Object.assign(Object.create(Site.prototype), {
                view: { state: () => state, clip: () => ({ box: null, planes: [] }) }, page: { models: [model] }, lattice: null,
                hiding: () => [transfer],
            });
            Object.defineProperty(site, 'root', { value: { box, kept: { coarse: { instances: all, fields: new Map([['0.', data]]) } } } });
            return site.visible({ eye: [0, 0, 5], forward: [0, 0, -1], parallel: true }, { field: '0.' })({ box: { center: [0, 0, -0.8], half: [0.05, 0.05, 0.05] } });
        })""")
        self.assertLess(seen[0], 0.5, seen)
        self.assertEqual(seen[1], 1)

    def test_rows_are_read(self):
        self.assertEqual(self.answer(self.row()), 2)

    def test_every_wrong_row_is_refused_in_one_line(self):
        part = self.row()["parts"][0]
        deep = part
        for _ in range(70):
            deep = self.row(parts=[{**deep, "box": [-1, -1, -1, 1, 1, 1]}])
        wrong = [
            *({"name": name} for name in ("../../etc/passwd", "0" * 31, "0" * 31 + "G", "0" * 31 + "/", None, 7, "0" * 32 + "\n", ["0" * 32])),
            *({"nodes": nodes} for nodes in (-1, 5, 1.5, "3", None, True)),
            *({"gaussians": count} for count in (0, -4, 2 ** 40, 1e300, "4", None)),
            *({"error": error} for error in (-1, None, "big", [])),
            *({"box": box} for box in ([], [0] * 5, [1, 0, 0, 0, 1, 1], [0, 0, 0, 0, 0, None], "box", [0, 0, 0, 1, 1, 1])),
            *({"bytes": sizes} for sizes in ([], [90], [90, 40, 1], [90, -1], [90, 2 ** 40], [90, 0.5], None)),
            *({"parts": parts} for parts in ([], None, {}, [7], [None], [{**part, "error": 1}], [{**part, "box": [-2, -1, -1, 0, 1, 1]}])),
            *({"parts": None, "table": table} for table in ("../x", 5)), {"parts": None, "table": "0" * 32, "tableBytes": -1},
            {"parts": [deep]},
        ]
        for change in wrong:
            message = self.answer(self.row(**change))
            self.assertIsInstance(message, str, change)
            self.assertIn("expected", message, change)
            self.assertNotIn("\n", message)
            self.assertLess(len(message), 300 + 12 * 70)
        for model in ({"origin": [0, 0]}, {"origin": [0, 0, "x"]}, {"gaussians": -1}, {"fields": []}, {"fields": [{"name": "g", "kind": "scalar"}]},
                      {"fields": [{"name": "f", "kind": "vector"}]}):
            self.assertIn("expected", self.answer(self.row(), **model))
        self.assertIn("a row", self.answer(None))

    def test_any_cut_draws_every_gaussian_or_its_node_once(self):
        """Random trees, views and chunks that are there: drawn parts cover each chunk of the leaves in view once."""
        rng = random.Random(4)

        def tree(depth, lower, upper):
            nodes = 10 if depth < 4 and rng.random() < 0.9 else 0
            row = {"name": f"{rng.getrandbits(128):032x}", "nodes": nodes, "gaussians": 10 + rng.randrange(1, 9), "error": 0.4 * 0.5 ** depth if nodes else 0,
                   "box": [*lower, *upper], "bytes": [1000, 0]}
            if nodes:
                row["parts"] = []
                middle = [0.5 * (a + b) for a, b in zip(lower, upper)]
                for n in range(8):
                    ends = [(a, m) if n >> k & 1 else (m, b) for k, (a, m, b) in enumerate(zip(lower, middle, upper))]
                    row["parts"].append(tree(depth + 1, [e[0] for e in ends], [e[1] for e in ends]))
            return row
        root = tree(0, [-1, -1, -1], [1, 1, 1])
        text = json.dumps({"format": "vog site", "version": 1, "models": [
            {"gaussians": 10, "origin": [0, 0, 0], "fields": [{"name": "f", "kind": "scalar"}], "root": root}]})
        page = {"models": [{"fields": [{"name": "f", "vector": False}]}]}
        found = self.value(f"""(() => {{
            const tree = treesOf(new TextEncoder().encode({json.dumps(text)}), 'm', {json.dumps(page)})[0].root, out = [];
            let seed = 1;
            const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
            for (let turn = 1; turn <= 200; ++turn) {{
              const eye = [3 * random() - 1.5, 3 * random() - 1.5, 3 * random() - 1.5];
              const view = viewOf({{ eye, at: [random(), random(), random()], up: [0, 1, 0], fov: 40, span: turn % 3 ? 0 : 1 }}, 200, 150, null);
              const there = new Map(), room = {{ bytes: turn % 2 ? 1e9 : 40000, gaussians: 1e9 }}, share = random();
              const cut = wantedCut(tree, view, turn, {{ error: 1, room, bytesOf: () => 1000, visible: () => random(), isBad: () => random() < 0.02 }});
              for (const {{ chunk }} of cut.chunks) there.set(chunk, !chunk.parent || (there.get(chunk.parent) && random() < share));
              const drawn = drawnCut(tree, turn, (chunk) => there.get(chunk) === true);
              const first = new Map(drawn.parts.map((part) => [part.chunk, part.first]));
              const wrong = [];
              // Each chunk that is not divided has all of it drawn, if what is above it is; parts of a divided one are all drawn.
              const visit = (chunk, isAbove) => {{
                const at = first.get(chunk), divided = isAbove && at === chunk.nodes && chunk.nodes > 0;
                if (isAbove !== (at !== undefined)) wrong.push('hole or overlap');
                if (at !== undefined && !there.get(chunk)) wrong.push('not there');
                for (const part of chunk.parts ?? []) visit(part, divided && isSeen(part.box, view));
              }};
              visit(tree, isSeen(tree.box, view));
              const sorted = cut.chunks.every(({{ use }}, n) => n === 0 || use <= cut.chunks[n - 1].use);
              const above = cut.chunks.every(({{ chunk }}, n) => !chunk.parent || cut.chunks.findIndex((one) => one.chunk === chunk.parent) < n);
              const bytes = cut.bytes <= room.bytes;
              out.push([wrong.length, sorted, above, bytes, drawn.count === drawn.parts.reduce((sum, part) => sum + part.count, 0)]);
            }}
            return out;
        }})()""")
        self.assertEqual(len(found), 200)
        for one in found:
            self.assertEqual(one, [0, True, True, True, True])

    def test_what_the_rest_hides_comes_last(self):
        row = {"gaussians": 10, "bytes": [1000]}
        leaf = lambda name, x: {**row, "name": name * 32, "nodes": 0, "error": 0, "box": [x, -1, -1, x + 1, 1, 1]}
        part = lambda name, x: {**leaf(name, x), "nodes": 8, "error": 0.1, "parts": [leaf(chr(ord(name) + 2), x)]}
        root = {**row, "name": "0" * 32, "nodes": 8, "error": 0.2, "box": [-1, -1, -1, 1, 1, 1], "parts": [part("a", -1), part("b", 0)]}
        text = json.dumps({"format": "vog site", "version": 1, "models": [{"gaussians": 20, "origin": [0, 0, 0], "fields": [], "root": root}]})
        for room, drawn, bound, seen in (1e9, "0abcd", 1, 1), (4e3, "0abc", 2.5, 1), (3e3, "0ab", 2.5, 2.5):
            found = self.value(f"""(() => {{
                const tree = treesOf(new TextEncoder().encode({json.dumps(text)}), 'm', {{ models: [{{ fields: [] }}] }})[0].root;
                const view = viewOf({{ eye: [0, 0, 5], at: [0, 0, 0], up: [0, 1, 0], fov: 40, span: 4 }}, 100, 100, null);
                const visible = ({{ name }}) => (name[0] === 'b' ? 0.3 : 1);
                const cut = wantedCut(tree, view, 1, {{ error: 1, room: {{ bytes: {room}, gaussians: 1e9 }}, bytesOf: () => 1000, visible, isBad: () => false }});
                return [cut.chunks.map(({{ chunk }}) => chunk.name[0]).sort().join(''), cut.error, cut.shown, drawnCut(tree, 1, () => true).error];
            }})()""")
            # 25 pixels a unit: 2.5 pixels of nodes, of the hidden ones 0.75 are seen.
            self.assertEqual(found[0], drawn)
            self.assertAlmostEqual(found[1], bound)
            self.assertAlmostEqual(found[2], seen)
            self.assertAlmostEqual(found[3], 0 if bound == 1 else 2.5)

    def test_visibility_is_that_of_the_optical_depth(self):
        found = self.value("""(() => {
            // 8000 Gaussians at random in a cube of edge 2, of extinction 1 on average: T = 2 through it.
            const count = 8000, s = 0.05, data = new Float32Array(11 * count), extinction = 1;
            let seed = 1;
            const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
            const density = (extinction * 8) / count / (s ** 3 * (2 * Math.PI) ** 1.5);
            for (let n = 0; n < count; ++n)
              data.set([2 * random() - 1, 2 * random() - 1, 2 * random() - 1, density, s, s, s, 1, 0, 0, 0], 11 * n);
            const model = { center: [10, 0, 0], unit: 3 }, box = { center: [10, 0, 0], half: [3, 3, 3] };
            const seen = new Visibility(model, box, data, () => 1);
            const view = viewOf({ eye: [10, 0, 60], at: [10, 0, 0], up: [0, 1, 0], fov: 30, span: 0 }, 100, 100, null);
            const parallel = viewOf({ eye: [10, 0, 60], at: [10, 0, 0], up: [0, 1, 0], fov: 30, span: 8 }, 100, 100, null);
            const behind = { box: null, planes: [{ normal: [0, 0, -1], offset: 0, on: true }] };
            const shares = (one, clip, inFront, ...boxes) => {
              seen.look(one, clip, inFront);
              return boxes.map(([x, z, half]) => seen.of({ center: [x, 0, z], half: [half, half, 0.1] }));
            };
            return [seen.depthOf([0, 0, 20], [0, 0, -1], 0, Infinity), ...shares(view, null, true, [10, 2.9, 1], [10, 0, 1], [10, -2.9, 1]),
              ...shares(view, null, false, [10, 2.9, 1], [10, -2.9, 1]), ...shares(parallel, null, false, [10, -2.9, 1]),
              ...shares(view, behind, true, [10, -2.9, 1]), ...shares(parallel, behind, false, [10, -2.9, 1]),
              ...shares(view, null, false, [10, 2.9, 3]), seen.depthOf([2, 0, 20], [0, 0, -1], 0, Infinity)];
        })()""")
        # Six points a Gaussian are 1.5 a cell: of 16 and 32 cells on a ray the deviation is 0.2 and 0.3 of 1 and 2. Of several rays the
        # thinner ones count, of a whole face its rim, where perspective rays are short.
        depths = [found[0], *(-math.log(share) for share in found[1:-1])]
        for depth, wanted in zip(depths[:-1], (2, 0, 1, 2, 2, 2, 2, 1, 1)):
            self.assertLess(abs(depth - wanted), 0.8 if wanted else 0.2, depths)
        self.assertLess(depths[-1], 0.8 * depths[4])
        self.assertEqual(found[-1], 0)

    def test_errors_are_projected_where_the_box_is_nearest(self):
        pixels = self.value("""(() => {
            const chunk = (center, half, error) => ({ error, box: { center, half } });
            // 100 pixels, 90 degrees: 50 pixels a unit of slope.
            const view = viewOf({ eye: [0, 0, 0], at: [0, 0, -1], up: [0, 1, 0], fov: 90, span: 0 }, 100, 100, null);
            const parallel = viewOf({ eye: [0, 0, 0], at: [0, 0, -1], up: [0, 1, 0], fov: 90, span: 4 }, 100, 100, null);
            return [pixelsOf(chunk([0, 0, -5], [1, 1, 1], 0.08), view), pixelsOf(chunk([0, 0, -5], [6, 6, 6], 0.08), view),
              pixelsOf(chunk([0, 0, -5], [1, 1, 1], 0.08), parallel), pixelsOf(chunk([0, 0, -5], [1, 1, 1], 0), view),
              isSeen({ center: [8, 0, -5], half: [1, 1, 1] }, view), isSeen({ center: [0, 0, 3], half: [1, 1, 1] }, view),
              isSeen({ center: [5.9, 0, -5], half: [1, 1, 1] }, view)];
        })()""")
        self.assertAlmostEqual(pixels[0], 50 * 0.08 / 4)
        self.assertGreater(pixels[1], 1000)
        self.assertAlmostEqual(pixels[2], 25 * 0.08)
        self.assertEqual(pixels[3:], [0, False, False, True])


if __name__ == "__main__":
    run()
