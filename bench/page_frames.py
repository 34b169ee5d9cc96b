#!/usr/bin/env python3
"""Frames of a page in motion beside whole ones: ratios of their times in software, and what a frame asks of a GPU.

usage: bench/page_frames.py VOG MODEL.ply [--size 480x270] [--rounds 3] [--gpu-size 1920x1080] [--pictures FOLDER]

Opens the page of a model in headless Chromium, whose GPU is software (Mesa's llvmpipe), and turns the camera: whole frames, frames in motion (half
the resolution, half the slabs), these with all slabs, and whole frames that draw behind opaque pixels, too. A frame's time is the CPU's in
the browser's GPU process, which other load of the machine changes little. Prints medians of the ratios to whole frames, the least and
the largest, and the PSNR of a frame in motion from the whole one.

Then counts, from the model and the first view, what a frame of --gpu-size does: line integrals (pixels of all supports, once for every four slabs,
with light two, that a support meets), slabs that are classified, and bytes that these read and write in 32-bit floats.
"""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests/web"))
from browser import Browser

MODES = {"visibility": {"show": "T"}, "mean of the field": {"show": "mean"}, "maximum of the field": {"show": "maximum"},
         "volume": {"show": "volume"}, "lit volume": {"show": "volume", "lit": True}, "dense volume": {"show": "volume", "unit": 0.02},
         "dense volume within": {"show": "volume", "unit": 0.02, "within": True}}

# Before the page's own scripts: draws behind opaque pixels where `all` is true.
BEFORE = """globalThis.all = false;
const enable = WebGL2RenderingContext.prototype.enable;
WebGL2RenderingContext.prototype.enable = function (what) { if (!(all && what === this.DEPTH_TEST)) enable.call(this, what); };"""

TILE = 16  # pixels a side, of tiles.glsl

# The camera turns about its up axis.
SCRIPT = """
const light = vog.state.light, slabs = [...vog.page.slabs], count = document.getElementById('count');
const turned = () => {
  const { eye, at, up } = vog.state.camera, c = Math.cos(Math.PI / 180), s = Math.sin(Math.PI / 180), v = eye.map((e, k) => e - at[k]);
  const along = v.reduce((sum, e, k) => sum + e * up[k], 0), across = [0, 1, 2].map((k) => up[(k + 1) % 3] * v[(k + 2) % 3] - up[(k + 2) % 3] * v[(k + 1) % 3]);
  return { ...vog.state.camera, eye: at.map((a, k) => a + c * v[k] + s * across[k] + (1 - c) * along * up[k]) };
};
/** The end of the next frame. */
const frame = () => new Promise((done) => {
  const told = new MutationObserver(() => { told.disconnect(); done(); });
  told.observe(count, { attributes: true });
});
globalThis.frames = async (n, change) => {
  for (; n > 0; --n) {
    if (change) vog.change({ camera: turned() });
    await frame();
  }
};
/** Keeps the picture in motion, from the first frames on that are no longer whole; or ends that. */
globalThis.moving = async (on) => {
  clearInterval(globalThis.timer);
  if (!on) return vog.settled();
  globalThis.timer = setInterval(() => vog.move(on === 'still' ? { ...vog.state.camera } : turned()), 20);
  await frames(3);
};
const first = vog.state.camera;
globalThis.select = async ({ lit = false, unit = 1, within = false, ...state }, more = 1) => {
  vog.page.slabs = slabs.map((n) => more * n);
  const { center, radius } = vog.page.models[0].box, inside = { ...first, eye: center, at: center.map((v, k) => v + (k === 2 ? radius : 0)) };
  vog.change({ ...state, camera: within ? inside : first, light: { ...light, on: lit }, transfers: {} });
  const { upper, unitDistance } = vog.page.models[0].fields[0];
  if (unit !== 1) vog.change({ transfers: { 0: { name: 'own', colors: [[0, 0.2, 0, 0.5], [upper, 1, 0.9, 0.3]], opacity: [[0, 0], [upper, 0.5]], unit: unit * unitDistance } } });
  await vog.settled();
};
"""


def seconds_of(browser):
    """CPU time of the browser's GPU process, s."""
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes()
            if b"--type=gpu-process" in words and browser.profile.name.encode() in words:
                return sum(map(int, (folder / "stat").read_text().rsplit(")", 1)[1].split()[11:13])) / os.sysconf("SC_CLK_TCK")
        except OSError:
            pass  # a process that has ended
    sys.exit("no GPU process, expected one of Chromium on Linux")


