"""The element <vog-view> in other people's pages: pictures against the command's, words, events, security policies, failures, hands."""
import base64
import gzip
import hashlib
import json
import os
import pathlib
import re
import shutil
import time
import unittest

from browser import HOUSE
from page_test_case import VOG, PageTest, command, run, vog, write_model
from quantity_test_case import make_plume, write_flow
from site_server import DROP, SiteServer

MODULE = pathlib.Path(os.environ.get("VOG_MODULE", pathlib.Path(VOG).resolve().parents[2] / "share/vog/vog-view.js"))
# A policy as strict as the documents' page says (docs/web_element.md), with scripts of the same origin alone.
POLICY = "default-src 'none'; script-src 'self'; worker-src 'self'; connect-src {}; style-src 'self'; img-src data:"  # the page's own icon

# As fine as the pictures that are compared.
PACKED = ("--hierarchy", "--deflate", "--set", "rounding=0.0001", "--set", "field-rounding=0.00005")

HOST = """<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>A page</title><link rel="icon" href="data:,">
<script type="module" src="vog-view.js"></script><script src="host.js"></script>
<link rel="stylesheet" href="host.css"><main><h1>A page</h1>{body}</main></html>"""
# What tests ask the host page. Its scripts are files: no policy allows inline ones.
SCRIPT = """
const told = [];
const view = (n = 0) => document.querySelectorAll('vog-view')[n];
const canvas = (n = 0) => view(n).shadowRoot.querySelector('canvas');
const line = (n = 0) => { const p = view(n).shadowRoot.querySelector('p'); return p.hidden ? '' : p.textContent; };
const errors = () => told.filter(([name]) => name === 'error').map(([, detail]) => detail);
// Before any element is defined.
for (const name of ['change', 'error', 'progress', 'probe'])
  addEventListener(name, ({ target, detail }) => { if (target.localName === 'vog-view') told.push([name, detail]); }, true);
const bytesOf = async (n = 0) => {
  const bytes = new Uint8Array(await (await view(n).picture()).arrayBuffer());
  return btoa(Array.from(bytes, (one) => String.fromCharCode(one)).join(''));
};
"""
STYLE = "body { margin: 0 } h1 { margin: 0; height: 40px } vog-view { width: 180px; height: 150px; aspect-ratio: auto }"


class ElementTest(PageTest):
    """Pages of a server with the module beside them."""

    policy = None

    @classmethod
    def setUpClass(cls):
        if not MODULE.exists():
            raise unittest.SkipTest(f"no {MODULE} (ninja vog_view)")
        super().setUpClass()

    @classmethod
    def make(cls):
        make_plume("plume.vdb")
        vog("convert", "plume.vdb", "-o", "plume.ply", "--block", 4)
        write_flow(cls.folder / "flow.ply")
        for name in ("plume", "flow"):
            vog("pack", f"{name}.ply", "-o", f"{name}.vogz", *PACKED)
        vog("page", "plume.ply", "-o", "site/", "--precise")
        shutil.copy(MODULE, cls.folder / "vog-view.js")
        (cls.folder / "host.js").write_text(SCRIPT)
        (cls.folder / "host.css").write_text(STYLE)

    def setUp(self):
        super().setUp()
        self.browser.viewport(400, 400)
        self.server = SiteServer(self.folder, ranges=True).__enter__()
        self.addCleanup(self.server.__exit__)

    def host(self, body, wait=True):
        """Opens a page with a body, and waits for the first picture of its first element."""
        (self.folder / "host.html").write_text(HOST.format(body=body))
        self.browser.open(self.server.url + "host.html")
        self.until("customElements.get('vog-view') && document.readyState === 'complete'")
        if wait:
            self.value("view().ready.then(() => true)")

    def shot(self, n=0, name="web.png"):
        (self.folder / name).write_bytes(base64.b64decode(self.value(f"bytesOf({n})")))
        return name

    def expect_rendered(self, model, least, n=0):
        """Expects the picture to be that of vog render by the element's own link, at least so many decibels from it."""
        self.shot(n)
        vog("render", model, "-o", "cpu.png", "--request", "http://localhost/" + self.value(f"view({n}).link"))
        self.hold("-PSNR of an element [dB]", -self.psnr("cpu.png", "web.png"), -least)


