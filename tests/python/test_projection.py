"""vog.projection: mass, directions, fields, units, and what it refuses."""
import json
import re

import numpy as np
import pytest

import vog


@pytest.fixture(scope="module")
def volume():
    return vog.sample_cloud(64)


@pytest.fixture(scope="module")
def model(volume):
    return vog.convert(volume, block=4)


def mass_of(projection):
    array, (left, right, bottom, top) = projection
    return float(array.sum()) * abs(right - left) * (top - bottom) / array.size


@pytest.mark.parametrize("axis", ["x", "y", "z", "-x", "-y", "-z", 0, 2, (1, 2, 3)])
def test_pixels_add_up_to_the_mass(model, axis):
    # Pixels are as fine as a hundredth of a Gaussian's extent: sampling them is exact to rounding there.
    assert mass_of(vog.projection(model, axis=axis, resolution=256)) == pytest.approx(model.mass, rel=2e-3)


def test_voxels_and_model_agree(volume, model):
    truth = vog.projection(volume, resolution=200)
    made = vog.projection(model, width=(truth.extent[1] - truth.extent[0], truth.extent[3] - truth.extent[2]),
                          center=(0.5 * (truth.extent[0] + truth.extent[1]), 0.5 * (truth.extent[2] + truth.extent[3]), 0), resolution=truth.array.shape[::-1])
    assert made.extent == pytest.approx(truth.extent, abs=1e-9)
    error = np.linalg.norm(made.array - truth.array) / np.linalg.norm(truth.array)
    assert error < 0.12


def test_rows_begin_at_the_bottom_and_axes_are_right_handed():
    # A voxel at x = 3, y = 1, z = 2 of a lattice of 4.
    array = np.zeros((4, 4, 4), dtype=np.float32)
    array[3, 1, 2] = 1
    array[0, 0, 0] = array[3, 3, 3] = 1e-6
    volume = vog.Volume.from_numpy(array)
    for axis, column, row in [("z", 3, 1), ("x", 1, 2), ("y", 2, 3), ("-z", 0, 1)]:
        found = vog.projection(volume, axis=axis, resolution=4)
        place = np.unravel_index(found.array.argmax(), found.array.shape)
        assert (place[1], place[0]) == (column, row), axis
        assert found.array.max() == pytest.approx(1, rel=1e-5)


def test_fields_are_means_by_density():
    density, heat = vog.sample_fire(64)
    got = vog.projection(density, "temperature", axis="z", resolution=64, fields={"temperature": heat})
    column = vog.projection(density, axis="z", resolution=64)
    inside = column.array > 0
    assert np.isnan(got.array[~inside]).all() and np.isfinite(got.array[inside]).all()
    assert got.array[inside].min() >= 400 and got.array[inside].max() <= 1900
    whole = vog.projection(density, "temperature", quantity="integral", resolution=64, fields={"temperature": heat})
    np.testing.assert_allclose(whole.array[inside], (got.array * column.array)[inside], rtol=1e-5)
    model = vog.convert(density, block=4, fields={"temperature": heat})
    mean = vog.projection(model, "temperature", resolution=64)
    assert np.nanmean(mean.array) == pytest.approx(np.nanmean(got.array), rel=0.05)
    assert (vog.projection(model, "temperature", quantity="deviation", resolution=32).array >= 0).any()


def test_texts_of_units_need_a_package_of_units(model):
    with pytest.raises(vog.Error, match="the data have no units"):
        vog.projection(model, unit="g/cm2")


def test_astropy_units_go_through():
    units = pytest.importorskip("astropy.units", reason="needs astropy (pip install astropy)")
    array = np.ones((8, 8, 8)) * units.Unit("g / cm3")
    volume = vog.Volume.from_numpy(array, voxel_size=2 * units.kpc)
    found = vog.projection(volume, resolution=8, unit="g / cm2")
    assert found.unit == units.Unit("g / cm2")
    assert found.array.to_value("g / kpc2").max() == pytest.approx((1 * units.Unit("g / cm3")).to_value("g / kpc3") * 16, rel=1e-5)
    assert found.header()["BUNIT"]
    with pytest.raises(vog.Error, match="expected one that"):
        vog.projection(volume, unit="K")
    with pytest.raises(vog.Error, match="has a unit|converts"):
        vog.projection(volume, width=3 * units.K)


