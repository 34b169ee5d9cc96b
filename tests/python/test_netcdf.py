"""Variables of NetCDF and Zarr that vog.load refuses or names otherwise than most: other lattices, unwritten values, groups, no numbers."""
import warnings

import numpy as np
import pytest

import vog

xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
netCDF4 = pytest.importorskip("netCDF4", reason="needs netCDF4 (pip install netCDF4)")


@pytest.mark.parametrize("origin, cell, shift", [(0, 50, 25), (5e6, 20, 40), (0, 1e-9, 5e-10), (5e6, 50, 0.5)])
def test_other_lattices_are_refused_in_voxels(tmp_path, origin, cell, shift):
    ones, x = np.ones((4, 4, 5)), origin + cell * np.arange(5)
    coords = {"x": x, "xu": x + shift, "y": cell * np.arange(4), "z": cell * np.arange(4)}
    xarray.Dataset({"rho": (("z", "y", "x"), ones), "u": (("z", "y", "xu"), ones)}, coords).to_netcdf(tmp_path / "a.nc")
    with pytest.raises(vog.Error, match="'u' has other coordinates than 'rho'"):
        vog.load(tmp_path / "a.nc", "rho", fields=["u"])


def test_fields_of_other_sizes_are_refused(tmp_path):
    xarray.Dataset({"rho": (("z", "y", "x"), np.ones((4, 5, 6))), "w": (("zw", "y", "x"), np.ones((5, 5, 6)))}).to_netcdf(tmp_path / "a.nc")
    with pytest.raises(vog.Error, match="'w' has 6 x 5 x 5 voxels, 'rho' 6 x 5 x 4"):
        vog.load(tmp_path / "a.nc", "rho", fields=["w"])


@pytest.mark.parametrize("kind", ["f4", "f8", "i2", "i4"])
def test_unwritten_values_are_missing(tmp_path, kind):
    with netCDF4.Dataset(tmp_path / "a.nc", "w") as file:
        for name in "zyx":
            file.createDimension(name, 4)
        file.createVariable("rho", kind, tuple("zyx"))[:2] = 3
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert vog.load(tmp_path / "a.nc", skip_nonfinite=True).mass == 3 * 32


@pytest.mark.skipif(not hasattr(xarray, "open_groups"), reason="needs an xarray that opens groups (pip install -U xarray)")
def test_groups_are_paths_and_texts_are_no_numbers(tmp_path):
    with netCDF4.Dataset(tmp_path / "a.nc", "w") as file:
        group = file.createGroup("model")
        for name in "zyx":
            group.createDimension(name, 4)
        group.createVariable("rho", "f4", tuple("zyx"))[:] = 1
        group.createVariable("mark", "S1", tuple("zyx"))[:] = "a"
    assert vog.load(tmp_path / "a.nc").mass == 64 and vog.load(tmp_path / "a.nc", "model/rho").name == "model/rho"
    with pytest.raises(vog.Error, match="'model/mark' holds no numbers but .*; model/rho holds some"):
        vog.load(tmp_path / "a.nc", "model/mark")


def test_names_of_the_metre_are_one_unit(tmp_path):
    coords = {name: (name, np.arange(4.0), {"units": unit}) for name, unit in zip("xyz", ("m", "metre", "meters"))}
    xarray.Dataset({"rho": (tuple("zyx"), np.ones((4, 4, 4)))}, coords).to_netcdf(tmp_path / "a.nc")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert vog.load(tmp_path / "a.nc").mass == 64


def test_a_bare_array_of_zarr_is_named(tmp_path):
    zarr = pytest.importorskip("zarr", reason="needs zarr (pip install zarr)")
    zarr.save_array(str(tmp_path / "a.zarr"), np.ones((4, 4, 4)))
    with pytest.raises(vog.Error, match="array of Zarr without names of axes|has no dimension names"):
        vog.load(tmp_path / "a.zarr")
