"""What tests of pages share: one browser, `vog`, pictures of both."""
import array
import json
import math
import os
import pathlib
import shutil
import sys
import tempfile
import unittest

from browser import HOUSE, Browser, find_chromium

sys.path.append(str(HOUSE / "tests/cli"))
import command_server

VOG = command_server.VOG
DATA = pathlib.Path(os.environ.get("VOG_DATA", HOUSE / "../shared/data"))  # real inputs
WIDTH, HEIGHT = 320, 240
# Pixels of the screen to a CSS pixel, for tests of what surrounds the picture: its area is what a GPU in software takes long for.
COARSE = 0.2
# Bounds of errors against `vog render` are measured errors of the made inputs, which run() prints, times this: other processors and
# drivers round otherwise. Wrong pictures exceed them: test_bounds_refuse_wrong_pictures.
FACTOR = 1.5
FACTOR_DB = 20 * math.log10(FACTOR)
# Both renderers are exact; the page's numbers are quantised (docs/web.md). Measured of the sampled cloud's T in gray: 62.0 dB; 1.26 times that error.
LEAST_PSNR_DB = 60


def command(*arguments):
    """Runs the command in the tests' folder. Forked from one process (tests/cli/command_server.py): its libraries load for longer than it draws."""
    return command_server.run(list(map(str, arguments)), FolderTest.folder or ".", 600)


def vog(*arguments):
    # Pages begin with the whole box in view: their bounds were measured so, and the tests' models have no content to frame.
    if arguments[0] == "page":
        arguments += ("--frame", "data")
    done = command(*arguments)
    if done.returncode:
        raise RuntimeError(f"vog {' '.join(map(str, arguments))}: {done.stderr.decode()}")
    return done.stdout.decode()


def nightly():
    """Whether this is a run of scripts/nightly.sh, with more of what takes long than every change has."""
    return "VOG_NIGHTLY" in os.environ


def sampled_cloud(size=64):
    """A volume of the sampled cloud, made anew: the same numbers everywhere."""
    vog("sample", "cloud", f"cloud-{size}.vdb", "--size", size)
    return f"cloud-{size}.vdb"


def write_model(path, gaussians):
    """Writes a PLY with rows (x, y, z, s, s, s, density)."""
    names = ["x", "y", "z", "scale_0", "scale_1", "scale_2", "density"]
    header = "ply\nformat binary_little_endian 1.0\ncomment vog 1\ncomment cutoff 2.25\n"
    header += f"element vertex {len(gaussians) // len(names)}\n"
    header += "".join(f"property float {name}\n" for name in names) + "end_header\n"
    with open(path, "wb") as out:
        out.write(header.encode())
        array.array("f", gaussians).tofile(out)


class FolderTest(unittest.TestCase):
    """One folder for all tests of a class, which overrides make()."""

    folder = None
    worst = {}  # (error, bound) to the largest that was found

    @classmethod
    def make(cls):
        """Writes the models and pages of the class to cls.folder."""

    @classmethod
    def setUpClass(cls):
        FolderTest.folder = pathlib.Path(tempfile.mkdtemp(prefix="vog-web-"))
        cls.addClassCleanup(shutil.rmtree, FolderTest.folder, ignore_errors=True)
        cls.make()

    def refused(self, *arguments):
        """The message of a command that fails."""
        done = command(*arguments)
        self.assertNotEqual(done.returncode, 0, arguments)
        return done.stderr.decode()

    def hold(self, error, found, bound):
        """Expects a named error of at most `bound`; run() prints the largest beside it. PSNRs are negative: less is better."""
        self.worst[error, bound] = max(found, self.worst.get((error, bound), -math.inf))
        self.assertLessEqual(found, bound, error)

    def until(self, expression, seconds=60):
        """Waits until a JavaScript expression holds."""
        self.assertTrue(self.value(f"""new Promise((done) => {{
            const end = performance.now() + {1000 * seconds};
            const ask = () => ({expression}) ? done(true) : performance.now() > end ? done(false) : setTimeout(ask, 20);
            ask();
        }})"""), expression)


