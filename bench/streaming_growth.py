#!/usr/bin/env python3
"""Bytes that views of growing data load: a site repeated as tiles of a cube, of which the manifest alone is made.

usage: bench/streaming_growth.py SITE/ [--tiles 1 2 4 8] [--voxels 132483949]

SITE's rows of chunks, their sizes and boxes, are repeated N x N x N times in a cube as large as one of them: cells are N times smaller.
Groups of up to 2 x 2 x 2 tiles have chunks above them, of the mean size of SITE's own below its coarsest, and twice the error. The page's
own modules (src/web/page/stream/cut.js) choose the chunks of views at one pixel of error, without limits of memory, all that is in view
counted as seen; no chunk is loaded. Runs in headless Chromium.
"""
import argparse
import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests/web"))
from browser import Browser, modules

VIEWS = (("256²", 256, 1), ("512²", 512, 1), ("1024²", 1024, 1), ("512², from 0.3", 512, 0.3), ("512², from 0.1", 512, 0.1))

# Chunks of n x n x n tiles: rows of the format's, without names.
SCRIPT = """
function tiled(root, n) {
  const lower = root.box.slice(0, 3), size = [0, 1, 2].map((k) => root.box[3 + k] - root.box[k]);
  const tile = (row, at) => {
    const place = (p, k) => lower[k] + (at[k] * size[k] + (p - lower[k])) / n;
    return { ...row, error: row.error / n, box: row.box.map((p, i) => place(p, i % 3)), parts: (row.parts ?? []).map((part) => tile(part, at)) };
  };
  const below = root.parts, mean = (of) => Math.round(below.reduce((sum, row) => sum + of(row), 0) / below.length);
  const group = (from, to) => {
    if (from.every((f, k) => to[k] - f === 1)) return tile(root, from);
    const halves = from.map((f, k) => (to[k] - f === 1 ? [[f, to[k]]] : [[f, (f + to[k] + 1) >> 1], [(f + to[k] + 1) >> 1, to[k]]]));
    const parts = halves[0].flatMap((x) => halves[1].flatMap((y) => halves[2].map((z) => group([x[0], y[0], z[0]], [x[1], y[1], z[1]]))));
    const box = [0, 1, 2, 3, 4, 5].map((i) => (i < 3 ? Math.min : Math.max)(...parts.map((part) => part.box[i])));
    const count = mean(({ gaussians }) => gaussians);
    return { nodes: count, gaussians: count, error: 2 * Math.max(...parts.map(({ error }) => error)), box, parts,
      bytes: below[0].bytes.map((_, f) => mean(({ bytes }) => bytes[f])) };
  };
  return group([0, 0, 0], [n, n, n]);
}
function prepared(row, origin, depth, all) {
  const half = [0, 1, 2].map((k) => 0.5 * (row.box[3 + k] - row.box[k]));
  Object.assign(row, { depth, box: { half, center: half.map((h, k) => origin[k] + row.box[k] + h) } });
  all.chunks += 1;
  all.gaussians += row.gaussians - row.nodes;
  all.bytes += row.bytes.reduce((a, b) => a + b);
  for (const part of row.parts) prepared(part, origin, depth + 1, all);
}
function measured(root, origin, camera, views, rowBytes) {
  const all = { chunks: 0, gaussians: 0, bytes: 0 };
  prepared(root, origin, 0, all);
  const ask = { error: 1, room: { bytes: Infinity, gaussians: Infinity }, bytesOf: () => 0, visible: () => 1, isBad: () => false };
  const found = views.map(([, side, distance], n) => {
    const eye = camera.eye.map((e, k) => camera.at[k] + distance * (e - camera.at[k]));
    const began = performance.now(), { chunks } = wantedCut(root, viewOf({ ...camera, eye }, side, side, null), n + 1, ask);
    // A table has two depths of rows.
    const rows = chunks.reduce((sum, { chunk }) => sum + (chunk.divided === n + 1 && chunk.depth % 2 === 0
      ? chunk.parts.reduce((s, part) => s + 1 + part.parts.length, 0) : 0), 0);
    return { chunks: chunks.length, gaussians: chunks.reduce((s, { chunk }) => s + chunk.gaussians, 0), rows: rows * rowBytes,
      bytes: chunks.reduce((s, { chunk }) => s + chunk.bytes[0], 0), ms: performance.now() - began };
  });
  return { all, found };
}
"""


def row_of(folder, row):
    """A row with all below it, from the tables."""
    if "table" in row:
        row["parts"] = json.loads((folder / "chunks" / f"{row['table']}.json").read_text())["parts"]
    return {**{key: row[key] for key in ("nodes", "gaussians", "error", "box", "bytes")}, "parts": [row_of(folder, part) for part in row.get("parts", [])]}


def count_of(row):
    return 1 + sum(count_of(part) for part in row["parts"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("site", type=pathlib.Path)
    parser.add_argument("--tiles", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--voxels", type=int, default=132483949, help="active voxels of the site's data")
    options = parser.parse_args()
    model = json.loads((options.site / "manifest.json").read_text())["models"][0]
    page = (options.site / "index.html").read_text()
    at = page.index('type="application/json"')
    view = json.loads(page[page.index(">", at) + 1:page.index("</script>", at)])["picture"]["camera"]
    camera = {"eye": view["eye"], "at": view["look_at"], "up": view["up"], "fov": view["fov_degrees"], "span": 0}
    root = row_of(options.site, model["root"])
    tables = sum(path.stat().st_size for path in [options.site / "manifest.json", *(options.site / "chunks").glob("*.json")])
    megabytes = lambda count: f"{count / 1e6:.1f} MB"
    with tempfile.TemporaryDirectory() as folder, Browser(600) as browser:
        script = modules("vectors.js", "camera.js", "picture/clip.js", "stream/cut.js") + SCRIPT
        (pathlib.Path(folder) / "page.html").write_text(f"<!doctype html><title>growth</title><script>{script}</script>")
        browser.open(pathlib.Path(folder) / "page.html")
        print(f"| voxels | Gaussians | chunks | bytes | {' | '.join(name for name, *_ in VIEWS)} | rows of the view of 512² | its plan |")
        print(f"|{'---|' * (6 + len(VIEWS))}")
        for tiles in options.tiles:
            found = browser.evaluate(f"measured(tiled({json.dumps(root)}, {tiles}), {json.dumps(model['origin'])}, {json.dumps(camera)}, "
                                     f"{json.dumps(VIEWS)}, {tables / count_of(root)})")
            all_, views = found["all"], found["found"]
            print(f"| {options.voxels * tiles ** 3:.2g} | {all_['gaussians']:,} | {all_['chunks']:,} | {all_['bytes'] / 1e9:.2f} GB | "
                  f"{' | '.join(megabytes(view['bytes']) for view in views)} | {megabytes(views[1]['rows'])} | {views[1]['ms']:.1f} ms |", flush=True)


if __name__ == "__main__":
    main()
