"""Data of other packages: readers without them say what to install; VTK, xarray, yt where they are."""
import os
import pickle
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import vog
from conftest import SOURCE
from vog import _packages, _python


def test_absent_packages_are_named_with_the_remedy():
    with pytest.raises(ImportError, match=r"vog.to_x: the Python package nothing_of_this_name is not installed.*pip install nothing_of_this_name"):
        _packages.need("nothing_of_this_name.part", "vog.to_x")


def test_other_interpreters_are_told(tmp_path):
    with pytest.raises(ImportError, match="expected Python 3.9 or later"):
        _python.require_python((3, 6, 0))
    (tmp_path / "_vog.cpython-27-x86_64-linux-gnu.so").touch()
    with pytest.raises(ImportError, match="is built for another: _vog.cpython-27"):
        _python.require_python(folder=str(tmp_path))


def test_vtk_has_points_and_voxels():
    pytest.importorskip("vtkmodules", reason="needs python3-vtk9")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    density, heat = vog.sample_fire(64)
    model = vog.convert(density, block=8, fields={"temperature": heat})
    points = vog.to_vtk(model)
    assert points.GetNumberOfPoints() == points.GetNumberOfVerts() == len(model)
    arrays = points.GetPointData()
    np.testing.assert_array_equal(vtk_to_numpy(arrays.GetArray("density")), model.density)
    np.testing.assert_array_equal(vtk_to_numpy(arrays.GetArray("scale")), model.scale)
    assert vtk_to_numpy(arrays.GetArray("mass")).sum() == pytest.approx(model.mass, rel=1e-6)
    assert arrays.GetArray("temperature") and arrays.GetArray("temperature_gradient")

    image = vog.to_vtk(density)
    lower, upper = density.index_box
    assert image.GetDimensions() == tuple(np.array(upper) - np.array(lower) + 1)
    values = vtk_to_numpy(image.GetPointData().GetArray("density")).reshape(image.GetDimensions(), order="F")
    np.testing.assert_array_equal(values, density.to_numpy())
    place = image.GetOrigin()
    np.testing.assert_allclose(place, (density.matrix @ [*lower, 1])[:3])
    voxels = vog.to_vtk(model, like=density)
    assert voxels.GetPointData().GetArray("temperature")
    with pytest.raises(vog.Error, match="a Volume has its own lattice"):
        vog.to_vtk(density, voxel_size=1)
    levels = vog.sample_levels(64)
    blocks = vog.to_vtk(levels)
    assert [blocks.GetBlock(n).GetNumberOfPoints() for n in range(blocks.GetNumberOfBlocks())] == [level.to_numpy().size for level in levels]
    with pytest.raises(TypeError, match="expected Gaussians, a Volume or Levels"):
        vog.to_vtk(np.zeros(3))


def test_xarray_brings_coordinates_and_units():
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    values = np.arange(1, 25, dtype=float).reshape(2, 3, 4)
    array = xarray.DataArray(values, dims=("z", "y", "x"), name="rain", attrs={"units": "g/m3"},
                             coords={"z": ("z", [10.0, 20.0], {"units": "m"}), "y": ("y", [2.0, 1.0, 0.0], {"units": "m"}),
                                     "x": ("x", [0.0, 1.0, 2.0, 3.0], {"units": "m"})})  # fmt: skip
    volume = vog.from_xarray(array)
    assert volume.name == "rain" and vog.units_of(volume) == ("g/m3", "m")
    got = volume.to_numpy()
    np.testing.assert_array_equal(got, values.transpose(2, 1, 0)[:, ::-1, :])
    np.testing.assert_allclose(volume.matrix[:3, 3], [0, 0, 10])
    with pytest.raises(vog.Error, match="not evenly spaced"):
        vog.from_xarray(array.assign_coords(x=("x", [0.0, 1.0, 2.0, 9.0])))
    with pytest.raises(TypeError, match="expected a DataArray"):
        vog.from_xarray(values)


