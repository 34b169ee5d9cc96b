#!/usr/bin/python3
"""Converts all levels of an AMR data set that yt reads to one model with fields, without intermediate files.

    apt install python3-yt                        # Debian 12
    examples/from_yt.py                           # sample data: two levels
    examples/from_yt.py DD0010/DD0010 -o out.png --field density --carry temperature --velocity --maps maps
    examples/from_yt.py DD0010/DD0010 --carry temperature --velocity --compare

For patch-based codes (Enzo, FLASH, Athena, Boxlib). examples/enzo_to_vdb.py handles octree codes too, and
writes files. --maps draws the column, the density-weighted mean of each field and its dispersion; --compare
sets the same maps beside yt's off-axis projections of the same cells, with the times of both.
"""
import argparse
import sys
import time

import numpy as np

import vog

try:
    import yt
except ImportError as error:
    sys.exit(f"from_yt: {error}; on Debian: apt install python3-yt")

VELOCITY = [("gas", f"velocity_{axis}") for axis in "xyz"]
# Direction of the maps, away from the eye, and up.
ALONG = np.array([1, 0.7, 0.5]) / np.sqrt(1.74)
UP = np.array([0.0, 0, 1])


def blobs():
    """Two levels: a coarse cloud with a refined centre, hot and turning."""

    def cells(left, right, count):
        axes = [np.linspace(l, r, n, endpoint=False) + (r - l) / n / 2 for l, r, n in zip(left, right, count)]
        x, y, z = np.meshgrid(*axes, indexing="ij")
        r2 = (x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2
        return {
            "density": (np.exp(-30 * r2) * (1.5 + np.sin(40 * x * y + 30 * z)), "code_mass/code_length**3"),
            "temperature": (1e4 + 1e6 * np.exp(-50 * r2), "K"),
            "velocity_x": (1e5 * (0.5 - y), "cm/s"),
            "velocity_y": (1e5 * (x - 0.5), "cm/s"),
            "velocity_z": (1e4 * np.sin(9 * z), "cm/s"),
        }

    patches = [([0, 0, 0], [1, 1, 1], 0), ([0.25] * 3, [0.75] * 3, 1)]
    grids = []
    for left, right, level in patches:
        grids.append(dict(left_edge=left, right_edge=right, level=level, dimensions=[32] * 3))
        grids[-1].update({("stream", name): data for name, data in cells(left, right, [32] * 3).items()})
    return yt.load_amr_grids(grids, [32] * 3)


def camera_of(ds, pixels):
    """Parallel rays through yt's pixels, whose outermost centres lie on the edges of its picture."""
    center = ds.domain_center.in_units("code_length").d
    width = 1.2 * float(ds.domain_width.in_units("code_length").d.max())
    eye = center - 3 * width * ALONG
    return vog.Camera(eye, center, UP, orthographic_width=width * pixels / (pixels - 1)), center, width


def draw_maps(model, camera, pixels, prefix):
    for name in ["column", *model.fields]:
        shows = ["column"] if name == "column" else ["mean", "deviation"]
        for show in shows:
            scale = "symmetric" if show == "mean" and name == "velocity" else "log"
            colors = "coolwarm" if scale == "symmetric" else "inferno"
            look = dict(tf=colors, scale=scale, background="white", color_bar=True)
            file = f"{prefix}-{name}{'-deviation' if show == 'deviation' else ''}.png"
            vog.render(model, camera, pixels, show=show, field="" if show == "column" else name, **look).save(file)
            print(file)


def yt_map(ds, field, center, width, pixels):
    """yt's off-axis projection, weighted by density (the column: not), rows from the top, columns from the left."""
    options = dict(north_vector=UP, weight=None if field == ("gas", "density") else ("gas", "density"))
    box = ds.arr([width, width, 6 * width], "code_length")
    buffer = yt.off_axis_projection(ds, ds.arr(center, "code_length"), ALONG, box, pixels, field, **options)
    return buffer.T[::-1, ::-1]


def los_velocity(field, data):
    """Component of the velocity along the maps' direction."""
    return sum(float(n) * data[axis] for n, axis in zip(ALONG, VELOCITY))


def timed(work):
    """Result, elapsed and processor time of work(), s."""
    start, cpu = time.perf_counter(), time.process_time()
    result = work()
    return result, np.array([time.perf_counter() - start, time.process_time() - cpu])


def compare(ds, levels, fields, model, pixels):
    """Maps of the cells by yt and by vog, and of the model: times, and differences weighted by the column."""
    camera, center, width = camera_of(ds, pixels)
    column, total = timed(lambda: yt_map(ds, ("gas", "density"), center, width, pixels).in_base("code").d)
    weight = np.where(column > 1e-3 * column.max(), column, 0)
    times = np.array([total, [0, 0], [0, 0]])

    def error(ours, theirs):
        # At the very edge of the box rays of both may or may not meet it.
        inside = (weight > 0) & np.isfinite(ours) & (ours != 0)
        return np.sqrt((weight * (ours - theirs) ** 2)[inside].sum() / (weight * theirs**2)[inside].sum())

    for name in fields:
        show = dict(show="mean", field=name)
        yt_field, unit = ("gas", name), fields[name]["unit"]
        if name == "velocity":
            yt_field = ("gas", "los")
            ds.add_field(yt_field, los_velocity, sampling_type="cell", units="cm/s")
        theirs, a = timed(lambda: yt_map(ds, yt_field, center, width, pixels).in_units(unit).d)
        voxels, b = timed(lambda: vog.render(levels, camera, pixels, **show, fields=fields))
        ours, c = timed(lambda: vog.render(model, camera, pixels, **show))
        times += a, b, c
        print(f"{name}: L2 of voxels {error(voxels.mean, theirs):.1e}, of the model {error(ours.mean, theirs):.1e}")
    # Every map of vog's has the column too.
    print(f"column: L2 of voxels {error(voxels.column, column):.1e}, of the model {error(ours.column, column):.1e}")
    for name, (wall, cpu) in zip(("yt", "voxels", "model"), times):
        print(f"{name}: {wall:.3f} s, {cpu:.3f} s of processor time, {times[0][0] / wall:.1f} and "
              f"{times[0][1] / cpu:.1f} times as fast")  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", nargs="?", help="data set for yt.load; default: a sample with two levels")
    parser.add_argument("-o", "--output", default="yt.png", help="picture to write")
    parser.add_argument("--field", default="density", help="name of a yt field (default: density)")
    parser.add_argument("--carry", nargs="*", default=[], help="names of yt fields that the model carries")
    parser.add_argument("--velocity", action="store_true", help="carry the velocity as a vector field")
    parser.add_argument("--maps", metavar="PREFIX", help="maps of column and fields: PREFIX-temperature.png, ...")
    parser.add_argument("--compare", action="store_true", help="compare the maps with yt's projections")
    parser.add_argument("--size", type=int, default=800, help="edge of the maps, pixels (default: 800)")
    arguments = parser.parse_args()
    if arguments.compare and arguments.field != "density":
        parser.error("--compare: is of --field density, which weighs the maps")
    if arguments.compare and not (arguments.carry or arguments.velocity):
        parser.error("--compare: of which fields? expected --carry NAME or --velocity")

    yt.set_log_level("error")
    ds = yt.load(arguments.dataset) if arguments.dataset else blobs()
    names = [*arguments.carry, *["velocity"] * arguments.velocity]
    levels, fields = vog.from_yt(ds, ("gas", arguments.field), fields=names)
    model = vog.convert(levels, fields=fields or None)
    print(levels, model.summary)
    vog.render(model, tf="jet").save(arguments.output)
    if arguments.maps:
        draw_maps(model, camera_of(ds, arguments.size)[0], arguments.size, arguments.maps)
    if arguments.compare:
        compare(ds, levels, fields, model, arguments.size)


if __name__ == "__main__":
    main()
