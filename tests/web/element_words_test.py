"""Words of <vog-view> over its life, its hands, what it says: what element_test.py has not, in few pages."""
import json
import unittest

from element_test import ElementTest
from exploring_test import random_gaussians, write_scalars
from page_test_case import run, vog


class Settings(ElementTest):
    @classmethod
    def make(cls):
        super().make()
        rows = random_gaussians(20, lambda mean: [(300 + 10 * mean[0], [10, 0, 0]), (0.5, [0, 0, 0])])
        write_scalars(cls.folder / "warm.ply", rows, [("scalar", "heat", 285, 315), ("measure", "mass", 0.1, 1)])
        turned = random_gaussians(20, lambda mean: [(0.5, [0, 0, 0]), (300 + 10 * mean[0], [10, 0, 0])])
        write_scalars(cls.folder / "turned.ply", turned, [("measure", "mass", 0.1, 1), ("scalar", "heat", 285, 315)])
        vog("page", "warm.ply", "turned.ply", "-o", "two/", "--site")

    def test_words_of_a_view(self):
        self.host('<vog-view src="two/" model="2" show="mean" field="heat" subframes="1" exposure="0"></vog-view>')
        self.assertEqual(self.value("line()"), "Not in this picture: exposure 0: expected a number from 1/64 to 64")
        self.assertEqual(self.value("[view().model, view().field, view().request.field, canvas().getAttribute('aria-label').split('.')[0]]"), [2, "heat", "heat", "turned"])
        self.assertEqual(self.value("[view().set({ model: 1.5 }), view().set({ model: 3 }), view().set({ pixel_error: 100 }), view().model]"),
                         [["model 1.5: expected a whole number above 0"], ["model 3: expected 1 to 2"], ["pixel_error 100: expected a number from 0.5 to 32 pixels"], 2])
        self.value("void (view().label = 'Heat. ')")
        self.assertEqual(self.value("canvas().getAttribute('aria-label').slice(0, 10)"), "Heat. Drag")
        # null is the default of every word, as a removed attribute is.
        first = self.value("(view().model = 1, view().set({ show: null, field: null }), view().link)")
        given = {"exposure": 2, "pixel_error": 4, "memory": 50, "most": 1e5, "subframes": 1, "still": True, "background": "white", "light_weights": [1, 0, 0, 1], "model": 2, "tf": "gray",
                 "extinction": 3, "blend": True, "clip": [0, 0, 0, 1, 1, 1], "show": "volume", "light": "head", "range": [1, 2]}
        before = self.value(f"Object.keys({json.dumps(given)}).map((word) => view()[word])")
        self.assertEqual(self.value(f"(view().subframes = 2, view().set({json.dumps(given)}))"), [])
        self.assertEqual(self.value(f"view().set({json.dumps(dict.fromkeys(given))})"), [])
        self.assertEqual(self.value("view().link"), first)
        before[4] = 8
        self.assertEqual(self.value(f"Object.keys({json.dumps(given)}).map((word) => view()[word])"), before)
        # Values are those of now.
        self.value("view().set({ show: 'volume', field: 'heat', range: [290, 300] })")
        self.assertEqual(self.value("[view().range, view().window]"), [[290, 300], None])
        self.value("view().set({ window: [300, 10] })")
        self.assertEqual(self.value("[view().range, view().window]"), [None, [300, 10]])
        self.value("(view().bands = [[290, 300, [1, 0, 0], 0.5]], view().tf = 'hot', view().threshold = 'a')")
        self.assertEqual(self.value("[view().window, view().bands, view().tf, view().threshold]"), [None, None, "hot", None])
        self.assertIn("rows of lower, upper or null", self.value("view().set({ bands: 3 })[0]"))
        for scheme in "light", "dark":
            self.browser.prefer(prefers_color_scheme=scheme)
            self.assertEqual(self.value("(view().background = 'system', view().background)"), "system")
        # Maps of its own do not pile up.
        self.value("for (let n = 0; n < 40; ++n) view().set({ show: 'T', tf: { colors: [[0, n / 40, 0, 0], [1, 1, 1, 1]] } })")
        self.assertLess(len(self.value("view().set({ tf: 'zz' })[0]")), 250)
        self.assertAlmostEqual(self.value("view().request.tf.colors[0][1]"), 39 / 40)

    def test_empty_attributes_are_defaults(self):
        self.host('<vog-view src="plume.vogz" show="column" range="" tf="" clip="" exposure="" camera.eye="" blend still></vog-view>')
        self.value("void (window.lines = [], view().on('error', ({ message }) => lines.push(message)))")
        self.assertEqual(self.value("[view().blend, view().still, view().exposure, view().clip]"), [True, True, 1, None])
        first = self.value("view().range")
        self.assertEqual(self.value("(view().setAttribute('range', '0,2'), view().range)"), [0, 2])
        self.assertEqual(self.value("(view().setAttribute('range', ''), [view().range, lines])"), [first, []])

    def test_the_command_takes_the_request_of_a_view(self):
        self.host('<vog-view src="plume.vogz" show="volume" tf="inferno" clip="-20,10,-20,40,90,40" subframes="1"></vog-view>')
        self.shot()
        self.assertIsNone(self.value("(view().clip = null, view().request.light)"))
        self.value("void (view().clip = [-20, 10, -20, 40, 90, 40])")
        vog("render", "plume.ply", "-o", "cpu.png", "--request", self.value("JSON.stringify(view().request)"))
        self.hold("-PSNR of a request [dB]", -self.psnr("cpu.png", "web.png"), -50)

    def test_settings_outlive_their_view(self):
        """The same whether they are set before a model or after, and after another one."""
        self.host('<vog-view src="plume.vogz"></vog-view><vog-view></vog-view>')
        tall = {"camera": {**self.value("view().camera"), "fov_degrees": 60}, "size": [150, 300]}
        self.value(f"view(1).set({json.dumps(tall)})")
        self.value("void (view(1).src = 'plume.vogz')")
        self.value(f"(view().set({json.dumps(tall)}), view(1).ready.then(() => true))")
        self.assertAlmostEqual(self.value("view(1).camera.fov_degrees"), self.value("view().camera.fov_degrees"))
        self.value("void (view(1).set({ camera: { eye: [300, 80, 0] } }), view(1).set({ camera: { fov_degrees: 20 } }), view(1).tf = 'viridis', view(1).tf = 'rainbow', view(1).range = 'x')")
        self.assertEqual(self.value("""(async () => {
            const one = view(1), lines = [];
            one.on('error', ({ message }) => lines.push(message));
            one.set({ show: 'column', range: [0, 5] });
            one.set({ show: 'mean' });
            const { range } = one;
            one.remove();
            await null;
            const ended = await one.ready.catch(({ message }) => message);
            document.body.append(one);
            await one.ready;
            return [ended, one.camera.eye, Math.round(one.camera.fov_degrees), one.tf, `${one.range}` === `${range}`, lines];
        })()"""), ["the view has been removed", [300, 80, 0], 20, "viridis", True, []])

    def test_promises_end_with_their_view(self):
        self.host('<vog-view src="plume.vogz" label="A plume"></vog-view>')
        self.assertEqual(self.value("""(async () => {
            const ends = [], end = (promise) => promise.then(() => 'kept', ({ message }) => message), one = view();
            one.dispose();
            ends.push(await end(one.ready), await end(one.picture()));
            one.src = 'plume.vogz';
            ends.push(await end(one.ready));
            one.src = 'site/';
            const [ready, picture] = [end(one.ready), end(one.picture())];
            one.remove();
            ends.push(await ready, await picture);
            document.querySelector('main').append(one);
            ends.push(await end(one.ready));
            one.hidden = true;
            ends.push(await end(one.picture()));
            one.hidden = false;
            ends.push(await end(one.picture()));
            one.files = 5;
            ends.push(await end(one.ready));
            return ends;
        })()"""), [*["the view has been removed"] * 2, "kept", *["the view has been removed"] * 2, "kept", "the element is hidden or has no size: show it first", "kept",
                   "The model cannot be read: files: expected a function (name) => bytes."])
        self.browser.complaints.clear()