def frame_seconds(browser, frames, moving=False):
    """CPU time of a frame under a turning camera."""
    if moving:
        browser.evaluate("moving(true)")
    before = seconds_of(browser)
    browser.evaluate(f"frames({frames}, {json.dumps(not moving)})")
    took = (seconds_of(browser) - before) / frames
    if moving:
        browser.evaluate("moving(false)")
    return took


def work(model, camera, size, slabs, per_pass, floats):
    """Integrals, slabs classified and bytes of a frame."""
    eye, at, up = (np.array(camera[key], float) for key in ("eye", "at", "up"))
    forward = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(forward, up)
    axes = np.stack([right / np.linalg.norm(right), np.cross(right / np.linalg.norm(right), forward), forward])
    w, x, y, z = model["rotation"].T
    turn = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1).reshape(-1, 3, 3)
    spread = np.einsum("ij,njk,nk->nik", axes, turn, model["scale"])  # of each axis of the camera, along the Gaussian's own
    mean = (model["mean"] - eye) @ axes.T
    per_slope = 0.5 * min(size) / math.tan(math.radians(camera["fov"]) / 2)
    depth = mean[:, 2]
    a, b = (per_slope / depth[:, None] * (spread[:, k] - (mean[:, k] / depth)[:, None] * spread[:, 2]) for k in (0, 1))
    least = 0.3  # pixels^2, of what is drawn
    xx, xy, yy = (a * a).sum(1) + least, (a * b).sum(1), (b * b).sum(1) + least
    pixels = math.pi * model["cutoff"] ** 2 * np.sqrt(np.maximum(xx * yy - xy * xy, 0))
    inside = (depth > 0) & (np.abs(mean[:, 0] / depth) * per_slope < 0.5 * size[0]) & (np.abs(mean[:, 1] / depth) * per_slope < 0.5 * size[1])
    all_pixels = size[0] * size[1]
    if not slabs:
        integrals = pixels[inside].sum()
        return len(mean), integrals, 0, integrals * 2 * 4 * floats + all_pixels * 4 * floats
    reach = model["cutoff"] * np.linalg.norm(spread[:, 2], axis=1)
    low, high = (depth - reach)[inside].min(), (depth + reach)[inside].max()
    edges = [np.clip(np.floor((end - low) / (high - low) * slabs / per_pass), 0, slabs / per_pass - 1) for end in (depth - reach, depth + reach)]
    integrals, passes = (pixels * (edges[1] - edges[0] + 1))[inside].sum(), math.ceil(slabs / per_pass)
    # Pixels that each pass classifies: those of tiles above which Gaussians meet its slabs.
    tiles = [math.ceil(n / TILE) for n in size]
    half_size = model["cutoff"] * np.sqrt(np.stack([xx, yy], -1))
    center = np.stack([0.5 * size[0] + per_slope * mean[:, 0] / depth, 0.5 * size[1] - per_slope * mean[:, 1] / depth], -1)
    first = np.clip(np.floor((center - half_size) / TILE), 0, tiles).astype(int)
    last = np.clip(np.floor((center + half_size) / TILE) + 1, 0, tiles).astype(int)
    nearest, farthest = np.full(tiles, np.inf), np.full(tiles, -np.inf)
    for n in np.flatnonzero(inside):
        above = tuple(slice(*ends) for ends in zip(first[n], last[n]))
        np.minimum(nearest[above], depth[n] - reach[n], out=nearest[above])
        np.maximum(farthest[above], depth[n] + reach[n], out=farthest[above])
    met = [np.floor((end[farthest > 0] - low) / (high - low) * slabs / per_pass) for end in (nearest, farthest)]
    needed = (np.clip(met[1], 0, passes - 1) - np.clip(met[0], 0, passes - 1) + 1).sum() * TILE * TILE
    images = 16 * 4  # bytes of a pixel in the four images of a pass
    # Blending reads and writes; each pass clears its images, and what classifies it reads them and those before.
    return passes * len(mean), integrals, needed * per_pass, integrals * 2 * images + passes * all_pixels * images + needed * (2 * images + 2 * 16)


