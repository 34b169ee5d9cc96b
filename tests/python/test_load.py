"""vog.load and python -m vog: files made by their own libraries come with their values, places, fields and units."""
import functools
import http.server
import os
import re
import subprocess
import sys
import threading

import numpy as np
import pytest

import vog

VOG = os.environ.get("VOG_COMMAND")
SHAPE = (5, 6, 7)


def values(offset=0.5):
    return np.random.default_rng(1).random(SHAPE) + offset


def check(loaded, expected, spacing, origin, signed=None):
    volume, fields = loaded
    np.testing.assert_allclose(volume.to_numpy((0, 0, 0), expected.shape), expected, rtol=1e-6)
    np.testing.assert_allclose(volume.matrix, [[spacing[0], 0, 0, origin[0]], [0, spacing[1], 0, origin[1]], [0, 0, spacing[2], origin[2]], [0, 0, 0, 1]])
    if signed is not None:
        model = vog.convert(volume, block=1, soft_steps=0, mass_threshold=0, fields=fields)
        heat = model.fields["heat"]
        assert heat.range == pytest.approx((signed.min(), signed.max()), rel=1e-5)
        at = np.linalg.solve(volume.matrix, np.append(model.world_mean, np.ones((len(model), 1)), axis=1).T)[:3]
        np.testing.assert_allclose(heat.value, signed[tuple(np.rint(at).astype(int))], atol=1e-6)


def test_numpy(tmp_path):
    density, heat = values(), values(-1)
    np.savez(tmp_path / "a.npz", rho=density, heat=heat, title="words", wind_x=heat, wind_y=heat, wind_z=heat)
    check(vog.load(tmp_path / "a.npz", fields=["heat"], voxel_size=(1, 2, 3)), density, (1, 2, 3), (0, 0, 0), heat)
    volume, fields = vog.load(tmp_path / "a.npz", "volume", fields=["heat", "wind"])
    assert volume.mass == pytest.approx(heat.size)
    model = vog.convert(volume, block=1, soft_steps=0, mass_threshold=0, fields=fields)
    assert model.fields["wind"].is_vector and model.fields["heat"].range[0] == pytest.approx(heat.min())
    with pytest.raises(vog.Error, match="a.npz: 'wind' is a vector, which is no density, expected one of wind_x, wind_y, wind_z"):
        vog.load(tmp_path / "a.npz", "wind")
    with pytest.raises(vog.Error, match="a.npz: no field 'x', expected one of rho, heat"):
        vog.load(tmp_path / "a.npz", "x")
    with pytest.raises(vog.Error, match="negative"):
        vog.load(tmp_path / "a.npz", "heat")
    with pytest.raises(vog.Error, match="level has no effect on NumPy arrays"):
        vog.load(tmp_path / "a.npz", level=1)
    np.save(tmp_path / "b.npy", density)
    np.testing.assert_allclose(vog.load(tmp_path / "b.npy").to_numpy(), density, rtol=1e-6)
    for edges in (-1, 0, float("nan"), (1, -1, 1), (1, 2)):
        with pytest.raises(vog.Error, match="edges of voxels .*: expected a number or .* finite and above 0"):
            vog.load(tmp_path / "b.npy", voxel_size=edges)
    (tmp_path / "c.npy").write_bytes(b"\x93NUMPY\x01")
    with pytest.raises(vog.Error, match="c.npy: not an array of numbers"):
        vog.load(tmp_path / "c.npy")
    np.save(tmp_path / "d.npy", np.ones(3))
    with pytest.raises(vog.Error, match=r"density \(3,\), expected an array of numbers"):
        vog.load(tmp_path / "d.npy")


def test_own_formats(tmp_path):
    cloud = vog.sample_cloud(64)
    cloud.save(tmp_path / "c.vdb")
    assert vog.load(tmp_path / "c.vdb").mass == pytest.approx(cloud.mass)
    vog.convert(cloud, block=8).save(tmp_path / "m.ply")
    assert isinstance(vog.load(tmp_path / "m.ply"), vog.Gaussians)
    vog.Points.from_numpy(np.eye(3)).save(tmp_path / "p.csv")
    assert isinstance(vog.load(tmp_path / "p.csv"), vog.Points)
    with pytest.raises(vog.Error, match="level has no effect"):
        vog.load(tmp_path / "c.vdb", level=1)


