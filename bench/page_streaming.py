#!/usr/bin/env python3
"""Bytes and memory of a streamed page: first picture, full detail of the first view, of a view zoomed to a hundredth of the distance, and a
flight.

usage: bench/page_streaming.py FOLDER/ [--size 512x512] [--error 1] [--rate kB/s] [--views 40] [--most GAUSSIANS] [--memory MB]
       [--reference VOG MODEL]

Serves a site, or a folder of a page (index.html, vog page MODEL.vogz --from MODEL.vogz) and its compact file, by ranges, on loopback
to headless Chromium, whose GPU is software (Mesa's llvmpipe), one sub-frame a picture. Bytes are those of answers' bodies, uncompressed,
the page's own included. Memory is private memory of the page's process and of the browser's GPU process, the largest of samples every
0.2 s. The flight nears the model to a hundredth of its distance and leaves it, turning by 9 degrees a view, 0.3 s each, as drags do:
frames decide on the error meanwhile. Expects that every view ends within the error or with full memory, and
without a line of error. --reference: also the PSNR of V of the pictures at rest but for the flight's, against vog render of the model
(a site with --tf gray).
"""
import argparse
import base64
import json
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests/web"))
from browser import Browser
from site_server import SiteServer

STATUS = """JSON.stringify({drawn: vog.source.drawn?.count ?? 0, error: vog.source.drawn?.error ?? 0,
    shown: vog.source.cut?.shown ?? 0, full: stream.textContent.includes('full'),
    notice: notice.hidden ? '' : notice.textContent, files: vog.source.requests.flying.size,
    store: vog.source.store.used().bytes})"""
VIEW = """(() => {{
    const {{ eye, at }} = vog.first, v = eye.map((e, k) => {distance} * (e - at[k])), c = Math.cos({angle}), s = Math.sin({angle});
    vog.move({{ ...vog.first, eye: [at[0] + c * v[0] + s * v[2], at[1] + v[1], at[2] + c * v[2] - s * v[0]] }});
}})()"""


def private_mb(browser):
    """Largest private memory of a process of a kind, MB."""
    rows = [line.split(None, 3) for line in subprocess.run(["ps", "-eo", "pid,ppid,args"], capture_output=True, text=True).stdout.splitlines()[1:]]
    family, grown = {str(browser.process.pid)}, True
    while grown:
        more = {row[0] for row in rows if row[1] in family} - family
        family, grown = family | more, bool(more)
    out = {"page": 0, "GPU": 0}
    for row in rows:
        kind = "page" if "--type=renderer" in row[-1] else "GPU" if "--type=gpu-process" in row[-1] else None
        if row[0] not in family or not kind:
            continue
        try:
            lines = pathlib.Path(f"/proc/{row[0]}/smaps_rollup").read_text().splitlines()
        except OSError:
            continue
        out[kind] = max(out[kind], sum(int(line.split()[1]) for line in lines if line.startswith("Private")) // 1000)
    return out


def psnr_db(browser, vog, model, size):
    """PSNR of the page's picture against that of vog render."""
    state = json.loads(browser.evaluate("JSON.stringify({...vog.state.camera, extinction: vog.page.models[vog.state.model].extinction * vog.state.exposure})"))
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        (folder / "page.png").write_bytes(base64.b64decode(browser.evaluate("vog.picture()").partition(",")[2]))
        (folder / "camera.json").write_text(json.dumps({"eye": state["eye"], "look_at": state["at"], "up": state["up"], "fov_degrees": state["fov"]}))
        subprocess.run([vog, "render", model, "-o", folder / "whole.png", "--camera", folder / "camera.json", "--size", size, "--tf", "gray",
                        "--extinction", repr(state["extinction"]), "--pixel-error", "0"], check=True, stdout=subprocess.DEVNULL)
        return json.loads(subprocess.run([vog, "compare", folder / "page.png", folder / "whole.png", "--json"], check=True, capture_output=True).stdout)["psnr_rgb_db"]


class Memory:
    """Largest private memory while a `with` block runs."""

    def __init__(self, browser):
        self.browser, self.most, self.over = browser, {"page": 0, "GPU": 0}, threading.Event()

    def __enter__(self):
        self.thread = threading.Thread(target=self.watch)
        self.thread.start()
        return self

    def watch(self):
        while not self.over.wait(0.2):
            now = private_mb(self.browser)
            self.most = {key: max(self.most[key], now[key]) for key in now}

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("site", type=pathlib.Path)
    parser.add_argument("--size", default="512x512")
    parser.add_argument("--error", type=float, default=1)
    parser.add_argument("--rate", type=float, help="kB/s of each connection; default: as fast as it goes")
    parser.add_argument("--views", type=int, default=40)
    parser.add_argument("--most", type=int)
    parser.add_argument("--memory", type=int)
    parser.add_argument("--reference", nargs=2, metavar=("VOG", "MODEL"))
    options = parser.parse_args()
    limits = "".join(f"&{name}={value}" for name, value in (("most", options.most), ("memory", options.memory)) if value)
    is_site = (options.site / "manifest.json").exists()
    with SiteServer(options.site, ranges=not is_site) as server, Browser(3000) as browser:
        browser.viewport(*map(int, options.size.split("x")))
        server.bytes_per_s = options.rate and int(1000 * options.rate)

        def report(name, sent, began, memory, rests=True):
            now = json.loads(browser.evaluate(STATUS))
            assert not now["notice"] and not browser.complaints, (now["notice"], browser.complaints)
            assert now["error"] <= options.error or now["full"], now
            print(f"{name:20} {(server.sent - sent) / 1e6:7.2f} MB, {len(server.paths)} requests in all, {now['drawn']:9,} Gaussians, error {now['error']:.2f} px, seen {now['shown']:.2f}"
                  f"{' (memory full)' if now['full'] else ''}, {time.monotonic() - began:.1f} s, held {now['store'] / 1e6:.0f} MB, "
                  f"page {memory.most['page']} MB, GPU {memory.most['GPU']} MB"
                  + (f", {psnr_db(browser, *options.reference, options.size):.1f} dB" if options.reference and rests else ""), flush=True)

        began = time.monotonic()
        with Memory(browser) as memory:
            browser.open(server.url, f"#subframes=1&embed&error={options.error}{limits}")
            browser.settle()
        size = lambda path: (options.site / (path[1:] or "index.html")).stat().st_size
        if is_site:
            first = next(n for n, path in enumerate(server.paths) if path.startswith("/chunks/"))
            sizes = [size(path) for path in server.paths[:first + 1]]
        else:  # the header, and the coarsest chunk, whose runs may be two requests
            sizes = [size("/"), *(last + 1 - first for first, last in server.asked[:3])]
        print(f"{'first picture':20} {sum(sizes) / 1e6:7.3f} MB: {', '.join(map(str, sizes))} bytes")
        report("first view", 0, began, memory)
        browser.evaluate("vog.first = vog.state.camera")
        for name, views in (("at a hundredth", [(0.01, 0)]),
                            ("flight", [(0.01 ** (1 - abs(1 - 2 * n / options.views)), 0.157 * n) for n in range(options.views + 1)])):
            sent, began = server.sent, time.monotonic()
            with Memory(browser) as memory:
                for distance, angle in views:
                    browser.evaluate(VIEW.format(distance=distance, angle=angle))
                    time.sleep(0.3)
                browser.settle()
            report(name, sent, began, memory, name != "flight")


if __name__ == "__main__":
    main()
