"""bench/rate_distortion.py: rows are files, more bytes err less, and what is missing is said. Coders that are not installed are left out, aloud."""
import csv
import importlib.util
import json
import os
import subprocess
import sys

import numpy as np
import pytest

import vog
from conftest import SOURCE

SCRIPT = SOURCE / "bench/rate_distortion.py"


@pytest.fixture(scope="module")
def study():
    spec = importlib.util.spec_from_file_location("rate_distortion", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_rows_are_files_and_more_bytes_err_less(tmp_path, cloud):
    cloud.save(tmp_path / "cloud.vdb")
    call = [sys.executable, SCRIPT, "cloud.vdb", "-o", "out", "--size", "24", "--model-sizes", "2", "--tolerances", "2"]
    done = subprocess.run(list(map(str, call)), cwd=tmp_path, capture_output=True, text=True, env={**os.environ, "MPLBACKEND": "agg"})
    assert done.returncode == 0, done.stderr
    results = json.loads((tmp_path / "out/rate_distortion.json").read_text())
    rows = {}
    for row in results["rows"]:
        assert row["bytes"] == (tmp_path / "out" / row["file"]).stat().st_size
        rows.setdefault(row["series"], []).append(row)
    few, many = rows["model"]
    assert few["bytes"] < many["bytes"] and few["psnr_v_db"]["+x"] < many["psnr_v_db"]["+x"]
    assert few["psnr_rgb_db"] == {} and set(rows["model with values"][0]["psnr_rgb_db"]) == {"ramp", "bands", "step"}
    exact, half = rows["vdb"]
    assert exact["psnr_v_db"]["paper"] is None and exact["voxels"]["relative_l2"] == 0 < half["voxels"]["relative_l2"] < 1e-3
    for name in ("NanoVDB", "ZFP", "SZ3"):  # each has rows, or a line that says why not
        found = [series for series in rows if series.startswith(name)]
        assert bool(found) != any(name in line for line in results["absent"]), results["absent"]
        for series in found:
            assert 1 <= len(rows[series]) <= 4 and rows[series][0]["voxels"]["relative_l2"] < 1
    assert all(line in done.stdout for line in results["absent"])
    assert (tmp_path / "out/V.svg").is_file() != any("No plots" in line for line in results["absent"])
    assert len(list(csv.DictReader(open(tmp_path / "out/rate_distortion.csv")))) == len(results["rows"])
    assert "| model with values |" in (tmp_path / "out/rate_distortion.md").read_text()
    print(*results["absent"], sep="\n")


@pytest.mark.parametrize("masks", [True, False])
def test_files_of_leaves_hold_the_volume(tmp_path, study, masks):
    array = np.random.default_rng(1).random((11, 17, 9), np.float32) * (np.random.default_rng(2).random((11, 17, 9)) > 0.6)
    volume = vog.Volume.from_numpy(array, voxel_size=0.5, origin=(1, 2, 3), first=(-5, 3, 70))
    file = tmp_path / "leaves"
    raw = lambda values, tolerance: values.tobytes()
    side = study.write_leaves(file, volume, raw, 0, masks)
    assert 0 < side < file.stat().st_size
    back = study.read_leaves(file, lambda data, shape: np.frombuffer(data, np.float32).reshape(shape).copy(), masks)
    assert back.index_box == volume.index_box and np.array_equal(back.matrix, volume.matrix)
    assert np.array_equal(back.to_numpy(), volume.to_numpy())


def test_inactive_voxels_continue_active_ones(study):
    leaves = np.zeros((1, 8, 8, 8), np.float32)
    leaves[0, 0, 0, 0], leaves[0, 7, 5, 4:6] = 2, (1, 3)
    continued = study.continued(leaves, leaves > 0)
    assert (continued[0, :4, :4, :4] == 2).all() and (continued[0, 4:, :4, :4] == 0).all()
    assert continued[0, 7, 5, 4] == 1 and continued[0, 7, 5, 6] == 3 and continued[0, 7, 6, 4] == 1


def test_bytes_at_equal_error_lie_between_files_of_a_curve(study):
    row = lambda size, db, tolerance: {"bytes": size, "psnr_v_db": {"paper": db, "+x": db}, "psnr_rgb_db": {}, "voxels": {"psnr_db": db}, "tolerance": tolerance, "gaussians": 0}
    curve, fixed = [row(1000, 40, 0.1), row(16000, 48, 0.01)], [row(1000, 40, 0), row(16000, 48, 0)]
    assert study.bytes_at(curve, "V mean", 44) == pytest.approx(4000)
    assert study.bytes_at(curve, "V mean", 20) == 1000 and study.bytes_at(curve, "voxels", 48.1) is None
    assert study.bytes_at(fixed, "V mean", 44) == 16000 and study.bytes_at(curve, "ramp mean", 44) is None
