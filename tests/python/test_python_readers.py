"""The calls that `vog FILE` recommends for files of other programs."""

import os
import re
import shlex
import subprocess
import sys

import numpy as np
import pytest

VOG = os.environ.get("VOG_COMMAND")


def ball():
    x = np.linspace(-1, 1, 8)
    return np.maximum(1 - np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2), 0)


def write_npy(folder):
    np.save(folder / "a.npy", ball())
    return "a.npy"


def write_npz(folder):
    np.savez(folder / "a.npz", NAME=ball())
    return "a.npz"


def write_hdf5(folder):
    with pytest.importorskip("h5py").File(folder / "a.h5", "w") as file:
        file["NAME"] = ball()
    return "a.h5"


def dataset():
    xarray = pytest.importorskip("xarray")
    axis = np.arange(8.0)
    return xarray.Dataset({"NAME": xarray.DataArray(ball(), dims=("z", "y", "x"), coords={"z": axis, "y": axis, "x": axis})})


def write_netcdf(folder):
    dataset().to_netcdf(folder / "a.nc")
    return "a.nc"


def write_zarr(folder):
    pytest.importorskip("zarr")
    dataset().to_zarr(folder / "a.zarr")
    return "a.zarr"


def vtk_grid():
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.ImageData(dimensions=(8, 8, 8), spacing=(1, 2, 3))
    grid["NAME"] = ball().ravel(order="F")
    return grid


def write_vti(folder):
    vtk_grid().save(folder / "a.vti")
    return "a.vti"


def write_amrex(folder):
    yt = pytest.importorskip("yt")
    (folder / "plt0/Level_0").mkdir(parents=True)
    (folder / "plt0/Header").write_text(
        "HyperCLaw-V1.1\n1\ndensity\n3\n0\n0\n0 0 0\n1 1 1\n\n((0,0,0) (7,7,7) (0,0,0))\n0\n0.125 0.125 0.125\n0\n0\n0 1 0\n0\n0 1\n0 1\n0 1\n"
        "Level_0/Cell\n")
    (folder / "plt0/Level_0/Cell_H").write_text("1\n1\n1\n0\n(1 0\n((0,0,0) (7,7,7) (0,0,0))\n)\n1\nFabOnDisk: Cell_D_00000 0\n\n1,1\n0,\n\n1,1\n1,\n")
    head = b"FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2 1)))((0,0,0) (7,7,7) (0,0,0)) 1\n"
    (folder / "plt0/Level_0/Cell_D_00000").write_bytes(head + ball().astype("<f8").tobytes(order="F"))
    del yt
    return "plt0"


@pytest.mark.skipif(not VOG, reason="VOG_COMMAND names no command")
@pytest.mark.parametrize("write", [write_npy, write_npz, write_hdf5, write_netcdf, write_zarr, write_vti, write_amrex])
def test_recommended_calls_work(write, tmp_path):
    name = write(tmp_path)
    done = subprocess.run([VOG, name], cwd=tmp_path, capture_output=True, text=True)
    text = done.stdout + done.stderr
    call = re.search(r"which Python reads for vog: python3 (-m vog render .*? -o (\S+));", text)
    assert call, text
    environment = {**os.environ, "PATH": os.path.dirname(VOG) + os.pathsep + os.environ["PATH"]}
    made = subprocess.run([sys.executable, *shlex.split(call[1]), "--size", "32"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    assert (tmp_path / call[2]).exists()
    refused = subprocess.run([VOG, "render", name], cwd=tmp_path, capture_output=True, text=True)
    assert refused.returncode == 1 and refused.stderr.count("\n") == 1 and ("python3 -m vog" in refused.stderr or name.endswith(".h5"))