class PageTest(FolderTest):
    """Tests of a page; all tests of a process share one browser, which run() closes."""

    browser = None

    @classmethod
    def setUpClass(cls):
        if not find_chromium():
            raise unittest.SkipTest("no Chromium here (scripts/install-deps.sh installs it)")
        super().setUpClass()
        PageTest.browser = PageTest.browser or Browser()

    def setUp(self):
        self.browser.viewport(WIDTH, HEIGHT, 0.5)
        self.browser.prefer()

    def tearDown(self):
        complaints = list(self.browser.complaints)
        self.browser.leave()
        self.assertEqual(complaints, [], "the page's console is not silent")

    def open(self, page="page.html", fragment="#subframes=1"):
        self.browser.open(self.folder / page, fragment)
        self.browser.settle()

    def before_pages(self, script):
        """Runs a script in each page before its own, until the test ends."""
        made = self.browser.call("Page.addScriptToEvaluateOnNewDocument", source=script)
        self.addCleanup(self.browser.call, "Page.removeScriptToEvaluateOnNewDocument", identifier=made["identifier"])

    def value(self, expression):
        return self.browser.evaluate(expression)

    def picture(self, name="web.png"):
        self.browser.picture(self.folder / name)
        return name

    def bytes(self):
        return (self.folder / self.picture()).read_bytes()

    def write_camera(self):
        """Writes camera.json, the page's camera; returns the picture's size."""
        state = self.value("({camera: vog.state.camera, width: vog.canvas.width, height: vog.canvas.height})")
        camera, width, height = state["camera"], state["width"], state["height"]
        # The page's field of view is that of the shorter side, vog render's that of the height.
        tall = max(1, height / width)
        fov = 2 * math.degrees(math.atan(tall * math.tan(math.radians(camera["fov"]) / 2)))
        lens = ({"orthographic_width": camera["span"] * width / min(width, height)} if camera.get("span")
                else {"fov_degrees": fov})
        (self.folder / "camera.json").write_text(json.dumps(
            {"eye": camera["eye"], "look_at": camera["at"], "up": camera["up"], **lens}))
        return width, height

    def render(self, model="fine.ply", *more, tf="gray"):
        """Picture of vog render with the page's camera and extinction."""
        width, height = self.write_camera()
        state = self.value("({exposure: vog.state.exposure,"
                           " extinction: vog.page.models[vog.state.model].extinction})")
        vog("render", model, "-o", "cpu.png", "--camera", "camera.json", "--tf", tf, "--size",
            f"{width}x{height}", "--extinction", repr(state["extinction"] * state["exposure"]), *more)
        return "cpu.png"

    def psnr(self, a, b):
        found = json.loads(vog("compare", a, b, "--json"))["psnr_rgb_db"]
        return math.inf if found is None else found

    def expect_same(self, *arguments, least=LEAST_PSNR_DB, **more):
        """Expects the page's picture to equal that of vog render."""
        self.picture()  # first, so that the state is the one that was drawn
        self.hold("-PSNR of T [dB]", -self.psnr(self.render(*arguments, **more), "web.png"), -least)


def run(*names):
    """Runs the tests of the script, or those of some names of modules or tests; exits with 77 where all are skipped."""
    try:
        named = {"module": None, "argv": [sys.argv[0], *names]} if names else {}
        result = unittest.main(exit=False, **named).result
    finally:
        if PageTest.browser:
            PageTest.browser.__exit__()
        for (error, bound), found in sorted(FolderTest.worst.items()):
            print(f"{error}: at most {found:.4g}, bound {bound:.4g}")
    if result.testsRun == 0 or (result.testsRun == len(result.skipped) and result.wasSuccessful()):
        for _, reason in result.skipped:
            print(f"skipped: {reason}", file=sys.stderr)
        sys.exit(77 if result.skipped else 1)
    sys.exit(not result.wasSuccessful())
