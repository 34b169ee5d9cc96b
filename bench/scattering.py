#!/usr/bin/env python3
"""Shadows and octaves of scattering beside a path tracer, Mitsuba 3 (docs/volume_rendering.md, "Beside a path tracer").

    pip install mitsuba
    vog sample cloud cloud.vdb
    PYTHONPATH=build/release/python bench/scattering.py cloud.vdb [--depth 10] [--size 160] [--samples 256] [-o strip.png]

One light, infinitely far away, over black; albedo 1, isotropic phase function, extinction proportional to density, constant in each voxel.
Mitsuba's `volpath` draws light scattered once and any number of times, each with two seeds; vog draws the voxels and a model. Under an
irradiance of 4 pi, light scattered once is the L of vog's equation. For each picture of vog's the table has the factor that gives it
Mitsuba's mean brightness and, with that factor, the relative L2 from the mean of both seeds; the same without the noise of the seeds,
from the product of the differences from each; and PSNR, where the 99th percentile of Mitsuba's picture is 1. Rows of Mitsuba have the
noise of that mean. The strip shows, for light scattered once and then for all, Mitsuba and the rows.
"""
import argparse
import math
import sys

try:
    import mitsuba as mi
except ImportError:
    sys.exit("scattering: Mitsuba 3 is missing, the path tracer: pip install mitsuba")
import numpy as np
import vog

MOST_OPACITY = 0.01  # opacity is linear in density; so small, it makes extinction so to half a hundredth
OCTAVES = (1, 3, 8)


class Cloud:
    """A volume with its camera, its light and a transfer function."""

    def __init__(self, volume, depth, size, light):
        self.volume, self.size, self.light = volume, size, light
        self.camera = vog.Camera.orbit(volume)
        self.density = volume.to_numpy()
        columns = vog.render(volume, self.camera, size, extinction=1).values
        largest = self.density.max() * depth / np.percentile(columns[columns > 0], 99)  # extinction
        self.unit_distance = -math.log1p(-MOST_OPACITY) / largest
        self.extinction = -np.log1p(-MOST_OPACITY * self.density / self.density.max()) / self.unit_distance
        self.tf = vog.TransferFunction.from_points("white", [[0, 1, 1, 1]], [[0, 0], [1, MOST_OPACITY]])

    def render(self, data, octaves):
        """vog's light, [size, size], of 4 x 4 rays a pixel."""
        picture = vog.render(data, self.camera, 4 * self.size, show="volume", tf=self.tf, range=(0, self.density.max()),
                             unit_distance=self.unit_distance, shadows=True, light_from=self.light, light_weights=(0, 1, 0, 1),
                             scattering=octaves)
        return picture.image.rgba[..., 0].reshape(self.size, 4, self.size, 4).mean((1, 3), dtype=float)

    def trace(self, scatterings, samples):
        """Mitsuba's light, of two seeds. scatterings: most of them, or -1."""
        at, box = mi.ScalarTransform4f, np.diag([*self.density.shape, 1.0])
        box[:3, 3] = np.subtract(self.volume.index_box[0], 0.5)
        world = at(self.volume.matrix @ box)  # from [0, 1]^3
        grid = mi.VolumeGrid(np.ascontiguousarray(self.extinction.T[..., None], np.float32))
        medium = {"type": "heterogeneous", "albedo": 1.0, "phase": {"type": "isotropic"},
                  "sigma_t": {"type": "gridvolume", "grid": grid, "filter_type": "nearest", "raw": True, "to_world": world}}
        camera = at().look_at(origin=self.camera.eye, target=self.camera.look_at, up=self.camera.up)
        film = {"type": "hdrfilm", "width": self.size, "height": self.size, "rfilter": {"type": "box"}, "pixel_format": "luminance"}
        scene = mi.load_dict({
            "type": "scene",
            "integrator": {"type": "volpath", "max_depth": -1 if scatterings < 0 else scatterings + 1, "rr_depth": 1 << 20},
            "sensor": {"type": "perspective", "fov": self.camera.fov_degrees, "to_world": camera, "film": film},
            "light": {"type": "directional", "direction": [-x for x in self.light], "irradiance": {"type": "rgb", "value": 4 * math.pi}},
            "cloud": {"type": "cube", "to_world": world @ at().translate(0.5).scale(0.5), "bsdf": {"type": "null"}, "interior": medium},
        })
        return [np.array(mi.render(scene, spp=samples, seed=seed), float)[..., 0] for seed in (0, 1)]


def norm(a):
    return math.sqrt(np.mean(a * a))


def print_row(name, factor, error, smooth, truth):
    psnr = 20 * math.log10(np.percentile(truth, 99) / error)
    print(f"| {name} | {factor} | {error / norm(truth):.3f} | {smooth} | {psnr:.1f} dB |", flush=True)


def compare(cloud, sources, scatterings, octaves, samples):
    """Rows of one kind of light. Returns the pictures side by side."""
    one, two = cloud.trace(scatterings, samples)
    truth = (one + two) / 2
    strip = [truth]
    print_row("Mitsuba, scattered once" if scatterings == 1 else "Mitsuba, all light", "", norm(one - two) / 2, "", truth)
    for name, data in sources.items():
        for count in octaves:
            picture = cloud.render(data, count)
            factor = truth.mean() / picture.mean()
            strip.append(factor * picture)
            smooth = math.sqrt(max(0, np.mean((strip[-1] - one) * (strip[-1] - two)))) / norm(truth)
            label = f"{name}, {count} octaves" if count > 1 else f"{name}, shadows"
            print_row(label, f"{factor:.3f}", norm(strip[-1] - truth), f"{smooth:.3f}", truth)
    return np.hstack(strip) / np.percentile(truth, 99)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("volume", help="OpenVDB or another file of a density")
    parser.add_argument("--grid", default="", help="grid of the file")
    parser.add_argument("--depth", type=float, default=10, help="optical depth, 99th percentile of the pixels that are not empty")
    parser.add_argument("--size", type=int, default=160, help="pixels along an edge")
    parser.add_argument("--samples", type=int, default=256, help="paths a pixel and seed")
    parser.add_argument("--light", type=float, nargs=3, default=(1, 2, 1), metavar=("X", "Y", "Z"), help="direction towards the light")
    parser.add_argument("-o", "--output", help="strip of pictures to write")
    options = parser.parse_args()
    mi.set_variant("scalar_rgb")
    volume = vog.Volume.load(options.volume, grid=options.grid)
    cloud = Cloud(volume, options.depth, options.size, options.light)
    model = vog.convert(volume)
    print(f"{options.volume}, {len(model)} Gaussians, optical depth {options.depth:g}\n")
    print("| picture | factor | relative L2 | without noise | PSNR |\n|---|---|---|---|---|")
    sources = {"voxels": volume, "model": model}
    strips = [compare(cloud, sources, 1, (1,), options.samples), compare(cloud, sources, -1, OCTAVES, options.samples)]
    if options.output:
        wide = max(strip.shape[1] for strip in strips)
        rows = np.vstack([np.pad(strip, ((0, 0), (0, wide - strip.shape[1]))) for strip in strips])
        vog.Image.from_numpy(np.repeat(np.clip(rows, 0, 1)[..., None], 3, 2).astype(np.float32)).save(options.output)


if __name__ == "__main__":
    main()
