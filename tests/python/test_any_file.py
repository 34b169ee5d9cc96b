"""The command `python3 -m vog` on files that Python reads, and the texts of its notes and errors."""
import os

import numpy as np
import pytest

import vog
from vog.__main__ import main

VOG = os.environ.get("VOG_COMMAND")
pytestmark = pytest.mark.skipif(not VOG, reason="VOG_COMMAND names no command")


@pytest.fixture
def run(tmp_path, monkeypatch, capfd):
    """Runs `python3 -m vog ARGUMENTS` in the test's own folder; returns its exit code and all that it prints."""
    monkeypatch.setenv("PATH", os.path.dirname(VOG) + os.pathsep + os.environ["PATH"])
    monkeypatch.chdir(tmp_path)

    def runs(*words):
        code = main([str(word) for word in words])
        return code, "".join(capfd.readouterr())

    return runs


@pytest.fixture
def mesh(tmp_path):
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    made = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    made["rho"], made["T"] = np.linspace(1, 2, 27), np.linspace(-5, 60, 27)
    made["vel"] = np.stack([np.linspace(1, 3, 27)] * 3, -1)
    made.save(tmp_path / "mesh.vtu")


def test_fields_of_meshes_are_drawn_and_renamed(run, mesh):
    for show in ("volume", "maximum"):
        code, text = run("render", "mesh.vtu", "--grid", "rho", "--show", show, "--field", "T", "--size", "32", "-o", "t.png")
        assert code == 0 and "T" in text, text
    code, text = run("render", "mesh.vtu", "--grid", "rho", "--show", "mean", "--field=speed=vel.x", "--size", "32", "-o", "t.png")
    assert code == 0 and "speed.x" in text
    assert run("convert", "mesh.vtu", "--grid", "rho", "--field", "heat=T", "-o", "m.ply")[0] == 0
    assert set(vog.Gaussians.load("m.ply").fields) == {"heat", "rho"}
    _, fields = vog.load("mesh.vtu", "rho", fields={"heat": "T"})
    assert fields is None
    code, text = run("render", "mesh.vtu", "--grid", "rho", "--field", "T", "--size", "32", "-o", "t.png")
    assert code != 0 and "--field has no effect" in text


def test_mistakes_with_meshes_are_one_line(run, mesh):
    assert run("convert", "mesh.vtu", "--grid", "rho", "--budget", "abc", "-o", "m.ply") == (1, "vog: --budget abc: write a whole number\n")
    code, text = run("evaluate", "mesh.vtu", "--grid", "rho", "-o", "e")
    assert code == 1 and text.startswith("vog: mesh.vtu: ") and text.count("\n") == 1


def test_options_of_loading(run, tmp_path):
    xarray = pytest.importorskip("xarray", reason="needs xarray (pip install xarray)")
    pytest.importorskip("netCDF4", reason="needs netCDF4")
    values = np.stack([np.ones((3, 4, 5)), np.full((3, 4, 5), 2.0)])
    xarray.Dataset({"rho": (("time", "z", "y", "x"), values), "T": (("time", "z", "y", "x"), values)}).to_netcdf("a.nc")
    code, text = run("convert", "a.nc", "--block", "1", "-o", "a.ply")
    assert code == 0 and text.count("time 0 of 2; --at time=N takes another") == 1
    assert run("convert", "a.nc", "--at", "time=1", "--load", "voxel_size=2", "--block", "1", "--field", "heat=T", "-o", "b.ply")[0] == 0
    model = vog.Gaussians.load("b.ply")
    assert model.mass == pytest.approx(16 * vog.Gaussians.load("a.ply").mass, rel=1e-5) and model.fields["heat"].range == (2, 2)
    assert run("convert", "a.nc", "--at", "time=1.5", "-o", "a.ply") == (1, "vog: --at time 1.5: write a whole number\n")
    assert run("convert", "a.nc", "--load", "size=1", "-o", "a.ply")[1].count("--load") == 2
    assert run("a.nc", "--at", "time=1")[1].count("time 0") == 0
    vog.sample_cloud(64).save("c.vdb")
    assert run("info", "c.vdb", "--at", "time=1")[0] != 0


def test_suggested_commands_name_a_scalar(run, tmp_path):
    np.savez(tmp_path / "a.npz", wind=np.ones((4, 4, 4, 3)), heat=np.ones((4, 4, 4)))
    assert run("a.npz")[1].endswith("render a.npz --grid heat\n")
    np.savez(tmp_path / "b.npz", wind=np.ones((4, 4, 4, 3)))
    assert run("b.npz")[1].endswith("convert b.npz --grid wind --measure volume -o model.ply\n")
    assert run("convert", "b.npz", "--grid", "wind", "--measure", "volume", "-o", "model.ply")[0] == 0
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    pyvista.ImageData(dimensions=(3, 3, 3)).save(tmp_path / "c.vti")
    assert run("c.vti") == (1, "c.vti: data of VTK\nvog: c.vti: no arrays of numbers at points or in cells\n")


def test_patterns_of_levels_are_fields(tmp_path):
    coarse = vog.Volume.from_numpy(np.ones((8, 8, 8)), voxel_size=1, origin=(0.5, 0.5, 0.5))
    fine = vog.Volume.from_blocks([((0, 0, 0), np.full((8, 8, 8), 3.0))], voxel_size=0.5, origin=(0.25, 0.25, 0.25), all_active=True)
    vog.Levels([coarse, fine]).save(tmp_path / "l.vdb", fields={"heat": [np.full((8, 8, 8), -1.0), np.full((8, 8, 8), -5.0)]})
    levels, fields = vog.load(tmp_path / "l.vdb", fields=["heat_L*"])
    assert vog.convert(levels, block=1, fields=fields).fields["heat"].range == (-5, -1)