@pytest.mark.parametrize(
    "limits", [{"valid_range": np.array([2, 20], np.int16)}, {"valid_min": np.int16(2), "valid_max": np.int16(20)}, {"valid_range": [1.2, 3.0]}]
)
def test_values_beyond_the_valid_range_of_netcdf_are_missing(tmp_path, limits):
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    pytest.importorskip("scipy", reason="needs scipy (pip install scipy)")
    packed = np.arange(24, dtype=np.int16).reshape(2, 3, 4)
    attributes = {"scale_factor": 0.1, "add_offset": 1.0, **limits}
    xarray.Dataset({"rain": (("z", "y", "x"), packed, attributes)}).to_netcdf(tmp_path / "rain.nc", engine="scipy")
    seen = np.where((packed >= 2) & (packed <= 20), packed * 0.1 + 1, np.nan).transpose(2, 1, 0)
    array = xarray.open_dataset(tmp_path / "rain.nc", engine="scipy")["rain"]
    for read in (lambda **rules: vog.from_xarray(array, **rules), lambda **rules: vog.load(tmp_path / "rain.nc", **rules)):
        np.testing.assert_allclose(read(skip_nonfinite=True).to_numpy(), np.nan_to_num(seen)[:, :, :], rtol=1e-6)
    with pytest.raises(vog.Error, match="'rain': valid range 'low', expected two numbers"):
        vog.from_xarray(array.assign_attrs(valid_range="low"))


def test_nibabel_and_paths_agree(tmp_path):
    nibabel = pytest.importorskip("nibabel", reason="needs nibabel (pip install nibabel)")
    values = np.random.default_rng(1).random((5, 6, 7)).astype(np.float32) + 0.1
    affine = np.array([[0, -2, 0, 5], [1.5, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1.0]])
    image = nibabel.Nifti1Image(values, affine)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, tmp_path / "a.nii.gz")
    by_path, by_image = vog.from_nifti(str(tmp_path / "a.nii.gz")), vog.from_nifti(nibabel.load(tmp_path / "a.nii.gz"))
    np.testing.assert_array_equal(by_path.to_numpy(), by_image.to_numpy())
    np.testing.assert_allclose(by_path.matrix, by_image.matrix)
    assert vog.units_of(by_path).length == vog.units_of(by_image).length == "mm"


def test_tifffile_and_paths_agree(tmp_path):
    tifffile = pytest.importorskip("tifffile", reason="needs tifffile (pip install tifffile)")
    values = np.random.default_rng(1).integers(1, 200, (4, 5, 6)).astype(np.uint8)
    tifffile.imwrite(tmp_path / "s.tif", values, imagej=True, resolution=(2, 2), metadata={"spacing": 3, "unit": "um", "axes": "ZYX"})
    by_path = vog.from_tiff(tmp_path / "s.tif")
    with tifffile.TiffFile(tmp_path / "s.tif") as file:
        by_file = vog.from_tiff(file)
    np.testing.assert_array_equal(by_file.to_numpy(), values.T)
    np.testing.assert_array_equal(by_path.to_numpy(), by_file.to_numpy())
    np.testing.assert_allclose(np.diag(by_file.matrix)[:3], [0.5, 0.5, 3])