class Pictures(ElementTest):
    def test_pictures_are_those_of_vog_render(self):
        self.host('<vog-view src="plume.vogz" subframes="1" tf="inferno"></vog-view><vog-view src="site/" subframes="1" show="volume" tf="inferno"></vog-view>')
        self.value("view(1).ready.then(() => true)")
        self.expect_rendered("plume.ply", 60)
        self.expect_rendered("plume.ply", 55, 1)
        for settings, least in (({"show": "column", "tf": "viridis"}, 50), ({"show": "mean"}, 50), ({"show": "deviation"}, 50), ({"show": "maximum"}, 50),
                                ({"show": "volume", "light": "head", "clip": [-20, 10, -20, 40, 90, 40]}, 50)):
            self.assertEqual(self.value(f"view().set({json.dumps(settings)})"), [])
            self.expect_rendered("plume.ply", least)
            self.value("view().set({clip: null, light: null})")

    def test_defaults_are_those_of_vog_page(self):
        self.host('<vog-view src="plume.vogz" subframes="1" pixel-error="0.5"></vog-view>')
        self.assertEqual(command("page", "plume.ply", "-o", "page.html").returncode, 0)
        page = json.loads(re.search('id="page">(.*?)</script>', (self.folder / "page.html").read_text())[1])
        model, near = page["models"][0], lambda a, b, share: self.assertLess(max(abs(x - y) for x, y in zip(a, b)), share * max(map(abs, b)))
        found = self.value("view().request")
        # Of the model's coarse nodes in place of all Gaussians.
        near([found["extinction"]], [model["extinction"]], 1e-3)
        near(found["camera"]["eye"], page["picture"]["camera"]["eye"], 1e-9)
        self.assertEqual(found["tf"], page["map"])
        field = model["fields"][0]
        ranges = {"column": ([model["lowColumn"], model["mostColumn"]], model["logColumn"]), "volume": (field["values"], field["log"])}
        for show in ("mean", "deviation"):
            one = field["ranges"][""][show]
            ranges[show] = (one["log" if one["isLog"] else "linear"], one["isLog"])
        for show, (ends, is_log) in ranges.items():
            self.value(f"(view().set({{show: '{show}'}}), view().picture().then(() => true))")
            found = self.value("view().request")
            near(found["range"], ends, 0.01)
            self.assertEqual(found["scale"], "log" if is_log else "linear", show)
        self.assertEqual(self.value("(view().set({show: 'volume'}), view().request.unit_distance)"), field["unitDistance"])
        self.assertEqual(self.value("errors()"), [])

    def test_a_view_takes_its_own_words(self):
        """Camera and request of a tall element, words in two orders, and names with hyphens."""
        self.host('<vog-view src="plume.vogz" subframes="1" show="volume" style="width: 90px; height: 180px" camera.look-at="-1,42,8"></vog-view>'
                  '<vog-view src="plume.vogz" style="width: 180px; height: 90px" camera.orthographic-width="120"></vog-view>')
        self.value("Promise.all([view().ready, view(1).ready]).then(() => true)")
        self.assertAlmostEqual(self.value("view(1).camera.orthographic_width"), 120, delta=1e-6)
        self.assertEqual(self.value("view().camera.look_at"), [-1, 42, 8])
        for again in ("view().set({ camera: view().camera })", "view().set(view().request)"):
            before = self.value("view().camera")
            self.assertEqual(self.value(again), [])
            for key, value in self.value("view().camera").items():
                for a, b in zip(*(v if isinstance(v, list) else [v] for v in (value, before[key]))):
                    self.assertAlmostEqual(a, b, delta=1e-5 * max(1, abs(b)), msg=(again, key))
        self.value("view().set({ range: [0.2, 0.6], unit_distance: 5 })")
        together = self.value("view().link")
        for order in (("range", "unit_distance"), ("unit_distance", "range")):
            self.value("view().set({ range: null, unit_distance: null })")
            for word in order:
                self.value(f"void (view().{word} = {({'range': '[0.2, 0.6]', 'unit_distance': 5})[word]})")
            self.assertEqual(self.value("view().link"), together)
        self.expect_rendered("plume.ply", 45)

    def test_two_elements_have_models_and_words_of_their_own(self):
        self.host('<vog-view src="plume.vogz" tf="viridis" subframes="1"></vog-view><vog-view src="flow.vogz" show="mean" field="temperature" background="white" subframes="1"></vog-view>')
        self.value("view(1).ready.then(() => true)")
        self.assertEqual(self.value("[view(0), view(1)].map(({ models, tf, show, field }) => [models[0].name, models[0].fields.length, tf, show, field])"),
                         [["plume", 1, "viridis", "T", None], ["flow", 2, "ember", "mean", "temperature"]])
        first = self.value("bytesOf(0)")
        self.value("view(1).set({ tf: 'gray', camera: { ...view(1).camera, up: [1, 0, 0] } })")
        self.expect_rendered("flow.ply", 40, 1)  # rims of few large Gaussians
        self.assertEqual(self.value("bytesOf(0)"), first)


