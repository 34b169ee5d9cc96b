#!/usr/bin/env python3
"""Edits of a still picture in the page that `vog export` writes, in Chromium: how often the model is drawn, and that no picture is stale.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Chromium.
"""
import json

from page_test_case import run, vog
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
            edits += [{"light": {**light, "shadows": True, "lights": [{"towards": [3, 1, -2], "ofCamera": False, "strength": 1}]}}, {"light": {**light, "shadows": True, "occlusion": True, "lights": [{"towards": [1, 2, 3], "ofCamera": False, "strength": 1}]}}]
            if lit:
                edits += [{"light": {**light, "lights": [{"towards": [1, 2, 3], "ofCamera": False, "strength": 1}]}}, {"light": {**light, "weights": [0.5, 0.5, 0.2, 8]}}]
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
    def test_slow_slabs_have_half_the_resolution_and_number_while_they_move(self):
        self.before_pages("""globalThis.widths = [], globalThis.slabs = [];
            const { texImage2D, getUniformLocation, uniform1f, fenceSync, getSyncParameter } = WebGL2RenderingContext.prototype, places = new Set();
            Object.assign(WebGL2RenderingContext.prototype, {
                texImage2D(...list) { widths.push(list[3]); return texImage2D.apply(this, list); },
                getUniformLocation(of, name) {
                    const place = getUniformLocation.call(this, of, name);
                    if (name === 'slabs') places.add(place);
                    return place;
                },
                uniform1f(place, value) { if (places.has(place)) slabs.push(value); uniform1f.call(this, place, value); },
                // A frame takes longer than 50 ms.
                fenceSync(...list) { globalThis.begun = performance.now(); return fenceSync.apply(this, list); },
                getSyncParameter(...list) { return performance.now() < begun + 60 ? this.UNSIGNALED : getSyncParameter.apply(this, list); },
            });""")
        self.start("model.html")
        self.change(show="volume", map="inferno")
        self.assertNotIn(self.size[0] // 2, self.value("widths"))
        self.assertEqual(self.value("[...new Set(slabs)]"), [32])
        # The camera moves on until the next one has been drawn, too.
        self.value("""new Promise((done) => {
            const move = () => {
                vog.move({ ...vog.state.camera, eye: vog.state.camera.eye.map((v) => 1.001 * v) });
                if (widths.includes(%d)) done(); else setTimeout(move, 20);
            };
            move();
        })""" % (self.size[0] // 2))
        self.assertEqual(self.value("[...new Set(slabs)]"), [32, 16])
        self.browser.settle()
        self.expect_page_is("model.ply", "--show", "volume", "--tf", "inferno")

    def test_nothing_is_drawn_behind_opaque_pixels(self):
        self.before_pages("""globalThis.hides = true, globalThis.queries = [];
            const { enable, drawArraysInstanced } = WebGL2RenderingContext.prototype;
            WebGL2RenderingContext.prototype.enable = function (what) { if (hides || what !== this.DEPTH_TEST) enable.call(this, what); };
            WebGL2RenderingContext.prototype.drawArraysInstanced = function (...list) {
                const query = this.createQuery();
                this.beginQuery(this.ANY_SAMPLES_PASSED, query);
                drawArraysInstanced.apply(this, list);
                this.endQuery(this.ANY_SAMPLES_PASSED);
                queries.push(() => this.getQueryParameter(query, this.QUERY_RESULT));
            };""")
        self.start("model.html")
        # From within: all rays begin in what is opaque.
        camera = self.value("vog.state.camera")
        dense = {"name": "dense", "colors": [[0, 0.2, 0, 0.4], [3, 1, 0.8, 0.3]], "opacity": [[0, 0.9], [3, 0.9]], "unit": 0.01}
        self.change(show="volume", transfers={"0": dense})
        drawn = {}
        for hides in False, True:
            self.value(f"(globalThis.hides = {json.dumps(hides)}, queries.length = 0, true)")
            step = 0.01 * hides  # another view draws all anew
            self.change(camera={**camera, "eye": [4 + step, 60, 4], "at": [40 + step, 60, 30]})
            self.value("new Promise((done) => setTimeout(done, 20))")
            drawn[hides] = self.value("queries.slice(2).map((result) => result())")  # behind those of the ranges of depths
            self.picture(f"{hides}.png")
        self.assertEqual([len(passes) for passes in drawn.values()], [8, 8])
        self.assertTrue(all(drawn[False][:6]), drawn)
        self.assertFalse(any(drawn[True][2:]), drawn)
        found = json.loads(vog("compare", "False.png", "True.png", "--json"))
        self.assertEqual(found["off_by_more_than_4"], 0, found)


if __name__ == "__main__":
    run()
