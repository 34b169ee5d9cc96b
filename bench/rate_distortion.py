#!/usr/bin/env python3
"""Bytes and error of one volume: models as .vogz beside its own voxels as .vdb, NanoVDB, ZFP and SZ3 (docs/evaluation.md, "Bytes and error").

    pip install zfpy pysz matplotlib
    PYTHONPATH=build/release/python bench/rate_distortion.py smoke.vdb -o out --size 256

Writes rate_distortion.md (tables), .json, .csv, plots and every file; errors are those of what is read back from the files. Rows of a codec
whose package is missing are left out, with a line that says so. NanoVDB's rows need nanovdb_convert (libnanovdb-tools), plots matplotlib.
"""
import argparse
import csv
import json
import lzma
import math
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np
import vog

VIEWS = ("paper", "+x", "-x", "+y", "-y", "+z", "-z")
FUNCTIONS = ("ramp", "bands", "step")
LEAST_DB, MOST_DB = 35, 58  # PSNR of V, mean of the views: the range of tolerances


def zfp():
    """Fixed accuracy on one array 8 x 8 x 8 N: ZFP's blocks of 4^3 values then lie each in one leaf."""
    import zfpy

    return lambda values, tolerance: zfpy.compress_numpy(values, tolerance=tolerance), lambda data, shape: zfpy.decompress_numpy(data)


def sz3():
    """Absolute bound on the same array."""
    from pysz import sz, szConfig, szErrorBoundMode

    def encode(values, tolerance):
        config = szConfig(values.shape)
        config.errorBoundMode, config.absErrorBound = szErrorBoundMode.ABS, tolerance
        return sz.compress(values, config)[0].tobytes()

    return encode, lambda data, shape: sz.decompress(np.frombuffer(data, np.uint8), np.float32, shape)[0]


def continued(leaves, active):
    """Leaves whose inactive voxels have the mean of neighbours with values in their cube of 4^3, from active voxels outwards: they cost little."""
    split = (-1, 2, 4, 2, 4, 2, 4)
    value, known = (a.reshape(split).transpose(0, 1, 3, 5, 2, 4, 6).reshape(-1, 4, 4, 4).copy() for a in (leaves, active))
    while (known.any((1, 2, 3)) & ~known.all((1, 2, 3))).any():
        total, count = np.zeros_like(value), np.zeros(value.shape, np.float32)
        for axis in (1, 2, 3):
            for to, by in ((slice(1, 4), slice(0, 3)), (slice(0, 3), slice(1, 4))):
                to, by = ((slice(None),) * axis + (part,) for part in (to, by))
                total[to] += value[by] * known[by]
                count[to] += known[by]
        take = ~known & (count > 0)
        value[take] = total[take] / count[take]
        known |= take
    return value.reshape(-1, 2, 2, 2, 4, 4, 4).transpose(0, 1, 4, 2, 5, 3, 6).reshape(-1, 8, 8, 8)


def write_leaves(file, volume, encode, tolerance, masks):
    """Transform, origins and, with masks, active voxels of the leaves of 8^3 voxels without loss, then their values by a codec; both by LZMA.
    Returns the bytes of all but the values."""
    first, last = (np.array(corner) for corner in volume.index_box)
    low, cells = first // 8, last // 8 - first // 8 + 1
    dense = volume.to_numpy(low * 8, cells * 8).reshape(cells[0], 8, cells[1], 8, cells[2], 8).transpose(0, 2, 4, 1, 3, 5)
    cell = np.argwhere(dense.any((3, 4, 5)))
    leaves = dense[tuple(cell.T)]
    active = leaves > 0
    topology = volume.matrix.astype("<f8").tobytes() + np.diff(cell + low, axis=0, prepend=0).T.astype("<i4").tobytes()
    if masks:
        topology += np.packbits(active, axis=None).tobytes()
        leaves = continued(leaves, active)
    topology = lzma.compress(topology, lzma.FORMAT_ALONE)
    values = encode(np.ascontiguousarray(leaves.reshape(-1, 8, 8)), tolerance)
    file.write_bytes(len(topology).to_bytes(8, "little") + topology + lzma.compress(values, lzma.FORMAT_ALONE))
    return 8 + len(topology)


