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
    for name in ("m.ply", "m.spz", "m.glb", "m.usda"):
        report = vog.export_splats(model, tmp_path / name, extinction=0.5)
        assert (tmp_path / name).stat().st_size > 10 * len(model)
        assert report["worst_db"] <= report["mean_db"] and 0.1 < report["depth"] < 1.1
    colors = np.zeros((len(model), 3), np.float32)
    for up in ("y", "z", "-x", (1, 2, 3)):
        vog.export_splats(model, tmp_path / "c.ply", colors=colors, up=up)
        rows = splat_rows(tmp_path / "c.ply")
        assert len(rows) == len(model) and np.abs(rows[:, :3]).max() <= np.sqrt(3)
        # Floats of 24 bits, in a box of a half edge of 1 and again in the world.
        back = vog.Gaussians.load(tmp_path / "c.ply")
        assert np.allclose(back.mean, model.mean, atol=2.4e-7 * 2 * np.abs(model.mean).max())
        assert np.allclose(np.sort(back.scale), np.sort(model.scale), rtol=1e-5)
    vog.export_splats(model, tmp_path / "v.ply", extinction=1, layout="volprim")
    assert vog.Gaussians.load(tmp_path / "v.ply").mass == pytest.approx(model.mass, rel=1e-5)
    for options, text in (({"units": "miles"}, "expected 'world' or 'box'"), ({"layout": "x"}, "expected '3dgs' or 'volprim'"),
                          ({"colors": colors[:2]}, "2 colours, expected"), ({"colors": colors + 255}, r"colour 255,255,255, expected in .0, 1"), ({"up": "w"}, "up 'w', expected x, y, z"),
                          ({"up": (0, 0, 0)}, "expected a direction"), ({"layout": "volprim", "up": "z"}, "leave out"),
                          ({"layout": "volprim", "units": "box"}, "leave out"), ({"layout": "volprim", "colors": colors}, "leave out")):
        with pytest.raises(vog.Error, match=text):
            vog.export_splats(model, tmp_path / "m.ply", **options)
    with pytest.raises(vog.Error, match="layout 'volprim' needs a .ply file"):
        vog.export_splats(model, tmp_path / "m.glb", layout="volprim")


def splat_rows(file):
    """Numbers of a PLY of 3DGS: x y z, normals, f_dc, opacity, scales, rotation."""
    data = file.read_bytes()
    return np.frombuffer(data[data.index(b"end_header\n") + 11:], np.float32).reshape(-1, 17)


def test_python_writes_the_bytes_of_the_command(tmp_path, model, command):
    model.save(tmp_path / "model.ply")
    for name, layout in (("m.ply", ["--as", "3dgs"]), ("m.spz", []), ("m.glb", []), ("m.usda", [])):
        command("export", "model.ply", "-o", name, *layout, "--up", "z")
        vog.export_splats(model, tmp_path / ("p" + name), up="z")
        assert (tmp_path / name).read_bytes() == (tmp_path / ("p" + name)).read_bytes(), name


def test_openusd_reads_layers(tmp_path, model):
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    name = "m.usda"
    vog.export_splats(model, tmp_path / name, extinction=0.5, up="z")
    stage = usd.Stage.Open(str(tmp_path / name))
    prim = stage.GetDefaultPrim()
    assert prim.GetTypeName() == "ParticleField3DGaussianSplat" and stage.GetMetadata("upAxis") == "Y"
    assert np.abs(np.array(prim.GetAttribute("positions").Get())).max() <= 1
    assert np.allclose(vog.Gaussians.load(tmp_path / name).mean, model.mean, atol=2.4e-7 * 2 * np.abs(model.mean).max())
    name = "world-" + name  # OpenUSD keeps layers by their names
    vog.export_splats(model, tmp_path / name, extinction=0.5, units="world")
    stage = usd.Stage.Open(str(tmp_path / name))
    prim = stage.GetDefaultPrim()
    read = vog.Gaussians.load(tmp_path / name)
    assert np.array_equal(np.array(prim.GetAttribute("positions").Get()), read.mean)
    assert np.array_equal(np.array(prim.GetAttribute("scales").Get()), read.scale)
    turns = [(q.GetReal(), *q.GetImaginary()) for q in prim.GetAttribute("orientations").Get()]
    assert np.array_equal(np.array(turns, np.float32), read.rotation)
    assert prim.GetAttribute("radiance:sphericalHarmonicsDegree").Get() == 0
    # OpenUSD's own layers of the same prim: of text, and binary, which have to be made text.
    for again in ("again.usda", "again.usdc", "again.usd"):
        stage.GetRootLayer().Export(str(tmp_path / again))
    with pytest.raises(vog.Error, match="usdcat .*again.usdc -o .*again.usda"):
        vog.Gaussians.load(tmp_path / "again.usdc")
    usd.Stage.Open(str(tmp_path / "again.usdc")).GetRootLayer().Export(str(tmp_path / "text.usda"))
    for again in ("again.usda", "text.usda"):
        back = vog.Gaussians.load(tmp_path / again)
        assert np.array_equal(back.mean, read.mean) and np.array_equal(back.density, read.density)


