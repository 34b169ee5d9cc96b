#!/usr/bin/env python3
"""Maxima along rays in the page that `vog page` writes, in Chromium, against the command's.

VOG_COMMAND names the command, VOG_DATA the folder of real inputs. Exits with 77, which ctest takes as skipped,
where there is no Chromium.
"""
import array

from page_test_case import COARSE, FACTOR, run, vog
from quantity_test_case import QuantityTest

RANGE = ("--range", "0,2.5")
SCALE = {"low": 0, "high": 2.5, "log": False}


class Maxima(QuantityTest):
    def pictures(self, page):
        """Clipped, and under parallel rays."""
        self.start(page)
        box, lens = self.value("vog.page.models[0].box"), self.value("vog.state.camera")
        lower = [c - 0.4 * h for c, h in zip(box["center"], box["half"])]
        upper = [c + s * h for c, h, s in zip(box["center"], box["half"], (0.5, 0.2, 1))]
        self.change(show="maximum", scale=SCALE, clip={"lower": lower, "upper": upper})
        self.expect_page_is("model.ply", "--show", "maximum", *RANGE, "--clip", ",".join(map(repr, lower + upper)))
        self.change(clip=None, camera={**lens, "span": 80})
        self.expect_page_is("model.ply", "--show", "maximum", *RANGE)

    def test_maxima_are_vog_renders(self):
        self.pictures("model.html")

    def test_maxima_of_precise_pages_are_nearer(self):
        vog("page", "model.ply", "-o", "precise.html", "--set", "levels=1", "--precise", "--tf", "inferno")
        self.pictures("precise.html")

    def test_maxima_have_a_number_and_a_link(self):
        self.browser.viewport(1000, 800, COARSE)
        self.open("model.html", "#subframes=1&show=maximum&range=0,2.5")
        width, height = self.write_camera()
        self.assertEqual(self.value("document.getElementById('of-quantity').textContent"), "maximum of density")
        self.assertEqual(self.value("[show.value, document.getElementById('scale-row').hidden]"), ["maximum", False])
        x, y = width // 2, height // 2
        self.browser.mouse("mouseMoved", (x + 0.5) / COARSE, (y + 0.5) / COARSE)
        vog("render", "model.ply", "--show", "maximum", "--values-out", "maximum.npy", "--camera", "camera.json", "--size", f"{width}x{height}")
        largest = array.array("f", (self.folder / "maximum.npy").read_bytes()[-4 * width * height:])
        shown = self.value("document.getElementById('probe').textContent")
        self.assertTrue(shown.startswith("maximum of density "), shown)
        self.assertAlmostEqual(float(shown.split()[-1]), largest[y * width + x], delta=5e-3)
        self.value("navigator.clipboard.writeText = (text) => { window.copied = text; return Promise.resolve(); }")
        self.value("vog.canvas.focus()")
        self.browser.key("c")
        self.assertRegex(self.value("window.copied"), "show=maximum&field=density&tf=\\w+&range=0,2.5&")

    def test_maxima_come_first_of_any_scalar_field(self):
        vog("page", "flow.ply", "-o", "first.html", "--set", "levels=1", "--show", "maximum", "--field", "temperature", "--slabs", 50)
        self.start("first.html")
        self.assertEqual(self.value("vog.page.slabs"), [32, 50, 64])
        ends = self.value("vog.page.models[0].fields[0].ranges[''].maximum.linear")
        # A pixel that a rim just meets or misses has a value or none: measured shares.
        found = self.compared("flow.ply", "--show", "maximum", "--field", "temperature", "--slabs", 50, "--range", ",".join(map(repr, ends)))
        self.hold("maximum of temperature: off by more than 4", found["off_by_more_than_4"], FACTOR * 7.8e-4)
        self.hold("maximum of temperature: off by more than 1", found["off_by_more_than_1"], FACTOR * 2.3e-3)
        self.assertIn("'velocity' is a vector field", self.refused("page", "flow.ply", "-o", "x.html", "--show", "maximum",
                                                              "--field", "velocity"))


if __name__ == "__main__":
    run()
