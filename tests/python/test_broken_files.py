"""Broken and incomplete files: one vog.Error line that names the file, and nothing of other packages' logs."""
import json
import shutil

import numpy as np
import pytest

import vog


def refused(path, match, capfd, **options):
    with pytest.raises(vog.Error, match=match) as error:
        vog.load(path, **options)
    assert str(path) in str(error.value) and "\n" not in str(error.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("ending, binary", [("vti", True), ("vtk", True), ("vtk", False), ("vtu", True)])
def test_truncated_files_of_vtk(tmp_path, capfd, ending, binary):
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    image = pyvista.ImageData(dimensions=(12, 12, 12))
    image["rho"] = np.linspace(1, 2, 12**3)
    file = tmp_path / f"a.{ending}"
    (image.cast_to_unstructured_grid() if ending == "vtu" else image).save(file, binary=binary)
    assert vog.load(file) is not None
    file.write_bytes(file.read_bytes()[:-3000])
    refused(file, "VTK cannot read it: ", capfd)


def test_missing_parts_are_named(tmp_path, capfd):
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    image = pyvista.ImageData(dimensions=(4, 4, 4))
    image["rho"] = np.ones(64)
    pyvista.MultiBlock([image, image.translate((3, 0, 0), inplace=False)]).save(tmp_path / "m.vtm")
    (tmp_path / "m" / "m_1.vti").unlink()
    refused(tmp_path / "m.vtm", "m_1.vti", capfd)
    image.save(tmp_path / "p0.vti")
    entry = lambda name, time: f'<DataSet timestep="{time}" part="0" file="{name}"/>'
    (tmp_path / "t.pvd").write_text(f'<VTKFile type="Collection"><Collection>{entry("p1.vti", 0)}{entry("p0.vti", 1)}</Collection></VTKFile>')
    refused(tmp_path / "t.pvd", "p1.vti", capfd)
    (tmp_path / "b.pvd").write_text("<VTKFile")
    refused(tmp_path / "b.pvd", "cannot be read", capfd)


def test_partitioned_data_of_vtk(tmp_path, capfd):
    core, model = (pytest.importorskip(f"vtkmodules.{name}", reason="needs vtk (pip install vtk)") for name in ("vtkIOParallelXML", "vtkCommonDataModel"))
    from vtkmodules.util.numpy_support import numpy_to_vtk

    def image(at):
        one = model.vtkImageData()
        one.SetDimensions(4, 4, 4)
        one.SetOrigin(at, 0, 0)
        values = numpy_to_vtk(np.ones(27), deep=True)
        values.SetName("rho")
        one.GetCellData().AddArray(values)
        return one

    both, parts = model.vtkPartitionedDataSetCollection(), model.vtkPartitionedDataSet()
    parts.SetPartition(0, image(0))
    parts.SetPartition(1, image(3))
    both.SetPartitionedDataSet(0, parts)
    writer = core.vtkXMLPartitionedDataSetCollectionWriter()
    writer.SetFileName(str(tmp_path / "a.vtpc"))
    writer.SetInputData(both)
    writer.Write()
    data = vog.load(tmp_path / "a.vtpc", "rho")
    assert abs(vog.convert(data).mass - 54) < 1e-3
    next((tmp_path / "a").rglob("*.vti")).unlink()
    refused(tmp_path / "a.vtpc", "VTK cannot read it: ", capfd, density="rho")


@pytest.mark.parametrize("form", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA"])
@pytest.mark.parametrize("time", [None, 3])
def test_truncated_files_of_classic_netcdf(tmp_path, capfd, form, time):
    netcdf = pytest.importorskip("netCDF4", reason="needs netCDF4 (pip install netCDF4)")
    pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    file = tmp_path / "a.nc"
    with netcdf.Dataset(file, "w", format=form) as made:
        made.title = "one, two"
        for axis, length in (("time", time), ("z", 5), ("y", 6), ("x", 7)):
            made.createDimension(axis, length)
        for name in ("rho", "heat"):
            made.createVariable(name, "f4", ("time", "z", "y", "x"))[:] = np.ones((3, 5, 6, 7))
        made.createVariable("flag", "i1", ("time",))[:] = 1
    whole = file.read_bytes()
    assert vog.load(file, "rho", at={"time": 2}).mass == 210
    for length in (len(whole) - 4, len(whole) // 2):
        file.write_bytes(whole[:length])
        refused(file, f"truncated: {length:,} bytes, expected 5,", capfd, density="rho", at={"time": 2})


def test_broken_arrays(tmp_path, capfd):
    np.savez(tmp_path / "a.npz", density=np.ones((8, 8, 8)))
    (tmp_path / "a.npz").write_bytes((tmp_path / "a.npz").read_bytes()[:1000])
    refused(tmp_path / "a.npz", "cannot be read: File is not a zip file", capfd)
    h5py = pytest.importorskip("h5py", reason="needs h5py (pip install h5py)")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["density"] = np.ones((8, 8, 8))
    (tmp_path / "a.h5").write_bytes((tmp_path / "a.h5").read_bytes()[:3000])
    refused(tmp_path / "a.h5", "cannot be read: .*truncated", capfd)


def test_broken_images_of_ome_zarr(tmp_path, capfd):
    zarr = pytest.importorskip("zarr", reason="needs zarr (pip install zarr)")
    if int(zarr.__version__.split(".")[0]) < 3:
        pytest.skip("needs zarr 3")
    file = tmp_path / "a.zarr"
    group = zarr.open_group(str(file), mode="w", zarr_format=2)
    group.create_array("0", shape=(4, 4, 4), dtype="u2", chunks=(4, 4, 4))[:] = 7
    image = {"axes": [{"name": axis} for axis in "zyx"], "datasets": [{"path": "0"}]}

    def write(text):
        (file / ".zattrs").write_text(text)

    for text, match in (('{"multiscales": [{', "cannot be read: "), ('{"multiscales": []}', "cannot be read: IndexError"),
                        (json.dumps({"multiscales": [{**image, "axes": [{"name": axis} for axis in "czyx"]}]}), "an array with 3 axes"),
                        (json.dumps({"multiscales": [{**image, "coordinateTransformations": [{"type": "scale", "scale": [1, 0, 1]}]}]}), "the scale of axis y is 0"),
                        (json.dumps({"multiscales": [{**image, "datasets": [{"path": "1"}]}]}), "cannot be read: KeyError: '1'")):  # fmt: skip
        write(text)
        refused(file, match, capfd)
    write(json.dumps({"multiscales": [image]}))
    assert vog.load(file, background=0).mass == 7 * 64
    (file / "0" / "0.0.0").write_bytes(b"garbage")
    refused(file, "cannot be read: ", capfd, background=0)
    shutil.rmtree(file)


@pytest.mark.parametrize("at", [3, {"time": "x"}, {"time": 1.5}])
def test_indices_along_axes_are_checked(tmp_path, capfd, at):
    np.save(tmp_path / "a.npy", np.ones((4, 4, 4)))
    refused(tmp_path / "a.npy", "write an index for each axis", capfd, at=at)
