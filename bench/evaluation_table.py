#!/usr/bin/env python3
"""Prints one Markdown table per evaluation, in the form of docs/evaluation.md.

usage: bench/evaluation_table.py [--all] FOLDER...      output folders of vog evaluate
--all: prints every row; default: the paper's finest and coarsest levels, and moments with the counts of
2, 4 and 8 voxels
"""
import json
import pathlib
import sys

SHORT = {"mean": ("lod1", "lod5"), "mass": ("lod1", "lod5"), "uniform": ("block2", "block4", "block8"),
         "adaptive": ("block2", "block4", "block8", "lod5", "default")}
COLUMNS = ["row", "Gaussians", "of active voxels", "V, dB", "mean", "worst", "covered: mean", "worst",
           "L2 of T", "mean", "bias"]


def name_of(row):
    series = {"mean": "paper", "mass": "paper, mass conserved", "uniform": "moments, uniform cells",
              "adaptive": "moments, adaptive"}.get(row["series"], row["series"])
    step = row["step"].replace("lod", "LOD ").replace("sigma", "LOD 3, boxes of σ = ")
    if step.startswith("block"):
        step = ("" if row["series"] == "uniform" else "count of ") + step[5:] + "³"
    elif row["series"] == "adaptive" and step.startswith("LOD"):
        step = "count of " + step
    return f"{series}, {step}"


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


def main(folders, every_row):
    for folder in folders:
        results = json.loads((pathlib.Path(folder) / "results.json").read_text())
        active = results["data"]["active_voxels"]
        print(f'\n#### {results["data"]["title"]}, {active:,} active voxels\n')
        print("| " + " | ".join(COLUMNS) + " |")
        print("|" + "---|" * len(COLUMNS))
        for row in results["rows"]:
            if every_row or row["step"] in SHORT.get(row["series"], ()):
                print("| " + " | ".join(cells_of(row, active)) + " |")


if __name__ == "__main__":
    arguments = sys.argv[1:]
    every_row = "--all" in arguments
    folders = [argument for argument in arguments if argument != "--all"]
    if not folders:
        sys.exit(__doc__)
    main(folders, every_row)