class Models(ElementTest):
    def test_steps_in_time_share_what_the_first_one_has(self):
        for step, density in enumerate((1, 3)):
            write_model(self.folder / f"step-{step}.ply", [0, 0, 0, 1, 1, 1, density, 2, 0, 0, 0.5, 0.5, 0.5, 1])
        vog("page", "step-*.ply", "-o", "steps/", "--site", "--precise")
        self.host('<vog-view src="steps/" subframes="1"></vog-view>')
        self.assertEqual(self.value("view().models.map(({ name }) => name)"), ["step-0", "step-1"])
        first = self.value("view().extinction")
        self.expect_rendered("step-0.ply", 47)
        self.assertEqual(self.value("(view().model = 2, view().picture().then(() => [view().model, view().extinction]))"), [2, first])
        self.expect_rendered("step-1.ply", 47)

    def test_a_model_without_fields_or_gaussians(self):
        write_model(self.folder / "none.ply", [])
        write_model(self.folder / "one.ply", [1, 2, 3, 0.5, 1, 2, 4])
        for name in "none", "one":
            vog("pack", f"{name}.ply", "-o", f"{name}.vogz", *PACKED)
        self.host('<vog-view src="one.vogz" show="volume" subframes="1"></vog-view><vog-view src="none.vogz"></vog-view>')
        self.value("view(1).ready.then(() => true)")
        self.assertEqual(self.value("errors().map(({ message }) => message).sort()"),
                         ['Not in this picture: show "volume": expected T, column', "This model is empty."])
        self.expect_rendered("one.ply", 47)


class Documents(ElementTest):
    def test_the_pasted_lines_work(self):
        text = (HOUSE / "docs/web_element.md").read_text()
        page = re.search("```html\n(.*?)```", text, re.S)[1]
        folder = self.folder / "pasted"
        folder.mkdir(exist_ok=True)
        (folder / "index.html").write_text(page.replace("<meta charset", '<link rel="icon" href="data:,"><meta charset'))
        shutil.copy(MODULE, folder)
        shutil.copy(self.folder / "plume.vogz", folder / "smoke.vogz")
        self.browser.open(self.server.url + "pasted/")
        self.until("customElements.get('vog-view')")
        self.assertEqual(self.value("view.ready.then(() => [view.show, view.tf, view.light])"), ["volume", "inferno", "head"])
        self.value("(button.click(), view.set({ subframes: 1 }), view.picture().then(() => true))")
        self.assertEqual(self.value("[view.camera.eye, view.camera.up]"), [[0, 300, 0], [0, 0, 1]])
        # All words of the documents are the element's, and all of its words are there.
        words = self.value("Object.keys(customElements.get('vog-view').prototype)")
        self.assertEqual([word for word in words if f"`{word}`" not in text], [])
        types = (MODULE.parent / "vog-view.d.ts" if (MODULE.parent / "vog-view.d.ts").exists() else HOUSE / "src/web/page/view/vog-view.d.ts").read_text()
        self.assertEqual([word for word in words if f"  {word}?: " not in types], [])


