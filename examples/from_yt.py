#!/usr/bin/python3
"""A data set that yt reads, all its levels as one model, without a file between.

    apt install python3-yt                        # Debian 12
    examples/from_yt.py                           # an AMR data set made here
    examples/from_yt.py DD0010/DD0010 -o out.png --field density

Codes whose mesh is made of patches (Enzo, FLASH, Athena, Boxlib). For octree codes, and for files that
other programs read too: examples/enzo_to_vdb.py.
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
    """Two levels: a coarse cloud, and a finer one in its middle."""

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
    """Every level as a Volume. All cells of a level go in: where a finer one is, it counts."""
    left = ds.domain_left_edge.in_units("code_length").d
    for level in range(ds.index.max_level + 1):
        edge = ds.domain_width.in_units("code_length").d / ds.domain_dimensions / ds.refine_by**level
        blocks = []
        for grid in ds.index.select_grids(level):
            first = np.rint((grid.LeftEdge.in_units("code_length").d - left) / edge).astype(int)
            # In the code's own units: grams a cubic centimetre are too small for single precision.
            blocks.append((first, grid[field].in_base("code").d))
        # A voxel's centre lies half a cell into the domain.
        yield vog.Volume.from_blocks(blocks, voxel_size=edge, origin=left + edge / 2, all_active=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", nargs="?", help="what yt.load takes; default: one made here")
    parser.add_argument("-o", "--output", default="yt.png", help="picture to write")
    parser.add_argument("--field", default="density", help="a field of yt's")
    arguments = parser.parse_args()

    yt.set_log_level("error")
    ds = yt.load(arguments.dataset) if arguments.dataset else blobs()
    levels = vog.Levels(levels_of(ds, ("gas", arguments.field)))
    model = vog.convert(levels)
    print(levels, model.reached)
    vog.render(model).shade("jet").save(arguments.output)


if __name__ == "__main__":
    main()
