#!/usr/bin/python3
"""Converts a grid of pyopenvdb in memory, sparse, with its tiles and transform.

    apt install python3-openvdb                   # Debian 12
    examples/from_openvdb.py                      # sample grid: a ball of fog
    examples/from_openvdb.py smoke.vdb -o out.png --grid density

Grids in files need no pyopenvdb: vog.Volume.load reads them. This example is for grids that a script
computes or changes.
"""
import argparse
import pathlib
import sys
import tempfile

import vog

try:
    import pyopenvdb as vdb
except ImportError as error:
    sys.exit(f"from_openvdb: {error}; on Debian: apt install python3-openvdb")


def volume_of(grid):
    """A FloatGrid as a Volume, by way of a file in memory, as the two modules share no types."""
    grid.gridClass = vdb.GridClass.FOG_VOLUME
    shm = pathlib.Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=shm if shm.is_dir() else None) as folder:
        file = pathlib.Path(folder) / "grid.vdb"
        vdb.write(str(file), grid)
        return vog.Volume.load(file)


def ball(radius=40):
    """A ball of fog whose density falls towards its surface."""
    grid = vdb.createLevelSetSphere(radius=radius, halfWidth=radius - 1)
    grid.mapOn(lambda distance: max(-distance, 0.0))
    return grid


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="?", help=".vdb file to read with pyopenvdb; default: a ball of fog")
    parser.add_argument("-o", "--output", default="openvdb.png", help="picture to write")
    parser.add_argument("--grid", default="density", help="name of the grid (default: density)")
    arguments = parser.parse_args()

    grid = vdb.read(arguments.file, arguments.grid) if arguments.file else ball()
    grid.mapOn(lambda value: value * value)  # any change that a script makes
    volume = volume_of(grid)
    model = vog.convert(volume, budget=5000)
    print(volume, model.summary)
    vog.render(model, tf="blue-white", blend=True).save(arguments.output)


if __name__ == "__main__":
    main()
