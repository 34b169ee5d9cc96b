#!/usr/bin/env python3
"""Contrast of all texts of the page that `vog page` writes, by WCAG 2.2 AA, in Chromium: 4.5 between text and ground, 3 for
large text, on dark and light pages. Computed colours, blended over every ground up to the page's own.

VOG_COMMAND names the command, VOG_DATA the folder of real inputs. Exits with 77, which ctest takes as skipped,
where there is no Chromium.
"""
import json

from page_test_case import COARSE, PageTest, run, vog, write_model
from quantity_test_case import write_flow

# [text, contrast, wanted] of each visible element with a text of its own; disabled controls are exempt.
CONTRASTS = """(() => {
  const parts = (color) => {
    const v = color.match(/[\\d.]+/g).map(Number);
    return [v[0], v[1], v[2], v[3] ?? 1];
  };
  const over = ([r, g, b, a], below) => [r, g, b].map((v, k) => a * v + (1 - a) * below[k]);
  const linear = (v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const chain = (element) => (element ? [...chain(element.parentElement), element] : []);
  const groundOf = (element) => chain(element).reduce(
    (below, e) => over(parts(getComputedStyle(e).backgroundColor), below), ON_PICTURE);
  const found = [];
  for (const element of document.body.querySelectorAll('*')) {
    const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim() !== '');
    const input = element.matches('input[type=text], select');
    if ((!own && !input) || element.matches('script, style, option, noscript, noscript *') || element.disabled) continue;
    if (!element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
    const style = getComputedStyle(element), ground = groundOf(element);
    const opacity = chain(element).reduce((all, e) => all * Number(getComputedStyle(e).opacity), 1);
    const ink = parts(element instanceof SVGElement ? style.fill : style.color);
    const [a, b] = [luminance(over([ink[0], ink[1], ink[2], ink[3] * opacity], ground)), luminance(ground)];
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    found.push([element.id || element.textContent.trim().slice(0, 30), ratio, large ? 3 : 4.5]);
  }
  return found;
})()"""


class Contrast(PageTest):
    @classmethod
    def make(cls):
        write_flow(cls.folder / "flow.ply", 4)
        write_model(cls.folder / "round.ply", [0, 0, 0, 1, 1, 1, 1])
        vog("page", "flow.ply", "round.ply", "-o", "page.html", "--set", "levels=1", "--show", "volume", "--slabs", 8, "--background", "system",
            "--title", "A title", "--set", "description=Words below the title.", "--clip", "1,0,0,-9")
        vog("page", "flow.ply", "round.ply", "-o", "steps.html", "--set", "levels=1", "--show", "volume", "--slabs", 8, "--steps")

    def expect_contrast(self, picture, shown):
        """Expects every text to differ enough from its ground; picture: the ground of texts over the picture."""
        found = self.value(CONTRASTS.replace("ON_PICTURE", json.dumps(picture)))
        self.assertGreater(len(found), 8, shown)
        for text, ratio, wanted in found:
            self.assertGreaterEqual(ratio, wanted, f"{text!r} {shown}")
        return {text for text, *_ in found}

    def test_all_texts_of_dark_and_light_pages(self):
        texts = set()
        for page in ("page.html", "steps.html"):
            self.browser.viewport(1000, 1400, COARSE / 4)
            self.open(page, "#subframes=1&show=T")
            self.value("document.getElementById('clip-row').open = true")
            # As a streamed page has it (stream/status.js).
            self.value("stream.hidden = false; stream.textContent = '1.2 MB loaded'")
            for scheme, picture in (("dark", [0, 0, 0]), ("light", [255, 255, 255])):
                self.browser.prefer(prefers_color_scheme=scheme)
                ground = picture if page == "page.html" else [0, 0, 0]
                for width, height in ((1000, 1400), (360, 740)):
                    self.browser.viewport(width, height, COARSE / 4)
                    for show in ("T", "mean", "volume") if width > 640 else ("volume",):
                        for panel in ("true", "false"):
                            self.value(f"vog.change({{show: '{show}', panel: {panel}, embed: false}})")
                            self.browser.settle()
                            texts |= self.expect_contrast(ground, f"{scheme} {width} {page} {show}")
                    self.value("vog.change({panel: true}); document.getElementById('help').click()")
                    texts |= self.expect_contrast(ground, f"{scheme} {width} {page}, keys")
                    self.value("document.getElementById('close-help').click(); vog.change({show: 'T', panel: false, embed: true})")
                    self.value("document.getElementById('notice').textContent = 'Words'; document.getElementById('notice').hidden = false")
                    texts |= {text for text, ratio, wanted in self.value(CONTRASTS.replace("ON_PICTURE", json.dumps(ground)))
                              if self.assertGreaterEqual(ratio, wanted, f"{text!r} {scheme} embedded") is None}
                    self.value("document.getElementById('notice').hidden = true")
        for text in ("A title", "description", "Clip", "Plane 1", "low", "unit", "step-name", "open", "notice", "close-help", "stream"):
            self.assertIn(text, texts)

    def test_a_message_in_place_of_the_picture(self):
        self.open()
        self.value("document.getElementById('failure').hidden = false; document.getElementById('failure-text').textContent = 'Words'")
        self.assertIn("failure-text", self.expect_contrast([0, 0, 0], "failure"))

    def test_the_measure_finds_what_is_too_faint(self):
        self.open()
        self.value("document.querySelector('h1').style.opacity = 0.4")
        ratios = {text: ratio for text, ratio, _ in self.value(CONTRASTS.replace("ON_PICTURE", "[0, 0, 0]"))}
        self.assertLess(ratios["A title"], 4.5)
        self.value("document.querySelector('h1').style.cssText = 'color: #777; opacity: 1'")
        ratios = {text: ratio for text, ratio, _ in self.value(CONTRASTS.replace("ON_PICTURE", "[255, 255, 255]"))}
        self.assertAlmostEqual(ratios["A title"], 4.48, delta=0.01)  # the published figure of #777 on white


if __name__ == "__main__":
    run()
