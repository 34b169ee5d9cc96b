"""The code of tutorial and README runs; the examples convert and render their inputs."""
import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

import vog
from conftest import SOURCE, same_picture


VOG = os.environ.get("VOG_COMMAND")


def blocks(file):
    return re.findall(r"```python\n(.*?)```", (SOURCE / file).read_text(), re.S)


@pytest.mark.parametrize("file, least", [("docs/python.md", 10), ("README.md", 1)])
def test_code_in_the_docs_runs(file, least, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = blocks(file)
    assert len(code) >= least
    names = {}
    for n, block in enumerate(code):
        exec(compile(block, f"{file}, block {n + 1}", "exec"), names)
    assert list(tmp_path.glob("*.png"))


def test_the_tutorials_picture_is_current(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(blocks("docs/python.md")[0], {})
    kept, made = vog.Image.load(SOURCE / "docs/images/python_torus.png"), vog.Image.load("torus.png")
    assert vog.compare(kept, made).psnr_db > 35  # conversions get better


def run_example(name, *arguments, cwd):
    done = subprocess.run(
        [sys.executable, SOURCE / "examples" / name, *map(str, arguments)], cwd=cwd, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def covered(file):
    """Fraction of the pixels that are not background."""
    return (np.asarray(vog.Image.load(file)).max(axis=2) > 0).mean()


def test_from_numpy(tmp_path):
    assert "psnr_db=" in run_example("from_numpy.py", cwd=tmp_path)
    assert covered(tmp_path / "numpy.png") > 0.05
    np.save(tmp_path / "a.npy", np.ones((9, 9, 9)))
    run_example("from_numpy.py", "a.npy", "-o", "b.png", "--voxel-size", 0.1, cwd=tmp_path)
    assert covered(tmp_path / "b.png") > 0.05


def test_from_csv(tmp_path):
    assert "20000 particles, mass" in run_example("from_csv.py", cwd=tmp_path)
    assert covered(tmp_path / "csv.png") > 0.05
    points = np.random.default_rng(1).random((99, 4))
    np.savetxt(tmp_path / "a.csv", points, delimiter=",", header="x,y,z,energy", comments="")
    run_example("from_csv.py", "a.csv", "--value", "energy", "--budget", 50, cwd=tmp_path)


def test_in_place(tmp_path):
    """A solver's processes each hand over their block: models of one and of two have its mass, and its picture."""
    found = []
    for count in (1, 2):
        command = [sys.executable, SOURCE / "examples" / "in_place.py", "--steps", "2", "--edge", "32", "-o", f"on{count}/"]
        if count > 1:
            pytest.importorskip("mpi4py", reason="needs mpi4py (apt install python3-mpi4py)")
            command = ["mpirun", "--oversubscribe", "-n", str(count), *command]
        allowed = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env={**os.environ, **allowed})
        assert done.returncode == 0, done.stderr
        masses = re.findall(r"step (\d): .* mass ([0-9.]+) of ([0-9.]+)", done.stdout)
        assert [step for step, *_ in masses] == ["0", "1"], done.stdout
        assert all(float(made) == pytest.approx(float(given), rel=2e-4) for _, made, given in masses)
        found.append([given for *_, given in masses])
        manifest = json.loads((tmp_path / f"on{count}/manifest.json").read_text())
        assert manifest["steps"] and len(manifest["models"]) == 2
    assert found[0] == found[1]  # the same solver
    if VOG:
        for count in (1, 2):
            look = ["--size", "128", "--eye", "2,1.5,3", "--look-at", "0.5,0.5,0.4", "--extinction", "8"]
            subprocess.run([VOG, "render", f"on{count}/", "-o", f"{count}.png", *look], cwd=tmp_path, check=True, capture_output=True)
        assert vog.compare(*(vog.Image.load(tmp_path / f"{count}.png") for count in (1, 2))).psnr_db > 40


def test_from_openvdb(tmp_path):
    pytest.importorskip("pyopenvdb", reason="needs pyopenvdb (apt install python3-openvdb)")
    run_example("from_openvdb.py", cwd=tmp_path)
    assert covered(tmp_path / "openvdb.png") > 0.05
    vog.sample_cloud(64).save(tmp_path / "cloud.vdb")
    run_example("from_openvdb.py", "cloud.vdb", "-o", "b.png", cwd=tmp_path)
    assert covered(tmp_path / "b.png") > 0.05


def test_from_yt(tmp_path):
    pytest.importorskip("yt", reason="needs yt (apt install python3-yt)")
    assert "2 volumes" in run_example("from_yt.py", cwd=tmp_path)
    assert covered(tmp_path / "yt.png") > 0.05


def test_from_yt_makes_yts_maps(tmp_path):
    pytest.importorskip("yt", reason="needs yt (apt install python3-yt)")
    text = run_example(
        "from_yt.py", "--carry", "temperature", "--velocity", "--maps", "m", "--compare", "--size", 60, cwd=tmp_path
    )
    found = dict(re.findall(r"(\w+): L2 of voxels (\S+), of the model", text))
    assert set(found) == {"temperature", "velocity", "column"}
    assert max(map(float, found.values())) < 1e-5, text  # the same cells, exactly
    assert covered(tmp_path / "m-velocity-deviation.png") > 0.05


def test_yt_reads_enzos_levels_as_they_are(tmp_path, data):
    pytest.importorskip("yt", reason="needs yt (apt install python3-yt)")
    dump = data("enzo-raw/DD0010/DD0010")
    files = [data(f"enzo/level{n}.vdb") for n in range(3)]
    for volume, file in zip(vog.load(dump), files, strict=True):
        expected = vog.Volume.load(file)
        assert volume.index_box == expected.index_box and volume.active_voxels == expected.active_voxels
        assert np.allclose(volume.matrix, expected.matrix)
        assert np.allclose(volume.to_numpy(), expected.to_numpy(), rtol=1e-5)


def test_real_files_look_the_same_as_the_commands(tmp_path, command, data):
    smoke = data("smoke.vdb")
    command("convert", smoke, "-o", "a.ply", "--budget", 3080, "--no-hierarchy")
    report = command("render", "a.ply", "-o", "a.png", "--size", "320x400", "--fov", 30, "--json")
    (tmp_path / "camera.json").write_text(report)
    model = vog.convert(vog.Volume.load(smoke), budget=3080)
    model.save(tmp_path / "b.ply")
    camera = vog.Camera.load(tmp_path / "camera.json")
    vog.render(model, camera, (320, 400)).save(tmp_path / "b.png")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    assert same_picture(tmp_path / "a.png", tmp_path / "b.png")