@pytest.mark.parametrize("name, shape, written, frame, channel, edges, unit", [
    ("units.ome.tif", (4, 5, 6), {"metadata": {"axes": "ZYX", "PhysicalSizeX": 200, "PhysicalSizeXUnit": "nm", "PhysicalSizeY": 200,
     "PhysicalSizeYUnit": "nm", "PhysicalSizeZ": 0.5, "PhysicalSizeZUnit": "\u00b5m"}}, 0, 0, (200, 200, 500), "nm"),
    ("channels.ome.tif", (2, 4, 5, 6), {"metadata": {"axes": "CZYX", "PhysicalSizeX": 2, "PhysicalSizeY": 2, "PhysicalSizeZ": 3}}, 0, 1, (2, 2, 3), "um"),
    ("frames.tif", (2, 4, 5, 6), {"imagej": True, "resolution": (2, 2), "metadata": {"axes": "TZYX", "spacing": -3, "unit": "um"}}, 1, 0, (0.5, 0.5, 3), "um"),
    ("one_page.tif", (4, 5, 6), {"truncate": True}, 0, 0, (1, 1, 1), None),
    ("axes.tif", (2, 4, 5, 6), {"metadata": {"axes": "CZYX"}}, 0, 1, (1, 1, 1), None),
])
def test_stacks_of_tifffile_lie_alike_by_path_and_by_file(tmp_path, name, shape, written, frame, channel, edges, unit):
    tifffile = pytest.importorskip("tifffile", reason="needs tifffile (pip install tifffile)")
    values = np.random.default_rng(1).integers(1, 200, shape).astype(np.uint16)
    tifffile.imwrite(tmp_path / name, values, photometric="minisblack", **written)
    wanted = values[max(frame, channel)] if len(shape) == 4 else values
    with tifffile.TiffFile(tmp_path / name) as file:
        by_file = vog.from_tiff(file, frame=frame, channel=channel)
    for volume in (vog.from_tiff(tmp_path / name, frame=frame, channel=channel), by_file):
        np.testing.assert_array_equal(volume.to_numpy(), wanted.T)
        np.testing.assert_allclose(np.diag(volume.matrix)[:3], edges)
        assert vog.units_of(volume).length == unit


def test_an_sform_of_zeros_leaves_the_qform(tmp_path):
    nibabel = pytest.importorskip("nibabel", reason="needs nibabel (pip install nibabel)")
    values = np.random.default_rng(1).random((5, 6, 7)).astype(np.float32) + 0.1
    affine = np.array([[0, -2, 0, 5], [1.5, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1.0]])
    image = nibabel.Nifti1Image(values, affine)
    image.set_qform(affine, 1)
    image.header["sform_code"] = 1
    for row in ("srow_x", "srow_y", "srow_z"):
        image.header[row] = 0
    (tmp_path / "a.nii").write_bytes(image.header.binaryblock + bytes(4) + values.tobytes(order="F"))
    head = bytearray((tmp_path / "a.nii").read_bytes())
    head[108:112] = np.float32(352).tobytes()
    (tmp_path / "a.nii").write_bytes(bytes(head))
    with pytest.warns(UserWarning, match="the qform places its voxels"):
        by_path = vog.from_nifti(tmp_path / "a.nii")
    np.testing.assert_allclose(by_path.matrix, affine, atol=1e-5)
    np.testing.assert_allclose(vog.from_nifti(nibabel.load(tmp_path / "a.nii")).matrix, affine, atol=1e-5)


def test_yt_levels_and_covering_grid():
    yt = pytest.importorskip("yt", reason="needs yt (pip install yt)")
    data = {"density": (np.random.default_rng(1).random((16, 16, 16)) + 0.5, "g/cm**3")}
    ds = yt.load_uniform_grid(data, (16, 16, 16), length_unit="Mpc", nprocs=8)
    levels, volume = vog.from_yt(ds, "density", unit="g/cm**3"), vog.from_yt(ds, "density", level=0, unit="g/cm**3")
    np.testing.assert_allclose(levels[0].to_numpy(), volume.to_numpy(), rtol=1e-6)
    with pytest.raises(vog.Error, match="no field"):
        vog.from_yt(ds, "nothing")


