#!/usr/bin/python3
"""AMR data that yt reads (Enzo, FLASH, Athena, Boxlib, RAMSES, ...) as one OpenVDB file a level.

    apt install python3-yt python3-openvdb          # Debian 12
    examples/enzo_to_vdb.py DD0010/DD0010 -o out    # out/level0.vdb, out/level1.vdb, ...
    vog render out/level*.vdb -o picture.png --tf jet

Every cell of a level is written, also where a finer level lies over it: vog lets the finest count.
Cells are voxels of the whole domain's lattice, so that all levels share one world: the domain is the
unit cube along its longest edge. Ghost cells are not written.
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
    """(first index, values) of each patch of a level: codes whose mesh is made of grids."""
    left = ds.domain_left_edge.in_units("code_length")
    for grid in ds.index.select_grids(level):
        first = np.rint(((grid.LeftEdge.in_units("code_length") - left) / grid.dds.in_units("code_length")).d)
        yield first.astype(int), grid[field]


def blocks_of_cells(ds, field, level):
    """The same for octree codes, where a block is one cell. Only leaf cells exist there."""
    data = ds.all_data()
    here = data["index", "grid_level"].d.astype(int) == level
    left = ds.domain_left_edge.in_units("code_length").d
    edge = [data["index", f"d{axis}"].in_units("code_length").d[here] for axis in "xyz"]
    at = [data["index", axis].in_units("code_length").d[here] for axis in "xyz"]
    index = np.stack([np.floor((a - l) / e) for a, l, e in zip(at, left, edge)], axis=1).astype(int)
    values = data[field][here]
    for first, value in zip(index, values):
        yield first, value.reshape(1, 1, 1)


def level_grid(ds, field, units, level, has_grids):
    """One level as a FloatGrid in world units; None if it has no cells."""
    grid = vdb.FloatGrid()
    cells = 0
    for first, values in (blocks_of_grids if has_grids else blocks_of_cells)(ds, field, level):
        # The code's own units keep numbers within a float's range: g/cm^3 would not.
        values = np.ascontiguousarray((values.in_units(units) if units else values.in_base("code")).d, np.float32)
        if values.min() > 0:
            # copyFromArray leaves values equal to the background inactive: 0, which is none here.
            grid.copyFromArray(values, ijk=tuple(int(i) for i in first))
        else:
            accessor = grid.getAccessor()
            for offset in np.ndindex(values.shape):
                index = tuple(int(i) for i in first + offset)
                accessor.setValueOn(index, max(float(values[offset]), 0.0))
        cells += values.size
    if cells == 0:
        return None, 0
    width = ds.domain_width.in_units("code_length").d
    across = ds.domain_dimensions * ds.refine_by**level
    edge = width / width.max() / across
    # Voxel i is centred on i in OpenVDB: the first cell's centre is half a cell into the domain.
    matrix = np.diag([*edge, 1.0])
    matrix[3, :3] = 0.5 * edge
    grid.transform = vdb.createLinearTransform(matrix.tolist())
    grid.gridClass = vdb.GridClass.FOG_VOLUME
    return grid, cells


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", help="what yt.load takes: a parameter file or a folder")
    parser.add_argument("-o", "--output", default=".", help="folder for level0.vdb, level1.vdb, ...")
    parser.add_argument("--field", default="density", help="a yt field (default: density)")
    parser.add_argument("--field-type", default="", help="its type: gas (the default), enzo, flash, ...")
    parser.add_argument("--units", default="", help="units of the values; default: the code's own")
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
        field = ds.field_info[field].alias_name  # as it was stored: no units to and fro
    os.makedirs(arguments.output, exist_ok=True)
    has_grids = len(getattr(ds.index, "grids", ())) > 0
    for level in range(ds.index.max_level + 1):
        grid, cells = level_grid(ds, field, arguments.units, level, has_grids)
        if grid is None:
            continue
        grid.name = arguments.field
        path = os.path.join(arguments.output, f"level{level}.vdb")
        vdb.write(path, grids=[grid])
        print(f"{path}: {cells} cells")


if __name__ == "__main__":
    main()