def test_saved_volumes_and_levels_keep_fields_and_units(tmp_path, command):
    density = values()
    volume = vog.set_units(vog.Volume.from_numpy(density), "g/cm3", "kpc")
    volume.save(tmp_path / "a.vdb", fields={"heat": {"value": density - 1, "unit": "K"}, "wind": np.stack([density] * 3, -1)})
    assert vog.grid_names(tmp_path / "a.vdb") == ["density", "heat", "wind"]
    again, fields = vog.load(tmp_path / "a.vdb", fields=["heat", "wind"])
    model = vog.convert(again, block=1, fields=fields)
    assert model.fields["heat"].unit == "K" and model.fields["heat"].range[0] == pytest.approx(density.min() - 1, rel=1e-5) and model.fields["wind"].is_vector
    with pytest.raises(vog.Error, match="half and fields"):
        volume.save(tmp_path / "a.vdb", half=True, fields={"heat": density})

    coarse = vog.Volume.from_numpy(np.ones((8, 8, 8)), voxel_size=1, origin=(0.5, 0.5, 0.5))
    fine = vog.Volume.from_blocks([((0, 0, 0), np.full((8, 8, 8), 3.0))], voxel_size=0.5, origin=(0.25, 0.25, 0.25), all_active=True)
    levels = vog.Levels([coarse, fine])
    heat = [np.full((8, 8, 8), -1.0), np.full((8, 8, 8), -5.0)]
    levels.save(tmp_path / "l.vdb", fields={"heat": {"value": heat, "unit": "K"}})
    assert vog.grid_names(tmp_path / "l.vdb") == ["density_L0", "heat_L0", "density_L1", "heat_L1"]
    assert vog.load(tmp_path / "l.vdb").arrangement == levels.arrangement
    command("convert", "l.vdb", "-o", "l.ply", "--block", "1", "--field", "heat=heat_L*", "--grid", "density_L*")
    read = vog.Gaussians.load(tmp_path / "l.ply")
    assert read.mass == pytest.approx(vog.convert(levels, block=1).mass, rel=1e-5)
    assert read.fields["heat"].range == (-5, -1) and read.fields["heat"].unit == "K"
    pytest.importorskip("astropy", reason="units of densities need astropy (pip install astropy)")
    assert vog.units_of(again) == ("g/cm3", "kpc")


def test_vtk_grids(tmp_path):
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    density, heat = values(), values(-1)
    image = pyvista.ImageData(dimensions=SHAPE, spacing=(1, 2, 3), origin=(4, 5, 6))
    image["density"], image["heat"] = density.ravel(order="F"), heat.ravel(order="F")
    image.save(tmp_path / "a.vti")
    check(vog.load(tmp_path / "a.vti", fields=["heat"]), density, (1, 2, 3), (4, 5, 6), heat)
    cells = pyvista.ImageData(dimensions=np.add(SHAPE, 1), spacing=(1, 2, 3), origin=(4, 5, 6))
    cells.cell_data["density"], cells.cell_data["heat"] = density.ravel(order="F"), heat.ravel(order="F")
    cells.save(tmp_path / "b.vtk")
    check(vog.load(tmp_path / "b.vtk", fields=["heat"]), density, (1, 2, 3), (4.5, 6, 7.5), heat)
    axes = [np.arange(n) * step for n, step in zip(SHAPE, (1, 2, 3))]
    even = pyvista.RectilinearGrid(*axes)
    even["density"] = density.ravel(order="F")
    even.save(tmp_path / "c.vtr")
    check((vog.load(tmp_path / "c.vtr"), {}), density, (1, 2, 3), (0, 0, 0))
    turned = even.cast_to_structured_grid().rotate_z(90, inplace=False)
    turned.save(tmp_path / "d.vts")
    np.testing.assert_allclose(vog.load(tmp_path / "d.vts").matrix, [[0, -2, 0, 0], [1, 0, 0, 0], [0, 0, 3, 0], [0, 0, 0, 1]], atol=1e-6)
    (tmp_path / "e.vti").write_text("<VTKFile>")
    with pytest.raises((vog.Error, ImportError), match="e.vti"):
        vog.load(tmp_path / "e.vti")


def dataset():
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    z, y, x = np.arange(7.0) * 3, np.arange(6.0)[::-1] * 2, np.arange(5.0)
    data = {name: (("time", "z", "y", "x"), np.stack([given.T, 2 * given.T]), {"units": unit})
            for name, given, unit in (("density", values(), "g/m3"), ("heat", values(-1), "K"))}  # fmt: skip
    return xarray.Dataset(data, {"z": ("z", z, {"units": "m"}), "y": ("y", y, {"units": "m"}), "x": ("x", x, {"units": "m"}), "time": [0, 1]})


@pytest.mark.parametrize("name, package", [("a.nc", "netCDF4"), ("a.zarr", "zarr")])
def test_xarray(tmp_path, name, package):
    pytest.importorskip(package, reason=f"needs {package}")
    data = dataset()
    data.to_zarr(tmp_path / name) if name.endswith("zarr") else data.to_netcdf(tmp_path / name)
    with pytest.warns(UserWarning, match="time 0 of 2"):
        loaded = vog.load(tmp_path / name, fields=["heat"])
    check(loaded, values()[:, ::-1], (1, 2, 3), (0, 0, 0), values(-1)[:, ::-1])
    assert vog.units_of(loaded[0]) == ("g/m3", "m") and loaded[1]["heat"]["unit"] == "K"
    check((vog.load(tmp_path / name, at={"time": 1}), {}), 2 * values()[:, ::-1], (1, 2, 3), (0, 0, 0))
    with pytest.raises(vog.Error, match="time 2, expected 0 to 1"):
        vog.load(tmp_path / name, at={"time": 2})