def test_openusd_validates_layers(tmp_path, model):
    validation = pytest.importorskip("pxr.UsdValidation", reason="usd-core with validators is not installed")
    usd = pytest.importorskip("pxr.Usd")
    vog.export_splats(model, tmp_path / "m.usda", extinction=0.5)
    context = validation.ValidationContext(validation.ValidationRegistry().GetOrLoadAllValidators())
    assert [str(e.GetErrorAsString()) for e in context.Validate(usd.Stage.Open(str(tmp_path / "m.usda")))] == []


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
    vog.export_splats(model, tmp_path / "m.spz", extinction=0.5, units="world")
    splats = spz.load(str(tmp_path / "m.spz"))
    read = vog.Gaussians.load(tmp_path / "m.spz")
    assert np.array_equal(splats.positions, read.mean)
    assert np.allclose(splats.scales, np.log(read.scale), atol=1e-5)
    x, y, z, w = splats.rotations.T
    # Quaternions of either sign are one rotation.
    assert np.allclose(np.abs(np.sum(np.stack([w, x, y, z], 1) * read.rotation, 1)), 1, atol=1e-5)


def test_gaussforge_reads_spz(tmp_path, model):
    gaussforge = pytest.importorskip("gaussforge", reason="gaussforge is not installed")
    vog.export_splats(model, tmp_path / "m.spz", extinction=0.5, units="world")
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
        report = vog.export_splats(model, tmp_path / name, extinction=0.5)
        subprocess.run(["node", command, "-w", tmp_path / name, tmp_path / "m.csv"], check=True, capture_output=True)
        rows = np.genfromtxt(tmp_path / "m.csv", delimiter=",", names=True)
        assert len(rows) == len(model)
        # Its tables are y down, as 3DGS's PLY is; it turns .spz, which is y up.
        upright = np.stack([rows["x"], -rows["y"], -rows["z"]], 1)
        assert np.allclose(report["world_center"] + report["world_scale"] * upright, model.mean, atol=1e-3)
        assert np.allclose([rows[f"f_dc_{k}"] for k in range(3)], np.sqrt(np.pi), atol=0.02)  # white, in 8 bits


def test_gltf_validator_finds_nothing_but_the_extension(tmp_path, model):
    modules = os.environ.get("VOG_NODE_MODULES", "")
    if not modules or not os.path.exists(os.path.join(modules, "gltf-validator")):
        pytest.skip("gltf-validator is not installed (VOG_NODE_MODULES: the folder node_modules with it)")
    vog.export_splats(model, tmp_path / "m.glb", extinction=0.5)
    script = ("const v = require(process.argv[1] + '/gltf-validator');"
              "v.validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[2])))"
              ".then(r => console.log(JSON.stringify([r.issues.messages, r.info])))")
    done = subprocess.run(["node", "-e", script, os.path.abspath(modules), tmp_path / "m.glb"], check=True, capture_output=True)
    messages, info = json.loads(done.stdout)
    assert info["drawCallCount"] == 1 and info["totalVertexCount"] == len(model)
    for message in messages:
        # Its 2.0.0-dev.3.10 knows no KHR_gaussian_splatting, and takes the names of its attributes for wrong ones
        # (KhronosGroup/glTF-Validator, issue 252).
        assert "KHR_gaussian_splatting" in message["message"] + message["pointer"], message
