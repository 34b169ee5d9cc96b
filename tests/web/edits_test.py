#!/usr/bin/env python3
"""Edits of a still picture in the page that `vog export` writes, in Chromium: how often the model is drawn, and that no picture is stale.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Chromium.
"""
import json

from page_test_case import run
from quantities_test import RAMP, STEP
from quantity_test_case import QuantityTest


class Edits(QuantityTest):
    def start_small(self, slabs=8):
        """A page of few pixels and slabs, whose pictures are compared with each other only."""
        self.start("model.html")
        self.browser.viewport(60, 50)
        self.value(f"vog.page.slabs.fill({slabs})")

    def test_edits_finish_kept_sums_and_give_the_picture_drawn_anew(self):
        for lit in (False, True):
            self.start_small()
            light, camera = self.value("[{...vog.state.light, on: %s}, vog.state.camera]" % json.dumps(lit))
            first = {"show": "volume", "transfers": {"0": RAMP}, "light": light, "camera": camera}
            self.change(panel=True, **first)
            edits = [{"transfers": {"0": {**RAMP, "unit": 4}}}, {"transfers": {"0": {**STEP, "opacity": [[0.9, 0], [0.95, 0.8], [1, 0]]}}}]
            edits += [{"light": {**light, "shadows": True, "towards": [3, 1, -2]}}, {"light": {**light, "shadows": True, "occlusion": True, "towards": [1, 2, 3]}}]
            if lit:
                edits += [{"light": {**light, "towards": [1, 2, 3]}}, {"light": {**light, "weights": [0.5, 0.5, 0.2, 8]}}]
            drawn, pictures = self.value("vog.draws()"), []
            for edit in edits:
                self.change(**edit)
                pictures.append(self.bytes())
            self.assertEqual(self.value("vog.draws()"), drawn)
            self.assertEqual(len(set(pictures)), len(edits))
            # In a page that showed nothing before, then after another view each.
            self.start_small()
            for n, picture in reversed(list(enumerate(pictures))):
                before, part = self.value("vog.draws()"), first
                for edit in edits[:n + 1]:
                    part = {**part, **edit}
                self.change(**part)
                self.assertGreater(self.value("vog.draws()"), before)
                self.assertTrue(self.bytes() == picture, part)
                self.change(camera={**camera, "fov": 20})
                self.assertFalse(self.bytes() == picture, part)

    def test_what_sums_depend_on_draws_them_anew(self):
        self.start_small()
        camera, light, box = self.value("[vog.state.camera, vog.state.light, vog.page.models[0].box]")
        state = {"show": "volume", "transfers": {"0": RAMP}, "panel": True}
        self.change(**state)
        for part in ({"camera": {**camera, "fov": 20}}, {"clip": {"lower": [c - h for c, h in zip(box["center"], box["half"])], "upper": box["center"]}},
                     {"planes": [{"normal": [1, 0, 0], "offset": box["center"][0] - 0.5 * box["half"][0], "on": True}]}, {"light": {**light, "on": True}}):
            before, picture = self.value("vog.draws()"), self.bytes()
            self.change(**part)
            self.assertGreater(self.value("vog.draws()"), before, part)
            self.assertFalse(self.bytes() == picture, part)
            state |= part
        drawn, picture = self.value("vog.draws()"), self.bytes()
        self.start_small()
        self.change(**state)
        self.assertTrue(self.bytes() == picture)
        for size, slabs in ((70, 8), (70, 16)):
            drawn = self.value("vog.draws()")
            self.browser.viewport(size, 50)
            self.value(f"vog.page.slabs.fill({slabs}); vog.change({{}})")
            self.browser.settle()
            self.assertGreater(self.value("vog.draws()"), drawn)

    def test_quantities_of_a_still_picture_are_drawn_once(self):
        self.start_small()
        self.change(transfers={"0": RAMP})

        def pictures():
            shown, draws = [], []
            for show in ("T", "column", "mean", "deviation", "volume"):
                before = self.value("vog.draws()")
                self.change(show=show)
                shown.append(self.bytes())
                draws.append(self.value("vog.draws()") - before)
            return shown, draws

        first, draws = pictures()
        self.assertEqual([n > 0 for n in draws], [False, False, True, False, True])
        self.assertEqual(len(set(first)), 5)
        self.assertEqual(pictures(), (first, [0] * 5))
        # Others take the place of the oldest, which are drawn again.
        light = self.value("vog.state.light")
        self.change(show="maximum")
        self.change(show="volume", light={**light, "on": True})
        self.change(light=light)
        again, draws = pictures()
        self.assertEqual(again, first)
        self.assertEqual([n > 0 for n in draws], [True, False, True, False, False])
        camera = self.value("vog.state.camera")
        self.change(camera={**camera, "eye": [e + 0.1 * (a - e) for e, a in zip(camera["eye"], camera["at"])]})
        moved, draws = pictures()
        self.assertEqual([n > 0 for n in draws], [True, False, True, False, False])  # the volume was shown
        for picture, before in zip(moved, first):
            self.assertNotEqual(picture, before)


class Motion(QuantityTest):
    def test_slow_slabs_have_half_the_resolution_while_they_move(self):
        self.before_pages("""globalThis.widths = [];
            const allocate = WebGL2RenderingContext.prototype.texImage2D;
            WebGL2RenderingContext.prototype.texImage2D = function (...list) { widths.push(list[3]); return allocate.apply(this, list); };""")
        self.start("model.html")
        self.change(show="volume", map="inferno")
        self.assertNotIn(self.size[0] // 2, self.value("widths"))
        # A frame here takes longer than 50 ms; the camera moves on until the next one has been drawn, too.
        self.value("""new Promise((done) => {
            const move = () => {
                vog.move({ ...vog.state.camera, eye: vog.state.camera.eye.map((v) => 1.001 * v) });
                if (widths.includes(%d)) done(); else setTimeout(move, 20);
            };
            move();
        })""" % (self.size[0] // 2))
        self.browser.settle()
        self.expect_page_is("model.ply", "--show", "volume", "--tf", "inferno")


if __name__ == "__main__":
    run()