def test_arrays_are_read_in_parts(tmp_path, monkeypatch):
    """Rows of chunks that end beside those of leaves, an axis downwards, and empty parts."""
    pytest.importorskip("zarr", reason="needs zarr (pip install zarr)")
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    array = np.random.default_rng(2).random((37, 9, 5)).astype(np.float32) + 0.5
    array[21:29] = 0
    xarray.Dataset({"density": (("z", "y", "x"), array)}, {"z": np.arange(37.0)[::-1]}).to_zarr(tmp_path / "a.zarr", encoding={"density": {"chunks": (5, 9, 5)}})
    from vog import _files

    monkeypatch.setattr(_files, "_PART_BYTES", 1)
    with vog.memory_limit(2**30):
        volume = vog.load(tmp_path / "a.zarr")
    np.testing.assert_array_equal(volume.to_numpy((0, 0, 0), (5, 9, 37)), array[::-1].T)
    assert volume.leaves == 2 * 4  # two rows of leaves, without the empty ones
    array[3, 4, 2] = -1
    xarray.Dataset({"density": (("z", "y", "x"), array)}).to_zarr(tmp_path / "b.zarr")
    with pytest.raises(vog.Error, match="negative"):
        vog.load(tmp_path / "b.zarr")
    xarray.Dataset({"density": (("z", "y", "x"), 0 * array)}).to_zarr(tmp_path / "c.zarr")
    with pytest.raises(vog.Error, match="density: no active voxel"):
        vog.load(tmp_path / "c.zarr")


def test_limits_of_memory():
    assert vog.peak_memory() > 1e6
    with vog.memory_limit(1e9), pytest.raises(vog.Error, match="limit"), vog.memory_limit(1e9):
        pass
    with pytest.raises(vog.Error, match="memory"), vog.memory_limit(1e6):
        pass
    for bytes in (0, -1, float("nan"), 1e30):
        with pytest.raises(vog.Error, match="memory_limit: .* bytes, expected at least 64 MiB"):
            vog.memory_limit(bytes)


@pytest.mark.parametrize("dims", [("x", "y", "z", "time"), ("z", "y", "x", "member"), ("lon", "lat", "lev", "time"), ("x", "y", "depth", "channel")])
def test_axes_are_taken_by_their_names(tmp_path, dims):
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    pytest.importorskip("netCDF4", reason="needs netCDF4")
    given = values() if dims[0] != "z" else values().T
    array = xarray.DataArray(np.stack([given, 2 * given], -1), dims=dims, name="density")
    xarray.Dataset({"density": array, "heat": array.isel({dims[3]: 0}, drop=True)}).to_netcdf(tmp_path / "a.nc")
    with pytest.warns(UserWarning, match=f"{dims[3]} 0 of 2"):
        check((vog.load(tmp_path / "a.nc"), {}), values(), (1, 1, 1), (0, 0, 0))
    check((vog.load(tmp_path / "a.nc", at={dims[3]: 1}), {}), 2 * values(), (1, 1, 1), (0, 0, 0))
    # `at` is of fields, too.
    _, fields = vog.load(tmp_path / "a.nc", "heat", fields=["density"], at={dims[3]: 1})
    np.testing.assert_allclose(fields["density"][0][1], 2 * values())
    with pytest.raises(vog.Error, match=f"no axis 'tiem' beside x, y and z, expected {dims[3]}") as refused:
        vog.load(tmp_path / "a.nc", at={"tiem": 1})
    assert "\n" not in str(refused.value)


def test_directions_of_coordinates_in_several_units(tmp_path):
    """Latitudes that fall run to the north, and pressures that fall upwards, as in cubes of 1."""
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    pytest.importorskip("netCDF4", reason="needs netCDF4")
    places = {"lev": ("lev", np.array([1000.0, 900, 850, 700, 500, 300, 200]), {"units": "hPa"}),
              "lat": ("lat", np.linspace(60.0, 40, 6), {"units": "degrees_north"}), "lon": ("lon", np.arange(5.0), {"units": "degrees_east"})}  # fmt: skip
    data = xarray.Dataset({"density": (("lev", "lat", "lon"), values().T)}, places)
    for name, one in (("a.nc", data), ("b.nc", data.isel(lev=slice(None, None, -1)))):
        one.to_netcdf(tmp_path / name)
        with pytest.warns(UserWarning, match="coordinates of several units"):
            check((vog.load(tmp_path / name), {}), values()[:, ::-1], (1, 1, 1), (0, 0, 0))
        check((vog.load(tmp_path / name, voxel_size=(1, 2, 3)), {}), values()[:, ::-1], (1, 2, 3), (0, 0, 0))
    np.testing.assert_allclose(vog.from_xarray(data["density"], voxel_size=1).to_numpy(), values()[:, ::-1], rtol=1e-6)


