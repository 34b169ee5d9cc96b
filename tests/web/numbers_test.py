#!/usr/bin/env python3
"""Numbers that a page shows: ticks, ends of ranges, the probe of gradient opacity, in Node.js without a browser.

Exits with 77, which ctest takes as skipped, where there is no Node.js.
"""
import json
import math

from page_test_case import run
from streaming_test_case import NodeTest


class Texts(NodeTest):
    modules = ("quantity.js", "controls.js")

    def ticks(self, low, high, log=False):
        return self.value(f"ticks({json.dumps({'low': low, 'high': high, 'log': log})})")

    def test_ticks_differ_and_are_their_places(self):
        ranges = [(100000, 100001), (300.12, 300.2), (1013.21, 1013.29), (-1e6, -999990), (1e6, 1e6 + 10), (5, 5.0001), (1e-30, 3e-30), (-2e30, 1e30), (0, 1.5e6), (-0.3, 0.7),
                  (1000, 1010), (-1e-4, 1e-4), (0, 3e-7), (1e12, 1e12 + 1)]
        for low, high in ranges:
            marks = self.ticks(low, high)
            self.assertGreater(len(marks), 2, (low, high))
            for at, text in marks:
                self.assertAlmostEqual((float(text) - low) / (high - low), at, delta=1e-3, msg=f"{low} to {high}: {text}")
            # One form: with powers of ten, or without any.
            self.assertEqual(len({"e" in text for _, text in marks if text != "0"}), 1, marks)
        self.assertEqual([text for _, text in self.ticks(100000, 100001)], ["100000", "100000.25", "100000.5", "100000.75", "100001"])
        self.assertEqual([text for _, text in self.ticks(-1e6, -999990)], ["-1000000", "-999997.5", "-999995", "-999992.5", "-999990"])
        self.assertEqual([text for _, text in self.ticks(300.12, 300.124, True)], ["300.12", "300.124"])
        self.assertEqual([text for _, text in self.ticks(1e-4, 1, True)], ["1e-4", "0.001", "0.01", "0.1", "1"])

    def test_numbers_have_four_digits_or_those_of_their_scale(self):
        self.assertEqual(self.value("[100000.26, 1234567, 0.0001236, 0, -0.5, NaN, 1e300].map((v) => numberText(v))"),
                         ["100000", "1.235e6", "1.236e-4", "0", "-0.5", "–", "1e300"])
        self.assertEqual(self.value("[[100000, 100001], [0, 1], [290, 310], [1e15, 1e15 + 1]].map(([low, high]) => numberText(low + 0.2621 * (high - low), stepOf({ low, high })))"),
                         ["100000.262", "0.2621", "295.24", "1e15"])


class Ranges(NodeTest):
    """The boxes of a range, without a document."""

    modules = ("controls.js", "quantity.js")

    def edited(self, ends, **typed):
        """Range after texts have been typed over those of one that is shown."""
        return self.value(f"""(() => {{
            const boxes = {{}}, box = () => ({{ value: '', classList: {{ add() {{}}, toggle() {{}} }}, setAttribute() {{}}, checked: false }});
            globalThis.document = {{ getElementById: (id) => (boxes[id] ??= box()), activeElement: null }};
            let made = null;
            const it = Object.assign(Object.create(Controls.prototype), {{ change: ({{ scale }}) => {{ made = scale; }} }});
            it.showScale({json.dumps(dict(zip(('low', 'high'), ends)))});
            globalThis.texts = [boxes.low.value, boxes.high.value];
            for (const [id, text] of Object.entries({json.dumps(typed)})) boxes[id].value = text;
            it.setScale();
            return made && [made.low, made.high];
        }})()""")

    def test_an_end_that_is_not_typed_keeps_its_value(self):
        self.assertEqual(self.edited((100000.123456789, 100001.987654321), low="100000.5"), [100000.5, 100001.987654321])
        self.assertEqual(self.value("texts"), ["100000.12", "100001.99"])
        self.assertEqual(self.edited((1 / 3, 2 / 3), high="1"), [1 / 3, 1])
        self.assertEqual(self.edited((1 / 3, 2 / 3)), [1 / 3, 2 / 3])
        self.assertEqual(self.edited((-1e-7 / 3, 1e30 / 3), low="-1"), [-1, 1e30 / 3])
        for wrong in {"low": "5"}, {"low": ""}, {"high": "a"}:
            self.assertIsNone(self.edited((0.5, 2), **wrong))


class GradientOpacity(NodeTest):
    modules = ("picture/probe.js",)

    def opacity(self, gradients, points):
        """Opacity through one place of unit Gaussians of heat 300 with these changes along x, behind a constant transfer function."""
        return self.value(f"""(() => {{
            const gradients = {json.dumps(gradients)}, model = {{ center: [0, 0, 0], unit: 2, cutoff: 3, extinction: 1 }}, source = {{ reference: 300, unit: 15 }};
            const half = Math.SQRT1_2;  // a quarter turn about z: the own y axis is the world's -x
            const instances = new Float32Array(gradients.flatMap(() => [0, 0, 0, 0.2, 0.5, 0.25, 0.5, half, 0, 0, half]));
            const data = new Float32Array(gradients.flatMap((g) => [0, 0, (-g * 0.25 * model.unit) / source.unit, 0, 0, 0]));
            const transfer = {{ unit: 1, colors: [[285, 1, 1, 1], [315, 1, 1, 1]], opacity: [[285, 0.9], [315, 0.9]], gradient: {json.dumps(points)} }};
            const ray = {{ origin: [0, 0, -4], direction: [0, 0, 1] }}, clip = {{ box: null, planes: [] }};
            return new Probe().probe([{{ instances, data, first: 0, count: gradients.length }}], model, ray, {{ transfer, source, clip }}).opacity;
        }})()""")

    def test_the_probe_knows_the_factor_of_the_mean_gradient(self):
        depth = lambda *case: -math.log1p(-self.opacity(*case))
        points = [[0, 0], [120, 1]]
        whole = depth([60, 60], None)
        self.assertGreater(whole, 0.3)
        # 60 a unit of length is half of 120; gradients of both signs cancel.
        for gradients, share in (([60, 60], 0.5), ([30, 60], 0.375), ([60, -60], 0), ([-240, -240], 1)):
            self.assertAlmostEqual(depth(gradients, points), share * whole, delta=1e-4 * whole)
        self.assertAlmostEqual(depth([60, 60], [[0, 1], [40, 0.25], [80, 0.75]]), 0.5 * whole, delta=1e-4 * whole)


if __name__ == "__main__":
    run()
