"""Dense images: files of other packages, and the examples of docs/scans.md."""
import importlib.util
import re
import warnings

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


def test_volumes_have_the_units_of_their_files(tmp_path):
    values = some_values()
    (tmp_path / "a.raw").write_bytes(values.tobytes(order="F"))
    for stated, density in (("g/cm**3", "g/cm**3"), ("HU", None)):
        if density and not _has_units():
            continue
        (tmp_path / "a.json").write_text(
            '{"size": [5, 7, 9], "type": "int16", "unit": "um", "value_unit": "%s"}' % stated)
        for data in (vog.Volume.load(tmp_path / "a.raw"), vog.Volume.load(file=str(tmp_path / "a.raw")),
                     vog.Levels.load([tmp_path / "a.raw"]), vog.Levels.load(tmp_path / "a.raw")):
            assert vog.units_of(data) == (density, "um")
        vog.convert(vog.Volume.load(tmp_path / "a.raw", clip_negative=True), block=4).save(tmp_path / "a.ply")
        assert vog.units_of(vog.Gaussians.load(tmp_path / "a.ply")) == (density, "um"), "models keep them"
    assert vog.units_of(vog.Volume.load(tmp_path / "a.raw", mask=True)) == (None, "um")
    vog.sample_cloud(64).save(tmp_path / "c.vdb")
    assert vog.units_of(vog.Volume.load(tmp_path / "c.vdb")) == (None, None)


def _has_units():
    return any(importlib.util.find_spec(package) for package in ("astropy", "pint"))


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
    placed = np.diag([0.2, 0.2, 0.5, 1])
    placed[:3, 3] = [-0.6, 0.2, -1]
    for axes in ({}, {"cf": 0, "c0": -2.0, "c1": 0.5, "vunit": "OD"}, {"cf": 1, "c0": 1.0, "c1": 0.0, "c2": 2.0}):
        tifffile.imwrite(tmp_path / "fiji.tif", values.T, imagej=True, resolution=(5, 5),
                         metadata={"spacing": 0.5, "unit": "um", "axes": "ZYX", "xorigin": 3.0, "yorigin": -1.0, "zorigin": 2.0, **axes})
        terms = [axes.get(f"c{n}", n == 1) for n in range(3)] if axes.get("cf") else [axes.get("c0", 0), axes.get("c1", 1)]
        shown = np.polynomial.polynomial.polyval(values.astype(float), terms)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            by_path = vog.Volume.load(tmp_path / "fiji.tif", clip_negative=True)
            by_image = vog.from_tiff(tifffile.TiffFile(tmp_path / "fiji.tif"), clip_negative=True)
        for volume in (by_path, by_image):
            expect(volume, np.maximum(shown, 0), placed)
            assert vog.units_of(volume).length == "um"
    for options in ({"tile": (16, 16)}, {"dtype": "f2"}, {"compression": "zlib"}, {"rowsperstrip": 2}, {"bigtiff": True}):
        dtype = options.pop("dtype", "f4")
        tifffile.imwrite(tmp_path / "a.tif", values.T.astype(dtype), photometric="minisblack", **options)
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
    # Linear maps as astropy.wcs has them, by every keyword.
    from astropy.wcs import WCS

    for keys in ({"CD1_2": 2.0, "CD2_1": 3.0, "CDELT3": 5.0}, {"CD1_1": 2.0, "CD2_2": 3.0, "CD3_3": 0.0, "CRPIX3": 3.0},
                 {"PC1_1": 0.8, "PC1_2": -0.6, "PC2_1": 0.6, "PC2_2": 0.8, "CRVAL1": 7.0}, {"PC1_2": -0.5, "CDELT2": 3.0},
                 {"PC1_1": 0.8, "CD1_1": 2.0, "CDELT3": 4.0}, {"CROTA2": 30.0, "CDELT1": 2.0}, {"CDELT1": -2.0, "CRPIX1": 2.0},
                 {"CD1_3": 2.0, "CD3_1": 3.0, "CD2_2": 4.0, "CD1_1": 1.0}):
        fits.PrimaryHDU(values.T, fits.Header(keys)).writeto(tmp_path / "w.fits", overwrite=True)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            corners = WCS(fits.getheader(tmp_path / "w.fits")).wcs_pix2world([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], 0)
            volume = vog.Volume.load(tmp_path / "w.fits", skip_nonfinite=True, clip_negative=True)
        assert np.allclose(volume.matrix[:3], np.c_[(corners[1:] - corners[0]).T, corners[0]]), keys
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
        one.is_little_endian, one.is_implicit_VR = True, False
        one.save_as(tmp_path / "series" / f"{(z * 7) % 4}.dcm", write_like_original=False)
    matrix = np.diag([-3, -2, 4, 1]).astype(float)
    matrix[:3, 3] = -7, -8, 9
    expect(run("pydicom", tmp_path, monkeypatch), values - 10 + 1000, matrix)  # above the background of -1000