def test_coordinates_along_two_axes_are_noted(tmp_path):
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    pytest.importorskip("netCDF4", reason="needs netCDF4")
    data = xarray.Dataset({"density": (("z", "y", "x"), values().T)}, {"lat": (("y", "x"), np.ones((6, 5)))})
    data.to_netcdf(tmp_path / "a.nc")
    for call in (lambda: vog.load(tmp_path / "a.nc"), lambda: vog.from_xarray(data["density"])):
        with pytest.warns(UserWarning, match="coordinates along several axes are left out: lat; positions are indices .*StructuredGrid"):
            check((call(), {}), values(), (1, 1, 1), (0, 0, 0))


def test_broken_netcdf_is_one_line(tmp_path):
    pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    (tmp_path / "a.nc").write_bytes(b"nothing")
    with pytest.raises(vog.Error, match="a.nc: xarray cannot read it") as refused:
        vog.load(tmp_path / "a.nc")
    assert "\n" not in str(refused.value)


def test_hdf5(tmp_path):
    h5py = pytest.importorskip("h5py", reason="needs h5py (pip install h5py)")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["run/density"], file["run/heat"], file["time"] = values(), values(-1), 3.0
        file["run/heat"].attrs["units"] = "K"
    volume, fields = vog.load(tmp_path / "a.h5", "run/density", fields=["run/heat"], voxel_size=2)
    check((volume, {}), values(), (2, 2, 2), (0, 0, 0))
    assert fields["run/heat"]["unit"] == "K"
    with h5py.File(tmp_path / "b.h5", "w") as file:
        for name, unit in (("density", np.bytes_("g/cm3")), ("heat", [np.bytes_("K")])):
            file[name] = values()
            file[name].attrs["units"] = unit
    volume, fields = vog.load(tmp_path / "b.h5", fields=["heat"])
    assert vog.units_of(volume).density == "g/cm3" and fields["heat"]["unit"] == "K"


def test_objects_beside_arrays_are_left_out(tmp_path):
    np.savez(tmp_path / "a.npz", density=values(), meta=np.array([{}], object))
    np.testing.assert_allclose(vog.load(tmp_path / "a.npz").to_numpy(), values(), rtol=1e-6)


def test_ome_zarr_takes_channels_places_and_levels(tmp_path):
    zarr = pytest.importorskip("zarr", reason="needs zarr (pip install zarr)")
    group = zarr.open_group(tmp_path / "a.zarr", mode="w")
    stack = np.random.default_rng(1).integers(20, 250, (2, 8, 12, 16)).astype(np.uint8)
    for n, step in enumerate((1, 2)):
        part = stack[:, ::step, ::step, ::step]
        group[str(n)] = part
    axes = [{"name": "c", "type": "channel"}] + [{"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"]
    datasets = [{"path": str(n), "coordinateTransformations": [{"type": "scale", "scale": [1, 3 * 2**n, 2 * 2**n, 2**n]},
                 {"type": "translation", "translation": [0, 5, 6, 7]}]} for n in range(2)]  # fmt: skip
    group.attrs["multiscales"] = [{"axes": axes, "datasets": datasets, "version": "0.4"}]
    group.attrs["omero"] = {"channels": [{"label": "nuclei"}, {"label": "walls"}]}
    loaded = vog.load(tmp_path / "a.zarr", "walls", fields=["nuclei"], background=0)
    check(loaded, stack[1].T, (1, 2, 3), (7, 6, 5))
    np.testing.assert_array_equal(loaded[1]["nuclei"][0][1], stack[0].T)
    assert vog.units_of(loaded[0]).length == "um"
    check((vog.load(tmp_path / "a.zarr", "walls", level=1, background=0), {}), stack[1, ::2, ::2, ::2].T, (2, 4, 6), (7, 6, 5))


def write_ome(folder, units, channels=1):
    zarr = pytest.importorskip("zarr", reason="needs zarr (pip install zarr)")
    group = zarr.open_group(folder, mode="w")
    group["0"] = np.random.default_rng(1).integers(20, 250, (channels, 8, 12, 16)).astype(np.uint8)
    axes = [{"name": "c", "type": "channel"}] + [{"name": axis, **({"unit": unit} if unit else {})} for axis, unit in zip("zyx", units)]
    steps = [{"type": "scale", "scale": [1, 4000, 3, 2]}, {"type": "translation", "translation": [0, 1000, 6, 7]}]
    group.attrs["multiscales"] = [{"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": steps}]}]
    group.attrs["omero"] = {"channels": [{"label": f"stain {n}"} for n in range(channels)]}