class Contexts(ElementTest):
    def test_a_context_that_does_not_come_back_does_once_another_view_ends(self):
        self.host('<vog-view src="plume.vogz"></vog-view><vog-view src="plume.vogz" tf="gray"></vog-view>')
        self.value("view(1).ready.then(() => canvas().getContext('webgl2').getExtension('WEBGL_lose_context').loseContext())")
        self.until("line().startsWith('The graphics driver')")
        self.value("view().set({ show: 'mean', tf: 'magma' })")
        self.until("line() === 'This browser shows no more 3D views at a time: close others or reload.'")
        self.assertEqual(self.value("(view(1).remove(), new Promise((done) => view().on('change', () => done(view().picture().then(() => [line(), view().show, view().tf])))))"),
                         ["", "mean", "magma"])


class Fingers(ElementTest):
    def swipe(self):
        """Where the camera is after a swipe, and whether the page has scrolled.

        The swipe begins at rest: a page scrolls on for a while after a finger has left it, and a browser takes the
        places that fingers may scroll from the frame it showed last.
        """
        self.value("""(async () => {
            for (let still = 0; still < 10; still = scrollY ? 0 : still + 1) {
                scrollTo(0, 0);
                await new Promise(requestAnimationFrame);
            }
        })()""")
        self.browser.touch(*([(180, 240 - 20 * n)] for n in range(8)))
        return self.value("view().picture().then(() => [view().camera.eye, scrollY > 0])")

    def test_a_swipe_scrolls_until_a_tap(self):
        self.browser.viewport(360, 640, 2, phone=True)
        self.host('<vog-view src="plume.vogz" subframes="1" style="width: 100%; height: 220px"></vog-view><p style="height: 2000px">')
        eye = self.value("view().picture().then(() => view().camera.eye)")
        self.assertEqual(self.swipe(), [eye, True])
        self.assertEqual(self.value("document.activeElement === view()"), False)
        self.value("new Promise((done) => setTimeout(() => done(scrollTo(0, 0)), 400))")  # a tap ends what still scrolls
        for _ in range(20):  # a tap while the page still scrolls ends that, and a slow one is a long press
            self.browser.touch([(180, 200)])
            if self.value("new Promise((done) => setTimeout(() => done(document.activeElement === view()), 400))"):
                break
        self.assertTrue(self.value("document.activeElement === view()"))
        self.assertEqual(self.value("getComputedStyle(canvas()).touchAction"), "none")
        turned, scrolls = self.swipe()
        self.assertEqual(scrolls, False)
        self.assertNotEqual(turned, eye)

    def test_a_still_view_has_no_hands(self):
        self.host('<vog-view src="plume.vogz" subframes="1"></vog-view><p style="height: 2000px">')
        # A pointer at rest has the numbers of what is shown now.
        self.value("view().picture().then(() => true)")
        self.browser.mouse("mouseMoved", 90, 120)
        self.until("told.some(([name, { lines }]) => name === 'probe' && lines[0].startsWith('T '))")
        self.value("(told.length = 0, view().set({ show: 'column' }))")
        self.until("told.some(([name, { lines }]) => name === 'probe' && lines[0].startsWith('column '))")
        self.browser.drag(60, 100, 120, 110)
        self.value("void (view().still = true)")
        before = self.value("(globalThis.kept = [], addEventListener('keydown', ({ defaultPrevented }) => kept.push(defaultPrevented)), view().link)")
        for key in "m", "b", "i", "=", "[", "ArrowLeft":
            self.browser.key(key)
        self.assertEqual(self.value("[view().link, kept]"), [before, [False] * 6])
        self.assertEqual(self.value("[canvas().getAttribute('aria-label'), canvas().tabIndex, getComputedStyle(canvas()).cursor, getComputedStyle(canvas()).touchAction]"), ["plume.", -1, "auto", "auto"])

    def test_readers_hear_it_once(self):
        self.host('<vog-view src="plume.vogz" label="A plume"></vog-view><vog-view label="Nothing yet"></vog-view>')
        self.value("view().picture().then(() => true)")
        heard = [[node["role"]["value"], node["name"]["value"]] for node in self.browser.call("Accessibility.getFullAXTree")["nodes"] if not node["ignored"] and node.get("name", {}).get("value")]
        self.assertIn(["group", "Nothing yet"], heard)
        self.assertEqual([name for role, name in heard if "Gaussians" in name], [])
        self.assertEqual(sum(name.startswith("A plume") for _, name in heard), 1)


if __name__ == "__main__":
    run()
