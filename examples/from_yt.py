#!/usr/bin/python3
"""Converts all levels of an AMR data set that yt reads to one model, without intermediate files.

    apt install python3-yt                        # Debian 12
    examples/from_yt.py                           # sample data: two levels
    examples/from_yt.py DD0010/DD0010 -o out.png --field density

For patch-based codes (Enzo, FLASH, Athena, Boxlib). examples/enzo_to_vdb.py handles octree codes too, and
writes files.
"""
import argparse
import sys

import numpy as np

import vog

try:
    import yt
except ImportError as error:
    sys.exit(f"from_yt: {error}; on Debian: apt install python3-yt")


def blobs():
    """Two levels: a coarse cloud with a refined centre."""

    def density(left, right, cells):
        axes = [np.linspace(l, r, n, endpoint=False) + (r - l) / n / 2 for l, r, n in zip(left, right, cells)]
        x, y, z = np.meshgrid(*axes, indexing="ij")
        return np.exp(-30 * ((x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2)) * (1.5 + np.sin(40 * x * y + 30 * z))

    patches = [([0, 0, 0], [1, 1, 1], 0), ([0.25] * 3, [0.75] * 3, 1)]
    grids = []
    for left, right, level in patches:
        grids.append(dict(left_edge=left, right_edge=right, level=level, dimensions=[32] * 3))
        grids[-1][("stream", "density")] = (density(left, right, [32] * 3), "code_mass/code_length**3")
    return yt.load_amr_grids(grids, [32] * 3)


def levels_of(ds, field):
    """Every level as a Volume with all its cells; in vog, finer levels hide coarser ones."""
    left = ds.domain_left_edge.in_units("code_length").d
    for level in range(ds.index.max_level + 1):
        edge = ds.domain_width.in_units("code_length").d / ds.domain_dimensions / ds.refine_by**level
        blocks = []
        for grid in ds.index.select_grids(level):
            first = np.rint((grid.LeftEdge.in_units("code_length").d - left) / edge).astype(int)
            # In code units, as values in g/cm^3 are below the range of single precision.
            blocks.append((first, grid[field].in_base("code").d))
        # The centre of the first voxel lies half a cell inside the domain.
        yield vog.Volume.from_blocks(blocks, voxel_size=edge, origin=left + edge / 2, all_active=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", nargs="?", help="data set for yt.load; default: a sample with two levels")
    parser.add_argument("-o", "--output", default="yt.png", help="picture to write")
    parser.add_argument("--field", default="density", help="name of a yt field (default: density)")
    arguments = parser.parse_args()

    yt.set_log_level("error")
    ds = yt.load(arguments.dataset) if arguments.dataset else blobs()
    levels = vog.Levels(levels_of(ds, ("gas", arguments.field)))
    model = vog.convert(levels)
    print(levels, model.summary)
    vog.render(model).shade("jet").save(arguments.output)


if __name__ == "__main__":
    main()