def test_ome_zarr_in_several_units_of_length(tmp_path):
    write_ome(tmp_path / "a.zarr", ("nanometer", "micrometer", "micrometer"))
    volume = vog.load(tmp_path / "a.zarr", background=0)
    np.testing.assert_allclose(volume.matrix @ [1, 1, 1, 1], [9, 9, 5, 1])
    assert vog.units_of(volume).length == "um"
    for units, words in ((("parsec", "micrometer", "micrometer"), "z parsec"), ((None, "micrometer", "micrometer"), "z without one")):
        write_ome(tmp_path / "a.zarr", units)
        with pytest.raises(vog.Error, match=f"axes in several units of length .*{words}"):
            vog.load(tmp_path / "a.zarr")


@pytest.fixture
def served(tmp_path):
    """Address of a folder by a server of this process."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=tmp_path)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()


def write_image(folder, size, chunk):
    """An OME-Zarr image of a ball of [size, size, size] 16-bit voxels."""
    zarr = pytest.importorskip("zarr", reason="needs zarr (pip install zarr)")
    group = zarr.open_group(folder, mode="w")
    if not hasattr(group, "create_array"):
        pytest.skip("needs zarr 3")
    array = group.create_array("0", shape=(size,) * 3, chunks=(chunk, size // 2, size // 2), dtype="u2")
    place = np.linspace(-1, 1, size, dtype=np.float32)
    for z in range(0, size, chunk):
        square = place[z : z + chunk, None, None] ** 2 + place[:, None] ** 2 + 2 * place**2
        array[z : z + chunk] = (np.clip(1 - np.sqrt(square), 0, 1) * 4000).astype("u2")
    scale = [{"type": "scale", "scale": [0.5, 0.25, 0.25]}]
    image = {"axes": [{"name": axis, "unit": "micrometer"} for axis in "zyx"], "datasets": [{"path": "0", "coordinateTransformations": scale}]}
    group.attrs["ome"] = {"multiscales": [image]}
    return array[:]


def test_stores_of_zarr_are_read_from_addresses(tmp_path, served):
    for package in ("aiohttp", "fsspec", "xarray"):
        pytest.importorskip(package, reason=f"needs {package}")
    stack = write_image(tmp_path / "image.zarr", 40, 16)
    check((vog.load(f"{served}/image.zarr", background=0), {}), stack.T, (0.25, 0.25, 0.5), (0, 0, 0))
    assert vog.units_of(vog.load(f"{served}/image.zarr", background=0)).length == "um"
    dataset().to_zarr(tmp_path / "wind.zarr")
    loaded = vog.load(f"{served}/wind.zarr", fields=["heat"], at={"time": 0})
    check(loaded, values()[:, ::-1], (1, 2, 3), (0, 0, 0), values(-1)[:, ::-1])
    for address, message in [(f"{served}/no.zarr", "no store of Zarr there"), ("http://127.0.0.1:9/a.zarr", "cannot be read")]:
        with pytest.raises(vog.Error, match=message) as refused:
            vog.load(address)
        assert "\n" not in str(refused.value)


@pytest.mark.skipif(not VOG, reason="needs the command (VOG_COMMAND)")
def test_an_image_at_an_address_is_converted_within_a_limit_of_memory(tmp_path, served):
    for package in ("aiohttp", "fsspec"):
        pytest.importorskip(package, reason=f"needs {package}")
    size = 384
    write_image(tmp_path / "image.zarr", size, 32)
    command = [sys.executable, "-m", "vog", "convert", f"{served}/image.zarr", "-o", f"{tmp_path}/a.ply"]
    command += ["--memory", "160M", "--block", "8", "--for", "none", "--no-hierarchy"]
    # A small process measures: a started one counts the peak of its parent as its own.
    measure = "import resource, subprocess, sys; subprocess.check_call(sys.argv[1:]); print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    environment = {**os.environ, "PATH": os.path.dirname(VOG) + os.pathsep + os.environ["PATH"]}
    done = subprocess.run([sys.executable, "-c", measure, *command], env=environment, check=True, capture_output=True, text=True)
    assert len(vog.Gaussians.load(tmp_path / "a.ply")) > 1000
    # The array has 226 MB in 32 bits, and as much again in leaves.
    assert int(done.stdout.split()[-1]) * 1024 < 0.9 * size**3 * 4


def write_dicom(folder, stack, spacing=(2.0, 0.5, 0.25), change=lambda slice_, n: None):
    pydicom = pytest.importorskip("pydicom", reason="needs pydicom (pip install pydicom)")
    from pydicom.dataset import FileMetaDataset

    uid = pydicom.uid.generate_uid()
    for n in np.random.default_rng(1).permutation(len(stack)):
        slice_ = pydicom.Dataset()
        slice_.file_meta = FileMetaDataset()
        slice_.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
        slice_.file_meta.MediaStorageSOPClassUID = slice_.SOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
        slice_.file_meta.MediaStorageSOPInstanceUID = slice_.SOPInstanceUID = pydicom.uid.generate_uid()
        slice_.SeriesInstanceUID, slice_.Modality = uid, "CT"
        slice_.ImageOrientationPatient, slice_.ImagePositionPatient = [1, 0, 0, 0, 1, 0], [10, 20, 30 + spacing[0] * float(n)]
        slice_.PixelSpacing = list(spacing[1:])
        slice_.Rows, slice_.Columns = stack.shape[1:]
        slice_.RescaleSlope, slice_.RescaleIntercept = 2, -1000
        slice_.SamplesPerPixel, slice_.PhotometricInterpretation = 1, "MONOCHROME2"
        slice_.BitsAllocated = slice_.BitsStored = 16
        slice_.HighBit, slice_.PixelRepresentation = 15, 0
        slice_.PixelData = stack[n].astype("<u2").tobytes()
        slice_.is_little_endian, slice_.is_implicit_VR = True, False
        change(slice_, n)
        slice_.save_as(folder / f"{n}.dcm", write_like_original=False)


def test_dicom_series(tmp_path):
    stack = np.random.default_rng(2).integers(100, 900, (4, 5, 6))
    write_dicom(tmp_path, stack)
    for path in (tmp_path, tmp_path / "2.dcm"):
        volume = vog.load(path, background=-1000)
        # RAS: DICOM's x and y the other way round.
        np.testing.assert_allclose(volume.matrix, [[-0.25, 0, 0, -10], [0, -0.5, 0, -20], [0, 0, 2, 30], [0, 0, 0, 1]])
        np.testing.assert_array_equal(volume.to_numpy(), 2 * stack.T)
        assert volume.background == -1000 and vog.units_of(volume).length == "mm"
    (tmp_path / "1.dcm").unlink()
    with pytest.raises(vog.Error, match="slices 2 to 4 mm apart, expected even steps"):
        vog.load(tmp_path)


@pytest.mark.parametrize("name, value, message", [
    ("PixelSpacing", None, "no PixelSpacing"), ("ImageOrientationPatient", None, "no ImageOrientationPatient"), ("Rows", 4, "6 x 4 pixels, 6 x 5 in "),
    ("NumberOfFrames", 3, "3 frames"), ("SamplesPerPixel", 3, "colours"), ("ImageOrientationPatient", [0, 1, 0, 0, 0, -1], "turned or scaled otherwise"),
    ("PixelData", b"12", "pydicom cannot read its pixels"),
])  # fmt: skip
def test_slices_that_make_no_series_are_named(tmp_path, name, value, message):
    write_dicom(tmp_path, np.ones((4, 5, 6), int), change=lambda slice_, n: n == 2 and (setattr(slice_, name, value) if value else delattr(slice_, name)))
    with pytest.raises(vog.Error, match=f"2.dcm: {message}.*dcm2niix") as refused:
        vog.load(tmp_path, background=0)
    assert "\n" not in str(refused.value)


def test_single_and_inverted_slices(tmp_path):
    def change(slice_, n):
        slice_.SpacingBetweenSlices, slice_.SliceThickness, slice_.PhotometricInterpretation = 4, 3, "MONOCHROME1"

    write_dicom(tmp_path, np.full((1, 5, 6), 700), change=change)
    with pytest.warns(UserWarning, match="MONOCHROME1, whose high values are meant to be dark: values are as stored"):
        volume = vog.load(tmp_path, background=-1000)
    assert volume.matrix[2, 2] == 4 and volume.to_numpy().max() == 1400


def test_openpmd(tmp_path):
    io = pytest.importorskip("openpmd_api", reason="needs openPMD-api (pip install openpmd-api)")
    series = io.Series(str(tmp_path / "a_%T.h5"), io.Access.create)
    step = series.iterations[5]
    for name, given in (("rho", values()), ("E", values(-1))):
        mesh = step.meshes[name]
        mesh.axis_labels, mesh.grid_spacing, mesh.grid_global_offset, mesh.grid_unit_SI = ["z", "y", "x"], [3.0, 2.0, 1.0], [6.0, 5.0, 4.0], 0.5
        for part in [io.Mesh_Record_Component.SCALAR] if name == "rho" else "xyz":
            mesh[part].position = [0.5, 0.5, 0.5]
            data = np.ascontiguousarray(given.T)
            mesh[part].reset_dataset(io.Dataset(data.dtype, data.shape))
            mesh[part].store_chunk(data)
    series.flush()
    series.close()
    pytest.importorskip("h5py", reason="needs h5py (pip install h5py)")
    volume, fields = vog.load(tmp_path / "a_5.h5", fields=["E"])
    check((volume, {}), values(), (0.5, 1, 1.5), (2.25, 3, 3.75))
    np.testing.assert_allclose(fields["E"][0][1][..., 1], values(-1))


def write_openpmd(path, meshes):
    """Meshes {name: (array, spacing, offset, unit, position, labels)}, with the component x of E."""
    io = pytest.importorskip("openpmd_api", reason="needs openPMD-api (pip install openpmd-api)")
    series = io.Series(str(path), io.Access.create)
    for name, (data, spacing, offset, unit, position, labels) in meshes.items():
        mesh = series.iterations[0].meshes[name]
        mesh.axis_labels, mesh.grid_spacing, mesh.grid_global_offset, mesh.grid_unit_SI = list(labels), [spacing] * 3, [offset] * 3, unit
        part = mesh["x" if name == "E" else io.Mesh_Record_Component.SCALAR]
        part.position = [position] * 3
        part.reset_dataset(io.Dataset(data.dtype, data.shape))
        part.store_chunk(np.ascontiguousarray(data))
        series.flush()
    series.close()


@pytest.mark.parametrize("ending", ["h5", "bp"])
def test_meshes_of_openpmd_have_their_own_lattices(tmp_path, ending):
    pytest.importorskip("h5py", reason="needs h5py (pip install h5py)")
    path, whole = tmp_path / f"a.{ending}", (values(), 2.0, 10.0, 0.5, 0.0, "xyz")
    write_openpmd(path, {"E": (values()[1:], 3.0, 1.0, 1.0, 0.5, "xyz"), "heat": (values(), 2.0, 10.0, 0.5, 0.5, "xyz"), "rho": whole, "flow": whole})
    check((vog.load(path), {}), values(), (1, 1, 1), (5, 5, 5))
    check((vog.load(path, "E_x"), {}), values()[1:], (3, 3, 3), (2.5, 2.5, 2.5))
    np.testing.assert_allclose(vog.load(path, fields=["flow"])[1]["flow"][0][1], values())
    with pytest.raises(vog.Error, match="'E_x' has another lattice than 'rho'"):
        vog.load(path, fields=["E_x"])
    with pytest.warns(UserWarning, match="'heat' is staggered, by 0.5, 0.5, 0.5 voxels from 'rho'"):
        vog.load(path, fields=["heat"])
    write_openpmd(tmp_path / f"b.{ending}", {"rho": (*whole[:5], "rtz")})
    with pytest.raises(vog.Error, match="rho along r, t, z, expected a mesh along x, y and z"):
        vog.load(tmp_path / f"b.{ending}")


def write_amrex(folder):
    (folder / "plt0/Level_0").mkdir(parents=True)
    (folder / "plt0/Header").write_text(
        "HyperCLaw-V1.1\n2\ndensity\nheat\n3\n0\n0\n0 0 0\n1 1 1\n\n((0,0,0) (7,7,7) (0,0,0))\n0\n0.125 0.125 0.125\n0\n0\n0 1 0\n0\n0 1\n0 1\n0 1\n"
        "Level_0/Cell\n")  # fmt: skip
    (folder / "plt0/Level_0/Cell_H").write_text("1\n1\n2\n0\n(1 0\n((0,0,0) (7,7,7) (0,0,0))\n)\n1\nFabOnDisk: Cell_D_00000 0\n\n1,2\n0,0,\n\n1,2\n1,1,\n")
    given = np.random.default_rng(1).random((2, 8, 8, 8)) + np.array([0.5, -0.5]).reshape(2, 1, 1, 1)
    head = b"FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2 1)))((0,0,0) (7,7,7) (0,0,0)) 2\n"
    (folder / "plt0/Level_0/Cell_D_00000").write_bytes(head + b"".join(part.astype("<f8").tobytes(order="F") for part in given))
    return given


def test_simulations_bring_fields(tmp_path):
    pytest.importorskip("yt", reason="needs yt (pip install yt)")
    density, heat = write_amrex(tmp_path)
    levels, fields = vog.load(tmp_path / "plt0", fields=["heat"])
    check((levels[0], fields), density, (0.125,) * 3, (0.0625,) * 3, heat)
    covering = vog.load(tmp_path / "plt0", level=0)
    np.testing.assert_allclose(covering.to_numpy(), density, rtol=1e-6)
    levels.save(tmp_path / "l.vdb", fields=fields)
    assert vog.grid_names(tmp_path / "l.vdb") == ["density", "heat"]


def test_uneven_and_curved_simulations_are_refused():
    yt = pytest.importorskip("yt", reason="needs yt (pip install yt)")
    data = {"density": np.ones((8, 8, 8))}
    widths = [np.array([0.05, 0.1, 0.2, 0.1, 0.05, 0.2, 0.2, 0.1]), np.full(8, 0.125), np.full(8, 0.125)]
    box = np.array([[1, 2], [0, np.pi], [0, 2 * np.pi]])
    for made, message in (
        (yt.load_uniform_grid(data, (8, 8, 8), bbox=box, geometry="spherical"), "spherical geometry, expected cartesian .*StructuredGrid"),
        (yt.load_uniform_grid(data, (8, 8, 8), bbox=np.array([[0, 1]] * 3), cell_widths=widths), "uneven widths, expected even ones .*RectilinearGrid"),
    ):  # fmt: skip
        with pytest.raises(vog.Error, match=message):
            vog.from_yt(made)


def test_missing_packages_are_named(tmp_path, monkeypatch):
    np.savez(tmp_path / "a.npz", density=values())
    for name in ("a.nc", "a.h5", "a.vti", "a.dcm", "a.bp"):
        (tmp_path / name).write_bytes(b"nothing")
        path = str(tmp_path / name)
        code = "import sys; sys.modules.update(dict.fromkeys('xarray h5py pyvista vtk vtkmodules pydicom openpmd_api'.split()));" \
               f"import vog\ntry: vog.load({path!r})\nexcept ImportError as error: print(error)"  # fmt: skip
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        assert re.fullmatch(r"load: .*a\.\w+: .*install(ed)?.*: pip install [\w-]+.*\n", done.stdout), done.stdout + done.stderr


@pytest.mark.skipif(not VOG, reason="VOG_COMMAND names no command")
class TestCommand:
    def run(self, folder, *words, code=0):
        environment = {**os.environ, "PATH": os.path.dirname(VOG) + os.pathsep + os.environ["PATH"]}
        done = subprocess.run([sys.executable, "-m", "vog", *map(str, words)], cwd=folder, env=environment, capture_output=True, text=True)
        assert done.returncode == code, done.stdout + done.stderr
        return done.stdout + done.stderr

    def test_commands_take_files_of_others(self, tmp_path):
        np.savez(tmp_path / "a.npz", **{"gas/rho": values(), "heat": values(-0.5)})
        assert "gas/rho" in self.run(tmp_path, "a.npz") and "python3 -m vog render a.npz" in self.run(tmp_path, "info", "a.npz")
        self.run(tmp_path, "convert", "a.npz", "--grid", "gas/rho", "--field", "T=heat", "--block", "1", "-o", "m.ply")
        model = vog.Gaussians.load(tmp_path / "m.ply")
        assert model.mass == pytest.approx(values().sum(), rel=1e-5) and model.fields["T"].range[0] == pytest.approx(values(-0.5).min(), rel=1e-5)
        self.run(tmp_path, "render", "a.npz", "--grid", "gas/rho", "--size", "32")
        assert (tmp_path / "a.png").exists()
        self.run(tmp_path, "convert", "a.npz", "--grid", "heat", "--measure", "volume", "--block", "1", "-o", "v.ply")
        assert vog.Gaussians.load(tmp_path / "v.ply").fields["heat"].range[0] == pytest.approx(values(-0.5).min(), rel=1e-5)
        line = self.run(tmp_path, "render", "a.npz", "--grid", "heat", "-o", "h.png", code=1)
        assert "--clip-negative" in line and line.count("\n") == 1
        self.run(tmp_path, "render", "a.npz", "--grid", "heat", "-o", "h.png", "--clip-negative")
        self.run(tmp_path, "render", "m.ply", "-o", "m.png", "--size", "32")
        assert "expected --grid with one: gas/rho, heat" in self.run(tmp_path, "render", "a.npz", "-o", "x.png", code=1)

    def test_levels_come_with_fields(self, tmp_path):
        pytest.importorskip("yt", reason="needs yt (pip install yt)")
        write_amrex(tmp_path)
        self.run(tmp_path, "convert", "plt0", "--field", "heat", "--block", "1", "-o", "m.ply")
        assert vog.Gaussians.load(tmp_path / "m.ply").fields["heat"].range[0] < 0

    def test_scans_come_as_scans(self, tmp_path):
        (tmp_path / "ct").mkdir()
        write_dicom(tmp_path / "ct", np.random.default_rng(2).integers(100, 900, (4, 5, 6)))
        self.run(tmp_path, "convert", "ct", "--set", "background-value=-1000", "-o", "ct.ply")
        assert "HU" in self.run(tmp_path, "info", "ct")

    def test_channels_are_chosen_by_their_names(self, tmp_path):
        write_ome(tmp_path / "a.zarr", ("micrometer",) * 3, channels=2)
        self.run(tmp_path, "convert", "a.zarr", "--grid", "stain 1", "--set", "background-value=0", "-o", "a.ply")
        assert vog.Gaussians.load(tmp_path / "a.ply").mass > 0
