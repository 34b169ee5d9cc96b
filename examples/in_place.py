#!/usr/bin/python3
"""A solver on several processes that hands its arrays to vog as it runs, and leaves a page that plays its steps.

    mpirun -n 4 examples/in_place.py --steps 8 -o dye/        # Debian: python3-mpi4py
    examples/in_place.py                                      # one process

Each process converts its own block with its share of the Gaussians; blocks touch, and so do their models. The first process joins the models
of a step by +, and writes them: a few thousand Gaussians where the solver has millions of cells.
"""
import argparse
import os
import sys
import time

import numpy as np

import vog

try:
    from mpi4py import MPI

    WORLD = MPI.COMM_WORLD
    RANK, RANKS = WORLD.Get_rank(), WORLD.Get_size()
except ImportError:
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE") or os.environ.get("PMI_SIZE") or 1) > 1:
        sys.exit("in_place: several processes need mpi4py (Debian: python3-mpi4py)")
    WORLD, RANK, RANKS = None, 0, 1


def gathered(value):
    """The values of all processes, in the first one."""
    return WORLD.gather(value) if WORLD else [value]


class Solver:
    """A drop that spreads and drifts along z: this process's layers of a lattice [edge, edge, edge] of x, y and z, and one on each side."""

    def __init__(self, edge):
        self.edge = edge
        self.first, self.last = (edge * n // RANKS for n in (RANK, RANK + 1))
        x, y, z = np.meshgrid(np.arange(edge), np.arange(edge), np.arange(self.first - 1, self.last + 1), indexing="ij")
        self.density = np.exp(-60 * ((x / edge - 0.5) ** 2 + (y / edge - 0.5) ** 2 + (z / edge - 0.3) ** 2)).astype(np.float32)

    @property
    def block(self):
        """This process's cells, a view: nothing is copied."""
        return self.density[:, :, 1:-1]

    def exchange(self):
        """Takes the outer layers from the neighbours; nothing is outside of the lattice."""
        self.density[:, :, [0, -1]] = 0
        if not WORLD:
            return
        below, above = (n if 0 <= n < RANKS else MPI.PROC_NULL for n in (RANK - 1, RANK + 1))
        for sent, to, source, layer in ((1, below, above, -1), (-2, above, below, 0)):
            received = np.zeros_like(self.density[:, :, layer])
            WORLD.Sendrecv(np.ascontiguousarray(self.density[:, :, sent]), to, recvbuf=received, source=source)
            self.density[:, :, layer] = received

    def advance(self):
        self.exchange()
        d = np.pad(self.density, ((1, 1), (1, 1), (0, 0)))
        sides = d[2:, 1:-1] + d[:-2, 1:-1] + d[1:-1, 2:] + d[1:-1, :-2]
        inner = self.density[:, :, 1:-1]
        flow = 0.4 * (self.density[:, :, :-2] - inner)
        spread = 0.1 * (sides[:, :, 1:-1] + self.density[:, :, :-2] + self.density[:, :, 2:] - 6 * inner)
        self.density[:, :, 1:-1] = inner + flow + spread
        self.density[self.density < 1e-4] = 0  # empty space costs nothing


def converted(solver, budget):
    """This process's Gaussians; None for a block without mass."""
    if not solver.block.any():
        return None
    size = 1 / solver.edge
    volume = vog.Volume.from_numpy(solver.block, voxel_size=size, origin=(size / 2, size / 2, (solver.first + 0.5) * size), name="dye")
    return vog.convert(volume, budget=budget)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=4)
    parser.add_argument("--edge", type=int, default=64, help="cells along each axis (default: %(default)s)")
    parser.add_argument("--budget", type=int, default=2000, help="Gaussians of a step (default: %(default)s)")
    parser.add_argument("-o", "--output", default="dye/", help="folder of the page (default: %(default)s)")
    given = parser.parse_args()
    solver, steps = Solver(given.edge), {}
    for step in range(given.steps):
        start = time.perf_counter()
        for _ in range(10):
            solver.advance()
        solved = time.perf_counter()
        parts = gathered(converted(solver, max(given.budget // RANKS, 1)))
        mass = gathered(float(solver.block.sum(dtype=float)) / given.edge**3)
        if RANK == 0:
            models = [part for part in parts if part is not None]
            model = models[0]
            for other in models[1:]:
                model = model + other
            steps[f"step {step}"] = model
            print(f"step {step}: solver {1e3 * (solved - start):.0f} ms, vog {1e3 * (time.perf_counter() - solved):.0f} ms, {len(model)} Gaussians, "
                  f"mass {model.mass:.6f} of {sum(mass):.6f}")
    if RANK == 0:
        report = vog.export_html(given.output, steps, title="A drop of dye", steps=True, show="volume", tf="white", background="black")
        print(f"{given.output}: {report['gaussians']} Gaussians in {len(steps)} steps")


if __name__ == "__main__":
    main()
