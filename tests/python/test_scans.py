"""Dense images: files of other packages, and the examples of docs/scans.md."""
import re

import numpy as np
import pytest

import vog
from conftest import SOURCE

OBLIQUE = np.array([[0.6, -0.8, 0.1, -31], [0.9, 0.5, -0.2, 12.5], [0.1, 0.3, 2.5, 80], [0, 0, 0, 1.0]])


def some_values(shape=(5, 7, 9), dtype="int16"):
    return np.random.default_rng(1).integers(1, 100, shape).astype(dtype)


def expect(volume, values, matrix):
    assert np.allclose(volume.matrix, matrix, atol=1e-5)
    assert np.array_equal(volume.to_numpy(first=(0, 0, 0), shape=values.shape), values.astype("f4"))


def block(word):
    found = [b for b in re.findall(r"```python\n(.*?)```", (SOURCE / "docs/scans.md").read_text(), re.S) if word in b]
    assert len(found) == 1
    return found[0]


def run(word, folder, monkeypatch):
    monkeypatch.chdir(folder)
    names = {"vog": vog, "np": np}
    with pytest.warns(UserWarning) if "clip_negative" in block(word) else __import__("contextlib").nullcontext():
        exec(block(word), names)
    return names["volume"]


def test_raw_values(tmp_path):
    values = some_values()
    (tmp_path / "a.raw").write_bytes(values.tobytes(order="F"))
    (tmp_path / "a.json").write_text('{"size": [5, 7, 9], "type": "int16", "spacing": [1, 2, 3], "name": "dose"}')
    volume = vog.Volume.load(tmp_path / "a.raw")
    assert volume.name == "dose" and vog.grid_names(tmp_path / "a.raw") == ["dose"]
    expect(volume, values, np.diag([1, 2, 3, 1]))


def test_nibabel(tmp_path, monkeypatch):
    nibabel = pytest.importorskip("nibabel")
    values = some_values()
    for name, image in (("a.nii", nibabel.Nifti1Image), ("a.nii.gz", nibabel.Nifti2Image)):
        nibabel.save(image(values, OBLIQUE), tmp_path / name)
        expect(vog.Volume.load(tmp_path / name), values, nibabel.load(tmp_path / name).affine)
    values[0, 0, 0] = -5
    nibabel.save(nibabel.Nifti1Image(values, OBLIQUE), tmp_path / "brain.nii.gz")
    values[0, 0, 0] = 0
    expect(run("nibabel", tmp_path, monkeypatch), values, OBLIQUE)


