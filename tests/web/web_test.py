#!/usr/bin/env python3
"""The page that `vog page` writes, opened from a file in Chromium: its pictures against the CPU's,
mouse, touch, keys and controls, what happens where something is missing.

VOG_COMMAND names the command, VOG_DATA the folder of real inputs. Exits with 77, which ctest takes as
skipped, where there is no Chromium.
"""
import array
import json
import math
import random
import sys

from page_test_case import FACTOR_DB, PageTest, run, HEIGHT, LEAST_PSNR_DB, WIDTH, nightly, sampled_cloud, vog, write_model


class Pages(PageTest):
    @classmethod
    def make(cls):
        volume = sampled_cloud()
        # A GPU in software takes as long for a Gaussian as for some hundred pixels.
        for name, block in (("levels", 2), ("fine", 4), ("coarse", 8)):
            vog("convert", volume, "-o", f"{name}.ply", "--block", block, "--set", "soft-steps=0")
        vog("page", "levels.ply", "-o", "levels.html", "--tf", "gray")
        vog("page", "fine.ply", "coarse.ply", "-o", "page.html", "--tf", "gray",
            "--title", "Smoke & mirrors", "--set", "description=A test.")

    # --- Pictures. ---

    def test_the_picture_is_the_cpu_splats(self):
        self.open()
        self.assertEqual(self.value("vog.bits()"), 32)
        self.expect_same()
        page = (self.folder / "page.html").as_uri()
        # The worker's text is the page's own.
        self.assertEqual([r for r in self.browser.requests if r != page and not r.startswith(("data:", "blob:null/"))], [])

    def test_from_inside_and_beside_the_volume(self):
        self.open()
        for place in ("[0, 0, 0]", "[0.3, 0.1, 0]", "[0.9, 0, 0.2]"):
            self.value(f"""(() => {{
                const {{center, radius}} = vog.page.models[0].box;
                const eye = center.map((c, k) => c + radius * {place}[k]);
                vog.change({{camera: {{eye, at: eye.map((c, k) => c + radius * [-1, 0.2, 0.1][k]),
                                       up: [0, 1, 0], fov: 70}}}});
            }})()""")
            self.expect_same()

    def test_parallel_rays_from_outside_and_through_the_volume(self):
        self.open()
        self.browser.key("5", "Digit5")
        self.assertGreater(self.value("vog.state.camera.span"), 0)
        self.expect_same()
        self.value("vog.change({camera: {...vog.state.camera, eye: vog.state.camera.at.map((c, k) => c + [0.3, 0, 0][k])}})")
        self.expect_same()
        self.browser.key("5", "Digit5")
        self.assertEqual(self.value("vog.state.camera.span"), 0)

    def test_half_floats_where_float_blending_is_missing(self):
        self.before_pages("""
            const { getExtension, readPixels } = WebGL2RenderingContext.prototype;
            WebGL2RenderingContext.prototype.getExtension = function (name) {
              return name === 'EXT_float_blend' ? null : getExtension.call(this, name);
            };
            window.reads = 0;
            WebGL2RenderingContext.prototype.readPixels = function (...all) { ++reads; return readPixels.apply(this, all); };""")
        self.open()
        self.assertEqual(self.value("vog.bits()"), 16)
        self.assertIn("32-bit float blending is missing", self.value("notice.textContent"))
        self.assertFalse(self.value("notice.hidden"))
        self.expect_same(least=66.7 - FACTOR_DB)
        self.browser.key("w")
        self.browser.settle()
        self.assertEqual(self.value("reads"), 0, "pictures stay on the GPU")

    def test_says_so_where_nothing_can_be_drawn(self):
        for name, message in (("webgl2", "no WebGL 2"), ("extensions", "floating-point images"),
                           ("inflation", "too old")):
            script = self.browser.call("Page.addScriptToEvaluateOnNewDocument", source={
                "webgl2": """
                    const getContext = HTMLCanvasElement.prototype.getContext;
                    HTMLCanvasElement.prototype.getContext = function (name, ...more) {
                      return name === '2d' ? getContext.call(this, name, ...more) : null;
                    };""",
                "inflation": "delete window.DecompressionStream; delete window.Worker;",
                "extensions": "WebGL2RenderingContext.prototype.getExtension = () => null;"}[name])
            try:
                self.browser.open(self.folder / "page.html")
            finally:
                self.browser.call("Page.removeScriptToEvaluateOnNewDocument", **script)
            self.value("new Promise((done) => setTimeout(done))")  # the code that reads the models has run
            self.assertIn(message, self.value("document.getElementById('failure-text').textContent"))
            self.assertTrue(self.value("document.getElementById('failure').checkVisibility()"))

    # --- Mouse, wheel, touch, keys. ---

    def test_dragging_turns_around_the_centre(self):
        self.open()
        before = self.value("vog.state.camera")
        self.browser.drag(160, 120, 220, 140)
        after = self.value("vog.state.camera")
        self.assertNotEqual(before["eye"], after["eye"])
        self.assertEqual(before["at"], after["at"])
        self.assertAlmostEqual(math.dist(before["eye"], before["at"]),
                               math.dist(after["eye"], after["at"]), delta=1e-6 * math.hypot(*before["eye"]))
        self.expect_same()

    def test_each_button_moves_the_camera_its_own_way(self):
        self.open()
        distance = "Math.hypot(...vog.state.camera.eye.map((x, k) => x - vog.state.camera.at[k]))"
        first = self.value(distance)
        self.browser.drag(160, 120, 160, 90, button="right")
        self.assertLess(self.value(distance), first * 0.9)
        at = self.value("vog.state.camera.at")
        self.browser.drag(160, 120, 190, 120, modifiers=8)  # Shift
        self.assertGreater(math.dist(at, self.value("vog.state.camera.at")), 0.01 * first)
        up = self.value("vog.state.camera.up")
        self.browser.drag(220, 120, 160, 40, modifiers=1)  # Alt
        self.assertGreater(math.dist(up, self.value("vog.state.camera.up")), 0.3)
        eye = self.value("vog.state.camera.eye")
        self.browser.drag(160, 120, 170, 120, modifiers=2)  # Ctrl
        self.assertEqual(eye, self.value("vog.state.camera.eye"))
        self.expect_same()

    def test_the_wheel_zooms_to_the_pointer_and_through(self):
        self.open()
        before = self.bytes()
        eye = self.value("vog.state.camera.eye")
        self.browser.wheel(200, 100, -240)
        self.assertLess(math.dist(self.value("vog.state.camera.eye"), self.value("vog.state.camera.at")),
                        math.dist(eye, self.value("vog.state.camera.at")))
        self.assertNotEqual(before, self.bytes())
        self.expect_same()
        for _ in range(60):
            self.browser.wheel(160, 120, -240)
        radius = self.value("vog.page.models[0].box.radius")
        self.assertGreater(math.dist(eye, self.value("vog.state.camera.eye")), 3 * radius)
        self.expect_same()

    def test_two_fingers_pan_pinch_and_twist(self):
        self.browser.viewport(WIDTH, HEIGHT, phone=True)
        self.open()
        first = self.value("vog.state.camera")
        span = math.dist(first["eye"], first["at"])
        self.browser.touch([(120, 120), (200, 120)], [(100, 120), (220, 120)], [(80, 120), (240, 120)])
        pinched = self.value("vog.state.camera")
        self.assertAlmostEqual(math.dist(pinched["eye"], pinched["at"]), span / 2, delta=0.01 * span)
        self.browser.touch([(120, 120), (200, 120)], [(120, 150), (200, 150)])
        self.assertGreater(math.dist(pinched["at"], self.value("vog.state.camera.at")), 0.01 * span)
        self.browser.touch([(120, 120), (200, 120)], [(160, 80), (160, 160)])
        self.assertGreater(math.dist(first["up"], self.value("vog.state.camera.up")), 0.5)
        eye = self.value("vog.state.camera.eye")
        self.browser.touch([(160, 120)], [(190, 120)])
        self.assertNotEqual(eye, self.value("vog.state.camera.eye"))
        self.expect_same()

    def test_keys(self):
        self.open()
        for key, changed in (("w", "camera"), ("ArrowLeft", "camera"), ("q", "camera"), ("f", "camera"),
                             ("=", "exposure"), ("m", "map"),
                             ("i", "reverse"), ("b", "fade"), ("n", "model"), ("l", "bar"), ("h", "panel")):
            before = self.value(f"JSON.stringify(vog.state.{changed})")
            self.browser.key(key)
            self.assertNotEqual(before, self.value(f"JSON.stringify(vog.state.{changed})"), key)
        self.browser.key("?")
        self.assertTrue(self.value("document.getElementById('help-box').open"))
        self.browser.key("?")
        self.assertFalse(self.value("document.getElementById('help-box').open"))
        self.browser.key("1", "Digit1")
        self.browser.key("i")
        self.expect_same("coarse.ply", "--blend", tf=self.value("vog.state.map"))

    # --- Controls. ---

    def set(self, control, value, event="input"):
        self.value(f"""(() => {{ const control = document.getElementById('{control}');
            control.value = {json.dumps(value)};
            control.dispatchEvent(new Event('{event}')); }})()""")

    def test_colours_exposure_and_fading_are_vog_renders(self):
        self.open()
        self.set("map", "viridis", "change")
        least = 55.0 - FACTOR_DB  # a step in every fifth number: colours change faster with T than grays
        self.expect_same(tf="viridis", least=least)
        self.set("exposure", 1.5)
        self.assertAlmostEqual(self.value("vog.state.exposure"), 2 ** 1.5)
        self.expect_same(tf="viridis", least=least)
        self.value("document.getElementById('fade').click()")
        self.expect_same("fine.ply", "--blend", tf="viridis")
        plain = self.bytes()
        self.value("document.getElementById('reverse').click()")
        self.assertNotEqual(plain, self.bytes())

    def test_the_slider_changes_detail_and_keeps_the_mass(self):
        self.open("levels.html")
        fine = self.picture("fine.png")
        count = self.value("document.getElementById('count').textContent")
        self.set("level", 0)
        last = self.value("vog.page.models[0].levels.length") - 1
        self.assertGreater(last, 0)
        self.assertEqual(self.value("vog.state.level"), last)
        self.assertNotEqual(count, self.value("document.getElementById('count').textContent"))
        coarse = self.picture("coarse.png")
        self.assertEqual(int(self.value("document.documentElement.dataset.drawn")),
                         self.value(f"vog.page.models[0].levels[{last}].count"))
        self.assertNotEqual((self.folder / fine).read_bytes(), (self.folder / coarse).read_bytes())
        self.assertGreater(self.psnr(fine, coarse), 30)
        for key, level in (("]", last - 1), ("[", last)):
            self.browser.key(key)
            self.assertEqual(self.value("vog.state.level"), level)

    def test_the_switch_keeps_the_view(self):
        self.open()
        self.browser.drag(160, 120, 220, 140)
        camera = self.value("vog.state.camera")
        self.value("document.querySelectorAll('#models input')[1].click()")
        self.assertEqual(self.value("vog.state.model"), 1)
        for part in ("eye", "at"):  # both models have the box of the volume
            self.assertLess(math.dist(camera[part], self.value("vog.state.camera")[part]), 1e-9 * 1e3)
        self.expect_same("coarse.ply")

    def test_saves_a_png(self):
        self.open()
        target = self.folder / "saved"
        target.mkdir()
        self.browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(target))
        expected = self.bytes()
        self.value("document.getElementById('save').click()")
        self.value("""new Promise((done) => setTimeout(done, 0))""")
        for _ in range(200):
            # While Chromium writes the file, it has another name, for a moment both.
            if {f.suffix for f in target.iterdir()} == {".png"}:
                break
            self.value("new Promise((done) => setTimeout(done, 20))")
        self.assertEqual([f.name for f in target.iterdir()], ["Smoke-mirrors.png"])
        self.assertEqual((target / "Smoke-mirrors.png").read_bytes(), expected)

    # --- The address. ---

    def test_a_link_brings_the_view_back(self):
        self.open("levels.html")
        self.browser.drag(160, 120, 200, 150)
        self.browser.wheel(160, 120, -120)
        self.value("vog.change({level: 1, map: 'magma', exposure: 2, fade: true})")
        expected = self.bytes()
        self.value("""(() => { Object.defineProperty(navigator, 'clipboard', { value:
            { writeText: async (text) => { window.copied = text; } } }); })()""")
        self.value("document.getElementById('link').click()")
        link = self.value("copied")
        self.assertTrue(link.startswith((self.folder / "levels.html").as_uri()))
        self.open("levels.html", "#" + link.split("#", 1)[1] + "&subframes=1")
        (self.folder / "before.png").write_bytes(expected)
        self.hold("-PSNR of a link [dB]", -self.psnr("before.png", self.picture()), -LEAST_PSNR_DB)  # eight digits

    def test_data_far_from_the_origin_have_their_picture_and_link(self):
        numbers = random.Random(4)
        (self.folder / "far.xyz").write_text("".join(
            "{:.4f} {:.4f} {:.4f}\n".format(*(1e7 * (k - 1) + numbers.gauss(0, 0.1) for k in range(3)))
            for _ in range(500)))
        vog("convert", "far.xyz", "-o", "far.ply", "--no-hierarchy")
        vog("page", "far.ply", "-o", "far.html", "--tf", "gray")
        self.open("far.html")
        self.expect_same("far.ply")
        self.browser.wheel(160, 120, -120)
        (self.folder / "before.png").write_bytes(self.bytes())
        self.value("""(() => { Object.defineProperty(navigator, 'clipboard', { value:
            { writeText: async (text) => { window.copied = text; } } }); })()""")
        self.value("document.getElementById('link').click()")
        self.open("far.html", "#" + self.value("copied").split("#", 1)[1] + "&subframes=1")
        self.hold("-PSNR of a link far from the origin [dB]", -self.psnr("before.png", self.picture()), FACTOR_DB - 90.9)

    def test_embedded_there_is_the_picture_and_its_scale(self):
        self.open(fragment="#embed&subframes=1")
        visible = "document.getElementById('{}').checkVisibility()"
        for part, shown in (("panel", False), ("caption", False), ("toggle", False),
                            ("scale", True), ("open", True), ("picture", True)):
            self.assertEqual(self.value(visible.format(part)), shown, part)
        self.expect_same()
        # The wheel scrolls the outer page until the picture is clicked.
        eye = self.value("vog.state.camera.eye")
        self.browser.wheel(160, 120, -120)
        self.assertEqual(eye, self.value("vog.state.camera.eye"))
        self.browser.drag(160, 120, 160, 120, steps=1)
        self.browser.wheel(160, 120, -120)
        self.assertNotEqual(eye, self.value("vog.state.camera.eye"))
        self.assertNotIn("#", self.value("document.getElementById('open').href"))

    def test_a_still_view_cannot_be_moved(self):
        self.open(fragment="#still&subframes=1")
        camera = self.value("vog.state.camera")
        self.browser.drag(160, 120, 220, 140)
        self.browser.wheel(160, 120, -120)
        for key in ("w", "f", "ArrowUp", "Home"):
            self.browser.key(key)
        self.assertEqual(camera, self.value("vog.state.camera"))

    # --- Screens. ---

    def test_a_phone_held_upright(self):
        self.browser.viewport(160, 300, scale=3, phone=True)
        self.open()
        self.assertEqual(self.value("[vog.canvas.width, vog.canvas.height]"), [320, 600])  # two pixels per CSS pixel
        self.assertFalse(self.value("document.getElementById('panel').checkVisibility()"))
        self.expect_same()
        self.value("document.getElementById('toggle').click()")
        self.browser.settle()
        self.assertTrue(self.value("document.getElementById('panel').checkVisibility()"))
        self.assertGreater(600, self.value("vog.canvas.height"))  # the controls do not cover the picture

    def test_a_desktop_window(self):
        self.browser.viewport(720, 450)
        self.open()
        for part in ("panel", "caption", "scale", "toggle"):
            self.assertTrue(self.value(f"document.getElementById('{part}').checkVisibility()"), part)
        self.assertEqual(self.value("[vog.canvas.clientWidth + panel.clientWidth + 1, vog.canvas.height]"), [720, 450])
        self.expect_same()

    def test_the_picture_follows_the_window(self):
        self.open()
        self.browser.viewport(200, 130, scale=1.5)
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        self.browser.settle()
        self.assertEqual(self.value("[vog.canvas.width, vog.canvas.height]"), [300, 195])
        self.expect_same()

    def test_the_background_of_the_readers_system(self):
        vog("page", "coarse.ply", "-o", "system.html", "--background", "system", "--blend")
        for scheme, ground, color in (("light", "light", "white"), ("dark", "dark", "black")):
            self.browser.prefer(prefers_color_scheme=scheme)
            self.open("system.html")
            self.assertEqual(self.value("document.documentElement.dataset.ground"), ground)
            self.expect_same("coarse.ply", "--blend", "--background", color, tf="ember")

    def test_a_lost_context_comes_back(self):
        self.open()
        expected = self.bytes()
        self.value("""new Promise((done) => {
            const loser = vog.canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
            vog.canvas.addEventListener('webglcontextlost', () => setTimeout(() => loser.restoreContext()));
            vog.canvas.addEventListener('webglcontextrestored', () => setTimeout(done));
            loser.loseContext(); })""")
        self.assertEqual(expected, self.bytes())

    # --- Models of other kinds. ---

    def test_a_title_is_text(self):
        title = "<img src=x onerror=document.title='broken'> & \"'</script><script>document.title='broken'"
        vog("page", "coarse.ply", "-o", "title.html", "--title", title, "--set", f"description={title}",
            "--name", title)
        self.open("title.html")
        self.assertEqual(self.value("document.title"), title)
        self.assertEqual(self.value("document.querySelector('h1').textContent"), title)
        self.assertEqual(self.value("vog.page.models[0].name"), title)
        self.assertEqual(self.value("document.images.length"), 0)

    def test_empty_and_single(self):
        write_model(self.folder / "none.ply", [])
        write_model(self.folder / "one.ply", [1, 2, 3, 0.5, 1, 2, 4])
        vog("page", "none.ply", "one.ply", "-o", "few.html", "--tf", "gray")
        self.open("few.html")
        self.assertIn("empty", self.value("notice.textContent"))
        self.value("vog.change({model: 1})")
        self.browser.settle()
        self.assertTrue(self.value("notice.hidden"))
        self.value("vog.change({camera: {eye: [1, 2, 12], at: [1, 2, 3], up: [0, 1, 0], fov: 50}})")
        self.expect_same("one.ply", least=47.4)  # 50.9 measured: alpha of 8 bits below V = 0.05

    def test_many_gaussians_open(self):
        count, levels = (1_000_000, 5) if nightly() else (30_000, 3)
        number = random.Random(1).random
        size = 0.4 / count ** (1 / 3)  # of an edge 1
        rows = array.array("f")
        for _ in range(count):
            rows.extend((number(), number(), number(), size, 0.75 * size, size, 1))
        write_model(self.folder / "many.ply", rows)
        report = json.loads(vog("page", "many.ply", "-o", "many.html", "--tf", "gray", "--json"))
        self.assertEqual(report["gaussians"], count)
        self.assertGreaterEqual(len(report["models"][0]["levels"]), levels)
        self.open("many.html")
        self.assertEqual(self.value("document.documentElement.dataset.drawn"), f"{count}")
        self.expect_same("many.ply")


if __name__ == "__main__":
    run()