def read_leaves(file, decode, masks):
    """Volume of a file of write_leaves; without masks active is what is decoded above 0."""
    data = file.read_bytes()
    end = 8 + int.from_bytes(data[:8], "little")
    topology = lzma.decompress(data[8:end])
    count = (len(topology) - 128) // (12 + 64 * masks)
    cell = np.frombuffer(topology, "<i4", 3 * count, 128).reshape(3, -1).T.cumsum(0)
    leaves = decode(lzma.decompress(data[end:]), (8 * count, 8, 8)).reshape(-1, 8, 8, 8).clip(0)
    if masks:
        leaves *= np.unpackbits(np.frombuffer(topology, np.uint8, -1, 128 + 12 * count)).reshape(leaves.shape)
    low, cells = cell.min(0), cell.max(0) - cell.min(0) + 1
    dense = np.zeros((*cells, 8, 8, 8), np.float32)
    dense[tuple((cell - low).T)] = leaves
    dense = dense.transpose(0, 3, 1, 4, 2, 5).reshape(cells * 8)
    return vog.Volume.from_numpy(dense, matrix=np.frombuffer(topology, "<f8", 16).reshape(4, 4), first=tuple(int(c) for c in low * 8))


def write_functions(folder, upper, radius):
    """Transfer functions of values from 0 to `upper`, those of vog evaluate --show volume: a ramp, three narrow bands, an opaque step."""

    def bands(q):
        weight = [most * max(0, 1 - abs(q - middle) / half) for most, middle, half in ((0.15, 0.12, 0.05), (0.6, 0.45, 0.08), (2, 0.85, 0.15))]
        return 2 * sum(weight), *(np.dot(weight, ((0.2, 0.5, 1), (1, 0.6, 0.1), (1, 0.95, 0.8))) / max(sum(weight), 1e-30))

    def ramp(q):
        return q, min(1, 3 * q), min(max(3 * q - 1, 0), 1), max(3 * q - 2, 0)

    most = 0.999999  # opacity within vog's largest
    points = {"step": ([[0, 0, 1, 0.5], [upper, 1, 0, 0.5]], [[0, 0], [0.3 * upper, 0], [0.3 * upper, most], [upper, most]])}
    for name, light, count in (("ramp", ramp, 301), ("bands", bands, 1001)):
        rows = [(q * upper, *light(q)) for q in np.linspace(0, 1, count)]
        points[name] = [[v, *color] for v, _, *color in rows], [[v, -math.expm1(-extinction)] for v, extinction, *_ in rows]
    files = {name: folder / f"{name}.json" for name in FUNCTIONS}
    for name, file in files.items():
        colors, opacity = points[name]
        file.write_text(json.dumps({"name": name, "domain": [0, upper], "unit_distance": radius / 12, "colors": colors, "opacity": opacity}))
    return files


