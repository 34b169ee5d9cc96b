#!/usr/bin/env python3
"""Exploring a model by hand in the page that `vog page` writes, in Chromium: fields that come first, the editor's axis and
bands, the probe in volumes, handles of the clip box, decoding in a worker.

VOG_COMMAND names the command, VOG_DATA the folder of real inputs. Exits with 77, which ctest takes as skipped,
where there is no Chromium.
"""
import array
import json
import math
import random

from page_test_case import COARSE, PageTest, nightly, run, vog


def write_scalars(path, gaussians, fields):
    """
    Writes a PLY of axis-aligned Gaussians with scalar fields that are planes.
    gaussians  rows (mean, scales, density, [(value, gradient) of each field])
    fields     [(kind, name, lower, upper)]
    """
    names = ["x", "y", "z", "scale_0", "scale_1", "scale_2", "density"]
    for _, name, *_ in fields:
        names += [name, *(f"{name}_{k}" for k in ("gx", "gy", "gz", "sd", "skew"))]
    header = "ply\nformat binary_little_endian 1.0\ncomment vog 1\ncomment cutoff 3\n"
    header += "".join(f"comment field {kind} {name} {lower} {upper}\n" for kind, name, lower, upper in fields)
    header += f"element vertex {len(gaussians)}\n" + "".join(f"property float {name}\n" for name in names) + "end_header\n"
    rows = array.array("f")
    for mean, scales, density, values in gaussians:
        rows.extend([*mean, *scales, density])
        for value, gradient in values:
            rows.extend([value, *gradient, 0, 0])
    with open(path, "wb") as out:
        out.write(header.encode())
        rows.tofile(out)


def random_gaussians(count, plane):
    """plane(mean)  [(value, gradient) of each field]"""
    rng, rows = random.Random(7), []
    for _ in range(count):
        mean = [rng.uniform(-1, 1) for _ in range(3)]
        rows.append((mean, [rng.uniform(0.1, 0.3) for _ in range(3)], rng.uniform(0.2, 1), plane(mean)))
    return rows


