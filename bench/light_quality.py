#!/usr/bin/env python3
"""Pictures of lit models against those of their voxels: PSNR of RGB over black, the table of docs/volume_rendering.md.

    PYTHONPATH=build/release/python bench/light_quality.py ../shared/data/smoke.vdb ../shared/data/beetle.vdb

Each volume is converted (--budget, default: the conversion's own) and drawn from the views paper, +x and -z under three transfer
functions: a linear ramp of inferno, white from a third of the range on (opaque), and a white ramp that is opaque within a
thousandth of the box's diagonal. A model's picture has the camera, range, scale and unit distance of its voxels'. A cell of the table is
the mean of the views, and the worst.
"""
import argparse
import math
import pathlib

import numpy as np
import vog

VIEWS = ("paper", "+x", "-z")
TOWARDS_LIGHT = (1, 2, 1)
LIGHTS = {
    "no light": {},
    "`--shadows`": {"shadows": True},
    "`--ambient-occlusion`": {"ambient_occlusion": True},
    "`--light 1,2,1`": {"light": TOWARDS_LIGHT},
    "`--light 1,2,1 --shadows --ambient-occlusion`": {"light": TOWARDS_LIGHT, "shadows": True, "ambient_occlusion": True},
}


def functions(volume, voxels, options):
    """Name and keywords of each transfer function; ranges and lengths are those of the voxels."""
    low, high = voxels.render(size=64, show="volume", tf="inferno", scale="linear").request["range"]
    step = options.step if options.step is not None else low + (high - low) / 3
    corners = np.array(volume.index_box, float) + [[-0.5], [0.5]]
    diagonal = np.linalg.norm(volume.matrix[:3, :3] @ (corners[1] - corners[0]))
    white = options.unit_distance or diagonal / 1000
    yield "`--tf inferno --scale linear`", {"tf": "inferno", "scale": "linear"}
    yield f"`--iso {step:.3g},white`", {"bands": [(float(f"{step:.3g}"), "white")]}
    yield f"`--tf white --unit-distance {white:.3g}`", {"tf": "white", "unit_distance": float(f"{white:.3g}")}


def same_picture(request):
    """Keywords that draw other data with a picture's range, scale and unit distance."""
    return {key: request[key] for key in ("range", "scale", "unit_distance") if request.get(key) is not None}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("volumes", nargs="+", help="OpenVDB files; their density, else their only grid")
    parser.add_argument("--budget", type=int, help="Gaussians (default: the conversion's default)")
    parser.add_argument("--size", type=int, default=384, help="pixels along each edge")
    parser.add_argument("--step", type=float, help="value of the opaque surface (default: a third of the range)")
    parser.add_argument("--unit-distance", type=float, help="world length over which the white ramp is opaque")
    options = parser.parse_args()

    print("| data | Gaussians | function | " + " | ".join(LIGHTS) + " |\n" + "|---" * (3 + len(LIGHTS)) + "|", flush=True)
    for file in options.volumes:
        volume = vog.Volume.load(file)
        model = vog.convert(volume, **({"budget": options.budget} if options.budget else {}))
        # One scene each: what a transfer function needs for its lights is prepared once for all views.
        voxels, gaussians = vog.Scene(volume), vog.Scene(model)
        for name, function in functions(volume, voxels, options):
            cells = []
            for light in LIGHTS.values():
                figures = []
                for view in VIEWS:
                    shown = {"show": "volume", "background": "black", **function, **light}
                    camera = vog.Camera.orbit(volume, view=view)
                    expected = voxels.render(camera, options.size, **shown)
                    made = gaussians.render(camera, options.size, **{**shown, **same_picture(expected.request)})
                    figures.append(vog.compare(expected.image, made.image).psnr_db)
                assert all(math.isfinite(figure) for figure in figures), f"{file}, {name}: equal pictures of voxels and model"
                cells.append(f"{sum(figures) / len(figures):.1f}, {min(figures):.1f}")
            print(f"| {pathlib.Path(file).stem} | {len(model):,} | {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