class Study:
    """Pictures of the data, and rows of what is measured against them."""

    def __init__(self, volume, folder, arguments):
        self.volume, self.folder, self.size, self.rows = volume, folder, arguments.size, []
        values = volume.to_numpy()
        values = values[values > 0]
        if not values.size:
            sys.exit(f"rate_distortion: {volume.source}: no density above 0")
        self.largest = float(values.max())
        self.functions = write_functions(folder, float(np.quantile(values, 0.999)), np.linalg.norm(np.diff(volume.box, axis=0)) / 2)
        self.cameras = [vog.Camera.orbit(volume.box, view=view, distance=3) for view in VIEWS]
        self.depth, self.colored = self.pictures(volume, True)

    def pictures(self, data, by_value):
        """Optical depth from each view, and pictures by value under each function."""
        scene = vog.Scene(data)
        colored = {}
        for name, file in self.functions.items() if by_value else ():
            colored[name] = [scene.render(camera, self.size, show="volume", tf=file) for camera in self.cameras]
        return [scene.render(camera, self.size) for camera in self.cameras], colored

    def voxel_error(self, other):
        """Relative L2, PSNR over the largest density, mean and worst difference, as `vog evaluate --voxels` has them."""
        corners = np.array([self.volume.index_box, other.index_box])
        first = corners[:, 0].min(0)
        a, b = (v.to_numpy(first, corners[:, 1].max(0) - first + 1).astype(float) for v in (self.volume, other))
        off, count, most = np.abs(b - a), self.volume.active_voxels, a.max()
        squares = (off**2).sum()
        psnr = 20 * math.log10(most / math.sqrt(squares / count)) if squares else math.inf
        return {"relative_l2": math.sqrt(squares / (a**2).sum()), "psnr_db": psnr, "mean": off.sum() / count / most, "worst": off.max() / most}

    def row(self, series, step, file, read, by_value=True, **facts):
        """Row of a file and of `read`, which was read from it."""
        depth, colored = self.pictures(read, by_value)
        voxels = vog.voxelize(read, like=self.volume) if isinstance(read, vog.Gaussians) else read
        row = {"series": series, "step": step, "file": f"files/{file.name}", "bytes": file.stat().st_size, "side_bytes": 0, "gaussians": 0}
        row |= {"tolerance": 0, **facts, "mass_ratio": read.mass / self.volume.mass, "voxels": self.voxel_error(voxels)}
        row["psnr_v_db"] = {view: vog.compare(a, b).grey.psnr_db for view, a, b in zip(VIEWS, self.depth, depth)}
        row["psnr_rgb_db"] = {f: {view: vog.compare(a, b).psnr_db for view, a, b in zip(VIEWS, self.colored[f], colored[f])} for f in colored}
        return row

    def add(self, row):
        self.rows.append(row)
        have = figures(row)
        print(f"{row['series']:17} {row['step']:22} {row['bytes']:12,} V {have['V mean']:6.2f} dB, worst {have['V worst']:6.2f}", flush=True)

    def add_models(self, sizes, max_loss):
        shares = np.geomspace(1 / 4096, 1 / 8, sizes) if sizes > 1 else [1 / 8]
        for series, fields in (("model", False), ("model with values", None)):
            for budget in sorted({max(8, round(self.volume.active_voxels * share)) for share in shares}):
                file = self.file(series, budget, ".vogz")
                model = vog.convert(self.volume, budget=budget, fields=fields)
                model.save(file, max_loss=max_loss, reference=self.volume)
                step = f"{len(model):,} Gaussians"
                self.add(self.row(series, step, file, vog.Gaussians.load(file), fields is None, gaussians=len(model)))

    def add_tolerances(self, series, suffix, write, read, most):
        """Halves a tolerance from the first that gives LEAST_DB to the first that gives MOST_DB."""
        rows = []
        for n in range(-3, 61):  # errors are far below tolerances: larger ones than all densities are of use
            tolerance = self.largest * 2.0**-n
            file = self.file(series, n + 3, suffix)
            side = write(file, tolerance)
            row = self.row(series, f"tolerance {tolerance:.3g}", file, read(file), tolerance=tolerance, side_bytes=side or 0)
            mean = figures(row)["V mean"]
            if not rows and mean < LEAST_DB:
                file.unlink()
                continue
            if rows and (rows[-1]["bytes"], rows[-1]["psnr_v_db"]) == (row["bytes"], row["psnr_v_db"]):
                rows.pop()  # the least number of bits serves several wide tolerances, of which the narrowest stays
            rows.append(row)
            if len(rows) == most or mean >= MOST_DB:
                break
        for row in rows:
            self.add(row)

    def file(self, series, step, suffix):
        return self.folder / "files" / (re.sub("[^a-z0-9]+", "-", f"{series}-{step}".lower()) + suffix)


