#!/usr/bin/python3
"""Converts AMR data that yt reads (Enzo, FLASH, Athena, Boxlib, RAMSES, ...) to one OpenVDB file per level.

    apt install python3-yt python3-openvdb          # Debian 12
    examples/enzo_to_vdb.py DD0010/DD0010 -o out    # out/level0.vdb, out/level1.vdb, ...
    vog render out/level*.vdb -o picture.png --tf jet

Every cell of a level is written, also where finer levels cover it: in vog, finer levels hide coarser ones.
All levels share one world space, in which the longest edge of the domain has length 1. Ghost cells are
not written.
"""
import argparse
import os
import sys

import numpy as np

try:
    import pyopenvdb as vdb
    import yt
except ImportError as error:
    sys.exit(f"enzo_to_vdb: {error}; on Debian: apt install python3-yt python3-openvdb")


def blocks_of_grids(ds, field, level):
    """(index of the first cell, values) of each patch of a level, for patch-based codes."""
    left = ds.domain_left_edge.in_units("code_length")
    for grid in ds.index.select_grids(level):
        first = np.rint(((grid.LeftEdge.in_units("code_length") - left) / grid.dds.in_units("code_length")).d)
        yield first.astype(int), grid[field]


def blocks_of_cells(ds, field, level):
    """The same for octree codes, where a block is one leaf cell."""
    data = ds.all_data()
    here = data["index", "grid_level"].d.astype(int) == level
    left = ds.domain_left_edge.in_units("code_length").d
    edge = [data["index", f"d{axis}"].in_units("code_length").d[here] for axis in "xyz"]
    at = [data["index", axis].in_units("code_length").d[here] for axis in "xyz"]
    index = np.stack([np.floor((a - l) / e) for a, l, e in zip(at, left, edge)], axis=1).astype(int)
    values = data[field][here]
    for first, value in zip(index, values):
        yield first, value.reshape(1, 1, 1)


def checked(values, first, rules, changed):
    """The values as densities: negative or non-finite ones are refused unless `rules` accept them, and counted.
    Returns values and a mask of the cells to write."""
    finite = np.isfinite(values)
    negative = finite & (values < 0)
    for bad, rule, what in ((~finite, "skip_nonfinite", "not finite"), (negative, "clip_negative", "negative")):
        if not bad.any():
            continue
        if not getattr(rules, rule):
            index = first + np.argwhere(bad)[0]
            sys.exit(f"enzo_to_vdb: {rules.dataset}: {bad.sum()} values of '{rules.field}' in a block are {what}, "
                     f"the first at cell {index.tolist()}, expected densities (--{rule.replace('_', '-')})")
        changed[rule] += int(bad.sum())
    return np.where(negative, np.float32(0), values), finite


def level_grid(ds, field, units, level, has_grids, rules, changed):
    """One level as a FloatGrid in world units, and its number of cells; None without cells."""
    grid = vdb.FloatGrid()
    cells = 0
    for first, values in (blocks_of_grids if has_grids else blocks_of_cells)(ds, field, level):
        # In code units, as values in g/cm^3 are below the range of single precision.
        values = np.ascontiguousarray((values.in_units(units) if units else values.in_base("code")).d, np.float32)
        values, finite = checked(values, first, rules, changed)
        if finite.all() and values.min() > 0:
            # copyFromArray leaves voxels of the background value 0 inactive; there are none here.
            grid.copyFromArray(values, ijk=tuple(int(i) for i in first))
        else:
            accessor = grid.getAccessor()
            for offset in np.argwhere(finite):
                index = tuple(int(i) for i in first + offset)
                accessor.setValueOn(index, float(values[tuple(offset)]))
        cells += int(finite.sum())
    if cells == 0:
        return None, 0
    width = ds.domain_width.in_units("code_length").d
    across = ds.domain_dimensions * ds.refine_by**level
    edge = width / width.max() / across
    # OpenVDB centres voxel i on index i: the first cell's centre lies half a cell inside the domain.
    matrix = np.diag([*edge, 1.0])
    matrix[3, :3] = 0.5 * edge
    grid.transform = vdb.createLinearTransform(matrix.tolist())
    grid.gridClass = vdb.GridClass.FOG_VOLUME
    return grid, cells


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", help="data set for yt.load: a parameter file or a folder")
    parser.add_argument("-o", "--output", default=".", help="folder to write level0.vdb, level1.vdb, ... into (default: the current one)")
    parser.add_argument("--field", default="density", help="name of a yt field (default: density)")
    parser.add_argument("--field-type", default="", help="type of the field: gas (the default), enzo, flash, ...")
    parser.add_argument("--units", default="", help="units of the values; default: code units")
    parser.add_argument("--clip-negative", action="store_true", help="set negative values to 0, which are an error otherwise")
    parser.add_argument("--skip-nonfinite", action="store_true", help="leave out cells with NaN or infinite values, which are an error otherwise")
    arguments = parser.parse_args()

    yt.set_log_level("error")
    try:
        ds = yt.load(arguments.dataset)
    except (OSError, yt.utilities.exceptions.YTException) as error:
        sys.exit(f"enzo_to_vdb: {arguments.dataset}: {error}")
    field = (arguments.field_type or "gas", arguments.field)
    if field not in ds.derived_field_list:
        known = sorted({name for _, name in ds.derived_field_list})
        sys.exit(f"enzo_to_vdb: {arguments.dataset}: no field {field} (it has: {', '.join(known)})")
    if not arguments.units and ds.field_info[field].is_alias:
        field = ds.field_info[field].alias_name  # the stored field: no conversion of units
    os.makedirs(arguments.output, exist_ok=True)
    has_grids = len(getattr(ds.index, "grids", ())) > 0
    for level in range(ds.index.max_level + 1):
        changed = {"clip_negative": 0, "skip_nonfinite": 0}
        grid, cells = level_grid(ds, field, arguments.units, level, has_grids, arguments, changed)
        if grid is None:
            continue
        grid.name = arguments.field
        path = os.path.join(arguments.output, f"level{level}.vdb")
        vdb.write(path, grids=[grid])
        print(f"{path}: {cells} cells")
        if changed["clip_negative"]:
            print(f"{path}: {changed['clip_negative']} negative values of '{arguments.field}' set to 0", file=sys.stderr)
        if changed["skip_nonfinite"]:
            print(f"{path}: {changed['skip_nonfinite']} values of '{arguments.field}' not finite left out", file=sys.stderr)


if __name__ == "__main__":
    main()
