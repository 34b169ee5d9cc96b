#!/usr/bin/python3
"""A CSV of particles: read by vog, or by whatever reads yours, weighed, and thinned out.

    examples/from_csv.py                          # particles made here
    examples/from_csv.py halo.csv -o out.png --value mass --budget 20000
"""
import argparse
import csv
import pathlib
import tempfile

import numpy as np

import vog


def spiral(file, count=20000):
    """Stars of two spiral arms: x, y, z, mass."""
    random = np.random.default_rng(1)
    radius = random.exponential(0.3, count)
    angle = 6 * np.sqrt(radius) + np.pi * random.integers(0, 2, count) + random.normal(0, 0.25, count)
    rows = np.stack([radius * np.cos(angle), random.normal(0, 0.02, count), radius * np.sin(angle)], axis=1)
    with open(file, "w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow(["x", "y", "z", "mass"])
        writer.writerows(np.column_stack([rows, random.pareto(2, count) + 1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="?", help="CSV with a line of names; default: one made here")
    parser.add_argument("-o", "--output", default="csv.png", help="picture to write")
    parser.add_argument("--value", default="mass", help="the column that a particle weighs, or count")
    parser.add_argument("--budget", type=int, default=4000, help="most Gaussians")
    arguments = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        file = arguments.file or pathlib.Path(folder) / "spiral.csv"
        if not arguments.file:
            spiral(file)
        points = vog.Points.load(file)
        # The same by hand, where another program reads the file:
        table = np.genfromtxt(file, delimiter=",", names=True)
        by_hand = vog.Points.from_numpy(
            np.stack([table["x"], table["y"], table["z"]], axis=1), attributes={arguments.value: table[arguments.value]}
        )
    assert np.array_equal(points.position, by_hand.position)

    model = vog.convert(points, value=arguments.value, budget=arguments.budget)
    print(points, model.reached)
    camera = vog.Camera.orbit(points, elevation=0.9, distance=2)
    vog.render(model, camera).shade("magma").save(arguments.output)


if __name__ == "__main__":
    main()