def test_simpleitk(tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    values = some_values()
    turn, _ = np.linalg.qr(OBLIQUE[:3, :3])
    turn *= np.sign(np.linalg.det(turn))
    image = sitk.GetImageFromArray(values.T)
    image.SetSpacing((0.7, 1.1, 2.5))
    image.SetOrigin((3, -4, 5))
    image.SetDirection(turn.flatten().tolist())
    corners = [image.TransformIndexToPhysicalPoint(p) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
    lps = np.eye(4)
    lps[:3, 3] = corners[0]
    lps[:3, :3] = np.subtract(corners[1:], corners[0]).T
    for name in ("a.mha", "a.mhd", "a.nrrd", "a.nhdr", "a.nii"):
        for packed in (False, True):
            sitk.WriteImage(image, str(tmp_path / name), packed)
            expect(vog.Volume.load(tmp_path / name), values, np.diag([-1, -1, 1, 1]) @ lps)


def test_pynrrd(tmp_path):
    nrrd = pytest.importorskip("nrrd")
    values = some_values(dtype="uint16")
    for encoding in ("raw", "gzip", "ascii"):
        head = {"encoding": encoding, "space": "right-anterior-superior", "space directions": OBLIQUE[:3, :3].T,
                "space origin": OBLIQUE[:3, 3]}
        nrrd.write(str(tmp_path / "a.nrrd"), values, head)
        expect(vog.Volume.load(tmp_path / "a.nrrd"), values, OBLIQUE)


def test_tifffile(tmp_path, monkeypatch):
    tifffile = pytest.importorskip("tifffile")
    values = some_values(dtype="uint16")
    tifffile.imwrite(tmp_path / "stack.tif", values.T, imagej=True, resolution=(5, 5),
                     metadata={"spacing": 0.5, "unit": "um", "axes": "ZYX"})
    expect(vog.Volume.load(tmp_path / "stack.tif"), values, np.diag([0.2, 0.2, 0.5, 1]))
    expect(run("tifffile", tmp_path, monkeypatch), values, np.diag([0.2, 0.2, 0.5, 1]))
    for options in ({"tile": (16, 16)}, {"compression": "zlib"}, {"rowsperstrip": 2}, {"bigtiff": True}):
        tifffile.imwrite(tmp_path / "a.tif", values.T.astype("f4"), photometric="minisblack", **options)
        expect(vog.Volume.load(tmp_path / "a.tif"), values, np.eye(4))


def test_astropy(tmp_path, monkeypatch):
    fits = pytest.importorskip("astropy.io.fits")
    values = some_values(dtype="float32")
    values[0, 0, 0] = np.nan
    values[1, 0, 0] = -1
    head = fits.Header({"CDELT1": 2.0, "CDELT2": 3.0, "CDELT3": 4.0, "CRPIX1": 1.0, "CRPIX2": 1.0, "CRPIX3": 1.0})
    fits.PrimaryHDU(values.T, head).writeto(tmp_path / "cube.fits")
    values[0, 0, 0] = values[1, 0, 0] = 0
    expect(run("astropy", tmp_path, monkeypatch), values, np.eye(4))
    with pytest.warns(UserWarning):
        volume = vog.Volume.load(tmp_path / "cube.fits", skip_nonfinite=True, clip_negative=True)
    expect(volume, values, np.diag([2, 3, 4, 1]))
    fits.HDUList([fits.PrimaryHDU(), fits.CompImageHDU(values.T.astype("i2"), head)]).writeto(tmp_path / "a.fits.fz")
    expect(vog.Volume.load(tmp_path / "a.fits.fz"), values, np.diag([2, 3, 4, 1]))


def test_h5py(tmp_path, monkeypatch):
    h5py = pytest.importorskip("h5py")
    values = some_values(dtype="float32")
    with h5py.File(tmp_path / "simulation.h5", "w") as file:
        file["density"] = values
        file["density"].attrs["dx"] = 0.25
    expect(run("h5py", tmp_path, monkeypatch), values, np.diag([0.25, 0.25, 0.25, 1]))
    position = np.random.default_rng(2).random((40, 3))
    with h5py.File(tmp_path / "snapshot.hdf5", "w") as file:
        gas = file.create_group("PartType0")
        gas.create_dataset("Coordinates", data=position, chunks=True, compression="gzip", shuffle=True)
        gas["Masses"] = np.arange(1, 41, dtype="f4")
        gas["ParticleIDs"] = np.arange(40)
    points = vog.Points.load(tmp_path / "snapshot.hdf5")
    assert np.array_equal(points.position, position)
    assert np.array_equal(points.attributes["Masses"], np.arange(1, 41))
    assert "ParticleIDs" not in points.attributes


def test_pydicom(tmp_path, monkeypatch):
    pydicom = pytest.importorskip("pydicom")
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid

    values = some_values((6, 5, 4))  # [x, y, z], stored with an intercept of -10
    (tmp_path / "series").mkdir()
    for z in range(4):
        meta = FileMetaDataset()
        meta.TransferSyntaxUID = ExplicitVRLittleEndian
        meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = "1.2.840.10008.5.1.4.1.1.2", generate_uid()
        one = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
        one.SOPClassUID, one.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
        one.Rows, one.Columns, one.PixelSpacing = 5, 6, [2, 3]
        one.ImageOrientationPatient, one.ImagePositionPatient = [1, 0, 0, 0, 1, 0], [7, 8, 9 + 4 * z]
        one.SamplesPerPixel, one.PhotometricInterpretation = 1, "MONOCHROME2"
        one.BitsAllocated = one.BitsStored = 16
        one.HighBit, one.PixelRepresentation = 15, 1
        one.RescaleSlope, one.RescaleIntercept = 1, -10
        one.PixelData = values[:, :, z].T.astype("<i2").tobytes()
        one.save_as(tmp_path / "series" / f"{(z * 7) % 4}.dcm", enforce_file_format=True)
    matrix = np.diag([-3, -2, 4, 1]).astype(float)
    matrix[:3, 3] = -7, -8, 9
    expect(run("pydicom", tmp_path, monkeypatch), np.maximum(values - 10, 0), matrix)