def test_yt_octrees_and_particles_need_a_level():
    yt = pytest.importorskip("yt", reason="needs yt (pip install yt)")
    leaves = {("stream", "density"): (np.arange(1.0, 65).reshape(64, 1), "g/cm**3")}
    tree = yt.load_octree(octree_mask=np.array([8] + [0] * 8, np.uint8), data=leaves, bbox=np.array([[0, 1.0]] * 3), num_zones=2)
    with pytest.raises(vog.Error, match="or level= for a covering grid"):
        vog.from_yt(tree, "density")
    with pytest.raises(vog.Error, match="level 2, expected 0 to 1"):
        vog.from_yt(tree, "density", level=2)
    cover = np.asarray(tree.covering_grid(1, left_edge=tree.domain_left_edge, dims=[4] * 3)["density"])
    np.testing.assert_allclose(vog.from_yt(tree, "density", level=1, unit="g/cm**3").to_numpy(), cover, rtol=1e-6)
    places = {f"particle_position_{axis}": np.random.default_rng(k).random(500) for k, axis in enumerate("xyz")}
    particles = yt.load_particles({**places, "particle_mass": np.ones(500)}, length_unit="kpc", mass_unit="Msun", bbox=np.array([[0, 1.0]] * 3))
    assert vog.from_yt(particles, ("deposit", "all_density"), level=3, unit="Msun/kpc**3").to_numpy().sum() == pytest.approx(500 * 8**3, rel=1e-5)


def test_yt_lengths_convert_in_every_direction():
    """Width in Mpc, columns in CGS and headers in FITS's own units, of a data set in code units: 8 cells of 2 Mpc."""
    yt = pytest.importorskip("yt", reason="needs yt (pip install yt)")
    ds = yt.load_uniform_grid({"density": (np.full((8, 8, 8), 2.0), "g/cm**3")}, (8, 8, 8), length_unit=(16, "Mpc"))
    levels = vog.from_yt(ds, "density", unit="g/cm**3")
    found = vog.projection(levels, resolution=8, width=(16, "Mpc"), center=([8, 8, 8], "Mpc"))
    assert found.extent == pytest.approx((0, 1, 0, 1))  # code_length
    # Numbers of yt's megaparsec and vog's float32.
    assert np.asarray(found.array.to_value("g/cm**2")) == pytest.approx(2 * 16 * 3.0856775814913673e24, rel=1e-5)
    assert str(found.unit) == "g/cm**2"
    header = found.header()
    assert header["CUNIT1"] == "Mpc" and header["CDELT1"] == pytest.approx(2, rel=1e-6)
    assert header["CRVAL2"] == pytest.approx(0, abs=1e-9) and "code" not in header["BUNIT"]
    with pytest.raises(vog.Error, match="width"):
        vog.projection(levels, width=(16, "g"))


def test_pictures_and_files_of_models_know_the_units_of_a_data_set(tmp_path):
    """vog.render converts as vog.projection does, of voxels, of a model and of its file; other labels are refused."""
    yt = pytest.importorskip("yt", reason="needs yt (pip install yt)")
    units = pytest.importorskip("astropy.units", reason="needs astropy (pip install astropy)")
    ds = yt.load_uniform_grid({"density": (np.full((8, 8, 8), 2.0), "g/cm**3")}, (8, 8, 8), length_unit=(16, "Mpc"))
    levels = vog.from_yt(ds, "density", unit="g/cm**3")
    camera = vog.Camera((0.5, 0.5, 3), (0.5, 0.5, 0.5), (0, 1, 0), orthographic_width=0.5)
    model = vog.convert(levels, block=1)
    model.save(tmp_path / "m.ply")
    expected = 2 * 16 * 3.0856775814913673e24  # g / cm2
    for data in (levels, model, vog.Gaussians.load(tmp_path / "m.ply"), pickle.loads(pickle.dumps(model))):
        picture = vog.render(data, camera, 8, show="column", units="g/cm2")
        assert picture.values.mean() == pytest.approx(expected, rel=0.02), data
        with pytest.raises(vog.Error, match="the data are in"):
            vog.render(data, camera, 8, show="column", units="K")
    read = vog.Gaussians.load(tmp_path / "m.ply")
    assert vog.units_of(read) == ("g/cm**3", "16 Mpc")
    found = vog.projection(read, resolution=8, width=(8, "Mpc"), unit="g/cm2")
    assert found.extent == pytest.approx((0.25, 0.75, 0.25, 0.75))
    assert found.array.mean().value == pytest.approx(expected, rel=0.02)
    header = vog.projection(read, resolution=8, width=(8, "Mpc")).header()
    assert header["CUNIT1"] == "Mpc" and header["CDELT1"] == pytest.approx(1, rel=1e-6)
    assert units.Unit(header["BUNIT"], format="fits") == units.Unit("g Mpc / cm3")


