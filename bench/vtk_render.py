#!/usr/bin/env python3
"""Times VTK's CPU volume mapper (vtkFixedPointVolumeRayCastMapper) on the dense array of a VDB grid.

usage: xvfb-run -a bench/vtk_render.py VOLUME.vdb GRID CAMERA.json SIZE [PICTURE.png]

CAMERA.json is the report of `vog render --json`. Prints one JSON object: render_ms {min, median, max}
of 5 frames after a warm-up, without loading. The mapper takes one sample per voxel edge, interpolates,
maps values to colour and opacity, composites front to back and stops at opaque pixels. The time includes
its final copy to a window. Debian: python3-vtk9 python3-openvdb xvfb.
"""
import json
import os
import statistics
import sys
import time

import numpy
import pyopenvdb
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  implements the window
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401  implements the copy to it
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper


def dense_image(path, name):
    """The grid's active bounding box as vtkImageData in world units, for cubic voxels. Also returns the
    largest value and the edge of a voxel."""
    grid = pyopenvdb.read(path, name)
    low, high = grid.evalActiveVoxelBoundingBox()
    shape = [b - a + 1 for a, b in zip(low, high)]
    array = numpy.zeros(shape, numpy.float32)
    grid.copyToArray(array, ijk=low)
    voxel = grid.transform.voxelSize()
    image = vtkImageData()
    image.SetDimensions(shape)
    image.SetSpacing(voxel)
    image.SetOrigin(grid.transform.indexToWorld(low))
    image.GetPointData().SetScalars(numpy_to_vtk(array.ravel(order="F"), deep=True))
    return image, float(array.max()), min(voxel)


def main():
    path, name, camera_file, size = sys.argv[1:5]
    image, largest, voxel = dense_image(path, name)
    mapper = vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetInteractiveSampleDistance(voxel)
    mapper.SetSampleDistance(voxel)
    mapper.SetImageSampleDistance(1)
    mapper.SetNumberOfThreads(os.cpu_count())
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    opacity.AddPoint(0, 0)
    opacity.AddPoint(largest, 0.3)
    colour.AddRGBPoint(0, 0, 0, 0)
    colour.AddRGBPoint(largest, 1, 1, 1)
    appearance = vtkVolumeProperty()
    appearance.SetScalarOpacity(opacity)
    appearance.SetColor(colour)
    appearance.SetInterpolationTypeToLinear()
    appearance.ShadeOff()
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(appearance)

    window, renderer = vtkRenderWindow(), vtkRenderer()
    window.SetOffScreenRendering(1)
    window.SetSize(int(size), int(size))
    window.AddRenderer(renderer)
    renderer.AddVolume(volume)
    with open(camera_file, encoding="utf-8") as file:
        view = json.load(file)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(view["eye"])
    camera.SetFocalPoint(view["look_at"])
    camera.SetViewUp(view.get("up", [0, 1, 0]))
    camera.SetViewAngle(view.get("fov_degrees", 38.58))
    renderer.ResetCameraClippingRange()

    times = []
    for _ in range(6):
        start = time.perf_counter()
        window.Render()
        times.append(1000 * (time.perf_counter() - start))
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.Update()
    # A black picture would be a wrong one, rendered fast.
    covered = grab.GetOutput().GetScalarRange()[1]
    if covered < 16:
        sys.exit("vtk_render: the picture is black")
    if len(sys.argv) > 5:
        from vtkmodules.vtkIOImage import vtkPNGWriter
        writer = vtkPNGWriter()
        writer.SetFileName(sys.argv[5])
        writer.SetInputConnection(grab.GetOutputPort())
        writer.Write()
    print(json.dumps({"render_ms": {"min": min(times[1:]), "median": statistics.median(times[1:]),
                                    "max": max(times[1:])}, "size": int(size)}))


if __name__ == "__main__":
    main()
