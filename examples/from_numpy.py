#!/usr/bin/python3
"""Converts a NumPy array of densities to Gaussians, renders it, and measures the error against the voxels.

    examples/from_numpy.py                        # sample array: a trefoil knot
    examples/from_numpy.py density.npy -o out.png --voxel-size 0.1
"""
import argparse

import numpy as np

import vog


def knot(size=96):
    """A thick trefoil knot: densities [size, size, size]."""
    t = np.linspace(0, 2 * np.pi, 600)
    curve = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=1)
    x, y, z = np.meshgrid(*[np.linspace(-4, 4, size)] * 3, indexing="ij")
    nearest = np.full(x.shape, np.inf)
    for a, b, c in curve:
        nearest = np.minimum(nearest, (x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2)
    return np.maximum(1 - nearest / 0.5, 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("array", nargs="?", help=".npy file with an array [x, y, z]; default: a trefoil knot")
    parser.add_argument("-o", "--output", default="numpy.png", help="picture to write")
    parser.add_argument("--voxel-size", type=float, default=1, help="edge of a voxel, world units")
    arguments = parser.parse_args()

    array = np.load(arguments.array) if arguments.array else knot()
    volume = vog.Volume.from_numpy(array, voxel_size=arguments.voxel_size)
    model = vog.convert(volume)
    print(model.summary)

    voxels, gaussians = vog.render(volume), vog.render(model, tf="viridis")
    print(vog.compare(voxels, gaussians))
    gaussians.save(arguments.output)


if __name__ == "__main__":
    main()