class Words(ElementTest):
    def test_attributes_and_properties_are_words_of_a_request(self):
        self.host('<vog-view src="plume.vogz" show="volume" tf="inferno" unit-distance="2" light="1,2,3" range="0.1,2" camera.eye="300,80,0" '
                  'camera.look_at="0,60,0" subframes="1" blend="false" pixel-error="2" label="A plume"></vog-view>')
        found = self.value("view().request")
        self.assertEqual([found["show"], found["light"], found["camera"]["eye"], found["camera"]["look_at"]], ["volume", [1, 2, 3], [300, 80, 0], [0, 60, 0]])
        self.assertEqual([found["tf"]["name"], found["tf"]["domain"], found["tf"]["unit_distance"]], ["inferno", [0.1, 2], 2])
        self.assertEqual(self.value("[view().subframes, view().pixel_error, view().exposure, view().model, view().still]"), [1, 2, 1, 1, False])
        # Without an attribute a word has its default.
        self.value("for (const name of ['show', 'light', 'range', 'unit-distance', 'subframes', 'camera.eye']) view().removeAttribute(name)")
        found = self.value("view().request")
        self.assertEqual([found["show"], self.value("view().subframes"), found["camera"]["look_at"]], ["T", 8, [0, 60, 0]])
        self.value("Object.assign(view(), { show: 'column', tf: 'gray', range: [0, 50], blend: null })")
        self.assertEqual(self.value("(({ show, tf, range }) => [show, tf, range])(view())"), ["column", "gray", [0, 50]])
        self.value("view().setAttribute('still', '')")
        self.assertTrue(self.value("view().still"))
        self.assertEqual(self.value("errors()"), [])
        self.assertIn("A plume", self.value("canvas().getAttribute('aria-label')"))

    def test_a_canvas_has_its_label_before_its_first_picture(self):
        self.host('<vog-view src="plume.vogz"></vog-view>')
        heard = self.value("""new Promise((resolve) => {
            const second = document.createElement('vog-view');
            second.setAttribute('label', 'Early');
            second.setAttribute('src', 'plume.vogz');
            new MutationObserver(() => {
              const canvas = second.shadowRoot.querySelector('canvas');
              if (canvas) resolve([canvas.getAttribute('aria-label'), second.shadowRoot.querySelector('#described').textContent]);
            }).observe(second.shadowRoot, { childList: true });
            document.body.append(second);
        })""")
        self.assertRegex(heard[0], "^Early[.]")

    def test_words_that_cannot_be_are_named(self):
        self.host('<vog-view src="plume.vogz" tf="no-such-map" range="a,b" show="volume"></vog-view>')
        lines = self.value("errors().map(({ message }) => message)")
        for text in ('tf "no-such-map": expected one of white, ', 'range "a,b": expected two numbers, the first below the second'):
            self.assertTrue(any(text in line for line in lines), lines)
        self.assertFalse(self.value("errors().some(({ fatal }) => fatal)"))
        self.assertEqual(self.value("[view().show, view().tf]"), ["volume", "ember"])
        self.assertEqual(self.value("[null, undefined, 'x', [1]].map((given) => view().set(given).length)"), [1, 1, 1, 1])
        self.assertIn("set(1): expected words, as {", self.value("line()"))
        self.assertEqual(self.value("view().set({ tiff: 1, subframes: 'many', show: 'depth' }).length"), 3)
        self.assertIn("tiff: expected one of show, field, tf", self.value("line()"))
        self.value("view().setAttribute('subframes', '1e9')")
        self.assertIn("subframes 1000000000: expected a whole number from 1 to 64", self.value("line()"))
        self.assertEqual(self.value("view().subframes"), 8)

    def test_what_was_set_before_a_model_holds_for_it(self):
        self.host('<vog-view></vog-view>', wait=False)
        self.value("Object.assign(view(), { show: 'volume', tf: 'magma', extinction: 5 })")
        self.value("view().set({ camera: { eye: [300, 80, 0], look_at: [0, 60, 0] } })")
        self.assertEqual(self.value("[view().show, view().request]"), ["volume", None])
        self.value("(view().src = 'plume.vogz', view().ready.then(() => true))")
        self.assertEqual(self.value("[view().show, view().tf, view().camera.eye]"), ["volume", "magma", [300, 80, 0]])
        self.assertAlmostEqual(self.value("(view().show = 'T', view().extinction)"), 5)
        # Another model takes the words, and the one before has gone.
        self.value("(view().src = 'site/', view().ready.then(() => true))")
        self.assertEqual(self.value("[view().tf, view().models[0].name, view().shadowRoot.querySelectorAll('canvas').length]"), ["magma", "plume", 1])

    def test_events_say_what_changes_and_what_comes(self):
        self.host('<vog-view src="site/"></vog-view>')
        self.value("view().picture().then(() => true)")
        self.assertEqual(self.value("told.findLast(([name]) => name === 'progress')[1].toCome"), 0)
        files = [self.folder / path.lstrip("/") for path in self.server.paths if path.startswith("/site/")]
        self.assertEqual(self.value("told.findLast(([name]) => name === 'progress')[1].loaded"), sum(file.stat().st_size for file in files))
        self.value("(told.length = 0, globalThis.end = view().on('change', (detail) => { globalThis.seen = detail.request.tf; }), view().set({ tf: 'gray' }))")
        self.until("globalThis.seen === 'gray' && told.some(([name]) => name === 'change')")
        self.value("(end(), view().set({ tf: 'magma' }), view().picture().then(() => true))")
        self.assertEqual(self.value("[globalThis.seen, view().tf]"), ["gray", "magma"])
        self.browser.mouse("mouseMoved", 90, 120)
        self.until("told.some(([name, { lines }]) => name === 'probe' && lines[0].startsWith('T '))")


