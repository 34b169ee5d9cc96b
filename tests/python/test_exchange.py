"""Splats of other programs, and those programs' own readers where they are installed."""
import json
import os
import subprocess

import numpy as np
import pytest

import vog


def test_files_of_splats(tmp_path, model):
    for name in ("m.ply", "m.spz", "m.glb", "m.usda"):
        report = vog.export_splats(model, tmp_path / name, extinction=0.5)
        assert (tmp_path / name).stat().st_size > 10 * len(model)
        assert report["worst_db"] <= report["mean_db"] and 0.1 < report["depth"] < 1.1
    colors = np.zeros((len(model), 3), np.float32)
    vog.export_splats(model, tmp_path / "c.ply", colors=colors, units="box")
    back = vog.Gaussians.load(tmp_path / "c.ply")
    assert len(back) == len(model) and np.abs(back.mean).max() <= 1
    vog.export_splats(model, tmp_path / "v.ply", extinction=1, layout="volprim")
    assert vog.Gaussians.load(tmp_path / "v.ply").mass == pytest.approx(model.mass, rel=1e-5)
    for options, text in (({"units": "miles"}, "expected 'world' or 'box'"), ({"layout": "x"}, "expected '3dgs' or 'volprim'"),
                          ({"colors": colors[:2]}, "2 colours, expected")):
        with pytest.raises(vog.Error, match=text):
            vog.export_splats(model, tmp_path / "m.ply", **options)


def test_openusd_reads_usda(tmp_path, model):
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    vog.export_splats(model, tmp_path / "m.usda", extinction=0.5)
    prim = usd.Stage.Open(str(tmp_path / "m.usda")).GetDefaultPrim()
    assert prim.GetTypeName() == "ParticleField3DGaussianSplat"
    assert np.allclose(prim.GetAttribute("positions").Get(), model.mean, atol=1e-6)


def test_splat_transform_reads_spz_and_ply(tmp_path, model):
    modules = os.environ.get("VOG_NODE_MODULES", "")
    command = os.path.join(modules, ".bin", "splat-transform")
    if not modules or not os.path.exists(command):
        pytest.skip("splat-transform is not installed (VOG_NODE_MODULES: the folder node_modules with it)")
    for name in ("m.ply", "m.spz"):
        vog.export_splats(model, tmp_path / name, extinction=0.5)
        subprocess.run(["node", command, "-w", tmp_path / name, tmp_path / "m.csv"], check=True, capture_output=True)
        rows = np.genfromtxt(tmp_path / "m.csv", delimiter=",", names=True)
        assert len(rows) == len(model)
        # Its tables are y down; .spz is y up.
        flip = 1 if name == "m.ply" else -1
        assert np.allclose(np.stack([rows["x"], flip * rows["y"], flip * rows["z"]], 1), model.mean, atol=1e-3)


def test_gltf_validator_finds_nothing_but_the_extension(tmp_path, model):
    modules = os.environ.get("VOG_NODE_MODULES", "")
    if not modules or not os.path.exists(os.path.join(modules, "gltf-validator")):
        pytest.skip("gltf-validator is not installed (VOG_NODE_MODULES: the folder node_modules with it)")
    vog.export_splats(model, tmp_path / "m.glb", extinction=0.5)
    script = ("const v = require(process.argv[1] + '/gltf-validator');"
              "v.validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[2])))"
              ".then(r => console.log(JSON.stringify(r.issues.messages)))")
    done = subprocess.run(["node", "-e", script, os.path.abspath(modules), tmp_path / "m.glb"], check=True, capture_output=True)
    for message in json.loads(done.stdout):
        # Its 2.0 knows no KHR_gaussian_splatting, and so none of its attributes.
        assert "KHR_gaussian_splatting" in message["message"] + message["pointer"], message
