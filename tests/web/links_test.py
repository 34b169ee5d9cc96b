#!/usr/bin/env python3
"""State of a page that opens, and its changes by addresses and by settings from outside, in Node.js without a browser.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Node.js.
"""
import json
import math
import re

from exploring_test import random_gaussians, write_scalars
from page_test_case import run, vog
from streaming_test_case import NodeTest

NONSENSE = ("#subframes=1&camera.eye=1,2&camera.look_at=x&camera.fov_degrees=400&tf=<b>&level=0&model=-3&exposure=NaN&camera.up=0,0,&show=<img>&field=nothing"
            "&shadows=7&light_from=up&ambient_occlusion=x&scattering=17&clip=1,1,1,0,0,0&extinction=-1&blend=7&light=up&background=mauve&range=2,1&scale=cubic&threshold=x&%E0%A4%A=&__proto__=1&constructor&toString.x=1&camera=3")
JSONS = ['{"tf": {"colors": 5}}', '{"tf": {"name": {"toString": 1}, "domain": [0, 1], "colors": [[0, 0, 0, 0]]}, "show": "volume"}', '{"camera": {"eye": "x", "sky": 1}}',
         '{"camera": null, "background": {"toString": 1}}', '{"picture": 3}', '{"picture": ["a"]}', '{"bands": [1], "show": "volume"}', '{"clip_planes": [[0, 0, 0, 1]]}',
         '{"__proto__": {"show": "T"}}', '{"light_weights": "x"}', '{"size": {}}', '{broken']