def test_pint_and_unyt_give_astropys_numbers():
    """The same column of a gas in kpc, by each package that is installed: 8 voxels of 2 kpc."""
    ones = np.ones((8, 8, 8))
    expected = 16 * 3.0856775814913674e21  # g / cm2 of 1 g / cm3 along 16 kpc; a parsec of IAU 2015
    tried = []
    for name in ("pint", "unyt"):
        try:
            package = __import__(name)
        except ImportError:
            continue
        if name == "pint":
            registry = package.UnitRegistry()
            density, edge = ones * registry.Unit("g/cm**3"), 2 * registry.kiloparsec
        else:
            density, edge = package.unyt_array(ones, "g/cm**3"), package.unyt_quantity(2, "kpc")
        found = vog.projection(vog.Volume.from_numpy(density, voxel_size=edge), resolution=8, unit="g/cm**2")
        assert type(found.array).__module__.split(".")[0] == name
        numbers = np.asarray(found.array.magnitude if name == "pint" else found.array.value)
        assert numbers.max() == pytest.approx(expected, rel=1e-5), name
        assert found.header()["BUNIT"] and found.header()["CUNIT1"]
        tried.append(name)
    if not tried:
        pytest.skip("needs pint or unyt (pip install pint)")


class StandIn:
    """A Quantity as pint has it, whose units are numbers."""

    __module__ = "pint"

    def __init__(self, magnitude, units):
        self.magnitude, self.units = magnitude, units

    def to(self, units):
        return StandIn(self.magnitude * (self.units / units), units)


@pytest.mark.parametrize("package, units", [("stand-in", (1.0, 1e-3)), ("astropy.units", ("g / cm**3", "kg / m**3")), ("pint", ("g / cm**3", "kg / m**3"))])
def test_units_are_rounded_once(package, units):
    """A factor of 1e-3 in float32 is off by 0.8 of half a unit in the last place, and the product is rounded once more."""
    if package == "stand-in":
        make = StandIn
    else:
        module = pytest.importorskip(package, reason="needs astropy and pint (pip install astropy pint)")
        make = (lambda array, unit: array * module.Unit(unit)) if package != "pint" else module.get_application_registry().Quantity
    values = np.random.default_rng(1).random((8, 8, 8), dtype=np.float32) + np.float32(1)
    found = vog.Volume.from_blocks([((0, 0, 0), make(values, units[0])), ((8, 0, 0), make(values, units[1]))]).to_numpy()
    exact = values.astype(float) * 1e-3
    assert np.abs(found[8:] / exact - 1).max() <= 2**-24 * (1 + 1e-6)


@pytest.mark.parametrize("package, dense", [("astropy.units", "Pg / pc**3"), ("pint", "petagram / parsec**3")])
def test_units_convert_in_double(package, dense):
    """A factor of 2.9e40 between the units of two blocks, beyond float32, whose values are not."""
    module = pytest.importorskip(package, reason="needs astropy and pint (pip install astropy pint)")
    unit = module.Unit if package != "pint" else module.get_application_registry().Unit
    ones = np.ones((8, 8, 8), dtype=np.float32)
    blocks = [((0, 0, 0), ones * np.float32(1e10) * unit(dense)), ((8, 0, 0), ones * np.float32(1e-30) * unit("g / cm**3"))]
    found = vog.Volume.from_blocks(blocks).to_numpy()
    assert found[0, 0, 0] == np.float32(1e10)
    assert found[8, 0, 0] == pytest.approx(1e-30 * 3.0856775814913674e18**3 / 1e15, rel=1e-4)


@pytest.mark.parametrize(
    "arguments",
    [{"axis": "w"}, {"axis": (0, 0, 0)}, {"resolution": 0}, {"resolution": 10**6}, {"width": -1}, {"width": float("nan")}, {"quantity": "mean"},
     {"center": 3}, {"field": "nothing"}, {"axis": "z", "up": "z"}, {"axis": np.zeros((50, 50))}],
)  # fmt: skip
def test_wrong_arguments_are_one_short_line(model, arguments):
    with pytest.raises((vog.Error, TypeError)) as error:
        vog.projection(model, **arguments)
    text = str(error.value)
    assert "\n" not in text and len(text) < 300 and "array(" not in text


@pytest.mark.parametrize("axis", ["z", "-x", 2, (0, 0, 1)])
def test_an_axis_without_its_keyword_is_refused(model, axis):
    with pytest.raises(TypeError, match=re.escape(f"axis={axis!r}")):
        vog.projection(model, axis)


def test_other_data_are_refused():
    with pytest.raises(TypeError, match="ndarray of shape"):
        vog.projection(np.zeros((4, 4, 4)))
    with pytest.raises(TypeError, match="vog.convert makes one of Points"):
        vog.projection(vog.sample_particles(8))


def test_the_header_says_how_it_was_drawn(model):
    projected = vog.projection(model, axis="x", resolution=24)
    request = json.loads(projected.header()["VOGREQ"])
    again = vog.render(model, **request)
    assert np.array_equal(again.values[::-1], np.asarray(projected.array).astype(np.float32))