class Hands(ElementTest):
    def setUp(self):
        super().setUp()
        self.host('<vog-view src="plume.vogz" subframes="1"></vog-view><p style="height: 2000px">')

    def eye(self):
        return self.value("view().picture().then(() => view().camera.eye)")

    def test_drags_and_keys_turn_it_once_it_has_the_focus(self):
        eye = self.eye()
        self.browser.wheel(90, 100, 120)
        self.until("scrollY > 0")
        self.value("scrollTo(0, 0)")
        self.browser.key("ArrowLeft")
        self.assertEqual(eye, self.eye())
        self.browser.drag(60, 100, 120, 110)
        turned = self.eye()
        self.assertNotEqual(eye, turned)
        self.assertTrue(self.value("document.activeElement === view() && view().shadowRoot.activeElement === canvas()"))
        self.browser.key("ArrowLeft")
        self.assertNotEqual(turned, self.eye())
        self.browser.wheel(90, 100, 120)
        self.assertNotEqual(turned, self.eye())
        self.assertEqual(self.value("scrollY"), 0)
        self.value("view().still = true")
        still = self.eye()
        self.browser.drag(60, 100, 120, 110)
        self.assertEqual(still, self.eye())

    def test_it_says_what_is_seen(self):
        self.value("view().set({ show: 'volume', tf: 'viridis' })")
        self.eye()
        self.until("view().shadowRoot.getElementById(canvas().getAttribute('aria-describedby')).textContent.startsWith('Volume, by value of density in viridis, ')")
        # A ring over the picture, at 3:1 on black and on white, for those who come by keys.
        self.browser.key("Tab")
        self.assertEqual(self.value("(({ outlineStyle, outlineColor, outlineOffset }) => [outlineStyle, outlineColor, outlineOffset])(getComputedStyle(canvas()))"),
                         ["solid", "rgb(59, 130, 214)", "-2px"])
        self.assertEqual(self.value("[canvas().tabIndex, canvas().getAttribute('role'), view().shadowRoot.querySelector('p').getAttribute('role')]"), [0, "img", "status"])

    def test_nothing_is_drawn_at_rest(self):
        self.eye()
        self.value("""{ globalThis.draws = 0;
            for (const name of ['drawArrays', 'drawArraysInstanced', 'clear']) {
                const before = WebGL2RenderingContext.prototype[name];
                WebGL2RenderingContext.prototype[name] = function (...list) { ++globalThis.draws; return before.apply(this, list); };
            }
            globalThis.frames = 0;
            const count = window.requestAnimationFrame;
            window.requestAnimationFrame = (call) => { ++globalThis.frames; return count.call(window, call); }; }""")
        self.assertEqual(self.value("new Promise((done) => setTimeout(() => done([draws, frames]), 700))"), [0, 0])
        self.browser.drag(60, 100, 70, 100)
        self.eye()
        self.assertGreater(self.value("draws"), 0)

    def test_a_phone_pinches_and_twists(self):
        self.browser.viewport(360, 640, 2, phone=True)
        self.value("Object.assign(view().style, { width: '100%', height: '200px' })")
        self.until("canvas().width === 720 && canvas().height === 400")
        before = self.value("view().picture().then(() => view().camera)")
        self.browser.touch([(150, 140), (210, 140)], [(130, 140), (230, 140)], [(110, 140), (250, 140)])
        self.eye()
        near = self.value("view().camera")
        far = lambda camera: sum((a - b) ** 2 for a, b in zip(camera["eye"], camera["look_at"])) ** 0.5
        self.assertLess(far(near), 0.6 * far(before))
        self.browser.touch([(150, 140), (210, 140)], [(155, 120), (205, 160)], [(170, 105), (190, 175)])
        self.eye()
        self.assertNotEqual(near["up"], self.value("view().camera.up"))
        # One finger turns sideways; upwards it scrolls the page.
        self.browser.touch([(100, 140)], [(140, 142)], [(200, 144)])
        self.assertNotEqual(near["eye"], self.eye())
        self.assertEqual(self.value("getComputedStyle(canvas()).touchAction"), "pan-y")
        self.assertEqual(self.value("document.documentElement.scrollWidth"), 360)

    def test_it_has_the_size_of_its_box_and_the_systems_ground(self):
        self.value("view().style.width = '250px'")
        self.until("canvas().width === 250")
        self.value("view().setAttribute('background', 'system')")
        for scheme, color in (("light", [1, 1, 1, 1]), ("dark", None)):
            self.browser.prefer(prefers_color_scheme=scheme)
            self.until(f"JSON.stringify(view().request.background ?? null) === '{json.dumps(color, separators=(',', ':'))}'")


