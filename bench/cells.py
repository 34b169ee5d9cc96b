#!/usr/bin/env python3
"""Conversion of a million tetrahedra beside a million voxels of the same field: processor time, and T beside that of the voxels."""
import time

import numpy as np

import vog

EDGE, VOXELS, SIZE = 55, 100, 256
KUHN = [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]]  # six tetrahedra about a diagonal


def field(place):
    x, y, z = np.moveaxis(place, -1, 0)
    return np.exp(-20 * ((x - 0.5) ** 2 + (y - 0.4) ** 2 + (z - 0.6) ** 2)) * (1.5 + np.sin(20 * x * y + 15 * z))


def lattice(axis):
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1)


def tetrahedra():
    points = lattice(np.linspace(0, 1, EDGE + 1)).reshape(-1, 3)
    number = np.arange(len(points)).reshape((EDGE + 1,) * 3)
    part = [slice(None, -1), slice(1, None)]
    cubes = np.stack([number[part[n & 1], part[n >> 1 & 1], part[n >> 2]].ravel() for n in range(8)], -1)
    corners = cubes[:, KUHN].ravel()
    return vog.Cells(points, corners, np.full(len(corners) // 4, 10), field(points))


def main():
    cells = tetrahedra()
    volume = vog.Volume.from_numpy(field(lattice((np.arange(VOXELS) + 0.5) / VOXELS)), voxel_size=1 / VOXELS, origin=(0.5 / VOXELS,) * 3)
    camera = vog.Camera.paper_view(volume)
    truth = vog.render(volume, camera, SIZE).depth
    cases = {
        "cells, 2 %": (cells, {"budget": len(cells) // 50}), "cells, one Gaussian each": (cells, {"budget": len(cells)}),
        "voxels, 2 %": (volume, {"budget": VOXELS**3 // 50}), "voxels, 2 %, hard": (volume, {"budget": VOXELS**3 // 50, "soft_steps": 0}),
    }  # fmt: skip
    for name, (data, options) in cases.items():
        start = time.process_time()
        model = vog.convert(data, fields=False, **options)
        spent = time.process_time() - start
        shown = vog.render(model, camera, SIZE, extinction=truth.extinction).depth.depth
        error = np.linalg.norm(shown - truth.depth) / np.linalg.norm(truth.depth)
        print(f"{name}: {len(model)} Gaussians, {spent:.2f} s of processor time, relative L2 of T {error:.4f}, mass {model.mass:.7g}")


if __name__ == "__main__":
    main()