def test_pyvista_wraps():
    pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    model = vog.convert(vog.sample_cloud(64), block=8)
    assert vog.to_pyvista(model).n_points == len(model)


def test_paraview_example(tmp_path, monkeypatch):
    pytest.importorskip("vtkmodules", reason="needs python3-vtk9")
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData

    model = vog.convert(vog.sample_cloud(64), block=8)
    model.save(tmp_path / "m.ply")
    monkeypatch.setenv("VOG_MODEL", str(tmp_path / "m.ply"))
    script = (SOURCE / "examples" / "paraview_source.py").read_text()
    for size, output in (("0", vtkPolyData()), ("0.1", vtkImageData())):
        monkeypatch.setenv("VOG_VOXEL_SIZE", size)

        class Source:  # as ParaView's
            @staticmethod
            def GetOutputDataObject(_, made=output):
                return made

        exec(compile(script, "paraview_source.py", "exec"), {"self": Source})
        assert output.GetPointData().GetArray("density") and output.GetNumberOfPoints() > 100


PVPYTHON = """
import sys
from paraview import simple, servermanager
made = simple.ProgrammableSource()
made.OutputDataSetType = sys.argv[1]
made.Script = open(sys.argv[2]).read()
simple.UpdatePipeline(proxy=made)
data = servermanager.Fetch(made)
print("points", data.GetNumberOfPoints(), [data.GetPointData().GetArrayName(n) for n in range(data.GetPointData().GetNumberOfArrays())])
"""


@pytest.mark.parametrize("kind, size", [("vtkPolyData", 0), ("vtkImageData", 0.1)])
def test_paraview_runs_the_example(tmp_path, kind, size):
    if not shutil.which("pvpython"):
        pytest.skip("needs pvpython (apt install paraview)")
    model = vog.convert(vog.sample_cloud(64), block=8)
    model.save(tmp_path / "m.ply")
    (tmp_path / "run.py").write_text(PVPYTHON)
    environment = {**os.environ, "VOG_MODEL": str(tmp_path / "m.ply"), "VOG_VOXEL_SIZE": str(size), "PYTHONPATH": str(Path(vog.__file__).parents[1])}
    done = subprocess.run(["pvpython", "--force-offscreen-rendering", tmp_path / "run.py", kind, SOURCE / "examples" / "paraview_source.py"],
                          env=environment, capture_output=True, text=True, timeout=300)  # fmt: skip
    found = re.search(r"points (\d+) (.*)", done.stdout)
    assert found, done.stdout + done.stderr
    assert "'density'" in found[2]
    expected = len(model) if size == 0 else np.prod(vog.voxelize(model, voxel_size=size).to_numpy().shape)
    assert int(found[1]) == expected


def test_fits_example(tmp_path):
    fits = pytest.importorskip("astropy.io.fits", reason="needs astropy (pip install astropy)")
    vog.convert(vog.sample_cloud(64), block=8).save(tmp_path / "m.ply")
    command = [sys.executable, SOURCE / "examples" / "projection_to_fits.py", tmp_path / "m.ply", tmp_path / "m.fits", "g / cm3", "kpc"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with fits.open(tmp_path / "m.fits") as file:
        head = file[0].header
        assert head["CUNIT1"] == "kpc" and head["CTYPE1"] == "X" and head["BUNIT"]
        assert file[0].data.shape[1] == 512
