#!/usr/bin/python3
"""Errors of maps of fields of a model of an AMR data set: density-weighted means along x, y and z, against its cells.

    PYTHONPATH=build/release/python /usr/bin/python3 bench/field_errors.py ../shared/data/enzo-raw/DD0010/DD0010 [--blocks 8]

Relative L2 over the pixels whose column is above a hundredth of its largest. Cells of constant value have faces, which no
smooth kernel follows; the second figure of a map is the model's against cells interpolated between their centres, the
third is what these two readings of the cells have between themselves. With --blocks the maps are means over blocks of pixels: 8
are a cell of Enzo's coarsest level.
"""
import argparse

import numpy as np

import vog
import yt


def maps(subject, view, pixels, name, **options):
    """Maps of a field by parallel rays along an axis of the unit cube."""
    center, away = np.full(3, 0.5), np.eye(3)["xyz".index(view)]
    camera = vog.Camera(center - 3 * away, center, np.roll(away, 2), orthographic_width=1)
    return vog.render(subject, camera, pixels, show="mean", field=name, **options)


def block_means(map, quantity, blocks):
    """Means over blocks of pixels, of fields weighted by the column; the column of each block."""

    def means(values):
        rows, columns = values.shape
        return values.reshape(rows // blocks, blocks, columns // blocks, blocks).mean((1, 3))

    column = np.asarray(map.column, float)
    if quantity == "column":
        return means(column), means(column)
    return means(np.where(column > 0, column * map.mean, 0)) / means(column), means(column)


def error(ours, reference, quantity, blocks):
    expected, column = block_means(reference, quantity, blocks)
    counts = column > 0.01 * column.max()
    difference = (block_means(ours, quantity, blocks)[0] - expected)[counts]
    return np.sqrt((difference**2).sum() / (expected[counts] ** 2).sum())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", help="for yt.load, with a domain that is the unit cube in code units")
    parser.add_argument("--field", action="append", help="carried field of yt, again for more (default: temperature)")
    parser.add_argument("--budget", type=int, help="Gaussians (default: the conversion's default)")
    parser.add_argument("--size", type=int, default=256, help="pixels along each edge")
    parser.add_argument("--blocks", type=int, default=1, help="pixels along the edge of a block (default: 1)")
    arguments = parser.parse_args()

    yt.set_log_level("error")
    ds = yt.load(arguments.dataset)
    names = [*(arguments.field or ["temperature"]), "velocity"]
    levels, fields = vog.from_yt(ds, ("gas", "density"), fields=names)
    model = vog.convert(levels, fields=fields, **({"budget": arguments.budget} if arguments.budget else {}))
    print(model.summary)
    print("L2, %: model - cells, model - interpolated cells, interpolated cells - cells")
    for name in fields:
        for view in "xyz":
            cells = maps(levels, view, arguments.size, name, fields=fields)
            between = maps(levels, view, arguments.size, name, fields=fields, interpolation="linear")
            ours = maps(model, view, arguments.size, name)
            for quantity in ("column", "mean"):
                pairs = ((ours, cells), (ours, between), (between, cells))
                figures = "  ".join(f"{100 * error(a, b, quantity, arguments.blocks):5.1f}" for a, b in pairs)
                print(f"{name:12} {view}  {quantity:6}  {figures}")


if __name__ == "__main__":
    main()
