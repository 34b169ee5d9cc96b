#!/usr/bin/env python3
"""Conversion of a million tetrahedra beside a million voxels of the same field: processor time, and T beside that of the function itself.
Where vtk (PyPI) and a display are there, its ray caster of unstructured meshes and its resampling to a lattice, as ParaView has them, stand beside."""
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
    return points, cubes[:, KUHN].ravel()


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


def of_vtk(points, corners):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    mesh, places, cells = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkCellArray()
    places.SetData(numpy_to_vtk(points))
    ends = np.arange(0, len(corners) + 1, 4)
    cells.SetData(*(numpy_to_vtk(numbers, array_type=vtk.VTK_ID_TYPE, deep=True) for numbers in (ends, corners)))
    mesh.SetPoints(places)
    mesh.SetCells(vtk.VTK_TETRA, cells)
    density = numpy_to_vtk(field(points), deep=True)
    density.SetName("density")
    mesh.GetPointData().SetScalars(density)
    return mesh


def resampled(mesh):
    """The mesh at the centres of the voxels, by vtkResampleToImage."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    half = 0.5 / VOXELS
    sampler = vtk.vtkResampleToImage(sampling_dimensions=(VOXELS,) * 3, use_input_bounds=False, sampling_bounds=(half, 1 - half) * 3)
    sampler.SetInputDataObject(mesh)
    sampler.Update()
    return vtk_to_numpy(sampler.GetOutput().GetPointData().GetArray("density")).reshape((VOXELS,) * 3).transpose(2, 1, 0)


def ray_cast(mesh, camera, most):
    """T by vtkUnstructuredGridVolumeRayCastMapper, from opacities of 8 bits up to T = 3, and the time of a second picture in seconds."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    opacity, white = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for value in (0, 3):  # values of the field are below: opacity is extinction per unit of length
        opacity.AddPoint(value, 3 / most * value)
        white.AddRGBPoint(value, 1, 1, 1)
    mapper = vtk.vtkUnstructuredGridVolumeRayCastMapper(image_sample_distance=1, auto_adjust_sample_distances=False)
    mapper.SetRayIntegrator(vtk.vtkUnstructuredGridLinearRayIntegrator())
    mapper.SetInputData(mesh)
    look = vtk.vtkVolumeProperty(shade=False)
    look.SetScalarOpacity(opacity)
    look.SetColor(white)
    volume, view, window = vtk.vtkVolume(mapper=mapper, property=look), vtk.vtkRenderer(), vtk.vtkRenderWindow(off_screen_rendering=True, size=(SIZE, SIZE))
    view.AddVolume(volume)
    window.AddRenderer(view)
    eye = view.GetActiveCamera()
    eye.SetPosition(camera.eye)
    eye.SetFocalPoint(camera.look_at)
    eye.SetViewUp(camera.up)
    eye.SetViewAngle(camera.fov_degrees)
    view.ResetCameraClippingRange()
    window.Render()
    eye.SetPosition(1.000000001 * np.array(camera.eye))
    start = time.perf_counter()
    window.Render()
    spent = time.perf_counter() - start
    grabbed = vtk.vtkWindowToImageFilter(read_front_buffer=False)
    grabbed.SetInput(window)
    grabbed.Update()
    shown = vtk_to_numpy(grabbed.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)[::-1, :, 0]
    return -np.log(1 - np.minimum(shown, 254.5) / 255) * most / 3, spent


def main():
    points, corners = tetrahedra()
    cells = vog.Cells(points, corners, np.full(len(corners) // 4, 10), field(points))
    volume = vog.Volume.from_numpy(field(lattice((np.arange(VOXELS) + 0.5) / VOXELS)), voxel_size=1 / VOXELS, origin=(0.5 / VOXELS,) * 3)
    camera = vog.Camera.paper_view(volume)
    truth = column(camera)
    cases = {
        "cells, 2 %": (cells, {"budget": len(cells) // 50}), "cells, one Gaussian each": (cells, {"budget": len(cells)}),
        "voxels, 2 %": (volume, {"budget": VOXELS**3 // 50}), "voxels, 2 %, hard": (volume, {"budget": VOXELS**3 // 50, "soft_steps": 0}),
    }  # fmt: skip
    def error(shown):
        return f"relative L2 of T {np.linalg.norm(shown - truth) / np.linalg.norm(truth):.4f}"

    def drawn(data):
        return vog.render(data, camera, SIZE, extinction=1).depth.depth

    for name, (data, options) in cases.items():
        start = time.process_time()
        model = vog.convert(data, fields=False, **options)
        spent = time.process_time() - start
        print(f"{name}: {len(model)} Gaussians, {spent:.2f} s of processor time, {error(drawn(model))}, mass {model.mass:.7g}")
    start = time.perf_counter()
    print(f"cells, the default search: {len(vog.convert(cells, fields=False))} Gaussians in {time.perf_counter() - start:.1f} s")
    scene = vog.Scene(cells)
    scene.render(camera, SIZE)
    views = [{"size": SIZE, "extinction": 1}, *({"size": 512, **words} for words in (
        {}, {"show": "mean", "field": "density"}, {"show": "maximum"}, {"show": "slice", "plane": "z=0.6"}, {"show": "volume"}
    ))]  # fmt: skip
    for words in views:
        start = time.perf_counter()
        picture = scene.render(camera, **words)
        spent = time.perf_counter() - start
        print(f"the cells themselves: {words} in {spent:.2f} s" + (f", {error(picture.depth.depth)}" if words["size"] == SIZE else ""))
    try:
        mesh = of_vtk(points, corners)
    except ImportError:
        print("without VTK: needs vtk (pip install vtk)")
        return
    start = time.process_time()
    values = np.ascontiguousarray(resampled(mesh))
    spent = time.process_time() - start
    lattice_of = vog.Volume.from_numpy(values, voxel_size=1 / VOXELS, origin=(0.5 / VOXELS,) * 3)
    print(f"VTK, resampled to {VOXELS}^3 voxels: {spent:.2f} s of processor time, {error(drawn(lattice_of))}; converted to 2 %: "
          f"{error(drawn(vog.convert(lattice_of, budget=VOXELS**3 // 50, fields=False)))}")
    shown, spent = ray_cast(mesh, camera, truth.max())
    print(f"VTK's ray caster: a picture in {spent:.2f} s, {error(shown)}")


if __name__ == "__main__":
    main()