class Removal(ElementTest):
    def test_a_removed_element_frees_its_memory(self):
        self.host("", wait=False)
        self.before = self.value("""(async () => {
            const kept = [];
            for (let n = 0; n < 18; ++n) {
                const one = document.createElement('vog-view');
                one.src = n % 2 ? 'site/' : 'plume.vogz';
                document.body.append(one);
                await one.ready;
                const gl = one.shadowRoot.querySelector('canvas').getContext('webgl2');
                one.remove();
                await null;
                kept.push([new WeakRef(one), gl.isContextLost()]);
            }
            globalThis.kept = kept;
            return kept.every(([, isLost]) => isLost);
        })()""")
        self.assertTrue(self.before)
        self.browser.call("HeapProfiler.collectGarbage")
        self.assertLessEqual(self.value("kept.filter(([one]) => one.deref()).length"), 2)
        # Of more than 16 contexts at once Chromium complains, which tearDown looks for.

    def test_an_element_that_moves_stays_and_one_that_comes_back_begins_anew(self):
        self.host('<vog-view src="plume.vogz"></vog-view><section></section>')
        self.value("(globalThis.before = canvas(), document.querySelector('section').append(view()))")
        self.assertTrue(self.value("Promise.resolve().then(() => canvas() === before)"))
        self.assertEqual(self.value("(globalThis.one = view(), one.remove(), Promise.resolve().then(() => one.shadowRoot.querySelectorAll('canvas').length))"), 0)
        self.value("(document.body.append(one), one.ready.then(() => true))")
        self.assertTrue(self.value("canvas() !== before && one.picture().then(({ size }) => size > 100)"))

    def test_what_is_under_way_ends(self):
        self.server.delay_s = 0.3
        self.host('<vog-view src="site/"></vog-view>', wait=False)
        self.until("told.length >= 0 && performance.getEntriesByType('resource').length >= 0")
        self.assertEqual(self.value("(globalThis.end = view().ready.then(() => 'ready', ({ message }) => message), view().src = 'plume.vogz', end)"), "another model is opened")
        self.value("view().ready.then(() => true)")
        self.assertEqual(self.value("errors()"), [])


class Security(ElementTest):
    # Where the decoding ran, as the page's own class tells.
    WORKERS = """customElements.whenDefined('vog-view').then((one) => { const before = one.worker; globalThis.workers = [];
        one.worker = () => { try { const made = before(); workers.push(true); return made; } catch (error) { workers.push(false); throw error; } }; });"""

    def other(self, origin=None):
        """A server of another origin."""
        other = SiteServer(self.folder, origin=origin, ranges=True).__enter__()
        self.addCleanup(other.__exit__)
        return other

    def test_the_module_is_whole_and_small(self):
        text = MODULE.read_text()
        self.assertLess(len(gzip.compress(text.encode(), 9)), 70_000)
        self.assertEqual(len(re.findall(r"\bexport\{", text)), 1)
        self.assertEqual(re.findall(r"\bimport\b(?!\.meta)", text), [])
        for word in ("http://", "https://", "eval(", "new Function", "innerHTML", "createObjectURL", ".style.cssText"):
            self.assertNotIn(word, text)

    def test_the_first_picture_of_a_streamed_model_takes_150_kb(self):
        vog("sample", "cloud", "large.vdb", "--size", 128)
        vog("convert", "large.vdb", "-o", "large.ply", "--block", 1)
        vog("pack", "large.ply", "-o", "large.vogz", "--hierarchy", "--deflate")
        vog("page", "large.ply", "-o", "large/")
        packed = lambda data: len(gzip.compress(data, 9))
        # What is behind the coarsest chunk waits until that has been drawn: all of it is asked for before its first answer.
        asked, pause_s = [], 0.4

        def slow(first, body, fields):
            asked.append((time.monotonic(), len(body)))
            time.sleep(pause_s)
            return body
        for src in "large/", "large.vogz":
            self.server.reset()
            self.server.part = slow
            self.host(f'<vog-view src="{src}" subframes="1"></vog-view>')
            if src == "large/":
                root = json.loads((self.folder / "large/manifest.json").read_text())["models"][0]["root"]
                paths = [path for path in self.server.paths if path.startswith("/large/")]
                self.assertEqual(sorted(paths[:2]) + paths[2:3], ["/large/manifest.json", "/large/page.json", f"/large/chunks/{root['name']}.vogz"])
                data = sum(packed((self.folder / "large" / name).read_bytes()) for name in ("manifest.json", "page.json")) + root["bytes"][0]
            else:
                data = asked[0][1] + sum(size for at, size in asked[1:] if at < asked[1][0] + 0.9 * pause_s)
            self.hold(f"bytes before the first picture of {src}", packed(MODULE.read_bytes()) + data, 150_000)

    def test_it_works_under_a_strict_policy_and_asks_for_the_model_alone(self):
        other = self.other("*")
        self.server.head = {"Content-Security-Policy": POLICY.format(f"'self' {other.url}")}
        self.before_pages("document.addEventListener('DOMContentLoaded', () => { " + self.WORKERS + " });")
        self.host(f'<vog-view src="site/" show="volume" light="studio"></vog-view><vog-view src="{other.url}plume.vogz"></vog-view>')
        self.value("Promise.all([view(0).picture(), view(1).picture()]).then(() => true)")
        self.assertEqual(self.value("[workers, errors()]"), [[True, True], []])
        asked = {path for path in self.server.paths if not path.startswith("/site/")}
        self.assertEqual(asked, {"/host.html", "/host.css", "/host.js", "/vog-view.js"})
        self.assertEqual(set(other.paths), {"/plume.vogz"})
        self.assertTrue(all(url.startswith((self.server.url, other.url, "data:,")) for url in self.browser.requests), self.browser.requests)

    def test_policies_without_workers_have_the_page_decode(self):
        policy = POLICY.format("'self'")
        for other in policy.replace("worker-src 'self'", "worker-src 'none'"), f"{policy}; require-trusted-types-for 'script'":
            self.server.head = {"Content-Security-Policy": other}
            self.host('<vog-view src="site/"></vog-view>')
            self.assertGreater(self.value("view().picture().then(({ size }) => size)"), 500)
            self.assertEqual(self.value("errors()"), [])
            self.assertTrue(all("worker" in line or "TrustedScriptURL" in line for line in self.browser.complaints), self.browser.complaints)
            self.browser.complaints.clear()

    def test_a_module_of_another_origin_is_checked_by_its_digest(self):
        other = self.other("*")
        digest = base64.b64encode(hashlib.sha384(MODULE.read_bytes()).digest()).decode()
        self.server.head = {"Content-Security-Policy": f"default-src 'none'; script-src 'self' {other.url}; connect-src 'self'; style-src 'self'; img-src data:"}
        own = '<script type="module" src="vog-view.js"></script>'
        for given, loads in ((digest, True), (digest[:-4] + "AAAA", False)):
            (self.folder / "host.html").write_text(HOST.replace(own, f'<script type="module" crossorigin src="{other.url}vog-view.js" integrity="sha384-{given}"></script>')
                                                   .format(body='<vog-view src="site/"></vog-view>'))
            self.browser.open(self.server.url + "host.html")
            if loads:
                self.until("customElements.get('vog-view')")
                self.assertGreater(self.value("view().picture().then(({ size }) => size)"), 500)
            else:
                self.until("document.readyState === 'complete'")
                self.assertFalse(self.value("Boolean(customElements.get('vog-view'))"))
                self.assertTrue(any("integrity" in line for line in self.browser.complaints), self.browser.complaints)
                self.browser.complaints.clear()

    def test_a_server_that_does_not_allow_the_page_is_named(self):
        other = self.other()
        self.host(f'<vog-view src="{other.url}site/"></vog-view><p id="rest">The rest</p>', wait=False)
        self.until("errors().some(({ fatal }) => fatal)")
        self.assertIn(f"does not allow pages from {self.server.url[:-1]}: its answer needs Access-Control-Allow-Origin", self.value("line()"))
        self.assertEqual(self.value("rest.textContent"), "The rest")
        self.assertTrue(all("CORS" in line or "ERR_FAILED" in line for line in self.browser.complaints), self.browser.complaints)
        self.browser.complaints.clear()