class Exploring(PageTest):
    @classmethod
    def make(cls):
        # Heat rises with x; the measure is the second field.
        cls.rows = random_gaussians(60, lambda mean: [(300 + 10 * mean[0], [10, 0, 0]), (0.5, [0, 0, 0])])
        write_scalars(cls.folder / "two.ply", cls.rows, [("scalar", "heat", 265, 335), ("measure", "mass", 0.1, 1)])
        # Pictures are compared with themselves alone: few slabs, which a GPU in software draws sooner.
        vog("page", "two.ply", "-o", "two.html", "--set", "levels=1", "--show", "volume", "--slabs", 8)
        # Three values of equal measure, four decades apart, and a field of both signs.
        cls.decades = [([k, 0, 0], [0.3] * 3, 1, [(v, [0] * 3), (k - 1, [0] * 3)]) for k, v in enumerate((1e-3, 0.1, 10))]
        write_scalars(cls.folder / "decades.ply", cls.decades, [("scalar", "f", 1e-3, 10), ("scalar", "signed", -1, 1)])
        vog("page", "decades.ply", "-o", "decades.html", "--set", "levels=1", "--show", "volume", "--field", "f", "--slabs", 8,
            "--scale", "linear")

    def start(self, page, fragment="#subframes=1&show=T"):
        self.browser.leave()
        self.browser.viewport(1000, 800, COARSE)
        self.open(page, fragment)

    def box_of(self, identifier):
        return self.value(f"(() => {{ const b = document.getElementById('{identifier}').getBoundingClientRect();"
                          " return [b.left, b.top, b.width, b.height]; })()")

    def test_numbers_at_the_pointer_overlap_nothing_at_any_width(self):
        """Probe, colour bar, scale bar and axes."""
        for width, height in ((360, 740), (640, 900), (820, 1180), (1440, 900)):
            self.browser.leave()
            self.browser.viewport(width, height, COARSE, width < 500)
            self.open("two.html", "#subframes=1&show=deviation&tf=gray")
            self.value("vog.page.models[0].fields[0].name = 'temperature of the gas'; vog.change({panel: innerWidth > 700})")
            self.browser.settle()
            x, y = self.value("[vog.canvas.clientWidth / 2, vog.canvas.clientHeight / 2]")
            self.browser.mouse("mouseMoved", x, y)
            boxes = self.value("""['probe', 'scale', 'length', 'axes'].map((id) => {
                const b = document.getElementById(id).getBoundingClientRect();
                return [id, b.left, b.top, b.right, b.bottom, document.getElementById(id).checkVisibility()];
            })""")
            self.assertTrue(all(box[5] for box in boxes), boxes)
            for n, (one, *a, _) in enumerate(boxes):
                for other, *b, _ in boxes[:n]:
                    apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
                    self.assertTrue(apart, (width, one, a, other, b))

    # --- The editor. ---

    def opacity(self, field=0):
        return self.value(f"vog.state.transfers[{field}].opacity")

    def test_the_axis_of_values_can_be_logarithmic(self):
        self.start("decades.html", "#subframes=1&show=volume&field=f")
        source = self.value("vog.page.models[0].fields[0]")
        filled = {n: count for n, count in enumerate(source["logHistogram"]) if count}
        self.assertEqual(filled, {0: 1000, 48: 1000, 95: 1000})
        self.assertEqual({n: count for n, count in enumerate(source["histogram"]) if count}, {0: 1000, 95: 500})
        marks = "[...document.querySelectorAll('#editor-ticks span')].map((s) => s.textContent)"
        self.assertIn("7.5", self.value(marks))
        before = self.bytes()
        self.value("document.getElementById('log-axis').click()")
        self.assertEqual(self.value(marks), ["0.001", "0.01", "0.1", "1", "10"])
        self.assertEqual(self.bytes(), before, "the axis is of the editor alone")
        # The middle is the geometric mean.
        x, y, width, height = self.box_of("editor")
        self.browser.mouse("mousePressed", x + 0.5 * width, y + 0.2 * height, button="left", buttons=1, clickCount=1)
        self.browser.mouse("mouseReleased", x + 0.5 * width, y + 0.2 * height, button="left", clickCount=1)
        self.assertAlmostEqual(self.opacity()[1][0], 0.1, delta=0.004)
        # Links keep it.
        self.value("navigator.clipboard.writeText = (text) => { window.copied = text; return Promise.resolve(); }")
        self.browser.key("c")
        link = self.value("window.copied")
        self.assertIn("&logaxis", link)
        self.start("decades.html", "#" + link.split("#")[1])
        self.assertTrue(self.value("document.getElementById('log-axis').checked"))
        # A field of both signs has none.
        self.value("vog.change({field: 1})")
        self.assertTrue(self.value("document.getElementById('log-axis').disabled"))
        self.assertFalse(self.value("document.getElementById('log-axis').checked"))

    def test_bands_are_dragged_as_one(self):
        band = [[0, 0], [0.3, 0], [0.4, 0.8], [0.5, 0.8], [0.6, 0], [1, 0]]
        colors = [[0, 0, 0, 1], [1, 1, 0, 0]]
        self.start("two.html", "#subframes=1&show=volume")
        self.value(f"vog.change({{transfers: {{1: {{name: 'own', unit: 1, opacity: {band}, colors: {colors}}}}}}})")
        x, y, width, height = self.box_of("editor")
        place = lambda v, o: (x + v * width, y + 4 + (1 - o) * (height - 8))

        def drag(start, end, **more):
            self.browser.drag(*place(*start), *place(*end), **more)
            return self.opacity(1)

        def expect(found, wanted):
            self.assertEqual(len(found), len(wanted))
            for point, other in zip(found, wanted):
                self.assertAlmostEqual(point[0], other[0], delta=0.006)
                self.assertAlmostEqual(point[1], other[1], delta=0.015)

        # From below the curve: the whole band, along the values alone.
        expect(drag((0.45, 0.3), (0.65, 0.5)), [[0, 0], [0.5, 0], [0.6, 0.8], [0.7, 0.8], [0.8, 0], [1, 0]])
        self.browser.key("z")
        self.assertEqual(self.opacity(1), band)
        # Up to its neighbours.
        expect(drag((0.45, 0.3), (0.99, 0.3)), [[0, 0], [0.7, 0], [0.8, 0.8], [0.9, 0.8], [1, 0], [1, 0]])
        self.browser.key("z")
        # The plateau by its line, up and aside between its feet.
        expect(drag((0.45, 0.8), (0.5, 0.6)), [[0, 0], [0.3, 0], [0.45, 0.6], [0.55, 0.6], [0.6, 0], [1, 0]])
        self.browser.key("z")
        # Two points selected by keys: arrows move both, Delete removes both.
        self.value("editor.focus()")
        self.browser.mouse("mousePressed", *place(0.4, 0.8), button="left", buttons=1, clickCount=1)
        self.browser.mouse("mouseReleased", *place(0.4, 0.8), button="left", clickCount=1)
        self.assertEqual(self.opacity(1), band, "a press on a point changes nothing")
        self.browser.key("PageDown", modifiers=8)
        self.browser.key("ArrowRight")
        expect(self.opacity(1), [[0, 0], [0.3, 0], [0.41, 0.8], [0.51, 0.8], [0.6, 0], [1, 0]])
        self.browser.key("Delete")
        expect(self.opacity(1), [[0, 0], [0.3, 0], [0.6, 0], [1, 0]])
        self.value("undo.click(); undo.click()")
        self.assertEqual(self.opacity(1), band)
        self.value("redo.click()")
        expect(self.opacity(1)[2:4], [[0.41, 0.8], [0.51, 0.8]])
        # A click below the curve that does not move is a new point.
        self.value("undo.click()")
        self.browser.drag(*place(0.45, 0.3), *place(0.45, 0.3), steps=0)
        expect(self.opacity(1), [*band[:3], [0.45, 0.3], *band[3:]])

    # --- The probe. ---

    def march(self, ray, extinction, steps=1200):
        """Opacity of a ray (origin, unit direction) through cls.rows and heat = 300 + 10 x at half of it."""
        origin, direction = ray
        ends, tau, half = (0, 8), 0, None
        for n in range(steps):
            t = ends[0] + (n + 0.5) * (ends[1] - ends[0]) / steps
            at, measure = [o + t * d for o, d in zip(origin, direction)], 0
            for mean, scales, density, _ in self.rows:
                m2 = sum(((a - m) / s) ** 2 for a, m, s in zip(at, mean, scales))
                measure += density * math.exp(-0.5 * m2) if m2 < 9 else 0
            tau += measure * extinction(300 + 10 * at[0]) * (ends[1] - ends[0]) / steps
            if half is None and tau > math.log(2):
                half = 300 + 10 * at[0], t
        return 1 - math.exp(-tau), half

    def probed(self, column, row):
        box = self.box_of("picture")
        self.browser.mouse("mouseMoved", box[0] + column / COARSE, box[1] + row / COARSE)
        lines = self.value("document.getElementById('probe').textContent").split("\n")
        return {line.rsplit(" ", 1)[0]: float(line.rsplit(" ", 1)[1]) for line in lines if line}

    def test_the_probe_tells_the_value_at_the_first_opaque_depth(self):
        self.start("two.html", "#subframes=1&show=volume&field=heat")
        ramp = {"name": "own", "unit": 0.4, "colors": [[285, 0, 0, 0], [315, 1, 1, 1]], "opacity": [[290, 0], [310, 0.9]]}
        extinction = lambda v: -math.log(1 - 0.9 * min(max((v - 290) / 20, 0), 1)) / ramp["unit"]
        self.value(f"vog.change({{transfers: {{0: {json.dumps(ramp)}}}, camera: {{...vog.state.camera, fov: 40,"
                   " eye: [-3, 1.5, 2], at: [0, 0, 0], up: [0, 1, 0], span: 0}})")
        self.browser.settle()
        seen = 0
        for span in (0, 3):
            self.value(f"vog.change({{camera: {{...vog.state.camera, span: {span}}}}})")
            self.browser.settle()
            width, height = self.value("[vog.canvas.width, vog.canvas.height]")
            for column, row in ((0.5, 0.5), (0.42, 0.6), (0.6, 0.35), (0.5, 0.72)):
                x, y = int(column * width), int(row * height)
                ray = self.value(f"vog.ray([{x}, {y}])")
                opacity, half = self.march((ray["origin"], ray["direction"]), extinction)
                found = self.probed(x + 0.5, y + 0.5)
                self.assertAlmostEqual(found.get("opacity", 0), opacity, delta=0.01)
                if opacity > 0.52:
                    # A hundredth of the field's range, 30; of the depth what moves the value as much.
                    self.assertAlmostEqual(found["heat"], half[0], delta=0.3)
                    self.assertAlmostEqual(found["depth"], half[1], delta=0.05)
                    seen += 1
                elif opacity < 0.48:
                    self.assertNotIn("heat", found)
        self.assertGreater(seen, 3)

    def test_the_probe_finds_surfaces_and_minds_the_clip(self):
        self.start("two.html", "#subframes=1&show=volume&field=heat")
        # Opaque from 303 on, which rays from -x meet at x = 0.3.
        step = {"name": "own", "unit": 0.02, "colors": [[285, 1, 1, 1], [315, 1, 1, 1]], "opacity": [[303, 0], [303.05, 0.999]]}
        self.value(f"vog.change({{transfers: {{0: {json.dumps(step)}}}, camera: {{...vog.state.camera, fov: 40,"
                   " eye: [-3, 0.5, 0.4], at: [0, 0, 0], up: [0, 1, 0]}})")
        self.browser.settle()
        width, height = self.value("[vog.canvas.width, vog.canvas.height]")
        found = [self.probed(int(width * x) + 0.5, int(height * y) + 0.5) for x in (0.45, 0.5, 0.55) for y in (0.45, 0.5, 0.55)]
        for one in found:
            self.assertAlmostEqual(one["heat"], 303, delta=0.15)
            self.assertAlmostEqual(one["depth"], 3.3, delta=0.15)
        # Cut open behind it: the value at the cut; cut away: nothing.
        self.value("vog.change({clip: {lower: [0.5, -1, -1], upper: [1, 1, 1]}})")
        self.browser.settle()
        self.assertAlmostEqual(self.probed(width // 2 + 0.5, height // 2 + 0.5)["heat"], 305, delta=0.3)
        self.value("vog.change({clip: {lower: [1e3, 1e3, 1e3], upper: [2e3, 2e3, 2e3]}})")
        self.browser.settle()
        self.assertEqual(self.probed(width // 2 + 0.5, height // 2 + 0.5), {})

    # --- The clip box. ---

    def dots(self):
        return self.value("""[...document.querySelectorAll('#handles g .grip')].map((c) => {
            const b = c.getBoundingClientRect();
            return c.hasAttribute('hidden') ? null : [b.left + b.width / 2, b.top + b.height / 2]; })""")

    def test_faces_of_the_clip_are_dragged_by_mouse_and_touch(self):
        self.start("two.html")
        self.assertTrue(self.value("document.querySelector('#handles g').hasAttribute('hidden')"))
        self.value("document.getElementById('clip-row').open = true; new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        center, half = self.value("vog.page.models[0].box.center"), self.value("vog.page.models[0].box.half")
        for lens in ({"span": 0}, {"span": 4}):
            for axis in range(3):
                for end in range(2):
                    self.value(f"vog.change({{clip: null, camera: {{...vog.state.camera, ...{json.dumps(lens)}}}}})")
                    face = 2 * axis + end
                    # Half the way to the middle of the box, the faces' common aim.
                    middle = [sum(k) / 6 for k in zip(*self.dots())] if lens["span"] else self.value(
                        "(() => { const b = vog.canvas.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; })()")
                    x, y = self.dots()[face]
                    to = [x + 0.5 * (middle[0] - x), y + 0.5 * (middle[1] - y)]
                    before = self.value("vog.state.camera")
                    self.browser.drag(x, y, *to)
                    clip = self.value("vog.state.clip")
                    self.assertEqual(self.value("vog.state.camera"), before, "the view stays")
                    moved = (clip["upper" if end else "lower"][axis] - center[axis]) / half[axis]
                    # Parallel rays: half the way; a pinhole's share of a depth is another.
                    self.assertAlmostEqual(moved, 0.5 if end else -0.5, delta=0.02 if lens["span"] else 0.25)
                    for other in range(6):
                        if other != face:
                            whole = center[other // 2] + (half if other % 2 else [-h for h in half])[other // 2]
                            self.assertAlmostEqual(clip["upper" if other % 2 else "lower"][other // 2], whole, delta=1e-9)
                    # The dot lies where the pointer let go.
                    self.assertLess(math.dist(self.dots()[face], to), 1.5)
        # No further than the opposite face, nor than the box.
        x, y = self.dots()[1]
        self.value("vog.change({clip: null})")
        self.browser.drag(*self.dots()[1], *self.dots()[0])
        self.browser.drag(*self.dots()[1], *[2 * a - b for a, b in zip(self.dots()[0], self.dots()[1])])
        clip = self.value("vog.state.clip")
        self.assertAlmostEqual(clip["upper"][0] - clip["lower"][0], 0.02 * half[0], delta=1e-6)
        # Sliders follow.
        self.assertAlmostEqual(self.value("document.querySelector('#clip-ends [aria-label=\"Clip x to\"]').valueAsNumber"), 0.01, delta=0.006)
        # By touch, on a phone.
        self.browser.viewport(360, 740, COARSE, phone=True)
        self.value("vog.change({clip: null}); new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        start, end = self.dots()[3], self.dots()[2]
        self.browser.touch([start], [[0.7 * a + 0.3 * b for a, b in zip(start, end)]])
        self.assertLess(self.value("vog.state.clip.upper[1]"), center[1] + 0.7 * half[1])
        # The axis along the view has no handle.
        self.value("vog.change({camera: {...vog.state.camera, eye: vog.page.models[0].box.center.map((c, k) => c + (k === 2 ? 5 : 0)),"
                   " at: vog.page.models[0].box.center, up: [0, 1, 0], span: 4}})")
        self.assertEqual([dot is None for dot in self.dots()], [False] * 4 + [True] * 2)

    # --- The light. ---

    def test_the_light_is_dragged_by_its_sphere_and_by_hand(self):
        self.start("two.html", "#subframes=1&show=volume&field=heat&shadows&light_from=0,0,1")
        sphere = """(() => { const c = document.querySelector('#handles > .grip'), b = c.getBoundingClientRect();
            return c.hasAttribute('hidden') ? null : [b.left + b.width / 2, b.top + b.height / 2]; })()"""
        before, camera, place = self.value("vog.state.light.lights[0].towards"), self.value("vog.state.camera"), self.value(sphere)
        to = [place[0] + 40, place[1] + 25]
        self.browser.drag(*place, *to)
        self.assertEqual(self.value("vog.state.camera"), camera, "the view stays")
        after = self.value("vog.state.light.lights[0].towards")
        self.assertAlmostEqual(math.hypot(*after), 1, delta=1e-3)
        self.assertLess(math.dist(self.value(sphere), to), 1.5)
        # In links; undone and done again.
        self.assertIn("light_from=" + ",".join(f"{v:g}" for v in after), self.value("vog.link()"))
        self.value("document.getElementById('undo').click()")
        self.assertEqual(self.value("vog.state.light.lights[0].towards"), before)
        self.value("document.getElementById('redo').click()")
        self.assertEqual(self.value("vog.state.light.lights[0].towards"), after)
        # A light without shadows or surfaces has none.
        self.value("vog.change({light: {...vog.state.light, shadows: false}})")
        self.assertIsNone(self.value(sphere))

    # --- The worker. ---

    def test_levels_and_fields_are_decoded_in_a_worker(self):
        self.start("two.html", "#subframes=1&show=mean")
        self.assertEqual(self.value("vog.decodes()"), {"worker": 2, "page": 0})
        self.assertEqual([url for url in self.browser.requests if not url.startswith(("file:", "data:", "blob:"))], [])
        before = self.bytes()
        # No workers; one that the browser refuses later; one that takes no messages: the page decodes, the picture stays.
        for broken in ("delete window.Worker",
                       "window.Worker = class { constructor() { setTimeout(() => this.onerror(new Event('error'))); }"
                       " postMessage() {} terminate() {} }",
                       "window.Worker = class { postMessage() { throw new Error('too long'); } terminate() {} }"):
            self.before_pages(broken)
            self.start("two.html", "#subframes=1&show=mean")
            self.assertEqual(self.value("vog.decodes()"), {"worker": 0, "page": 2}, broken)
            self.assertEqual(self.bytes(), before)

    def test_a_damaged_field_says_so_through_the_worker(self):
        text = (self.folder / "two.html").read_text()
        at = text.index('id="model-0-0">') + len('id="model-0-0">')
        (self.folder / "damaged.html").write_text(text[:at] + text[text.index("<", at):])
        self.browser.open(self.folder / "damaged.html", "#subframes=1")
        self.until("!document.getElementById('failure').hidden")
        self.assertIn("cannot be read", self.value("document.getElementById('failure-text').textContent"))

    def heap(self):
        for _ in range(3):  # what one collection leaves another may free
            self.browser.call("HeapProfiler.collectGarbage")
        found = self.browser.call("Runtime.getHeapUsage")
        return found["usedSize"] + found.get("backingStorageSize", 0) + found.get("embedderHeapUsedSize", 0)

    def test_many_frames_take_no_more_memory(self):
        frames = 300 if nightly() else 100
        for n in range(3):
            write_scalars(self.folder / f"s_{n}.ply", self.rows[n:], [("scalar", "heat", 265, 335), ("measure", "mass", 0.1, 1)])
        vog("page", "s_*.ply", "-o", "steps.html", "--set", "levels=1", "--show", "volume", "--slabs", 8)
        self.browser.viewport(80, 60)
        self.open("steps.html", "#subframes=1&embed&show=volume")
        # Steps, fields, quantities and edits in turns.
        play = """(async () => { for (let n = %d; n < %d; ++n) {
            vog.change({ model: n %% 3, field: (n >> 2) %% 2, show: n %% 5 === 4 ? 'mean' : 'volume' });
            if (n %% 7 === 0) vog.change({ transfers: { [vog.state.field]: { name: 'own', unit: 1 + 0.1 * (n %% 9),
              colors: [[0, 1, 0, 0], [400, 1, 1, 1]], opacity: [[0, 0], [1 + n, 0.5]] } } });
            await vog.settled();
        } })()"""
        self.value(play % (0, 45))
        before = self.heap()
        for first in range(0, frames, 50):
            self.value(play % (first, first + 50))
        self.assertLess(self.heap(), before + 2e6 * frames / 300)
        self.assertEqual(self.value("vog.decodes().page"), 0)


if __name__ == "__main__":
    run()
