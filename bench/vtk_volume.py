#!/usr/bin/env python3
"""Volume rendering by value beside VTK's CPU volume mapper: pictures against each other, and times.

usage: xvfb-run -a bench/vtk_volume.py VOG VOLUME.vdb GRID HIGH BUDGET [PICTURES_FOLDER]

The same volume, transfer function, view (`paper`) and size, 1024 x 1024, over black: a ramp of opacity and an opaque step over the
values from 0 to HIGH, unit distance a twelfth of the box's radius (docs/evaluation.md, "Figures of pictures by value"). VTK's mapper
(vtkFixedPointVolumeRayCastMapper) takes one sample per voxel edge and interpolates. vog draws the voxels, constant and
interpolated, and a model of BUDGET Gaussians by splat. PSNR is of RGB with 8 bits. Times are medians of 5 frames, wall and processor
time, VTK and vog in turn; three rounds, each with its ratio. Debian: python3-vtk9 python3-openvdb xvfb.
"""
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

from vtk_render import dense_image

from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume,
                                         vtkVolumeProperty, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper

SIZE, FRAMES, ROUNDS = 1024, 5, 3


def transfer_function(name, high, unit):
    """A vog JSON file's content."""
    if name == "ramp":
        shares = [n / 300 for n in range(301)]
        colors = [[high * q, min(1, 3 * q), min(max(3 * q - 1, 0), 1), min(max(3 * q - 2, 0), 1)] for q in shares]
        opacity = [[high * q, 1 - 2.718281828459045 ** -q] for q in shares]
    else:
        colors = [[0, 0, 1, 0.5], [high, 1, 0, 0.5]]
        opacity = [[0, 0], [0.3 * high, 0], [0.3 * high, 0.9999], [high, 0.9999]]
    return {"domain": [0, high], "unit_distance": unit, "colors": colors, "opacity": opacity}


class Vtk:
    """A window with the volume, from a camera file of vog."""

    def __init__(self, path, grid, camera_file):
        image, _, voxel = dense_image(path, grid)
        mapper = vtkFixedPointVolumeRayCastMapper()
        mapper.SetInputData(image)
        mapper.SetAutoAdjustSampleDistances(0)
        mapper.SetInteractiveSampleDistance(voxel)
        mapper.SetSampleDistance(voxel)
        mapper.SetImageSampleDistance(1)
        mapper.SetNumberOfThreads(os.cpu_count())
        self.appearance = vtkVolumeProperty()
        self.appearance.SetInterpolationTypeToLinear()
        self.appearance.ShadeOff()
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(self.appearance)
        self.window, renderer = vtkRenderWindow(), vtkRenderer()
        self.window.SetOffScreenRendering(1)
        self.window.SetSize(SIZE, SIZE)
        self.window.AddRenderer(renderer)
        renderer.AddVolume(volume)
        view = json.loads(pathlib.Path(camera_file).read_text(encoding="utf-8"))
        camera = renderer.GetActiveCamera()
        camera.SetPosition(view["eye"])
        camera.SetFocalPoint(view["look_at"])
        camera.SetViewUp(view["up"])
        camera.SetViewAngle(view["fov_degrees"])
        renderer.ResetCameraClippingRange()

    def set_transfer(self, tf):
        opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
        before = None
        for value, share in tf["opacity"]:
            # VTK has one point a value: a step is a steep line.
            opacity.AddPoint(value + 1e-6 * tf["domain"][1] if value == before else value, share)
            before = value
        for value, r, g, b in tf["colors"]:
            colour.AddRGBPoint(value, r, g, b)
        self.appearance.SetScalarOpacity(opacity)
        self.appearance.SetColor(colour)
        self.appearance.SetScalarOpacityUnitDistance(tf["unit_distance"])

    def render(self, output):
        """Median wall and processor time of a frame, ms."""
        self.window.Render()
        wall, processor = [], []
        for _ in range(FRAMES):
            start, start_cpu = time.perf_counter(), time.process_time()
            self.window.Render()
            wall.append(1000 * (time.perf_counter() - start))
            processor.append(1000 * (time.process_time() - start_cpu))
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.Update()
        if grab.GetOutput().GetScalarRange()[1] < 16:
            sys.exit("vtk_volume: the picture is black")
        writer = vtkPNGWriter()
        writer.SetFileName(output)
        writer.SetInputConnection(grab.GetOutputPort())
        writer.Write()
        return statistics.median(wall), statistics.median(processor)


def main():
    vog, path, grid, high, budget = sys.argv[1:6]
    high = float(high)
    keep = sys.argv[6] if len(sys.argv) > 6 else None
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(keep or scratch)
        folder.mkdir(exist_ok=True)

        def run(*arguments):
            return subprocess.run([vog, *map(str, arguments)], check=True, capture_output=True, text=True).stdout

        model, camera = folder / "model.ply", folder / "camera.json"
        run("convert", path, "--grid", grid, "-o", model, "--budget", budget, "--no-hierarchy")
        camera.write_text(run("render", path, "--grid", grid, "-o", folder / "T.png", "--size", 16, "--view", "paper", "--json"), encoding="utf-8")
        view = json.loads(camera.read_text(encoding="utf-8"))["camera"]
        radius = sum((a - b) ** 2 for a, b in zip(view["eye"], view["look_at"])) ** 0.5 / 3  # paper: three radii away
        vtk = Vtk(path, grid, camera)

        def render(source, name, tf, *more, repeat=FRAMES):
            start = resource.getrusage(resource.RUSAGE_CHILDREN)
            report = json.loads(run("render", source, "--show", "volume", "--tf", tf, "--camera", camera, "--size", SIZE,
                                    "--background", "black", "-o", folder / name, "--repeat", repeat, "--json", *more))
            end = resource.getrusage(resource.RUSAGE_CHILDREN)
            return report["render_ms"]["median"], 1000 * (end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime)

        def psnr(a, b):
            return json.loads(run("compare", folder / a, folder / b, "--json"))["psnr_rgb_db"]

        for name in ("ramp", "step"):
            content, tf = transfer_function(name, high, radius / 12), folder / f"{name}.json"
            tf.write_text(json.dumps(content), encoding="utf-8")
            vtk.set_transfer(content)
            for n in range(ROUNDS):
                wall, processor = vtk.render(str(folder / f"{name}-vtk.png"))
                ours, more = render(model, f"{name}-model.png", tf, repeat=3 * FRAMES)
                _, less = render(model, f"{name}-model.png", tf, repeat=FRAMES)
                each = (more - less) / (2 * FRAMES)  # without loading and fitting
                print(f"{name} {n}: VTK {wall:.0f} ms, vog {ours:.1f} ms, ratio {wall / ours:.1f}; "
                      f"processor time {processor:.0f} and {each:.1f} ms, ratio {processor / each:.1f}", flush=True)
            for kind, more in (("constant", ()), ("linear", ("--interpolation", "linear"))):
                render(path, f"{name}-{kind}.png", tf, "--grid", grid, *more, repeat=1)
            pairs = [("vtk", "linear"), ("vtk", "constant"), ("vtk", "model"), ("constant", "model"), ("constant", "linear")]
            for a, b in pairs:
                print(f"{name}: {a} and {b}: {psnr(f'{name}-{a}.png', f'{name}-{b}.png'):.1f} dB", flush=True)


if __name__ == "__main__":
    main()
