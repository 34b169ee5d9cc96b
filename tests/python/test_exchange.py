"""Splats of other programs, and those programs' own readers where they are installed."""
import glob
import importlib.util
import json
import os
import subprocess

import numpy as np
import pytest

import vog


def test_files_of_splats(tmp_path, model):
    for name in ("m.ply", "m.spz", "m.glb", "m.usda", "m.usdc"):
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


@pytest.mark.parametrize("name", ["m.usda", "m.usdc"])
def test_openusd_reads_layers(tmp_path, model, name):
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    vog.export_splats(model, tmp_path / name, extinction=0.5)
    stage = usd.Stage.Open(str(tmp_path / name))
    prim = stage.GetDefaultPrim()
    assert prim.GetTypeName() == "ParticleField3DGaussianSplat"
    read = vog.Gaussians.load(tmp_path / name)
    assert np.array_equal(np.array(prim.GetAttribute("positions").Get()), read.mean)
    assert np.array_equal(np.array(prim.GetAttribute("scales").Get()), read.scale)
    turns = [(q.GetReal(), *q.GetImaginary()) for q in prim.GetAttribute("orientations").Get()]
    assert np.array_equal(np.array(turns, np.float32), read.rotation)
    assert prim.GetAttribute("radiance:sphericalHarmonicsDegree").Get() == 0
    # OpenUSD's own layers of the same prim, whose crates are compressed.
    for again in ("again.usda", "again.usdc", "again.usd"):
        stage.GetRootLayer().Export(str(tmp_path / again))
        back = vog.Gaussians.load(tmp_path / again)
        assert np.array_equal(back.mean, read.mean) and np.array_equal(back.density, read.density)


def test_openusd_validates_layers(tmp_path, model):
    validation = pytest.importorskip("pxr.UsdValidation", reason="usd-core with validators is not installed")
    usd = pytest.importorskip("pxr.Usd")
    for name in ("m.usda", "m.usdc"):
        vog.export_splats(model, tmp_path / name, extinction=0.5)
        context = validation.ValidationContext(validation.ValidationRegistry().GetOrLoadAllValidators())
        assert [str(e.GetErrorAsString()) for e in context.Validate(usd.Stage.Open(str(tmp_path / name)))] == []


def spz_package():
    """The extension of the package spz, by its file: version 0.0.1 of the package imports itself."""
    found = importlib.util.find_spec("spz")
    files = glob.glob(os.path.join(found.submodule_search_locations[0], "spz.*")) if found else []
    files = [file for file in files if file.endswith((".so", ".pyd"))]
    if not files:
        pytest.skip("spz is not installed")
    spec = importlib.util.spec_from_file_location("spz", files[0])
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_spz_package_reads_spz(tmp_path, model):
    spz = spz_package()
    vog.export_splats(model, tmp_path / "m.spz", extinction=0.5)
    splats = spz.load(str(tmp_path / "m.spz"))
    read = vog.Gaussians.load(tmp_path / "m.spz")
    assert np.array_equal(splats.positions, read.mean)
    assert np.allclose(splats.scales, np.log(read.scale), atol=1e-5)
    x, y, z, w = splats.rotations.T
    # Quaternions of either sign are one rotation.
    assert np.allclose(np.abs(np.sum(np.stack([w, x, y, z], 1) * read.rotation, 1)), 1, atol=1e-5)


def test_gaussforge_reads_spz(tmp_path, model):
    gaussforge = pytest.importorskip("gaussforge", reason="gaussforge is not installed")
    vog.export_splats(model, tmp_path / "m.spz", extinction=0.5)
    done = gaussforge.GaussForge().convert((tmp_path / "m.spz").read_bytes(), "spz", "ply")
    assert "error" not in done, done["error"]
    (tmp_path / "m.ply").write_bytes(bytes(done["data"]))
    ply, read = vog.Gaussians.load(tmp_path / "m.ply"), vog.Gaussians.load(tmp_path / "m.spz")
    assert np.allclose(ply.mean, read.mean, atol=1e-6) and np.allclose(ply.scale, read.scale, rtol=1e-5)
    assert np.allclose(ply.density, read.density, rtol=1e-3)
    assert np.allclose(np.abs(np.sum(ply.rotation * read.rotation, 1)), 1, atol=1e-4)


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
