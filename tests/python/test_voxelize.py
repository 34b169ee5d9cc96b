"""voxelize(): the volumes of vog voxelize, and fields as arrays."""
import numpy as np
import pytest

import vog


def test_volumes_are_the_commands(tmp_path, command, cloud):
    cloud.save(tmp_path / "cloud.vdb")
    command("convert", "cloud.vdb", "-o", "cloud.ply", "--block", 4)
    command("voxelize", "cloud.ply", "--like", "cloud.vdb", "-o", "command.vdb")
    model = vog.Gaussians.load(tmp_path / "cloud.ply")
    volume = vog.voxelize(model, like=cloud, file=tmp_path / "python.vdb")
    assert (tmp_path / "python.vdb").read_bytes() == (tmp_path / "command.vdb").read_bytes()
    assert volume.mass == pytest.approx(model.mass, rel=1e-5)
    assert np.array_equal(volume.matrix, cloud.matrix)
    inside = vog.voxelize(model, like=cloud, within=True)
    assert inside.mass <= volume.mass
    assert (np.asarray(inside.index_box)[0] >= np.asarray(cloud.index_box)[0]).all()


def test_levels_give_the_lattice_of_the_finest(tmp_path, command):
    levels = vog.sample_levels(64)
    names = [f"density_L{n}" for n in range(len(levels))]
    command("sample", "amr", "amr.vdb", "--size", "64")
    command("convert", "amr.vdb", "--grid", "density_L*", "-o", "amr.ply", "--block", 4)
    model = vog.Gaussians.load(tmp_path / "amr.ply")
    finest = min(levels, key=lambda level: np.linalg.det(level.matrix[:3, :3]))
    for within in (False, True):
        command("voxelize", "amr.ply", "--like", "amr.vdb", "--grid", "density_L*", "-o", "command.vdb", *["--within"] * within)
        for like in (levels, [levels[n] for n in range(len(names))]):
            volume = vog.voxelize(model, like=like, within=within, file=tmp_path / "python.vdb")
            assert (tmp_path / "python.vdb").read_bytes() == (tmp_path / "command.vdb").read_bytes()
            assert np.array_equal(volume.matrix, finest.matrix)
    # Within: the box of all levels, in voxels of the finest.
    lower, upper = (np.array(corner) for corner in volume.index_box)
    corners = [level.matrix[:3, :3] @ (np.array(corner) + half) + level.matrix[:3, 3]
               for level in levels for corner, half in zip(level.index_box, (-0.5, 0.5))]
    edge = np.diag(finest.matrix)[:3]
    assert (lower >= np.rint((np.min(corners, axis=0) - finest.matrix[:3, 3]) / edge + 0.5)).all()
    assert (upper <= np.rint((np.max(corners, axis=0) - finest.matrix[:3, 3]) / edge - 0.5)).all()


def test_fields_are_arrays_over_the_volume():
    model = vog.Gaussians(
        mean=[[0.2, 0.1, 0.0]],
        scale=[[1, 1.5, 0.7]],
        density=[2],
        fields={"temperature": {"value": [300.0], "gradient": [[10.0, 0, 0]], "deviation": [1.0], "skewness": [0.0]}},
    )
    volume, fields = vog.voxelize(model, voxel_size=0.5, fields=True, name="gas")
    assert volume.name == "gas" and list(fields) == ["temperature"]
    densities, temperature = volume.to_numpy(), fields["temperature"]
    assert temperature.shape == densities.shape and temperature.dtype == np.float32
    # Weighted by density the field has its mean at the Gaussian's, and rises by 5 a voxel.
    assert (densities * temperature).sum() / densities.sum() == pytest.approx(300, abs=1e-2)
    middle = temperature[:, temperature.shape[1] // 2, temperature.shape[2] // 2]
    assert np.diff(middle[middle > 0])[1:-1] == pytest.approx(5, abs=1)
    assert (temperature[densities == 0] == 0).all()


def test_surfaces_of_models_are_the_commands(tmp_path, command, cloud):
    model = vog.convert(cloud, block=4)
    model.save(tmp_path / "m.ply")
    for voxel_size in (None, 0.02):
        command("export", "m.ply", "-o", "m.obj", "--iso", 0.2, *(["--voxel-size", voxel_size] if voxel_size else []))
        lines = (tmp_path / "m.obj").read_text().splitlines()
        points, triangles = vog.isosurface(model, 0.2, voxel_size=voxel_size)
        assert [sum(line.startswith(f"{kind} ") for line in lines) for kind in "vf"] == [len(points), len(triangles)]
        assert len(triangles) > 100
    with pytest.raises(vog.Error, match="voxel_size has no effect on a Volume"):
        vog.isosurface(cloud, 0.2, voxel_size=1)
    with pytest.raises(TypeError, match="expected a Volume or Gaussians"):
        vog.isosurface([cloud], 0.2)


def test_refusals(cloud):
    model = vog.convert(cloud, block=8)
    for arguments in [{}, {"voxel_size": 1, "like": cloud}, {"voxel_size": 0}, {"voxel_size": float("nan")},
                      {"voxel_size": 1, "within": True}, {"voxel_size": 1, "name": "density", "file": "v.txt"}]:
        with pytest.raises(vog.Error):
            vog.voxelize(model, **arguments)
