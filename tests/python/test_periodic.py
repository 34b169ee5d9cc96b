"""Periodic boxes and kernels of particles: mass, agreement with yt's SPH projections, and a choice among several grids."""
import warnings

import numpy as np
import pytest

import vog

EDGE = 10.0


def gas(count=3000):
    """Positions in clumps, some on the faces, and radii at which kernels end."""
    random = np.random.default_rng(5)
    clumps = random.uniform(0, EDGE, (60, 3))
    place = (clumps[random.integers(60, size=count)] + random.normal(0, 0.7, (count, 3))) % EDGE
    return place, random.uniform(0.8, 1.6, count)


def projected(place, radius, axis="z", **options):
    model = vog.convert(vog.Points.from_numpy(place), smoothing=radius, **options)
    return vog.projection(model, axis=axis, width=EDGE, center=(EDGE / 2,) * 3, resolution=128).array


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_mass_is_kept_and_the_picture_moves_with_the_particles(axis):
    place, radius = gas()
    whole = projected(place, radius, axis, periodic=EDGE)
    # Kernels of six pixels and more at pixel centres.
    assert whole.sum() * (EDGE / 128) ** 2 == pytest.approx(len(place), rel=1e-3)
    assert projected(place, radius, axis).sum() < 0.99 * whole.sum()
    moved = projected(place + EDGE / 2, radius, axis, periodic=[[0, 0, 0], [EDGE] * 3])
    assert np.linalg.norm(np.roll(moved, (64, 64), (0, 1)) - whole) < 1e-4 * np.linalg.norm(whole)


def test_columns_are_yts():
    yt = pytest.importorskip("yt", reason="needs yt (pip install yt)")
    place, radius = gas()
    data = {("io", f"particle_position_{axis}"): place[:, n] for n, axis in enumerate("xyz")}
    data.update({("io", "particle_mass"): np.ones(len(place)), ("io", "smoothing_length"): radius, ("io", "density"): 1 / radius**3})
    ds = yt.load_particles(data, length_unit=1.0, mass_unit=1.0, bbox=np.array([[0, EDGE]] * 3), periodicity=(True,) * 3)
    buffer = ds.proj(("io", "density"), "z").to_frb((EDGE, "code_length"), (128, 128), center=[EDGE / 2] * 3, periodic=True)
    truth = np.array(buffer["io", "density"].in_units("code_mass/code_length**2"))
    error = np.linalg.norm(projected(place, radius, periodic=EDGE) - truth) / np.linalg.norm(truth)
    assert error < 0.01


def test_what_does_not_fit_is_refused():
    points = vog.Points.from_numpy(gas(100)[0])
    with pytest.raises(vog.Error, match="states no periodic box"):
        vog.convert(points, periodic=True)
    with pytest.raises(vog.Error, match="expected its edge"):
        vog.convert(points, periodic=[1, 2])
    with pytest.raises(vog.Error, match="smoothing has no effect beside `radius`"):
        vog.convert(points, radius=1.0, smoothing=np.ones(100))
    with pytest.raises(vog.Error, match="no value named 'h'"):
        vog.convert(points, smoothing="h")


def test_the_largest_of_several_grids_is_loaded_with_a_warning(data):
    file = data("fire.vdb")
    with pytest.warns(UserWarning, match="reading 'temperature', the largest of 2 grids; grid=... chooses another: flames"):
        assert vog.Volume.load(file).name == "temperature"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert vog.Volume.load(file, "flames").name == "flames"
