#!/usr/bin/env python3
"""State of a page that opens, and its changes by addresses and by settings from outside, in Node.js without a browser.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Node.js.
"""
import json
import re

from exploring_test import random_gaussians, write_scalars
from page_test_case import run, vog
from streaming_test_case import NodeTest

NONSENSE = "#subframes=1&eye=1,2&at=x&fov=400&map=<b>&level=0&model=-3&exposure=NaN&up=0,0,"


class Links(NodeTest):
    modules = ("link.js", "quantity.js")

    @classmethod
    def make(cls):
        # Heat rises with x; the measure is the second field, `signed` has both signs.
        rows = random_gaussians(20, lambda mean: [(300 + 10 * mean[0], [10, 0, 0]), (0.5, [0, 0, 0]), (mean[1], [0, 1, 0])])
        write_scalars(cls.folder / "two.ply", rows, [("scalar", "heat", 285, 315), ("measure", "mass", 0.1, 1), ("scalar", "signed", -1, 1)])

    def state(self, *hashes):
        """State after the address of a page and then some settings; its page stays in `page`."""
        vog("export", "two.ply", "-o", "page.html", "--set", "levels=1")
        page = re.search(r'<script[^>]*id="page"[^>]*>(.*?)</script>', (self.folder / "page.html").read_text(), re.S).group(1)
        return self.value(f"""(() => {{
            globalThis.page = {page};
            let state = firstState(page, true);
            for (const hash of {json.dumps(hashes or [""])}) state = changedState(page, state, partOfLink(page, state, readLink(hash, state.camera)));
            return globalThis.state = state;
        }})()""")

    def field(self, *hashes):
        return self.value(f"page.models[0].fields[{self.state(*hashes)['field']}].name")

    def test_volumes_without_a_word_about_the_field_are_of_the_density(self):
        self.assertEqual(self.field("#subframes=1&show=volume"), "mass")
        self.assertEqual(self.field("#subframes=1&show=volume&field=heat"), "heat")
        # A field that was chosen stays.
        self.assertEqual(self.field("#subframes=1&show=mean"), "heat")
        self.assertEqual(self.field("#subframes=1&show=mean", "#show=volume"), "heat")
        # A transfer function of a link is the density's.
        state = self.state("#subframes=1&show=volume&colors=0,1,0,0;1,1,1,1&opacity=0,0;1,1&unit=2")
        self.assertEqual(list(state["transfers"]), ["1"])

    def test_an_address_of_nonsense_is_ignored(self):
        expected = self.state("#subframes=1")
        self.assertEqual(self.state(NONSENSE), expected)
        self.assertEqual(self.state("#subframes=1&eye=0,0,0&at=0,0,0"), expected)

    def test_planes_that_are_none_are_ignored(self):
        for wrong in ("planes=1,2", "planes=0,0,0,1", "planes=a,b,c,d", "planes=" + ";".join(["1,0,0,0"] * 11)):
            self.assertEqual(self.state(f"#{wrong}")["planes"], [])
        self.assertEqual(len(self.state("#planes=" + ";".join(["1,0,0,0"] * 10))["planes"]), 10)

    def test_settings_change_what_they_name_and_nothing_else(self):
        begun = self.state("#embed&still&map=magma&light&logaxis&subframes=2")
        for settings, changed in (("#map=viridis", {"map": "viridis"}), ("#exposure=2", {"exposure": 2}), ("", {}), (NONSENSE, {"subframes": 1}),
                                  ("#embed=0", {"embed": False}), ("#still=0", {"still": False}), ("#clip=0,0,0,1,1,1", {"clip": {"lower": [0] * 3, "upper": [1] * 3}})):
            self.assertEqual(self.state("#embed&still&map=magma&light&logaxis&subframes=2", settings), {**begun, **changed}, settings)
        self.assertEqual([begun["embed"], begun["still"], begun["panel"]], [True, True, False])
        # A page's own settings, as it sends them, say nothing of the embedding.
        written = self.value("writeLink(state, {field: null, scale: null, transfer: null, planes: true, streamed: false})")
        self.assertNotIn("embed", written)
        self.assertTrue(self.state("#embed", written)["embed"])

    def scale(self, *hashes):
        state = self.state(*hashes)
        return [state["scale"], self.value("automaticScale(page.models, state, state.scale?.log)")]

    def test_a_logarithm_without_a_range_has_the_ends_of_the_first_view(self):
        stated, found = self.scale("#show=column&log")
        self.assertEqual(stated, {"log": True})
        self.assertTrue(found["log"])
        self.assertEqual(found["high"], self.value("page.models[0].mostColumn"))
        self.assertEqual(found["low"], self.value("page.models[0].lowColumn"))
        self.assertTrue(10 <= found["high"] / found["low"] <= 1.0001e4)
        self.assertIn("&log", self.value("writeLink(state, {scale: state.scale})"))
        # Values above 0 within fewer decades keep their ends; the part above 0 of others; none where nothing is above 0.
        linear = self.scale("#show=mean&field=heat")[1]
        self.assertEqual(self.scale("#show=mean&field=heat&log")[1], {**linear, "log": True})
        signed = self.scale("#show=mean&field=signed&log")[1]
        self.assertTrue(signed["log"])
        self.assertAlmostEqual(signed["low"] * 1e4 / signed["high"], 1)
        self.assertEqual(self.value("automaticScale([{lowColumn: 0, mostColumn: 0}], {show: 'column'}, true)"), {"low": 0, "high": 1, "log": False})
        # A range with the logarithm, and one that has none.
        self.assertEqual(self.state("#show=column&range=1,10&log")["scale"], {"low": 1, "high": 10, "log": True})
        self.assertIsNone(self.state("#show=column&range=-1,10&log")["scale"])


if __name__ == "__main__":
    run()
