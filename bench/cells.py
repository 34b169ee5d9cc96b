#!/usr/bin/env python3
"""Conversion of a million tetrahedra beside a million voxels of the same field: processor time, and T beside that of the function itself."""
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


def column(camera, steps=400):
    """Integral of the field along the ray through each pixel, by midpoints."""
    eye = np.array(camera.eye)
    forward = (camera.look_at - eye) / np.linalg.norm(camera.look_at - eye)
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    on_screen = ((np.arange(SIZE) + 0.5) / SIZE * 2 - 1) * np.tan(np.radians(camera.fov_degrees) / 2)
    along = forward + on_screen[None, :, None] * right - on_screen[:, None, None] * np.cross(right, forward)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    first = np.minimum(-eye / along, (1 - eye) / along).max(-1)
    last = np.maximum(np.maximum(-eye / along, (1 - eye) / along).min(-1), first)
    middles = ((n + 0.5) / steps for n in range(steps))
    return (last - first) / steps * sum(field(eye + (first + n * (last - first))[..., None] * along) for n in middles)


def main():
    cells = tetrahedra()
    volume = vog.Volume.from_numpy(field(lattice((np.arange(VOXELS) + 0.5) / VOXELS)), voxel_size=1 / VOXELS, origin=(0.5 / VOXELS,) * 3)
    camera = vog.Camera.paper_view(volume)
    truth = column(camera)
    cases = {
        "cells, 2 %": (cells, {"budget": len(cells) // 50}), "cells, one Gaussian each": (cells, {"budget": len(cells)}),
        "voxels, 2 %": (volume, {"budget": VOXELS**3 // 50}), "voxels, 2 %, hard": (volume, {"budget": VOXELS**3 // 50, "soft_steps": 0}),
    }  # fmt: skip
    for name, (data, options) in cases.items():
        start = time.process_time()
        model = vog.convert(data, fields=False, **options)
        spent = time.process_time() - start
        error = np.linalg.norm(vog.render(model, camera, SIZE, extinction=1).depth.depth - truth) / np.linalg.norm(truth)
        print(f"{name}: {len(model)} Gaussians, {spent:.2f} s of processor time, relative L2 of T {error:.4f}, mass {model.mass:.7g}")


if __name__ == "__main__":
    main()
