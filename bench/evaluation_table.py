#!/usr/bin/env python3
"""Prints one Markdown table of several evaluations, as docs/evaluation.md holds it.

usage: bench/evaluation_table.py FOLDER...      folders that vog evaluate wrote
"""
import json
import pathlib
import sys

COLUMNS = ["row", "Gaussians", "of active voxels", "V, dB", "mean", "worst", "covered: mean", "worst",
           "L2 of T", "mean", "bias"]


def name_of(row):
    series = {"mean": "paper", "mass": "paper, mass conserved", "uniform": "moments, uniform",
              "adaptive": "moments, adaptive"}.get(row["series"], row["series"])
    return f'{series}, {row["step"]}'


def cells_of(row, active):
    views = row["views"]
    paper = views[0]

    def spread(figure, worst):
        values = [view[figure] for view in views]
        return sum(values) / len(values), worst(values)

    psnr, covered = spread("psnr_v_db", min), spread("psnr_v_covered_db", min)
    l2 = spread("relative_l2", max)
    return [name_of(row), f'{row["gaussians"]:,}', f'{100 * row["gaussians"] / active:.2g} %',
            f'{paper["psnr_v_db"]:.2f}', f"{psnr[0]:.2f}", f"{psnr[1]:.2f}", f"{covered[0]:.1f}",
            f"{covered[1]:.1f}", f'{paper["relative_l2"]:.4f}', f"{l2[0]:.4f}", f'{paper["bias"]:.3f}']


def main(folders):
    for folder in folders:
        results = json.loads((pathlib.Path(folder) / "results.json").read_text())
        active = results["data"]["active_voxels"]
        print(f'\n#### {results["data"]["title"]}, {active:,} active voxels\n')
        print("| " + " | ".join(COLUMNS) + " |")
        print("|" + "---|" * len(COLUMNS))
        for row in results["rows"]:
            print("| " + " | ".join(cells_of(row, active)) + " |")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