def figures(row):
    """Figures by which rows compare, dB; larger is better."""
    views = list(row["psnr_v_db"].values())
    named = {"V mean": np.mean(views), "V axes": np.mean(views[1:]), "V worst": min(views), "V paper": views[0]}
    for name, of_views in row["psnr_rgb_db"].items():
        named |= {f"{name} mean": np.mean(list(of_views.values())), f"{name} worst": min(of_views.values())}
    return {name: float(value) for name, value in named.items()} | {"voxels": row["voxels"]["psnr_db"]}


def bytes_at(rows, name, decibels):
    """Bytes of one series at a figure: geometric between two files of a curve, else the least file that is near enough; None: no file is."""
    points = sorted((row["bytes"], figures(row)[name]) for row in rows if name in figures(row))
    curve = all(row["tolerance"] or row["gaussians"] for row in rows)
    for n, (size, value) in enumerate(points):
        if value >= decibels:
            if n == 0 or not curve or math.isinf(value):
                return size
            before, lower = points[n - 1]
            return before * (size / before) ** ((decibels - lower) / (value - lower))
    return None


def table(heads, rows):
    line = lambda cells: "| " + " | ".join(cells) + " |\n"
    return "\n" + line(heads) + "|:---|" + "---:|" * (len(heads) - 1) + "\n" + "".join(map(line, rows))


def equal_error_table(series, columns):
    """Bytes of each series in kB (1000) at figures [(name, dB)]."""
    text = lambda size: "–" if size is None else f"{size / 1000:.3g}" if size < 1e6 else f"{size / 1000:,.0f}"
    heads = ["kB", *(f"{name.removesuffix(' mean')} {decibels} dB" for name, decibels in columns)]
    return table(heads, [[name, *(text(bytes_at(rows, *column)) for column in columns)] for name, rows in series.items()])


def markdown(study, title, series, missing, plots):
    by_figure = lambda *columns: [(name, db) for name, figures in columns for db in figures]
    tables = [by_figure(("V mean", (36, 40, 43, 46, 48, 51)), ("V worst", (36, 40, 46)), ("ramp mean", [38]), ("bands mean", [34]), ("step mean", [34]))]
    tables += [by_figure(("V axes", (40, 46, 51)), ("V paper", (40, 46, 51)), ("voxels", (20, 25, 30, 35, 40, 50)))]
    text = f"# Bytes and error of {title}\n\n{study.volume.active_voxels:,} active voxels, pictures of {study.size}² pixels\n"
    text += "".join(f"\n{line}\n" for line in missing)
    text += "\n## Bytes at equal error\n" + "".join(equal_error_table(series, columns) for columns in tables)
    text += "\n" + "".join(f"![{plot}]({plot})\n" for plot in plots) + "\n## Files\n"
    names = sorted({name for row in study.rows for name in figures(row)}, key=lambda name: name[0] != "V")
    cell = lambda value: "" if value is None else f"{value:.2f}"
    heads = ["file", "step", "bytes", "of them beside", "mass", "voxels L2", *(f"{name}, dB" for name in names)]
    facts = lambda row: [row["series"], row["step"], f"{row['bytes']:,}", f"{row['side_bytes']:,}", f"{row['mass_ratio']:.4f}"]
    l2 = lambda row: f"{row['voxels']['relative_l2']:.4f}"
    return text + table(heads, [[*facts(row), l2(row), *(cell(figures(row).get(name)) for name in names)] for row in study.rows])


def write_plots(folder, title, series):
    """Error over bytes, a line for each series."""
    import matplotlib.pyplot as plt

    files = {"V.svg": "V mean", "V-worst.svg": "V worst", **{f"{f}.svg": f"{f} mean" for f in FUNCTIONS}, "voxels.svg": "voxels"}
    for file, name in files.items():
        figure, axes = plt.subplots(figsize=(8, 5), layout="constrained")
        low, high = (0, 80) if name == "voxels" else (25, 65)
        for one, rows in series.items():
            # Models with and without values are the same Gaussians: of T and of voxels the smaller files count.
            if one == ("model" if name.split()[0] in FUNCTIONS else "model with values"):
                continue
            points = sorted((row["bytes"], figures(row)[name]) for row in rows)
            if points := [point for point in points if low <= point[1] <= high]:
                axes.semilogx(*zip(*points), "o-", markersize=4, label=one)
        axes.set(title=f"{title}: {name}", xlabel="bytes", ylabel="PSNR, dB")
        axes.grid(alpha=0.3)
        axes.legend()
        figure.savefig(folder / file)
        plt.close(figure)
    return list(files)