def read_model(path):
    """Shapes of a model of vog convert: the Gaussians come first, and all their columns are floats."""
    head, body = pathlib.Path(path).read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in head.decode().splitlines()]
    elements = [n for n, words in enumerate(lines) if words[0] == "element"] + [len(lines)]
    names, count = [words[-1] for words in lines[elements[0]:elements[1]] if words[0] == "property"], int(lines[elements[0]][2])
    rows = np.frombuffer(body, np.float32, count * len(names)).reshape(count, -1).astype(float)
    columns = lambda *words: np.stack([rows[:, names.index(word)] for word in words], -1)
    turned = "rot_0" in names
    return {"mean": columns("x", "y", "z"), "scale": columns("scale_0", "scale_1", "scale_2"),
            "rotation": columns("rot_0", "rot_1", "rot_2", "rot_3") if turned else np.tile([1.0, 0, 0, 0], (len(rows), 1)),
            "cutoff": next(float(words[2]) for words in lines if words[:2] == ["comment", "cutoff"])}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("vog")
    parser.add_argument("model")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=2, help="of a kind in a round")
    parser.add_argument("--gpu-size", default="1920x1080")
    parser.add_argument("--pictures", help="folder for pictures of all modes, in motion and at rest")
    parser.add_argument("--modes", default=",".join(MODES), help="separated by commas; empty: counts alone")
    parser.add_argument("--timeout", type=int, default=600)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, Browser(timeout_s=given.timeout) as browser:
        page = pathlib.Path(name) / "page.html"
        subprocess.run([given.vog, "page", given.model, "-o", page, "--set", "levels=1"], check=True, capture_output=True)
        browser.viewport(*map(int, given.size.split("x")))
        browser.call("Page.addScriptToEvaluateOnNewDocument", source=BEFORE)
        browser.open(page, "#subframes=1&embed&tf=inferno")
        browser.settle()
        camera = browser.evaluate("vog.state.camera")
        count = browser.evaluate("vog.page.models[0].levels[0].count")
        browser.evaluate(f"{{{SCRIPT}}}")
        print(f"{count:,} Gaussians, {given.size}: times beside whole frames")
        for title in filter(None, given.modes.split(",")):
            mode, ratios, whole_s = MODES[title], {"in motion": [], "in motion, all slabs": [], "behind opaque pixels, too": []}, []
            for _ in range(given.rounds):
                browser.evaluate(f"select({json.dumps(mode)})")
                whole_s.append(frame_seconds(browser, given.frames))
                ratios["in motion"].append(frame_seconds(browser, 4 * given.frames, True) / whole_s[-1])
                if mode["show"] == "volume":
                    browser.evaluate("(globalThis.all = true, true)")
                    ratios["behind opaque pixels, too"].append(frame_seconds(browser, given.frames) / whole_s[-1])
                    browser.evaluate("(globalThis.all = false, true)")
                if mode["show"] in ("volume", "maximum"):
                    browser.evaluate(f"select({json.dumps(mode)}, 2)")
                    ratios["in motion, all slabs"].append(frame_seconds(browser, 2 * given.frames, True) / whole_s[-1])
            browser.evaluate(f"select({json.dumps(mode)})")
            browser.evaluate("moving('still')")
            pictures = [pathlib.Path(given.pictures or name) / f"{title.replace(' ', '_')}_{which}.png" for which in ("moving", "rest")]
            browser.screenshot(pictures[0])
            browser.evaluate("moving(false)")
            browser.screenshot(pictures[1])
            near = json.loads(subprocess.run([given.vog, "compare", *pictures, "--json"], check=True, capture_output=True, text=True).stdout)
            told = "; ".join(f"{kind} {statistics.median(found):.2f} ({min(found):.2f} to {max(found):.2f})" for kind, found in ratios.items() if found)
            print(f"{title:<21} {1000 * statistics.median(whole_s):6.0f} ms; {told}; {near['psnr_rgb_db'] or math.inf:.1f} dB", flush=True)
    model, size = read_model(given.model), tuple(map(int, given.gpu_size.split("x")))
    half = tuple(n // 2 for n in size)
    print(f"\n{count:,} Gaussians, {given.gpu_size}: vertices, line integrals, slabs of pixels, bytes")
    for title, slabs, per_pass, floats in (("visibility", 0, 0, 1), ("mean of the field", 0, 0, 4), ("volume", 32, 4, 4), ("lit volume", 64, 2, 4)):
        for kind, at, n in (("whole", size, slabs), ("in motion", half, slabs // 2)):
            instances, integrals, classified, bytes_ = work(model, camera, at, n, per_pass, floats)
            print(f"{title:<18} {kind:<10} {4 * instances / 1e6:7.1f} M {integrals / 1e6:9.0f} M {classified / 1e6:8.0f} M {bytes_ / 1e9:8.2f} GB")


if __name__ == "__main__":
    main()
