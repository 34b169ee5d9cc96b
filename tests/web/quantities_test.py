#!/usr/bin/env python3
"""Fields, volume rendering and time in the page that `vog page` writes, in Chromium: every quantity's picture
against the command's, edits of transfer functions, clips, the play bar.

VOG_COMMAND names the command, VOG_DATA the folder of real inputs. Exits with 77, which ctest takes as skipped,
where there is no Chromium.
"""
import array
import base64
import json
import math
import re
import unittest.mock

from page_test_case import COARSE, FACTOR_DB, nightly, run, vog
from quantity_test_case import QuantityTest

# The first colour of viridis on black, in steps: the page may end a support a pixel earlier.
RIM = 84
RAMP = {"name": "ramp", "unit": 1, "opacity": [[0, 0], [1, 0.5]],
        "colors": [[0, 0, 0, 0.2], [1, 1, 0.5, 0.1], [3, 1, 1, 1]]}
STEP = {"name": "step", "unit": 0.5, "opacity": [[0.5, 0], [0.6, 0.9]], "colors": [[0, 0.8, 0.4, 0.2], [3, 1, 1, 1]]}


class Quantities(QuantityTest):
    def write_transfer(self, transfer):
        (self.folder / "tf.json").write_text(json.dumps(
            {"domain": [0, 3], "unit_distance": transfer["unit"], "colors": transfer["colors"], "opacity": transfer["opacity"],
             **({"gradient_opacity": transfer["gradient"]} if "gradient" in transfer else {})}))
        return "tf.json"

    def volume(self, transfer, *options):
        self.expect_page_is("model.ply", "--show", "volume", "--tf", self.write_transfer(transfer), *options)

    # --- Pictures. ---

    def test_maps_of_scalars_and_vectors_are_vog_renders(self):
        self.start("flow.html")
        names = self.value("vog.page.models[0].fields.map((field) => field.name)")
        lens = self.value("vog.state.camera")
        for camera in (lens, {**lens, "span": 2.5}, {**lens, "eye": [0.2, 0.1, 0.3], "at": [-1, 0, 0]}):
            self.change(camera=camera)
            self.change(show="column", scale={"low": 0, "high": 2, "log": False})
            self.expect_page_is("flow.ply", "--show", "column", "--range", "0,2")
            for show, ends in (("mean", (280, 320)), ("deviation", (0, 15))):
                self.change(show=show, field=names.index("temperature"), part="", scale={"low": ends[0], "high": ends[1], "log": False})
                self.expect_map_is("flow.ply", "--show", show, "--field", "temperature", "--range", f"{ends[0]},{ends[1]}")
                self.change(field=names.index("velocity"), part="view", scale={"low": -20, "high": 20, "log": False})
                self.expect_map_is("flow.ply", "--show", show, "--field", "velocity", "--range=-20,20")
            self.change(show="mean", part="y", scale={"low": -20, "high": 20, "log": False})
            self.expect_map_is("flow.ply", "--show", "mean", "--field", "velocity.y", "--range=-20,20")
            self.change(part="magnitude", scale={"low": 0, "high": 60, "log": False})
            self.expect_map_is("flow.ply", "--show", "mean", "--field", "velocity.magnitude", "--range", "0,60")

    def test_volume_pictures_are_vog_renders(self):
        self.start("model.html")
        for transfer in (RAMP, STEP):
            self.change(show="volume", transfers={"0": transfer})
            self.volume(transfer)
        self.value("vog.change({light: {...vog.state.light, on: true}})")
        self.volume(STEP, "--light", "head")
        self.change(camera={**self.value("vog.state.camera"), "span": 80})
        self.volume(STEP, "--light", "head")

    def test_gradient_opacity_is_vog_renders(self):
        self.start("model.html")
        steep = {**STEP, "gradient": [[0, 0], [0.5 * self.value("vog.page.models[0].fields[0].steepest"), 1]]}
        self.change(show="volume", transfers={"0": steep})
        self.volume(steep)
        self.value("vog.change({light: {...vog.state.light, shadows: true, lights: [{towards: [3, -1, 2], ofCamera: false, strength: 1}]}})")
        self.volume(steep, "--shadows", "--light-from", "3,-1,2")

    def test_shadows_and_ambient_occlusion_are_vog_renders(self):
        light = ("--light", "1,2,1", "--shadows", "--ambient-occlusion")
        vog("page", "model.ply", "-o", "lit.html", "--set", "levels=1", "--show", "volume", "--tf", self.write_transfer(STEP), *light)
        self.start("lit.html")
        self.volume(STEP, *light)
        box = self.value("vog.page.models[0].box")
        lower = [c - 0.4 * h for c, h in zip(box["center"], box["half"])]
        clip = "--clip=" + ",".join(map(repr, lower + [c + h for c, h in zip(box["center"], box["half"])]))
        # By requests, as the command takes them.
        for request, options in ((dict(light="studio", scattering=3), ("--light", "studio")),
                                 (dict(light=None, ambient_occlusion=False, scattering=2, light_from=[3, -1, 2]), ("--shadows", "--light-from", "3,-1,2", "--set", "scattering=2")),
                                 (dict(shadows=False, ambient_occlusion=True), ("--ambient-occlusion",))):
            self.value(f"location.hash = '#' + Object.entries({json.dumps(request)}).map(([key, v]) => `${{key}}=${{v ?? ''}}`).join('&')")
            self.browser.settle()
            self.volume(STEP, *options)
        self.change(clip={"lower": lower, "upper": [c + h for c, h in zip(box["center"], box["half"])]}, light={**self.value("vog.state.light"), "shadows": True, "scattering": 1})
        self.volume(STEP, "--shadows", "--light-from", "3,-1,2", "--ambient-occlusion", clip)

    def test_clips_of_every_quantity_are_vog_renders(self):
        self.start("model.html")
        box = self.value("vog.page.models[0].box")
        lower = [c - 0.4 * h for c, h in zip(box["center"], box["half"])]
        upper = [c + s * h for c, h, s in zip(box["center"], box["half"], (0.5, 0.2, 1))]
        clip = ("--clip", ",".join(map(repr, lower + upper)))
        self.change(clip={"lower": lower, "upper": upper})
        self.expect_page_is("model.ply", "--extinction", repr(self.value("vog.page.models[0].extinction")), *clip)
        self.change(show="volume", transfers={"0": RAMP})
        self.volume(RAMP, *clip)

    def test_bounds_refuse_wrong_pictures(self):
        """A fiftieth of the Gaussians left out; red a pixel aside."""
        vog("convert", self.make_volume(), "-o", "leaves.ply", "--block", self.block, "--no-hierarchy")
        head, rows = (self.folder / "leaves.ply").read_bytes().split(b"end_header\n", 1)
        count = int(re.search(rb"element vertex (\d+)", head).group(1))
        stride = len(rows) // count
        kept = [rows[n * stride:(n + 1) * stride] for n in range(count) if n % 50 != 25]
        (self.folder / "fewer.ply").write_bytes(head.replace(b"vertex %d" % count, b"vertex %d" % len(kept)) + b"end_header\n" + b"".join(kept))
        vog("page", "fewer.ply", "-o", "fewer.html", "--set", "levels=1", "--tf", "inferno")
        tf = ("--tf", self.write_transfer(RAMP))

        def expect_failures():
            extinction = ("--extinction", repr(self.value("vog.page.models[0].extinction")))
            for show, expect, options in (("T", self.expect_page_is, extinction), ("column", self.expect_page_is, ("--range", "0,30")),
                                          ("volume", self.expect_page_is, tf), ("maximum", self.expect_page_is, ("--range", "0,2")),
                                          ("mean", self.expect_map_is, ("--field", "density", "--range", "0,2"))):
                self.change(show=show, transfers={"0": RAMP}, scale={"low": 0, "high": 30 if show == "column" else 2, "log": False})
                with unittest.mock.patch.dict(self.worst), self.assertRaises(AssertionError, msg=show):
                    expect("model.ply", *(() if show == "T" else ("--show", show)), *options)

        self.start("fewer.html")
        expect_failures()
        self.start("model.html")
        self.value("""{
            const { picture } = vog;
            vog.picture = async () => {
                const image = Object.assign(new Image(), { src: await picture() }), canvas = document.createElement('canvas');
                await image.decode();
                Object.assign(canvas, { width: image.width, height: image.height });
                const context = canvas.getContext('2d');
                context.drawImage(image, 0, 0);
                const pixels = context.getImageData(0, 0, image.width, image.height);
                for (let n = 0; n + 4 < pixels.data.length; n += 4) pixels.data[n] = pixels.data[n + 4];
                context.putImageData(pixels, 0, 0);
                return canvas.toDataURL('image/png');
            };}""")
        expect_failures()

    def test_precise_pages_are_within_2_of_255(self):
        vog("page", "model.ply", "-o", "precise.html", "--set", "levels=1", "--precise")
        usual, precise = ((self.folder / name).stat().st_size for name in ("model.html", "precise.html"))
        self.start("precise.html")
        box, lens, light = self.value("vog.page.models[0].box"), self.value("vog.state.camera"), self.value("vog.state.light")
        count = self.value("vog.page.models[0].levels[0].count")
        self.assertLess(precise - usual, 5 * count)
        extinction = repr(self.value("vog.page.models[0].extinction"))
        step = ("--show", "volume", "--tf", self.write_transfer(STEP))
        beside = {"eye": [c + f * h for c, f, h in zip(box["center"], (0, 0, 1.2), box["half"])], "at": box["center"]}
        within = {"eye": [c + 0.1 * h for c, h in zip(box["center"], box["half"])],
                  "at": [c + f * h for c, f, h in zip(box["center"], (0.3, -1, 0.2), box["half"])]}
        for part in ({}, within, *((beside, {"span": 80}) if nightly() else ())):
            self.change(show="T", map="gray", camera={**lens, **part}, light=light)
            self.expect_page_is("model.ply", "--tf", "gray", "--extinction", extinction, off=2)
            self.change(show="column", scale={"low": 0, "high": 100, "log": False})
            self.expect_page_is("model.ply", "--show", "column", "--range", "0,100", "--tf", "gray", off=2)
            self.change(show="volume", transfers={"0": STEP})
            self.expect_page_is("model.ply", *step, off=2)
            self.change(light={**light, "on": True})
            self.expect_page_is("model.ply", *step, "--light", "head", off=2)

    def plane_through(self, normal, share):
        """Offset of a plane at a share of the half extent of the model's box from its centre."""
        box = self.value("vog.page.models[0].box")
        return sum(n * c for n, c in zip(normal, box["center"])) + share * sum(abs(n) * h for n, h in zip(normal, box["half"]))

    def test_clip_planes_of_every_quantity_are_vog_renders(self):
        self.start("model.html")
        slanted, flat = (2, 0.5, -1), (0, -1, 0)
        places = [self.plane_through(slanted, -0.1), self.plane_through(flat, -0.3)]
        planes = ["--clip=" + ",".join(map(repr, (*normal, place))) for normal, place in zip((slanted, flat), places)]
        # The command's planes are the page's first ones.
        vog("page", "model.ply", "-o", "planes.html", "--set", "levels=1", "--tf", "inferno", *planes)
        whole = self.bytes()
        self.start("planes.html")
        extinction = repr(self.value("vog.page.models[0].extinction"))
        self.expect_page_is("model.ply", "--extinction", extinction, *planes)
        cut = self.bytes()
        self.change(show="column", scale={"low": 0, "high": 30, "log": False})
        self.expect_page_is("model.ply", "--show", "column", "--range", "0,30", *planes)
        for show, ends in (("mean", (0, 2)), ("deviation", (0, 0.5))):
            self.change(show=show, field=0, part="", scale={"low": ends[0], "high": ends[1], "log": False})
            self.expect_map_is("model.ply", "--show", show, "--field", "density", "--range", f"{ends[0]},{ends[1]}", *planes)
        self.change(show="volume", transfers={"0": RAMP})
        self.volume(RAMP, *planes)
        # Beside a box, under parallel rays, from inside.
        box = self.value("vog.page.models[0].box")
        lower = [c - 0.6 * h for c, h in zip(box["center"], box["half"])]
        self.change(clip={"lower": lower, "upper": [c + h for c, h in zip(box["center"], box["half"])]},
                    camera={**self.value("vog.state.camera"), "span": 80})
        self.volume(RAMP, "--clip", ",".join(map(repr, [*lower, *(c + h for c, h in zip(box["center"], box["half"]))])), *planes)
        # Each can be switched off.
        self.start("planes.html")
        self.value("[...document.querySelectorAll('#planes input[type=checkbox]')].forEach((box) => box.click())")
        self.browser.settle()
        self.assertEqual(self.bytes(), whole)
        self.value("document.querySelector('#planes input').click()")
        self.browser.settle()
        self.expect_page_is("model.ply", "--extinction", extinction, planes[0])
        self.assertNotEqual(self.bytes(), cut)
        # Ten at most.
        self.assertIn("11 planes, expected at most 10", self.refused("page", "model.ply", "-o", "x.html", *planes[:1] * 11))
        self.assertIn("or a plane NX,NY,NZ,D", self.refused("page", "model.ply", "-o", "x.html", "--clip", "1,2,3"))
        vog("page", "model.ply", "-o", "ten.html", "--set", "levels=1", *(f"--clip={x},1,0,{-200 - x}" for x in range(10)),
            "--clip=-100,-100,-100,100,100,100")

    def test_planes_are_added_moved_turned_and_removed_by_keys(self):
        self.browser.viewport(1000, 800, COARSE)
        self.open("model.html", "#subframes=1")
        whole = self.bytes()
        self.value("document.getElementById('clip-row').open = true; document.getElementById('add-plane').focus()")
        self.browser.key("Enter")
        self.assertEqual(self.value("document.activeElement.getAttribute('aria-label')"), "Place of plane 1")
        camera, box = self.value("vog.state.camera"), self.value("vog.page.models[0].box")
        view = [a - e for a, e in zip(camera["at"], camera["eye"])]
        axis = max(range(3), key=lambda k: abs(view[k]))
        (plane,) = self.value("vog.state.planes")
        self.assertEqual(plane["normal"], [(k == axis) * math.copysign(1, view[k]) for k in range(3)], "what is in front is cut off")
        self.assertAlmostEqual(plane["offset"], plane["normal"][axis] * box["center"][axis])
        before = plane["offset"]
        self.browser.key("ArrowRight")
        self.browser.settle()
        (plane,) = self.value("vog.state.planes")
        self.assertAlmostEqual(plane["offset"] - before, 0.01 * box["half"][axis], delta=1e-6)
        shown = self.value("document.querySelector('#planes output').textContent")
        self.assertAlmostEqual(float(shown), plane["offset"], delta=1e-3 * abs(plane["offset"]) + 1e-6)
        self.expect_page_is("model.ply", "--extinction", repr(self.value("vog.page.models[0].extinction")),
                            "--clip=" + ",".join(map(repr, [*plane["normal"], plane["offset"]])))
        # The other side of the same plane, then the one behind what is seen.
        choose = ("(() => { const side = document.querySelector('#planes select'); side.value = '%s';"
                  " side.dispatchEvent(new Event('change')); })()")
        opposite = ("towards " + ("−" if plane["normal"][axis] > 0 else "") + "xyz"[axis])
        self.value(choose % opposite)
        self.assertEqual(self.value("vog.state.planes[0].normal"), [-n if n else 0 for n in plane["normal"]])
        self.assertAlmostEqual(self.value("vog.state.planes[0].offset"), -plane["offset"])
        self.value(choose % "view")
        normal, length = self.value("vog.state.planes[0].normal"), math.hypot(*view)
        for k in range(3):
            self.assertAlmostEqual(normal[k], view[k] / length)
        self.assertEqual(self.value("document.querySelector('#planes select').value"), "tilted")
        # Links hold planes, those that are off, and that there is none.
        self.browser.settle()
        self.value("vog.change({planes: [...vog.state.planes, {normal: [0, 3, 0], offset: 1, on: false}]})")
        self.value("navigator.clipboard.writeText = (text) => { window.copied = text; return Promise.resolve(); }")
        self.browser.settle()
        before, planes = self.bytes(), self.value("vog.state.planes")
        self.value("vog.canvas.focus()")
        self.browser.key("c")
        link = self.value("window.copied")
        self.open("model.html", "#" + link.split("#")[1] + "&subframes=1")
        self.assertEqual([plane["on"] for plane in self.value("vog.state.planes")], [True, False])
        for got, wanted in zip(self.value("vog.state.planes"), planes):
            for a, b in zip([*got["normal"], got["offset"]], [*wanted["normal"], wanted["offset"]]):
                self.assertAlmostEqual(a, b, delta=1e-6 * (1 + abs(b)))
        (self.folder / "before.png").write_bytes(before)
        self.hold("-PSNR of a link's planes [dB]", -self.psnr("before.png", self.picture()), -70)
        self.value("document.getElementById('clip-row').open = true")
        for left in (1, 0):
            self.value("document.querySelector('#planes button').click()")
            self.assertEqual(len(self.value("vog.state.planes")), left)
        self.browser.settle()
        (self.folder / "whole.png").write_bytes(whole)
        self.hold("-PSNR without its planes [dB]", -self.psnr("whole.png", self.picture()), -70)

    def test_tall_pictures_are_drawn_in_strips(self):
        # A GPU in software takes a minute for a million pixels: by night. Strips of a small picture are as high as a smaller limit makes them.
        # mostPixels of slabs.js, beside reachedUnit.
        page, found = re.subn(r"=1<<20(,\w+=15,)", r"=1<<13\1", (self.folder / "model.html").read_text())
        self.assertEqual(found, 1)
        (self.folder / "strips.html").write_text(page)
        pages = [("strips.html", 1 << 13, self.size), ("model.html", 1 << 20, (1100, 1000))]
        for page, most, size in pages if nightly() else pages[:1]:
            with self.subTest(page):
                self.start(page)
                self.value("vog.page.slabs[0] = 8")
                self.change(show="volume", transfers={"0": RAMP})
                self.browser.viewport(*size)
                self.value("vog.settled()")
                self.assertGreater(self.value("vog.canvas.width * vog.canvas.height"), most)
                self.volume(RAMP, "--slabs", 8)
                # During edits there are fewer pixels, since sums of all have no room; then all again.
                for opacity in (0.3, 0.6, 0.9):
                    self.value("vog.change({transfers: {0: %s}})" % json.dumps({**STEP, "opacity": [[0.5, 0], [0.6, opacity]]}))
                edited = self.bytes()
                self.value("vog.change({camera: {...vog.state.camera}})")
                self.assertEqual(self.bytes(), edited)
                # Of a million pixels a few lie at rims: at most 8 of 255, measured.
                self.expect_page_is("model.ply", "--show", "volume", "--tf", self.write_transfer(STEP), "--slabs", 8, off=12)

    def test_a_page_begins_as_its_command_says(self):
        vog("page", "model.ply", "-o", "first.html", "--set", "levels=1", "--show", "volume", "--tf", self.write_transfer(RAMP))
        self.start("first.html")
        self.volume(RAMP)
        vog("page", "model.ply", "-o", "first.html", "--set", "levels=1", "--show", "column", "--scale", "log", "--tf", "viridis")
        self.start("first.html")
        self.assertEqual(self.value("vog.state.scale"), {"log": True})
        low, high = self.value("[vog.page.models[0].lowColumn, vog.page.models[0].mostColumn]")
        self.expect_page_is("model.ply", "--show", "column", "--scale", "log", "--tf", "viridis", "--range", f"{low!r},{high!r}", off=RIM)
        vog("page", "flow.ply", "-o", "first.html", "--set", "levels=1", "--show", "mean", "--field", "velocity.x",
            "--range=-40,40", "--tf", "viridis")
        self.start("first.html")
        self.expect_map_is("flow.ply", "--show", "mean", "--field", "velocity.x", "--range=-40,40", "--tf", "viridis")

    def test_a_logarithm_without_a_range_has_the_ends_of_the_first_view(self):
        self.start("model.html", "#subframes=1&embed&show=column&scale=log&tf=viridis")
        low, most = self.value("[vog.page.models[0].lowColumn, vog.page.models[0].mostColumn]")
        self.assertTrue(self.value("document.getElementById('log').checked"))
        self.expect_page_is("model.ply", "--show", "column", "--scale", "log", "--tf", "viridis", "--range", f"{low!r},{most!r}", off=RIM)
        shown = self.bytes()
        self.value("navigator.clipboard.writeText = (text) => { window.copied = text; return Promise.resolve(); }")
        self.browser.key("c")
        link = self.value("window.copied")
        self.value("document.getElementById('log').click()")
        self.assertEqual(self.value("vog.state.scale"), {"log": False})
        self.assertNotEqual(self.bytes(), shown)
        self.value("document.getElementById('log').click()")
        self.assertEqual(self.bytes(), shown)
        self.start("model.html", "#" + link.split("#")[1] + "&subframes=1&embed")
        self.assertTrue(self.value("document.getElementById('log').checked"))
        # Another quantity has its own scale again.
        self.change(show="deviation")
        self.assertIsNone(self.value("vog.state.scale"))

    def test_root_mean_squares_come_first_have_a_number_and_are_of_means_alone(self):
        vog("page", "flow.ply", "-o", "first.html", "--set", "levels=1", "--show", "mean", "--field", "velocity.magnitude", "--tf", "viridis")
        self.start("first.html", "#subframes=1")
        self.assertEqual(self.value("document.getElementById('of-quantity').textContent"), "root mean square of velocity [km/s]")
        ends = self.value("[low.value, high.value]")
        self.expect_map_is("flow.ply", "--show", "mean", "--field", "velocity.magnitude", "--tf", "viridis",
                           "--range", ",".join(map(repr, self.value("vog.page.models[0].fields[1].ranges.magnitude.mean.linear"))))
        self.assertLess(float(ends[0]), float(ends[1]))
        self.browser.viewport(1000, 800, COARSE)
        self.browser.settle()
        width, height = self.write_camera()
        x, y = width // 2, height // 2
        self.browser.mouse("mouseMoved", (x + 0.5) / COARSE, (y + 0.5) / COARSE)
        vog("render", "flow.ply", "--show", "mean", "--field", "velocity.magnitude", "--values-out", "rms.npy", "--camera", "camera.json",
            "--size", f"{width}x{height}")
        rms = array.array("f", (self.folder / "rms.npy").read_bytes()[-4 * width * height:])
        shown = self.value("document.getElementById('probe').textContent").splitlines()
        self.assertEqual(len(shown), 2, shown)
        self.assertTrue(shown[1].startswith("root mean square of velocity [km/s] "), shown)
        self.assertAlmostEqual(float(shown[1].split()[-1]), rms[y * width + x], delta=0.05)
        # Deviations have components.
        self.change(show="deviation")
        self.assertEqual(self.value("vog.state.part"), "view")
        self.assertIn("expected a component", self.refused("page", "flow.ply", "-o", "x.html", "--show", "deviation",
                                                           "--field", "velocity.magnitude"))

    # --- Edits. ---

    def test_a_map_by_its_name_covers_as_in_the_command(self):
        self.start("model.html", "#subframes=1&show=volume")
        self.browser.settle()
        unit = float(self.value("document.getElementById('unit').textContent.split(' ')[1]"))
        self.write_camera()
        chosen = json.loads(vog("render", "model.ply", "-o", "cpu.png", "--show", "volume", "--json", "--camera", "camera.json",
                                "--size", "{0}x{1}".format(*self.value("[vog.canvas.width, vog.canvas.height]"))))
        self.assertAlmostEqual(unit / chosen["unit_distance"], 1, delta=0.02)

    def test_the_curve_is_edited_undone_and_saved(self):
        self.browser.viewport(1000, 800, COARSE)
        self.open("model.html", "#subframes=1&show=volume")
        before = self.bytes()
        box = self.value("(() => { const b = editor.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
        x, y = box[0] + 0.2 * box[2], box[1] + 0.3 * box[3]
        self.browser.drag(x, y, x + 20, y - 10)
        self.browser.settle()
        edited = self.value("vog.state.transfers[0].opacity")
        self.assertGreater(len(edited), 2)
        self.assertNotEqual(self.bytes(), before)
        self.browser.key("ArrowUp")
        raised = [new[1] - old[1] for new, old in zip(self.value("vog.state.transfers[0].opacity"), edited) if new != old]
        self.assertEqual([round(by, 6) for by in raised], [0.02])
        for _ in range(8):
            self.value("undo.click()")
        self.browser.settle()
        self.assertEqual(self.bytes(), before)
        self.value("redo.click()")
        self.assertEqual(len(self.value("vog.state.transfers[0].opacity")), len(edited))
        # Saved files are what the command reads.
        text = self.value("""new Promise((done) => {
            HTMLAnchorElement.prototype.click = function () { done(decodeURIComponent(this.href.split(',').slice(1).join(','))); };
            document.getElementById('save-transfer').click();
        })""")
        (self.folder / "saved.json").write_text(text)
        self.browser.settle()
        found = self.compared("model.ply", "--show", "volume", "--tf", "saved.json")
        self.hold("-PSNR of a saved transfer function [dB]", -(found["psnr_rgb_db"] or math.inf), FACTOR_DB - 74.7)

    def test_a_right_drag_is_window_and_level(self):
        self.start("flow.html", "#subframes=1&show=mean")
        eye, scale = self.value("vog.state.camera.eye"), self.value("Number(low.value)")
        self.browser.drag(100, 120, 130, 90, button="right")
        self.assertEqual(self.value("vog.state.camera.eye"), eye)
        wider = self.value("vog.state.scale")
        self.assertNotEqual(wider["low"], scale)
        self.browser.key("z")  # no transfer function, nothing to undo

    def test_a_range_that_is_none_is_refused(self):
        self.start("flow.html", "#subframes=1&show=mean")
        self.value("low.value = '9e9'; low.dispatchEvent(new Event('change'))")
        self.assertIsNone(self.value("vog.state.scale"))
        self.assertIn("two numbers", self.value("notice.textContent"))
        self.assertEqual(self.value("low.getAttribute('aria-invalid')"), "true")

    def test_a_link_brings_quantity_range_transfer_and_clip_back(self):
        self.start("model.html")
        # A link has eight digits of the camera.
        camera = {name: [float(f"{v:.8g}") for v in part] if isinstance(part, list) else float(f"{part:.8g}")
                  for name, part in self.value("vog.state.camera").items()}
        self.change(show="volume", transfers={"0": STEP}, clip={"lower": [-5, -5, -5], "upper": [5, 60, 5]}, camera=camera)
        before = self.bytes()
        self.value("navigator.clipboard.writeText = (text) => { window.copied = text; return Promise.resolve(); }")
        self.browser.key("c")
        link = self.value("window.copied")
        self.start("model.html", "#" + link.split("#")[1] + "&subframes=1&embed")
        self.assertEqual(self.bytes(), before)

    def test_the_command_draws_the_picture_of_a_link_and_the_page_that_of_the_command(self):
        """`vog render --request LINK`, and its record pasted into the page."""
        self.start("model.html")
        self.browser.viewport(120, 160)  # taller than wide: angles are of the shorter side there
        self.value("vog.settled()")
        view, light = self.value("[vog.state.camera, vog.state.light]")
        for n, part in enumerate((
                {"show": "T", "map": "viridis", "reverse": True, "exposure": 2, "fade": True},
                {"show": "column", "map": "magma", "reverse": False, "fade": False, "camera": {**view, "span": 40}},
                {"show": "volume", "transfers": {"0": RAMP}, "light": {**light, "on": True, "towards": [1, 2, 3]}, "clip": {"lower": [-5, -5, -5], "upper": [5, 60, 5]},
                 "planes": [{"normal": [0, 0, 1], "offset": -20, "on": True}, {"normal": [1, 0, 0], "offset": 90, "on": False}]})):
            self.change(**part)
            self.picture("page.png")
            link = self.value("vog.link()")
            exact = ("--set", "precision=0") if part["show"] == "volume" else ()
            vog("render", "model.ply", "-o", "again.png", "--request", f"http://127.0.0.1/model.html{link}", *exact)
            self.hold(f"-PSNR of the command's picture of a link {n} [dB]", -self.psnr("again.png", "page.png"), FACTOR_DB - 65.3)
            # Another state, then the picture itself, as text and as a file.
            request = json.loads(vog("render", "model.ply", "-o", "again.png", "--request", link, "--json"))["request"]
            png = base64.b64encode((self.folder / "again.png").read_bytes()).decode()
            for given in (f"data.setData('text/plain', {json.dumps(json.dumps(request))})",
                          f"data.items.add(new File([Uint8Array.from(atob('{png}'), (c) => c.charCodeAt(0))], 'again.png'))"):
                self.change(show="T", map="gray", exposure=1, reverse=False, fade=False, planes=[], clip=None, transfers={}, camera={**view, "eye": view["at"], "at": view["eye"]})
                self.value(f"(() => {{ const data = new DataTransfer(); {given}; "
                           "window.dispatchEvent(new ClipboardEvent('paste', {clipboardData: data, cancelable: true})); })()")
                self.value(f"(async () => {{ while (vog.state.show !== '{part['show']}' || vog.state.reverse !== {json.dumps(part.get('reverse', False))}) await new Promise((done) => setTimeout(done, 20)); await vog.settled(); }})()")
                self.assertTrue(self.value("notice.hidden"), self.value("notice.textContent"))
                self.hold(f"-PSNR of the page's picture of a record {n} [dB]", -self.psnr("page.png", self.picture()), -70)
        # Text that states no picture is named, as text.
        for text, line in (("hello", "Neither a link"), ("#show=<img src=x onerror=alert(1)>", "Not in this picture: show"), ('{"show": 1', "neither a link")):
            self.value(f"(() => {{ const data = new DataTransfer(); data.setData('text/plain', {json.dumps(text)}); "
                       "window.dispatchEvent(new ClipboardEvent('paste', {clipboardData: data, cancelable: true})); })()")
            self.assertIn(line, self.value("new Promise((done) => setTimeout(() => done(notice.textContent), 50))"))
        self.assertEqual(self.value("document.querySelectorAll('#notice *').length"), 0)

    # --- Time. ---

    def test_steps_play_scrub_and_keep_one_range(self):
        for step, block in ((1, 4), (2, 8), (10, 16)):
            vog("convert", "plume.vdb", "-o", f"t_{step}.ply", "--block", block, "--set", "soft-steps=0")
        vog("page", "t_*.ply", "-o", "steps.html", "--set", "levels=1")
        self.start("steps.html", "#subframes=1")
        self.browser.viewport(1000, 800, COARSE)
        names = self.value("vog.page.models.map(({name}) => name)")
        self.assertEqual(names, ["t_1", "t_2", "t_10"])
        self.assertEqual(len(set(self.value("vog.page.models.map(({extinction}) => extinction)"))), 1)
        self.assertTrue(self.value("document.getElementById('model-row').hidden"))
        self.value("play.click()")
        seen = self.value("""new Promise((done) => {
            const seen = new Set(), timer = setInterval(() => {
              seen.add(vog.state.model);
              if (seen.size === 3) { clearInterval(timer); done([...seen]); }
            }, 5);
        })""")
        self.assertEqual(sorted(seen), [0, 1, 2])
        self.value("play.click()")
        self.value("time.value = 1; time.dispatchEvent(new Event('input'))")
        self.browser.settle()
        self.assertEqual(self.value("document.getElementById('step-name').textContent"), "t_2")
        self.change(show="mean")
        first = self.value("[low.value, high.value]")
        self.change(model=2)
        self.assertEqual(self.value("[low.value, high.value]"), first)
        # The pictures do not pile up.
        heap = "performance.memory.usedJSHeapSize"
        self.value("(async () => { for (let n = 0; n < 15; ++n) { vog.change({model: n % 3}); await vog.settled(); } })()")
        before = self.value(heap)
        self.value("(async () => { for (let n = 0; n < 60; ++n) { vog.change({model: n % 3}); await vog.settled(); } })()")
        self.assertLess(self.value(heap), before + 30e6)

    # --- Around the picture. ---

    def test_the_scale_bar_has_its_length(self):
        self.browser.viewport(1000, 800, COARSE)
        self.open("model.html", "#subframes=1")
        lens = self.value("vog.state.camera")
        self.value("vog.change({camera: {...vog.state.camera, span: 100}})")
        pixels = self.value("getComputedStyle(document.getElementById('length')).width")
        world = float(self.value("document.getElementById('length').textContent"))
        side = self.value("Math.min(vog.canvas.clientWidth, vog.canvas.clientHeight)")
        self.assertAlmostEqual(float(pixels[:-2]) / side, world / 100, delta=0.01)
        self.value("vog.change({camera: %s})" % json.dumps(lens))
        self.value("document.getElementById('z-up').click()")
        self.assertEqual(self.value("vog.state.camera.up"), [0, 0, 1])

    # --- What is missing. ---

    def test_a_page_cut_in_half_says_so(self):
        whole = (self.folder / "model.html").read_bytes()
        (self.folder / "half.html").write_bytes(whole[:len(whole) // 2])
        self.browser.open(self.folder / "half.html")
        # 1.5 s by the page's clock of frames, which is late on a busy machine.
        self.value("""new Promise((done) => {
            const line = document.getElementById('loading'), end = Date.now() + 20000;
            const poll = () => (getComputedStyle(line).visibility === 'visible' || Date.now() > end ? done() : setTimeout(poll, 50));
            poll();
        })""")
        self.assertIn("not whole", self.value("document.getElementById('loading').textContent"))
        self.assertEqual(self.value("getComputedStyle(document.getElementById('loading')).visibility"), "visible")
        self.open("model.html")
        self.assertIsNone(self.value("document.getElementById('loading')"))

    def test_a_lost_context_brings_the_volume_back(self):
        self.start("model.html")
        self.change(show="volume", transfers={"0": RAMP})
        before = self.bytes()
        self.value("""new Promise((done) => {
            const loser = vog.canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
            vog.canvas.addEventListener('webglcontextlost', () => setTimeout(() => loser.restoreContext()));
            vog.canvas.addEventListener('webglcontextrestored', () => setTimeout(done));
            loser.loseContext(); })""")
        self.assertEqual(self.bytes(), before)
        self.change(transfers={"0": STEP})
        edited = self.bytes()
        self.assertNotEqual(edited, before)
        self.change(transfers={"0": RAMP})
        self.assertEqual(self.bytes(), before)

    def test_a_model_without_fields_offers_none(self):
        vog("page", "model.ply", "-o", "bare.html", "--set", "levels=1", "--no-fields")
        self.start("bare.html", "#subframes=1&show=volume")
        self.assertEqual(self.value("[...show.options].map(({value}) => value)"), ["T", "column"])
        self.assertEqual(self.value("vog.state.show"), "T")
        self.assertIn("needs a scalar field", self.refused("page", "flow.ply", "-o", "x.html", "--no-fields", "--show", "volume"))

    def test_half_floats_show_volumes_too(self):
        self.start("model.html", "#subframes=1&embed&half")
        self.assertEqual(self.value("vog.bits()"), 16)
        self.change(show="volume", transfers={"0": RAMP})
        found = self.compared("model.ply", "--show", "volume", "--tf", self.write_transfer(RAMP))
        self.hold("-PSNR of half floats [dB]", -(found["psnr_rgb_db"] or math.inf), FACTOR_DB - 59.3)  # sums of squares would be noise: spreads of means are left out


if __name__ == "__main__":
    run()