def write_results(study, title, missing):
    series = {}
    for row in study.rows:
        series.setdefault(row["series"], []).append(row)
    try:
        plots = write_plots(study.folder, title, series)
    except ImportError as error:
        plots = []
        missing.append(f"No plots: {error}.")
    results = {"title": title, "active_voxels": study.volume.active_voxels, "size": study.size, "absent": missing, "rows": study.rows}
    (study.folder / "rate_distortion.json").write_text(json.dumps(results, indent=1).replace(": Infinity", ": null"))
    (study.folder / "rate_distortion.md").write_text(markdown(study, title, series, missing, plots))
    with open(study.folder / "rate_distortion.csv", "w", newline="") as file:
        rows = [{key: value for key, value in row.items() if not isinstance(value, dict)} | figures(row) for row in study.rows]
        writer = csv.DictWriter(file, fieldnames=list(rows[-1]))
        writer.writeheader()
        writer.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("volume")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder to write")
    parser.add_argument("--grid", default="", help="name of the grid")
    parser.add_argument("--size", type=int, default=512, help="pixels along each edge of the pictures")
    parser.add_argument("--model-sizes", type=int, default=10, help="models, of 1/4096 to 1/8 of the active voxels as Gaussians")
    parser.add_argument("--tolerances", type=int, default=10, help="most tolerances of a codec, each half of the one before")
    parser.add_argument("--max-loss", type=float, default=0.1, help="loss of PSNR of V by the rounding of a model's file, dB")
    arguments = parser.parse_args()

    volume, folder = vog.Volume.load(arguments.volume, arguments.grid), arguments.output
    (folder / "files").mkdir(parents=True, exist_ok=True)
    study, missing = Study(volume, folder, arguments), []
    study.add_models(arguments.model_sizes, arguments.max_loss)
    for step in ("float", "half"):
        file = study.file("vdb", step, ".vdb")
        volume.save(file, half=step == "half")
        study.add(study.row("vdb", step, file, vog.Volume.load(file)))
    if shutil.which("nanovdb_convert"):
        base = study.file("vdb", "float", ".vdb")
        convert = lambda file, *codes: subprocess.run(["nanovdb_convert", "-f", "-z", *codes, base, file], check=True)
        for step in ("float", "Fp16", "Fp8", "Fp4"):
            file = study.file("NanoVDB", step, ".nvdb")
            convert(file, *([] if step == "float" else [f"--{step.lower()}"]))
            study.add(study.row("NanoVDB", step, file, vog.Volume.load(file)))
        fpn = lambda file, tolerance: convert(file, "--fpN", "-a", str(tolerance)) and None
        study.add_tolerances("NanoVDB FpN", ".nvdb", fpn, vog.Volume.load, arguments.tolerances)
    else:
        missing.append("No rows of NanoVDB: nanovdb_convert is not on PATH.")
    for name, codec in (("ZFP", zfp), ("SZ3", sz3)):
        try:
            encode, decode = codec()
        except ImportError as error:
            missing.append(f"No rows of {name}: {error}.")
            continue
        for masks, series in ((True, f"{name} and masks"), (False, f"{name}, no masks")):
            write = lambda file, tolerance: write_leaves(file, volume, encode, tolerance, masks)
            study.add_tolerances(series, f".{name.lower()}", write, lambda file: read_leaves(file, decode, masks), arguments.tolerances)
    write_results(study, f"{pathlib.Path(arguments.volume).name} {volume.name}", missing)
    print(*missing, folder / "rate_distortion.md", sep="\n")


if __name__ == "__main__":
    main()
