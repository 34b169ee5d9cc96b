#!/usr/bin/env python3
"""Times of the page's modes against each other: visibility, column density, mean and maximum of a field, volume by value without and with
light.

usage: bench/page_modes.py VOG MODEL.ply [--size 640x480] [--rounds 5] [--frames 3]

Opens the page of a model in headless Chromium, whose GPU is software (Mesa's llvmpipe), checks each mode's picture against that
of the command, then draws frames under a camera that turns by a degree each: the modes in turn, so that all share the
machine's other load. A frame is from the change to the GPU's end of it. Prints medians over the rounds and their ratios to
visibility, with the least and the largest ratio of a round.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests/web"))
from browser import Browser

# A frame, ms: the camera turns about the view's up axis.
FRAME = """(async () => {
    const { eye, at, up } = vog.state.camera, c = Math.cos(Math.PI / 180), s = Math.sin(Math.PI / 180);
    const v = eye.map((e, k) => e - at[k]), along = v.reduce((sum, e, k) => sum + e * up[k], 0);
    const across = [0, 1, 2].map((k) => up[(k + 1) % 3] * v[(k + 2) % 3] - up[(k + 2) % 3] * v[(k + 1) % 3]);
    const turned = at.map((a, k) => a + c * v[k] + s * across[k] + (1 - c) * along * up[k]);
    const start = performance.now();
    vog.change({ camera: { ...vog.state.camera, eye: turned } });
    await vog.settled();
    return performance.now() - start;
})()"""
MOST_WRONG = 0.01  # share of pixels off by more than 4 of 255: Gaussians near a pixel's size are at sharp limits (docs/web.md)


def modes_of(field):
    """Name: (change of the page's state, options of the command); scales and transfer function fixed."""
    low, high = field["lower"], field["upper"]
    ramp = {"name": "ramp", "unit": 1, "colors": [[low, 0, 0, 0.2], [high, 1, 0.9, 0.3]], "opacity": [[low, 0], [high, 0.3]]}
    scale = {"low": low, "high": high, "log": False}
    values = ("--range", f"{low!r},{high!r}")
    volume = ("--show", "volume", "--tf", "tf.json")
    return ramp, {
        "visibility": ({"show": "T"}, ()),
        "column density": ({"show": "column", "scale": {**scale, "low": 0, "high": 50}}, ("--show", "column", "--range", "0,50")),
        "mean of the field": ({"show": "mean", "field": 0, "scale": scale},
                              ("--show", "mean", "--field", field["name"], *values)),
        "maximum of the field": ({"show": "maximum", "field": 0, "scale": scale},
                                 ("--show", "maximum", "--field", field["name"], *values)),
        "volume": ({"show": "volume", "transfers": {"0": ramp}}, volume),
        "volume, lit": ({"show": "volume", "transfers": {"0": ramp}, "light": True}, (*volume, "--light", "head")),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("vog")
    parser.add_argument("model")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--frames", type=int, default=3, help="of a mode in a round")
    given = parser.parse_args()
    command, model = pathlib.Path(given.vog).resolve(), pathlib.Path(given.model).resolve()
    with tempfile.TemporaryDirectory() as name, Browser(timeout_s=600) as browser:
        folder = pathlib.Path(name)

        def vog(*arguments):
            return subprocess.run([command, *arguments], cwd=folder, check=True, capture_output=True, text=True).stdout

        vog("page", str(model), "-o", "page.html", "--set", "levels=1")
        browser.viewport(*map(int, given.size.split("x")))
        browser.open(folder / "page.html", "#subframes=1&embed&tf=gray")
        browser.settle()
        page = browser.evaluate("vog.page.models[0]")
        ramp, modes = modes_of(page["fields"][0])
        light = browser.evaluate("vog.state.light")
        (folder / "tf.json").write_text(json.dumps(
            {"domain": [ramp["colors"][0][0], ramp["colors"][-1][0]], "unit_distance": 1, "colors": ramp["colors"],
             "opacity": ramp["opacity"]}))
        camera = browser.evaluate("vog.state.camera")
        (folder / "camera.json").write_text(json.dumps(
            {"eye": camera["eye"], "look_at": camera["at"], "up": camera["up"], "fov_degrees": camera["fov"]}))

        def select(state):
            state = {**state, "light": {**light, "on": state.get("light", False)}}
            browser.evaluate(f"vog.change({json.dumps(state)})")
            browser.settle()

        for title, (state, options) in modes.items():
            select(state)
            browser.picture(folder / "page.png")
            colors = () if "--tf" in options else ("--tf", "gray")
            vog("render", str(model), "-o", "cpu.png", "--camera", "camera.json", "--size", given.size, *colors, *options,
                *(("--extinction", repr(page["extinction"])) if not options else ()))
            wrong = json.loads(vog("compare", "cpu.png", "page.png", "--json"))["off_by_more_than_4"]
            if wrong > MOST_WRONG:
                sys.exit(f"{title}: {100 * wrong:.2g} % of the pixels are not the command's")
        times = {title: [] for title in modes}
        for turn in range(given.rounds):
            for title, (state, _) in modes.items():
                select(state)  # draws the first frame, too: shaders, tables
                times[title].append(statistics.median(browser.evaluate(FRAME) for _ in range(given.frames)))
                print(f"round {turn + 1} of {given.rounds}: {title} {times[title][-1]:.0f} ms", file=sys.stderr, flush=True)
        print(f"{page['levels'][0]['count']:,} Gaussians, {given.size}")
        for title, found in times.items():
            ratios = [mode / first for mode, first in zip(found, times["visibility"])]
            print(f"{title:<18} {statistics.median(found):7.0f} ms   {statistics.median(ratios):5.2f}"
                  f"   ({min(ratios):.2f} to {max(ratios):.2f})")


if __name__ == "__main__":
    main()