class Failures(ElementTest):
    def failed(self, src, body=""):
        """The line of an element that has no picture, which the event and the promise have, too."""
        self.host(f'<vog-view src="{src}"></vog-view>{body}', wait=False)
        self.until("errors().some(({ fatal }) => fatal)")
        said = self.value("view().ready.then(() => '', ({ message }) => message)")
        self.assertEqual([self.value("line()"), self.value("errors().at(-1).message")], [said, said])
        self.browser.complaints.clear()  # of the requests
        return said

    def test_what_is_no_model_is_named_and_another_address_recovers(self):
        (self.folder / "text.vogz").write_text("no model")
        (self.folder / "no").mkdir(exist_ok=True)
        (self.folder / "no/manifest.json").write_text("<!doctype html>")
        vog("pack", "plume.ply", "-o", "bare.vogz", "--deflate")
        for name in "old", "wide":
            shutil.copytree(self.folder / "site", self.folder / name, dirs_exist_ok=True)
        (self.folder / "old/page.json").unlink()
        page = json.loads((self.folder / "site/page.json").read_text())
        page["models"][0]["cutoff"] = "wide"
        (self.folder / "wide/page.json").write_text(json.dumps(page))
        for src, part in (("text.vogz", "text.vogz: 8 bytes that begin no compact model"), ("missing.vogz", "missing.vogz: HTTP 404"),
                          ("no/", "manifest.json: not valid JSON; expected a site's manifest"),
                          ("wide/", 'page.json: models[0]: cutoff: "wide", expected a number'),
                          ("old/", "page.json: HTTP 404; vog page MODEL -o FOLDER/ writes it beside the models"),
                          ("bare.vogz", "bare.vogz: has no levels of detail; write it with: vog pack MODEL -o FILE.vogz --hierarchy --deflate"),
                          ("plume.ply", "plume.ply: expected a compact file, FILE.vogz, or the folder of a site, which ends in /"),
                          ("http://", "http://: expected an address with https:"), ("ftp://127.0.0.1/a.vogz", "expected an address with http: or https:, not ftp:")):
            self.assertIn(part, self.failed(src))
        # Without an address the element is as one that never had any.
        self.assertTrue(self.value("(globalThis.ends = [], view().removeAttribute('src'), view().ready.then(() => ends.push('ready'), (error) => ends.push(error.message)), true)"))
        self.assertEqual(self.value("new Promise((done) => setTimeout(() => done([ends, line()]), 50))"), [[], ""])
        self.value("(view().src = 'plume.vogz', view().ready.then(() => true))")
        self.assertEqual(self.value("[line(), ends]"), ["", ["ready"]])
        # A blob, and a name in capitals.
        self.value("fetch('plume.vogz').then((answer) => answer.blob()).then((blob) => { view().src = URL.createObjectURL(blob); return view().ready; }).then(() => true)")
        shutil.copy(self.folder / "plume.vogz", self.folder / "PLUME.VOGZ")
        self.value("(view().src = 'PLUME.VOGZ', view().ready.then(() => true))")
        self.assertEqual(self.value("view().models[0].name"), "PLUME")
        self.value("(view().dispose(), true)")
        self.assertEqual(self.value("view().picture().then(() => '', ({ message }) => message)"), "the view has been removed")

    def test_a_damaged_chunk_leaves_the_page_and_a_coarser_picture(self):
        vog("sample", "cloud", "cloud.vdb", "--size", 64)
        vog("convert", "cloud.vdb", "-o", "cloud.ply", "--budget", 20000)
        vog("page", "cloud.ply", "-o", "cloud/")
        root = json.loads((self.folder / "cloud/manifest.json").read_text())["models"][0]["root"]
        spoiled = lambda body: body[:300] + bytes([body[300] ^ 1]) + body[301:]
        self.server.answers[f"{root['parts'][0]['name']}.vogz"] = spoiled
        self.host('<vog-view src="cloud/" pixel-error="0.5" subframes="1"></vog-view><vog-view src="plume.vogz"></vog-view>')
        self.value("view().picture().then(() => true)")
        self.assertEqual(self.value("errors().map(({ message, fatal }) => [message.replace(/.*: (damaged)/, '$1'), fatal])"), [["damaged: the picture stays coarse there.", False]])
        self.server.answers = {f"{root['name']}.vogz": spoiled}
        self.assertIn("damaged", self.failed("cloud/", '<vog-view src="plume.vogz"></vog-view>'))
        self.assertGreater(self.value("view(1).picture().then(({ size }) => size)"), 500)

    def test_a_server_that_is_away_is_asked_again(self):
        self.server.answers["manifest.json"] = DROP
        self.host('<vog-view src="site/"></vog-view>', wait=False)
        self.until("line().startsWith('No answer from 127.0.0.1')")
        self.assertFalse(self.value("errors().some(({ fatal }) => fatal)"))
        self.server.answers.clear()
        self.value("(dispatchEvent(new Event('online')), view().ready.then(() => true))")
        self.assertEqual(self.value("line()"), "")
        self.browser.complaints.clear()

    def test_no_webgl_is_named(self):
        self.before_pages("HTMLCanvasElement.prototype.getContext = () => null;")
        self.assertIn("No picture here: this browser offers no WebGL 2, or it is switched off.", self.failed("plume.vogz"))
        self.assertEqual(self.value("view().shadowRoot.querySelectorAll('canvas').length"), 0)

    def test_a_lost_context_comes_back(self):
        self.host('<vog-view src="plume.vogz" subframes="1" show="volume"></vog-view>')
        before = self.value("bytesOf()")
        self.value("(globalThis.loser = canvas().getContext('webgl2').getExtension('WEBGL_lose_context')).loseContext()")
        self.until("line() === 'The graphics driver restarts …'")
        self.value("loser.restoreContext()")
        self.until("line() === ''")
        self.assertEqual(self.value("bytesOf()"), before)

    def test_an_element_without_a_size_says_so_until_it_has_one(self):
        self.host('<vog-view src="plume.vogz" hidden></vog-view>', wait=False)
        self.value("view().style.height = '0'")
        self.value("new Promise((done) => setTimeout(done, 200))")
        self.assertEqual(self.value("errors()"), [])  # of a hidden one nobody expects a picture
        self.value("view().hidden = false")
        self.until("errors().some(({ message }) => message === 'The element is 180 x 0 pixels, expected a width and a height')")
        self.value("view().style.height = '100px'")
        self.until("line() === '' && canvas().height === 100")
        self.assertGreater(self.value("view().picture().then(({ size }) => size)"), 300)


if __name__ == "__main__":
    run()
