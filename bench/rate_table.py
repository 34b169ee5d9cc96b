#!/usr/bin/env python3
"""Tables of docs/evaluation.md, "Bytes and error": bytes of each series at equal error, in kB.

usage: bench/rate_table.py FOLDER...     folders of vog evaluate --rate-distortion
"""
import json
import math
import sys

V = (36, 40, 43, 46, 48, 51)


def figure(row, function, worst):
    views = row["psnr_v_db"] if function is None else row.get("psnr_rgb_db", {}).get(function)
    if not views:
        return None
    values = [math.inf if value is None else value for value in views.values()]
    return min(values) if worst else sum(values) / len(values)


def bytes_at(rows, decibels, function=None, worst=False):
    """As vog::bytes_at: geometric between two files of a curve, else the least file that is near enough."""
    points = sorted((row["bytes"], figure(row, function, worst)) for row in rows)
    graded = all(row["tolerance"] or row["gaussians"] for row in rows)
    for n, (size, value) in enumerate(points):
        if value < decibels:
            continue
        if n == 0 or not graded or math.isinf(value):
            return size
        before, lower = points[n - 1]
        return math.exp(math.log(before) + (decibels - lower) / (value - lower) * math.log(size / before))
    return None


def text(size):
    return "–" if size is None else f"{size / 1000:.3g}" if size < 1e6 else f"{size / 1000:,.0f}"


def line(name, cells):
    return f"| {name} | " + " | ".join(cells) + " |"


for folder in sys.argv[1:]:
    with open(f"{folder}/rate_distortion.json", encoding="utf-8") as file:
        results = json.load(file)
    series = {}
    for row in results["rows"]:
        series.setdefault(row["series"], []).append(row)
    print(f"\n#### {results['title']}, {results['active_voxels']:,} active voxels\n")
    heads = [f"V {db} dB" for db in V] + [f"worst view {db} dB" for db in (36, 40, 46)]
    heads += ["ramp 38 dB", "bands 34 dB", "step 34 dB"]
    print(line("kB", heads))
    print("|:---|" + "---:|" * len(heads))
    for name, rows in series.items():
        cells = [bytes_at(rows, db) for db in V] + [bytes_at(rows, db, worst=True) for db in (36, 40, 46)]
        by_value = name != "model"
        for function, db in (("ramp", 38), ("bands", 34), ("step", 34)):
            cells.append(bytes_at(rows, db, function) if by_value else None)
        print(line(name, map(text, cells)))