class Links(NodeTest):
    modules = ("link/link.js", "link/request.js", "quantity.js", "vectors.js")

    @classmethod
    def make(cls):
        # Heat rises with x; the measure is the second field, `signed` has both signs.
        rows = random_gaussians(20, lambda mean: [(300 + 10 * mean[0], [10, 0, 0]), (0.5, [0, 0, 0]), (mean[1], [0, 1, 0])])
        write_scalars(cls.folder / "two.ply", rows, [("scalar", "heat", 285, 315), ("measure", "mass", 0.1, 1), ("scalar", "signed", -1, 1)])

    def state(self, *hashes):
        """State after the address of a page and then some settings; its page stays in `page`."""
        vog("page", "two.ply", "-o", "page.html", "--set", "levels=1")
        page = re.search(r'<script[^>]*id="page"[^>]*>(.*?)</script>', (self.folder / "page.html").read_text(), re.S).group(1)
        return self.value(f"""(() => {{
            globalThis.page = {page};
            let state = firstState(page, true);
            globalThis.problems = [];
            for (const hash of {json.dumps(hashes or [""])}) {{
                const found = partOfLink(page, state, readLink(hash), state.camera);
                problems.push(...found.problems);
                state = changedState(page, state, found.part);
            }}
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
        state = self.state('#subframes=1&show=volume&tf={"domain":[0,1],"unit_distance":2,"colors":[[0,1,0,0],[1,1,1,1]],"opacity":[[0,0],[1,1]]}')
        self.assertEqual(list(state["transfers"]), ["1"])
        self.assertEqual(state["transfers"]["1"]["unit"], 2)

    def test_sums_depend_on_what_is_drawn_and_on_nothing_after(self):
        self.state("#show=volume&light=head")

        def changed(*changes):
            """Whether other members of the state, or another key of parts, size or number of slabs, have other sums: of the view, of the quantity."""
            return self.value(f"""[{", ".join(changes)}].map((change) => {{
                const key = ({{ parts, size, slabs, ...part }}) => sumsOf({{ ...state, ...part }}, parts ?? 1, size ?? [2, 3], slabs ?? 32);
                const [a, b] = [key({{}}), key(change)];
                return [!isSame(a.view, b.view), a.of !== b.of];
            }})""")

        views = ("{camera: {...state.camera}}", "{model: 1}", "{clip: {lower: [0, 0, 0], upper: [1, 1, 1]}}", "{planes: []}", "{size: [2, 4]}")
        self.assertEqual(changed(*views), [[True, False]] * len(views))
        others = ("{field: 0}", "{show: 'mean'}", "{show: 'maximum'}", "{show: 'T'}", "{part: 'x'}", "{light: {...state.light, on: false}}", "{parts: 2}", "{slabs: 64}")
        self.assertEqual(changed(*others), [[False, True]] * len(others))
        after = ("{transfers: {}}", "{light: {...state.light, lights: [{towards: [1, 2, 3], ofCamera: false, strength: 1}]}}", "{map: 'gray'}", "{exposure: 2}", "{scale: {low: 0, high: 1, log: true}}", "{fade: true}",
                 "{reverse: true}", "{logAxis: true}", "{panel: false}")
        self.assertEqual(changed(*after), [[False, False]] * len(after))
        # T and column, mean and deviation share theirs.
        pairs = [["T", "column"], ["mean", "deviation"], ["mean", "maximum"], ["T", "mean"]]
        same = self.value(f"{json.dumps(pairs)}.map((pair) => new Set(pair.map((show) => sumsOf({{ ...state, show }}, 1, [2, 3], 32).of)).size === 1)")
        self.assertEqual(same, [True, True, False, False])

    def test_nonsense_changes_nothing_and_is_named(self):
        expected = self.state("#subframes=1")
        self.assertEqual(self.state(NONSENSE), expected)
        problems = self.value("problems")
        for key in ("camera", "tf", "level", "model", "exposure", "show", "field", "clip", "extinction", "blend", "light", "shadows", "light_from", "ambient_occlusion", "scattering", "background", "range", "scale", "threshold"):
            self.assertTrue(any(line.startswith(f"{key} ") or line.startswith(f"{key}:") for line in problems), f"{key}: {problems}")
        self.assertTrue(all(len(line) < 300 and "\n" not in line for line in problems))
        self.assertEqual(self.state("#subframes=1&camera.eye=0,0,0&camera.look_at=0,0,0"), expected)
        for text in JSONS:
            state = self.state(text)
            self.assertTrue(self.value("problems.length > 0") or "toString" in text and "tf" in text or text == '{"size": {}}', text)
            self.assertEqual([state["map"], state["clip"], state["planes"]], [expected["map"], None, []], text)

    def test_steps_in_time_keep_the_camera(self):
        self.state("#camera.eye=3,2,1&camera.look_at=0,0.5,0&camera.orthographic_width=2")
        moved = self.value("""[true, false].map((steps) => {
            const [model] = page.models, larger = { ...model, box: { ...model.box, center: [9, 9, 9], radius: 2 * model.box.radius } };
            return changedState({ ...page, steps, models: [model, larger] }, state, { model: 1 }).camera;
        })""")
        self.assertEqual(moved[0], self.value("state.camera"))
        # Other models are seen from the same place beside their boxes.
        self.assertAlmostEqual(moved[1]["span"], 2 * moved[0]["span"])

    def test_a_field_is_that_of_the_model_that_is_chosen_with_it(self):
        self.state()
        found = self.value("""(() => {
            const [model] = page.models, both = { ...page, models: [model, { ...model, fields: [...model.fields].reverse() }] };
            return [['#model=2&show=mean&field=heat'], ['#show=mean&field=heat', '#model=2'], ['#model=2', '#show=mean&field=heat'], ['#model=2&show=mean&field=signed', '#model=1']].map((hashes) => {
                const state = hashes.reduce((now, hash) => changedState(both, now, partOfLink(both, now, readLink(hash), now.camera).part), firstState(both, true));
                return both.models[state.model].fields[state.field].name;
            });
        })()""")
        self.assertEqual(found, ["heat", "heat", "heat", "signed"])

    def test_words_of_the_page_have_ranges_and_defaults(self):
        expected = self.state()
        self.state("#model=1.5&level=0&subframes=2.5&exposure=1000&memory=-1&error=100&most=x&still=no")
        self.assertEqual(self.value("problems"), [
            "model 1.5: expected a whole number above 0", "level 0: expected a whole number above 0", "subframes 2.5: expected a whole number from 1 to 64",
            "exposure 1000: expected a number from 1/64 to 64", "memory -1: expected a number from 1 to 100000 MB", "error 100: expected a number from 0.5 to 32 pixels",
            'most "x": expected a whole number from 1 to 1000000000', 'still "no": expected true or false'])
        words = {"exposure": 2, "subframes": 1, "still": "still", "error": 4, "memory": 50, "most": 1000, "logaxis": 1}
        changed = self.state("#" + "&".join(f"{word}={value}" for word, value in words.items()))
        self.assertEqual([changed[key] for key in ("exposure", "subframes", "still", "pixelError", "memory", "most", "logAxis")], [2, 1, True, 4, 50, 1000, True])
        self.assertEqual(self.state("#" + "&".join(f"{word}={value}" for word, value in words.items()), "#" + "&".join(f"{word}=" for word in words)), expected)
        self.assertEqual(self.state("#light_weights=1,0,0,1", "#light_weights=&background=")["light"], expected["light"])
        self.assertEqual(self.state("#model=9")["model"], 0)
        self.assertEqual(self.value("problems"), ["model 9: expected 1 to 1"])

    def test_maps_of_requests_replace_each_other(self):
        for name in "own", "viridis":
            state = self.state(*(f'#tf={{"name":"{name}","colors":[[0,{n / 8},0.3,0],[1,1,1,1]]}}' for n in range(9)))
            own = self.value("page.maps.filter(({ own }) => own)")
            self.assertLessEqual(len(own), 2)
            self.assertIn(state["map"], [f"{name}{' (own)' * n}" for n in range(3)])
            self.assertEqual([map["colors"][0] for map in own if map["name"] == state["map"]], [[0, 1, 0.3, 0]])

    def test_a_map_replaces_colours_at_values(self):
        bands, window = "#show=volume&field=heat&bands=[[290,300,[1,0,0],0.5]]", "#show=volume&field=heat&window=300,10"
        for begun in bands, window:
            state = self.state(begun, "#tf=hot")
            self.assertEqual([state["transfers"], state["asked"]["words"], state["map"]], [{}, {}, "hot"])
        self.assertEqual(self.state("#show=volume&field=heat&range=290,300", "#tf=hot", "#threshold=x")["asked"]["words"], {"range": [290, 300]})

    def test_planes_that_are_none_are_refused(self):
        for wrong in ("clip_planes=1,2", "clip_planes=0,0,0,1", "clip_planes=a,b,c,d", f"clip_planes={[[1, 0, 0, 0]] * 11}"):
            self.assertEqual(self.state(f"#{wrong}")["planes"], [])
            self.assertEqual(len(self.value("problems")), 1)
        self.state("#clip_planes=0,0,0,1&camera.fov_degrees=200")
        self.assertIn("with a normal other than 0", self.value("problems[0]"))
        self.assertIn("fov_degrees in (0, 180)", self.value("problems[1]"))
        self.assertEqual(len(self.state(f"#clip_planes={[[1, 0, 0, 0]] * 10}")["planes"]), 10)
        self.assertEqual(self.state("#clip_planes=1,0,0,2", "#clip_planes=")["planes"], [])

    def test_a_request_states_every_member(self):
        """JSON of a picture: members that it leaves out have their defaults, those of links stay."""
        begun = "#show=volume&clip=0,0,0,1,1,1&light=1,2,3&tf=magma&blend"
        self.assertEqual(self.state(begun, "#tf=viridis")["clip"], {"lower": [0] * 3, "upper": [1] * 3})
        state = self.state(begun, '{"vog": "1", "inputs": ["<b>"], "picture": {"show": "column", "range": [1, 10], "scale": "log", "size": [40, 20], "renderer": "trace"}}')
        self.assertEqual([state["show"], state["clip"], state["light"]["on"], state["fade"]], ["column", None, False, False])
        self.assertEqual(state["scale"], {"low": 1, "high": 10, "log": True})
        self.assertEqual(self.value("problems"), [])
        # As the window copies it.
        state = self.state("""--request '{"inputs":[],"picture":{"show":"volume","field":"heat","threshold":300,"range":[290,310],"unit_distance":3}}'""")
        transfer = state["transfers"]["0"]
        self.assertEqual([transfer["unit"], transfer["opacity"][0], transfer["opacity"][-1], transfer["colors"][0][0]], [3, [300, 0], [310, 1], 290])
        self.assertAlmostEqual(transfer["opacity"][1][1], 0.5)
        band = self.state('{"show": "volume", "field": "heat", "bands": [[290, 300, [1, 0, 0], 0.5], [305, null, [0, 0, 1], 1]]}')["transfers"]["0"]
        self.assertEqual([band["colors"][2], band["opacity"][-1]], [[305, 0, 0, 1], [315, 0]])
        # Gradient opacity: under the page's own function, of a file, and beside an edited one.
        steep = [[0, 0], [2, 0.5], [4, 1]]
        own = self.state(json.dumps({"show": "volume", "field": "heat", "gradient_opacity": steep}))["transfers"]["0"]
        self.assertEqual(own["gradient"], steep)
        self.assertEqual(self.state(json.dumps({"show": "volume", "field": "heat", "tf": {"name": "own", "domain": [290, 310], "colors": [[290, 0, 0, 0], [310, 1, 1, 1]], "opacity": [[290, 0], [310, 1]], "gradient_opacity": steep}}))["transfers"]["0"]["gradient"], steep)
        for wrong in ([[0, 0]], [[1, 0], [1, 1]], [[0, 0], [1, 2]], [[-1, 0], [1, 1]], "steep", [[n, 0] for n in range(9)]):
            self.assertNotIn("0", self.state(json.dumps({"show": "volume", "field": "heat", "gradient_opacity": wrong}))["transfers"])
            self.assertTrue(self.value("problems")[0].startswith("gradient_opacity "), wrong)
        self.state('{"units": "K"}')
        self.assertEqual(self.value("problems"), ["unknown setting: units"])

    def test_studio_is_shadows_occlusion_and_three_octaves_from_the_upper_left(self):
        light = self.state("#show=volume&light=studio")["light"]
        self.assertEqual([light[key] for key in ("on", "shadows", "occlusion", "scattering")], [False, True, True, 3])
        camera = self.value("state.camera")
        view = [a - e for a, e in zip(camera["at"], camera["eye"])]
        self.assertAlmostEqual(sum(t * v for t, v in zip(light["lights"][0]["towards"], view)) / math.hypot(*view), -0.6 / math.hypot(0.6, 0.9, 0.6), delta=2e-4)
        self.assertEqual(self.state("#show=volume&light=studio", '{"show": "volume"}')["light"], {**light, "shadows": False, "occlusion": False, "scattering": 1, "lights": []})

    def test_lights_have_directions_of_the_world_or_the_view_and_strengths(self):
        lights = self.state('#show=volume&light=[1,2,3],"head=0.3","camera:0,1,-2e-1"')["light"]["lights"]
        self.assertEqual(lights, [{"towards": [1, 2, 3], "ofCamera": False, "strength": 1}, {"towards": [0, 0, 0], "ofCamera": False, "strength": 0.3},
                                  {"towards": [0, 1, -0.2], "ofCamera": True, "strength": 1}])
        for words in ("head=-1", "head=", "1,2", "camera:head", "camera:0,0,0", "1,2,3=1=2", '[1,2,3],"moon"', '[1,2,3],"studio"', ",".join(["[1,2,3]"] * 9)):
            self.state(f"#show=volume&light={words}")
            self.assertEqual(len(self.value("problems")), 1, words)
            self.assertIn("light ", self.value("problems[0]"))

    def test_members_of_shadows_are_refused_without_them(self):
        for words in ("light_from=1,2,3", "scattering=3", "asymmetry=0.5", "shadows&light=head&light_from=1,2,3"):
            self.state(f"#show=volume&{words}")
            self.assertEqual(len(self.value("problems")), 1, words)
            self.assertIn("has no effect", self.value("problems[0]"))

    def test_a_link_is_the_picture_again(self):
        written = "writeLink(page, state, {scale: automaticScale(page.models, state, state.scale?.log), size: [40, 80], background: [1, 1, 1, 1], streamed: false})"
        for begun in ("#show=mean&field=heat&tf=viridis&range=290,300", "#show=volume&field=heat&light=1,2,3&light_weights=0.1,0.2,0.3,4", "#blend&exposure=2",
                      "#show=volume&shadows&light_from=1,2,3&scattering=2&asymmetry=0.4", "#show=volume&light=head&shadows&ambient_occlusion", "#show=volume&light=studio",
                      '#show=volume&shadows&light_from="1,2,3=0.5",[3,0,1],"camera:0,1,1=0.4"', '#show=volume&light=[1,2,3],"head=0.3"', "#show=volume&light=camera:-1,0,2",
                      '#show=volume&tf={"domain":[0,1],"unit_distance":2,"colors":[[0,1,0,0],[1,1,1,1]],"opacity":[[0,0],[1,1]]}',
                      "#show=column&clip=0,0,0,1,2,3&clip_planes=1,2,3,4&planes_off=[[0,1,0,0.5]]&camera.orthographic_width=7",
                      '#show=column&tf={"name":"two","colors":[[0,0.5,0,0],[1,1,1,1]]}'):
            first = self.state(begun, "#")
            link = self.value(written)
            self.assertEqual(self.value("problems"), [], begun)
            again = self.state(begun, "#show=T&field=&clip=&clip_planes=&light=&light_from=&shadows=false&ambient_occlusion=false&tf=gray&blend=false", link)
            self.assertEqual(self.value("problems"), [], link)
            for key in ("show", "field", "part", "map", "reverse", "light", "clip", "planes", "transfers", "fade"):
                if key == "map" and "domain" in link or key == "field" and first["show"] in ("T", "column") or key == "fade" and first["show"] != "T" or key == "light" and first["show"] != "volume":
                    continue
                self.assertEqual(again[key], first[key], f"{key} of {link}")
            self.assertAlmostEqual(again["exposure"], first["exposure"])
            for key in ("eye", "at", "up"):
                for a, b in zip(again["camera"][key], first["camera"][key]):
                    self.assertAlmostEqual(a, b, delta=1e-6)
            for key in ("fov", "span"):
                self.assertAlmostEqual(again["camera"][key], first["camera"][key], delta=1e-5, msg=link)
        # A reversed map has no name.
        self.state("#show=column&tf=viridis")
        self.value("(state.reverse = true, 0)")
        link = self.value(written)
        state = self.state(link)
        self.assertEqual([state["map"], state["reverse"]], ["viridis", True])

    def test_settings_change_what_they_name_and_nothing_else(self):
        begun = self.state("#embed&still&tf=magma&light=head&logaxis&subframes=2")
        for settings, changed in (("#tf=viridis", {"map": "viridis"}), ("#exposure=2", {"exposure": 2}), ("", {}), (NONSENSE, {"subframes": 1}),
                                  ("#embed=0", {"embed": False}), ("#still=0", {"still": False}), ("#clip=0,0,0,1,1,1", {"clip": {"lower": [0] * 3, "upper": [1] * 3}})):
            self.assertEqual(self.state("#embed&still&tf=magma&light=head&logaxis&subframes=2", settings), {**begun, **changed}, settings)
        self.assertEqual([begun["embed"], begun["still"], begun["panel"]], [True, True, False])
        # A page's own settings, as it sends them, say nothing of the embedding.
        written = self.value("writeLink(page, state, {scale: null, size: [1, 1], background: page.background, streamed: false})")
        self.assertNotIn("embed", written)
        self.assertTrue(self.state("#embed", written)["embed"])

    def scale(self, *hashes):
        state = self.state(*hashes)
        return [state["scale"], self.value("automaticScale(page.models, state, state.scale?.log)")]

    def test_a_logarithm_without_a_range_has_the_ends_of_the_first_view(self):
        stated, found = self.scale("#show=column&scale=log")
        self.assertEqual(stated, {"log": True})
        self.assertTrue(found["log"])
        self.assertEqual(found["high"], self.value("page.models[0].mostColumn"))
        self.assertEqual(found["low"], self.value("page.models[0].lowColumn"))
        self.assertTrue(10 <= found["high"] / found["low"] <= 1.0001e4)
        self.assertIn("&scale=log", self.value("writeLink(page, state, {scale: automaticScale(page.models, state, true), size: [1, 1], background: page.background})"))
        # Values above 0 within fewer decades keep their ends; the part above 0 of others; none where nothing is above 0.
        linear = self.scale("#show=mean&field=heat")[1]
        self.assertEqual(self.scale("#show=mean&field=heat&scale=log")[1], {**linear, "log": True})
        signed = self.scale("#show=mean&field=signed&scale=log")[1]
        self.assertTrue(signed["log"])
        self.assertTrue(1 < signed["high"] / signed["low"] <= 1.0001e4)
        self.assertEqual(self.value("automaticScale([{lowColumn: 0, mostColumn: 0}], {show: 'column'}, true)"), {"low": 0, "high": 1, "log": False})
        # A range with the logarithm, and one that has none.
        self.assertEqual(self.state("#show=column&range=1,10&scale=log")["scale"], {"low": 1, "high": 10, "log": True})
        self.assertIsNone(self.state("#show=column&range=-1,10&scale=log")["scale"])

    def test_words_hold_in_whatever_order_they_come(self):
        cases = ["show=volume&field=heat&range=295,305&unit_distance=0.05", "show=volume&field=heat&range=290,310&scale=log", "show=volume&field=heat&window=300,20&unit_distance=0.02",
                 "show=volume&field=heat&window=300,20&threshold=298", "show=volume&field=heat&bands=[[300,310,[1,0,0],1]]&unit_distance=0.02", "show=volume&field=heat&threshold=300",
                 "show=volume&field=heat&gradient_opacity=[[0,0],[60,1]]&range=290,310&tf=viridis", "show=mean&field=heat&range=290,310&scale=log", "show=column&range=0.1,3&scale=log",
                 "camera.eye=3,2,1&camera.look_at=0,0,0.5&camera.orthographic_width=2"]
        shown = ("map", "scale", "show", "camera", "part")
        made = lambda state: {**{key: state[key] for key in shown}, "transfer": state["transfers"].get(str(state["field"]))}
        for case in cases:
            together = made(self.state(f"#{case}"))
            for words in (case.split("&"), case.split("&")[::-1]):
                self.assertEqual(made(self.state(*(f"#{word}" for word in words))), together, words)
        # The last of those that replace each other holds, a word without a value has its default, and a reader's own choice ends what was asked for.
        transfer = lambda *hashes: made(self.state(*(f"#{words}" for words in ("show=volume&field=heat", *hashes))))["transfer"]
        self.assertEqual(transfer("window=300,20", "range=290,310"), transfer("range=290,310"))
        self.assertEqual(transfer("range=290,310", "threshold=300", "window=300,20"), transfer("window=300,20&threshold=300"))
        self.assertIsNone(transfer("range=290,310", "range="))
        self.assertIsNone(transfer("range=290,310", "field=signed"))
        self.assertEqual(self.value("changedState(page, state, {show: 'mean'}).asked.words"), {})
        # Nonsense leaves what is there.
        self.assertEqual(transfer("range=290,310", "range=310,290", "bands=[[1]]"), transfer("range=290,310"))

    def test_unit_distances_of_ranges_are_those_of_the_command(self):
        for words, options in (("range=295,305", ["--range", "295,305"]), ("range=299,312", ["--range", "299,312"]), ("range=286,314&scale=log", ["--range", "286,314", "--scale", "log"]),
                               ("window=300,20", ["--window", "300,20"]), ("bands=[[300,310,[1,0,0],1]]", ["--band", "300,310,red,1"])):
            unit = self.state(f"#show=volume&field=heat&{words}")["transfers"]["0"]["unit"]
            vog("render", "two.ply", "-o", "unit.png", "--size", "16", "--show", "volume", "--field", "heat", *options)
            record = (self.folder / "unit.png").read_bytes()
            self.assertAlmostEqual(unit, float(re.search(rb'"unit_distance": ?([-+.e0-9]+)', record).group(1)), delta=1e-6 * unit, msg=words)

    def test_words_that_cannot_be_are_named(self):
        self.state("#show=volume&field=signed&model=9&level=9")
        self.assertEqual(self.value("problems"), ["model 9: expected 1 to 1", "level 9: expected 1 to 1"])


class ReachedLight(NodeTest):
    modules = ("picture/light.js",)

    def test_a_box_of_one_extinction_lets_exp_of_its_depth_through(self):
        box = "globalThis.box = { sum: new Float32Array(20 * 22 * 8).fill(1.5), size: [20, 22, 8], first: [0, 0, 0], edge: 0.25 }"
        for towards, length in (([0, 0, 3], 1), ([1, -2, 4], math.sqrt(21) / 4), ([0, 0, -1], 1)):
            # From the middle of a face's cells; each layer adds the way through it, its own half.
            layers = [7.5 - z if towards[2] > 0 else z + 0.5 for z in range(8)]
            for octaves in (1, 3):
                found = self.value(f"({box}, (({{size}}) => Array.from({{length: 8}}, (_, z) => directLight(box, {towards}, {octaves})[(z * 22 + 11) * 20 + 10]))(box))")
                for n, share in zip(layers, found):
                    depth, weights = 1.5 * 0.25 * length * n, [0.5 ** k for k in range(octaves)]
                    self.assertAlmostEqual(share, sum(w * math.exp(-w * depth) for w in weights) / sum(weights), delta=2e-6)
        for ambient in ("ambientLight", "ambientDraft"):
            empty = self.value(f"[...{ambient}({{ ...box, sum: new Float32Array(box.sum.length) }})]")
            self.assertTrue(all(abs(share - 1) < 1e-6 for share in empty))
            self.assertEqual(len(empty), 20 * 22 * 8)
            dark = self.value(f"[...{ambient}(box)]")
            self.assertLess(max(dark[(4 * 22 + 11) * 20 + 8:][:4]), dark[0])
        # Faint fog, whose share is about linear: the draft is near.
        fog = "globalThis.fog = { ...box, sum: box.sum.map((_, n) => 0.02 * (1 + Math.sin(n % 20 / 4))) }"
        self.assertLess(self.value(f"({fog}, ((draft) => Math.max(...ambientLight(fog).map((v, n) => Math.abs(v - draft[n]))))(ambientDraft(fog)))"), 0.01)

    def test_lattices_hold_the_extinction_of_rotated_gaussians(self):
        """Three Gaussians of one value under an opacity that is constant: mass times extinction."""
        rows = [[0.1, -0.2, 0.3, 2, 0.1, 0.02, 0.3, 0.5, 0.5, -0.5, 0.5], [0, 0, 0, 1, 0.001, 0.001, 0.001, 1, 0, 0, 0], [0.9, 0.4, 0.2, 3, 0.2, 0.05, 0.05, 0.8, 0, 0.6, 0]]
        model = {"box": {"center": [10, 0, 0], "half": [6, 4, 4]}, "center": [10, 0, 0], "unit": 4, "cutoff": 2.25, "limits": [0, 0, 0.7, 13], "extinction": 5}
        found = self.value(f"""(() => {{
            const data = new Float32Array(18), extinction = (value, deviation) => 0.3;
            const {{ sum, size, edge, first }} = extinctionLattice({json.dumps(model)}, {{ instances: Float32Array.from({json.dumps(sum(rows, []))}), data }}, extinction);
            const whole = [0, 0, 0, 0];
            sum.forEach((v, n) => {{ const at = [n % size[0], Math.floor(n / size[0]) % size[1], Math.floor(n / size[0] / size[1])]; whole[3] += v; at.forEach((i, k) => {{ whole[k] += v * (first[k] + edge * i); }}); }});
            return {{ size, edge, mass: whole[3] * edge ** 3, mean: whole.slice(0, 3).map((v) => v / whole[3]) }};
        }})()""")
        masses = [13 * 0.3 / 5 * row[3] * row[4] * row[5] * row[6] for row in rows]
        self.assertEqual(found["size"], [68, 47, 47])
        self.assertAlmostEqual(found["edge"], 3 / 64)
        self.assertAlmostEqual(found["mass"], sum(masses), delta=1e-5 * sum(masses))
        for k in range(3):
            self.assertAlmostEqual(found["mean"][k], sum(m * row[k] for m, row in zip(masses, rows)) / sum(masses), delta=0.01)


if __name__ == "__main__":
    run()
