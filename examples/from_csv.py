#!/usr/bin/python3
"""Converts particles of a CSV file to a model with a given number of Gaussians, and renders it.

    examples/from_csv.py                          # sample particles: a spiral galaxy
    examples/from_csv.py halo.csv -o out.png --value mass --budget 20000
"""
import argparse
import csv
import pathlib
import tempfile

import numpy as np

import vog


def spiral(file, count=20000):
    """Writes stars of two spiral arms: x, y, z, mass."""
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
    parser.add_argument("file", nargs="?", help="CSV file with a header line; default: sample particles")
    parser.add_argument("-o", "--output", default="csv.png", help="picture to write")
    parser.add_argument("--value", default="mass", help="column with the mass of a particle, or count (1 each)")
    parser.add_argument("--budget", type=int, default=4000, help="largest number of Gaussians")
    arguments = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        file = arguments.file or pathlib.Path(folder) / "spiral.csv"
        if not arguments.file:
            spiral(file)
        points = vog.Points.load(file)
        # The same from arrays, for data that another library reads:
        table = np.genfromtxt(file, delimiter=",", names=True)
        from_arrays = vog.Points.from_numpy(
            np.stack([table["x"], table["y"], table["z"]], axis=1), attributes={arguments.value: table[arguments.value]}
        )
    assert np.array_equal(points.position, from_arrays.position)

    model = vog.convert(points, value=arguments.value, budget=arguments.budget)
    print(points, model.summary)
    camera = vog.Camera.orbit(points, elevation=50)
    vog.render(model, camera, tf="magma").save(arguments.output)


if __name__ == "__main__":
    main()
