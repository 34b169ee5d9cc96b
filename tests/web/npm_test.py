"""The npm package of <vog-view> in a page of Vite, its types in TypeScript, and axe-core on pages with it. Needs npm and a registry."""
import shutil
import subprocess
import unittest

from browser import HOUSE
from element_test import MODULE, ElementTest
from page_test_case import run

PEERS = ("vite@5", "typescript@5", "axe-core@4")
SECONDS = 240

PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Of Vite</title><link rel="icon" href="data:,">
<main><h1>Of Vite</h1><vog-view src="../plume.vogz" show="volume" label="A plume"></vog-view></main><script type="module" src="./main.ts"></script></html>"""
MAIN = """import { VogView, type Camera } from 'vog-view';
import address from 'vog-view/vog-view.js?url';

const workers: Worker[] = [];
VogView.worker = () => {
  const made = new Worker(address, { type: 'module', name: 'vog-view' });
  workers.push(made);
  return made;
};
const view: VogView = document.querySelector('vog-view')!;
const end: () => void = view.on('error', ({ message, fatal }) => console.error(message, fatal));
const camera: Camera = { eye: [1, 2, 3], look_at: [0, 0, 0] };
const lines: string[] = view.set({ tf: 'viridis', range: [0, 2], light: 'head' });
view.addEventListener('change', (event) => console.log(event.detail.request.size));
view.addEventListener('click', (event) => console.log(event.clientX));
view.set({ exposure: null, still: null, camera, size: [640, 400] });
const model: number = view.get('model');
const eye: [number, number, number] | undefined = view.camera?.eye;
Object.assign(window, { view, workers, end, camera, lines, eye, model, VogView });
"""
# Each of these lines is wrong, and the types say so.
WRONG = ("view.set({ tiff: 1 });", "view.set({ range: [0] });", "view.show = 'depth';", "view.on('errors', () => {});", "view.picture().width;")


class Npm(ElementTest):
    @classmethod
    def make(cls):
        super().make()
        cls.place = cls.folder / "vite"
        cls.place.mkdir()
        if not shutil.which("npm"):
            raise unittest.SkipTest("no npm here")
        build = MODULE.parents[2]
        packed = cls.call([HOUSE / "scripts/npm.sh", build, cls.place]).strip().splitlines()[-1]
        (cls.place / "package.json").write_text('{"name": "page", "private": true, "type": "module"}')
        try:
            cls.call(["npm", "install", "--no-audit", "--no-fund", "--silent", *PEERS, f"./{packed}"])
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            raise unittest.SkipTest(f"npm installs nothing here: {str(error).strip().splitlines()[-1]}")

    @classmethod
    def call(cls, words, place=None):
        done = subprocess.run(list(map(str, words)), cwd=place or cls.place, capture_output=True, text=True, timeout=SECONDS)
        if done.returncode:
            raise RuntimeError(f"{words}: {done.stdout}{done.stderr}")
        return done.stdout

    def types(self, text):
        (self.place / "main.ts").write_text(text)
        return subprocess.run(["npx", "tsc", "--noEmit", "--strict", "--target", "es2022", "--module", "esnext", "--moduleResolution", "bundler", "--lib",
                               "es2022,dom", "--types", "vite/client", "main.ts"], cwd=self.place, capture_output=True, text=True, timeout=SECONDS)

    def test_a_page_of_vite(self):
        (self.place / "index.html").write_text(PAGE)
        done = self.types(MAIN)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.call(["npx", "vite", "build", "--base", "./", "--logLevel", "error", "--outDir", self.folder / "dist"])
        self.browser.open(self.server.url + "dist/")
        self.until("globalThis.view")
        self.assertGreater(self.value("view.picture().then(({ size }) => size)"), 500)
        self.assertEqual(self.value("[lines, workers.length, view.tf.name, view.show, view.models[0].name]"), [[], 1, "viridis", "volume", "plume"])
        script = max((self.folder / "dist/assets").glob("index-*.js"), key=lambda file: file.stat().st_size)
        self.assertLess(script.stat().st_size, 1.1 * MODULE.stat().st_size)

    def test_types_refuse_what_is_wrong(self):
        for line in WRONG:
            self.assertEqual(self.types(f"{MAIN}{line}\n").stdout.count("error TS"), 1, line)

    def test_axe_finds_nothing(self):
        self.host('<vog-view src="plume.vogz" label="A plume"></vog-view><vog-view src="missing.vogz"></vog-view>')
        self.until("errors().some(({ fatal }) => fatal)")
        self.browser.complaints.clear()
        self.value((self.place / "node_modules/axe-core/axe.min.js").read_text() + ";true")
        for scheme in ("dark", "light"):
            self.browser.prefer(prefers_color_scheme=scheme)
            found = self.value("axe.run().then(({ violations, incomplete, passes }) => [[...violations, ...incomplete].map(({ id, nodes }) => "
                               "[id, nodes.map(({ html }) => html)]), passes.filter(({ nodes }) => nodes.some(({ html }) => html.startsWith('<canvas'))).length > 3])")
            self.assertEqual(found, [[], True])


if __name__ == "__main__":
    run()
