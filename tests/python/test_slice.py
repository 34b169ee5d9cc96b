"""vog.slice: values on a plane with their extent, against the arrays that made them, a model's own Gaussians, and yt."""

import numpy as np
import pytest

import vog


def voxels(value, **keywords):
    return vog.Volume.from_numpy(np.asarray(value, dtype=np.float32), **keywords)


def some_array(shape=(6, 5, 4), seed=1):
    return np.random.default_rng(seed).uniform(0.5, 2, shape)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_of_voxels_are_planes_of_the_array(axis):
    array = some_array()
    volume, n = voxels(array, voxel_size=0.5), "xyz".index(axis)
    for k in range(array.shape[n]):
        shown, extent = vog.slice(volume, axis, 0.5 * k, resolution=30)
        plane = np.moveaxis(np.take(array, k, axis=n), 0, 1) if axis != "y" else np.take(array, k, axis=n)
        size = np.array(plane.shape)
        assert np.shape(shown) == tuple(size * (30 // size.max()))
        assert extent == pytest.approx((-0.25, 0.5 * size[1] - 0.25, -0.25, 0.5 * size[0] - 0.25))
        assert np.array_equal(shown, np.kron(plane.astype(np.float32), np.ones((30 // size.max(),) * 2)))


def test_along_an_axis_turned_round_and_wider_than_the_data():
    volume = voxels(some_array(), voxel_size=0.5)
    front, extent = vog.slice(volume, "z", 0.5, resolution=12)
    back, turned = vog.slice(volume, "-z", -0.5, resolution=12)
    assert np.array_equal(front, back[:, ::-1]) and turned == pytest.approx((extent[1], extent[0], *extent[2:]))
    wide, extent = vog.slice(volume, "z", 0.5, width=6, resolution=24)
    assert extent == pytest.approx((-1.75, 4.25, -2, 4))
    assert np.isnan(wide[0]).all() and np.nansum(wide) == pytest.approx(np.sum(front))
    middle = vog.slice(volume, (0, 0, 3), resolution=12)
    assert np.array_equal(middle.array, vog.slice(volume, "z", 0.75, resolution=12).array)
    assert middle.quantity == "slice" and "slice of density" in repr(middle)
    again = vog.render(volume, **middle.request)
    assert np.array_equal(again.values[::-1], middle.array.astype(np.float32))


def test_averaged_across_are_means_of_planes_weighted_by_density():
    array, heat = some_array(), some_array(seed=2)
    volume = voxels(array, voxel_size=0.5)
    shown = vog.slice(volume, "z", 0.75, thickness=2.0, resolution=6).array
    assert shown == pytest.approx(array.mean(axis=2).T, rel=1e-5)
    shown = vog.slice(volume, "z", 0.75, "heat", thickness=2.0, resolution=6, fields={"heat": heat.astype(np.float32)}).array
    assert shown == pytest.approx(((array * heat).sum(axis=2) / array.sum(axis=2)).T, rel=1e-5)
    # A slab that the data fill by halves has half of their density.
    assert vog.slice(volume, "z", 1.75, thickness=2.0, resolution=6).array == pytest.approx(array[:, :, 2:].mean(axis=2).T / 2, rel=1e-5)


def test_of_models_are_sums_of_their_gaussians():
    model = vog.convert(voxels(some_array((24, 24, 24)), voxel_size=0.1), block=4)
    made = vog.slice(model, (1, 2, 2), 1.5, resolution=40)
    shown, extent = made
    right, up, towards = np.array(made.axes[0]), np.array(made.axes[1]), np.array([1, 2, 2]) / 3
    mean, scale, density = (np.asarray(a, dtype=float) for a in (model.mean, model.scale, model.density))
    w, x, y, z = (np.asarray(model.rotation, dtype=float).T if len(model.rotation) else np.array([[1], [0], [0], [0]]) * np.ones(len(mean)))
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)  # fmt: skip
    rows, columns = np.shape(shown)
    checked = 0
    for row in range(0, rows, 5):
        for column in range(0, columns, 3):
            place = extent[0] + (column + 0.5) / columns * (extent[1] - extent[0]), extent[2] + (row + 0.5) / rows * (extent[3] - extent[2])
            point = place[0] * right + place[1] * up + 1.5 * towards
            white = np.einsum("nji,nj->ni", turn, point - mean) / scale
            q = (white**2).sum(axis=1)
            total = (density * np.exp(-q / 2))[q <= model.cutoff**2].sum()
            assert np.isnan(shown[row, column]) if total == 0 else shown[row, column] == pytest.approx(total, rel=2e-5)
            checked += total > 0
    assert checked > 30


def test_units_are_those_of_density_and_of_fields():
    units = pytest.importorskip("astropy.units")
    volume = vog.Volume.from_numpy(some_array() * units.g / units.cm**3, voxel_size=0.5 * units.kpc)
    made = vog.slice(volume, "z", (500, "pc"), resolution=6)
    assert made.array.unit == units.g / units.cm**3 and made.length_unit == units.kpc
    assert made.array.value == pytest.approx(some_array()[:, :, 1].T, rel=1e-6)
    assert vog.slice(volume, "z", 0.5, resolution=6, unit="kg / m3").array.value == pytest.approx(1000 * made.array.value)
    assert made.header()["BUNIT"]


@pytest.mark.parametrize("call, message", [
    (lambda volume: vog.slice(volume, "w"), "slice: axis"),
    (lambda volume: vog.slice(volume, "z", 9), "lies outside of the data"),
    (lambda volume: vog.slice(volume, "z", thickness=0), "thickness"),
    (lambda volume: vog.slice(volume, "z", field="heat"), "heat"),
    (lambda volume: vog.render(volume, show="slice"), "show 'slice' has no effect without `plane`"),
    (lambda volume: vog.render(volume, plane="z=1"), "plane"),
    (lambda volume: vog.render(volume, show="slice", plane=(0, 0, 0, 1)), "plane"),
    (lambda volume: vog.render(volume, show="slice", plane="axial"), "plane"),
    (lambda volume: vog.render(volume, show="slice", plane="z", interpolation="linear"), "interpolation"),
    (lambda volume: vog.render(vog.convert(volume), show="slice", plane="z", renderer="trace"), "plane"),
])  # fmt: skip
def test_what_cannot_be_drawn_is_refused_in_one_line(call, message):
    with pytest.raises(vog.Error) as error:
        call(voxels(some_array()))
    assert message in str(error.value) and "\n" not in str(error.value)


def yt_slice(ds, axis, position, pixels, name):
    """The centres of pixels in yt's own slice, rows from the bottom up."""
    buffer = ds.slice(axis, position).to_frb(ds.domain_width[0], pixels)
    array = np.asarray(buffer[name].in_base("code"))
    return array


def test_of_levels_are_those_of_yt():
    yt = pytest.importorskip("yt")
    yt.set_log_level(50)
    fine = {"left_edge": [0.25, 0.25, 0.25], "right_edge": [0.75, 0.75, 0.75], "level": 1, "dimensions": [16, 16, 16]}
    coarse = {"left_edge": [0, 0, 0], "right_edge": [1, 1, 1], "level": 0, "dimensions": [16, 16, 16]}
    grids = [{**grid, ("gas", "density"): (some_array((16,) * 3, n), "code_mass/code_length**3")} for n, grid in enumerate((coarse, fine))]
    ds = yt.load_amr_grids(grids, [16, 16, 16])
    levels = vog.from_yt(ds)
    for axis in range(3):
        for position in (0.1, 0.4, 0.5, 0.51):
            shown = vog.slice(levels, axis, position, resolution=64).array
            expected = yt_slice(ds, axis, position, 64, ("gas", "density"))
            assert np.asarray(shown) == pytest.approx(expected, rel=1e-6), (axis, position)


def test_of_real_data_are_those_of_yt(data):
    yt = pytest.importorskip("yt")
    yt.set_log_level(50)
    dump = data("enzo-raw/DD0010/DD0010")
    ds = yt.load(str(dump))
    levels = vog.from_yt(ds, ("enzo", "Density"))
    for axis in range(3):
        for position in (0.3, 0.5, 0.62):
            shown = np.asarray(vog.slice(levels, axis, position, resolution=256).array)
            expected = np.asarray(ds.slice(axis, position).to_frb(1.0, 256)["enzo", "Density"].in_cgs())
            assert shown == pytest.approx(expected, rel=1e-6), (axis, position)


def test_of_scans_are_seen_as_radiologists_see_them(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    values = np.random.default_rng(4).integers(1, 200, (6, 7, 8)).astype("f4")
    nibabel.save(nibabel.Nifti1Image(values, np.diag([2.0, 3, 4, 1])), tmp_path / "a.nii")  # x to the right, y front, z up
    scan = vog.Volume.load(tmp_path / "a.nii", background=0)
    for axis, position, shown in (("axial", 12, values[::-1, :, 3].T), ("coronal", 9, values[::-1, 3, :].T), ("sagittal", 4, values[2, ::-1, :].T)):
        rows, columns = shown.shape
        array, extent = vog.slice(scan, axis, position, resolution=(4 * columns, 4 * rows))
        picture = vog.render(scan, show="slice", plane=f"{axis}={position}", size=(4 * columns, 4 * rows))
        assert picture.values.shape == np.asarray(array).shape
        assert set(np.unique(np.asarray(array)[~np.isnan(np.asarray(array))])) == set(np.unique(shown))
        # The first row is the lowest: corners of the data at corners of the picture.
        found = np.asarray(array)
        inside = found[np.ix_(~np.isnan(found).all(1), ~np.isnan(found).all(0))]
        for y in (0, -1):
            for x in (0, -1):
                assert inside[y, x] == shown[y, x], (axis, x, y)
        # The extent has world coordinates, also where they fall to the right.
        _, columns_of, rows_of = {"axial": (2, 0, 1), "coronal": (1, 0, 2), "sagittal": (0, 1, 2)}[axis]
        edges = np.array([[-0.5, n - 0.5] for n in values.shape]) * np.array([2.0, 3, 4])[:, None]
        found = np.array(extent).reshape(2, 2)
        assert found[0, 0] > found[0, 1] and found[1, 0] < found[1, 1]
        assert found.sum(axis=1) == pytest.approx([edges[columns_of].sum(), edges[rows_of].sum()])
    made = vog.slice(scan, "axial", resolution=8)
    assert "slice of value," in repr(made) and made.pixel_area > 0
    assert made.header()["CTYPE1"] == "X" and made.header()["CDELT1"] < 0 < made.header()["CDELT2"]
    middle = vog.slice(scan, "axial").array
    assert set(np.unique(middle[~np.isnan(middle)])) <= set(np.unique(values[:, :, 3])) | set(np.unique(values[:, :, 4]))
    with pytest.raises(vog.Error, match="axial"):
        vog.slice(voxels(some_array()), "axial")
