"""convert(): the models of vog convert; every option is passed on or refused."""
import numpy as np
import pytest

import vog


@pytest.mark.parametrize(
    "options, flags",
    [
        ({"block": 4}, ["--block", 4]),
        ({"budget": 300}, ["--budget", 300]),
        ({"error": 0.1}, ["--error", 0.1]),
        ({"lod": 3}, ["--lod", 3]),
        (
            {"block": 4, "soft_steps": 2, "spread": 1.1, "mass_threshold": 0.01, "axis_aligned": True, "measure": True},
            ["--block", 4, "--set", "soft-steps=2", "--set", "spread=1.1", "--set", "mass-threshold=0.01", "--set", "axis-aligned=1", "--set", "measure-error=1"],
        ),
        ({"method": "paper", "lod": 4}, ["--method", "paper", "--lod", 4]),
        (
            {"method": "paper", "strategy": "strict", "dense_block": 4, "amplitude": "mass", "kappa": 0.05},
            ["--method", "paper", "--set", "strategy=strict", "--set", "dense-block=4", "--set", "amplitude=mass", "--set", "kappa=0.05"],
        ),
        (
            {"method": "paper", "strategy": "variance", "variance_threshold": 0.1, "opacity_threshold": 0.01},
            ["--method", "paper", "--set", "strategy=variance", "--set", "variance-threshold=0.1", "--set", "opacity-threshold=0.01"],
        ),
        (
            {"method": "paper", "strategy": "neighbours", "similarity": 0.3, "minimum_radius": 0.7},
            ["--method", "paper", "--set", "strategy=neighbours", "--set", "similarity=0.3", "--set", "minimum-radius=0.7"],
        ),
        (
            {"method": "paper", "strategy": "tree", "tree_depth": 2},
            ["--method", "paper", "--set", "strategy=tree", "--set", "tree-depth=2"],
        ),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, list) else "",
)
def test_models_are_the_commands_byte_for_byte(tmp_path, command, cloud, options, flags):
    cloud.save(tmp_path / "cloud.vdb")
    command("convert", "cloud.vdb", "-o", "command.ply", "--no-hierarchy", *flags)
    vog.convert(vog.Volume.load(tmp_path / "cloud.vdb"), **options).save(tmp_path / "python.ply")
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "command.ply").read_bytes()


@pytest.mark.parametrize(
    "options, flags",
    [
        ({}, []),
        ({"budget": 100, "value": "speed"}, ["--budget", 100, "--value", "speed"]),
        ({"block": 2, "neighbours": 4}, ["--block", 2, "--neighbours", 4]),
        ({"radius": 0.5, "error": 0.2}, ["--radius", 0.5, "--error", 0.2]),
        ({"method": "paper", "kappa": 0.1}, ["--method", "paper", "--set", "kappa=0.1"]),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, list) else "",
)
def test_models_of_particles_are_the_commands_too(tmp_path, command, options, flags):
    vog.sample_particles(8).save(tmp_path / "points.xyz")
    command("convert", "points.xyz", "-o", "command.ply", "--no-hierarchy", *flags)
    vog.convert(vog.Points.load(tmp_path / "points.xyz"), **options).save(tmp_path / "python.ply")
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "command.ply").read_bytes()


@pytest.mark.parametrize("method", ["moments", "paper"])
def test_models_of_levels_are_the_commands_too(tmp_path, command, method):
    command("sample", "amr", "amr.vdb", "--size", 64)
    flags = ["--no-hierarchy", "--lod", 3, "--method", method]
    command("convert", "amr.vdb", "--grid", "density_L*", "-o", "command.ply", *flags)
    levels = vog.Levels.load(tmp_path / "amr.vdb", "density_L*")
    vog.convert(levels, lod=3, method=method).save(tmp_path / "python.ply")
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "command.ply").read_bytes()
    assert len(vog.convert([levels[0], levels[1], levels[2]], lod=3, method=method)) == len(
        vog.convert(levels, lod=3, method=method)
    )


def test_report_and_progress_are_told(cloud):
    report, fractions = {}, []
    model = vog.convert(cloud, error=0.1, progress=fractions.append, report=report)
    assert 0 < report["measured_error"] <= 0.1 and report["mass_ratio"] == pytest.approx(1, abs=1e-5)
    assert report["stage_ms"]["search"] > 0 and f"{report['measured_error']:.4g}" in model.summary
    assert fractions and all(0 <= f <= 1 for f in fractions) and fractions == sorted(fractions)
    vog.convert(cloud, block=4, report=report)
    assert report["measured_error"] is None


def test_an_unreachable_error_bound_warns():
    x, y, z = np.mgrid[-12:12, -12:12, -12:12]
    ball = np.clip(12 - np.sqrt(x**2 + y**2 + z**2), 0, None)
    with pytest.warns(UserWarning, match="of the finest cut, expected at most 0.000001"):
        vog.convert(vog.Volume.from_numpy(ball), error=1e-6)
    # Noise has no reading that a model could be nearer to.
    report = {}
    vog.convert(vog.Volume.from_numpy(np.random.default_rng(1).random((16, 16, 16))), error=1e-6, report=report)
    assert report["as_near_as_interpolation"] and report["measured_error"] <= report["interpolation_error"]


@pytest.mark.parametrize(
    "options, message",
    [
        ({"block": 0}, "block 0, expected 1, 2, 4, 8, 16, 32, 64 or 128"),
        ({"budget": 0}, "budget 0, expected a whole number, at least 1"),
        ({"block": 3}, "block 3, expected 1, 2, 4"),
        ({"block": 4, "budget": 10}, "budget has no effect beside `block`"),
        ({"lod": 9}, r"lod 9, expected a whole number, in \[1, 5\]"),
        ({"error": 2}, r"error 2, expected in \(0, 1\)"),
        ({"kappa": 0.1}, "kappa does not go with moments of volumes"),
        ({"budget": 50, "joint_steps": 3}, "joint_steps has no effect without `joint_field`"),
        ({"error": 0.2, "measure": True}, "measure has no effect without `block`, `budget` or `lod`"),
        ({"method": "paper", "tree_depth": 2}, "tree_depth needs strategy 'tree'"),
        ({"method": "paper", "similarity": 0.5}, "similarity needs strategy 'neighbours'"),
        ({"method": "paper", "variance_threshold": 0.5}, "variance_threshold needs strategy 'variance'"),
        ({"method": "paper", "strategy": "tree", "dense_block": 4}, "dense_block needs strategy 'smart', 'strict' or 'single'"),
        ({"method": "paper", "block": 4}, "block does not go with the paper's conversion"),
        ({"method": "paper", "strategy": "clever"}, "strategy clever, expected smart, strict, single, variance, neighbours or tree"),
        ({"method": "paper", "lod": 1, "strategy": "single"}, "strategy has no effect beside `lod`"),
        ({"method": "paper", "amplitude": "loud"}, "amplitude loud, expected mean or mass"),
        ({"method": "magic"}, "expected 'moments' or 'paper'"),
    ],
)
def test_options_are_refused_in_one_line(cloud, options, message):
    with pytest.raises(vog.Error, match=message):
        vog.convert(cloud, **options)


def test_labels_divide_as_the_commands_do(tmp_path, command):
    volume = vog.Volume.from_numpy(1 + np.random.default_rng(1).random((24, 24, 24), dtype="f4"))
    segments = np.zeros((24, 24, 24), "f4")
    segments[:, 12:], segments[8:16, 8:16, 8:16] = 1, 7
    volume.save(tmp_path / "gas.vdb")
    vog.Volume.from_numpy(segments).save(tmp_path / "seg.vdb")  # 0 is not active
    command("convert", "gas.vdb", "-o", "command.ply", "--no-hierarchy", "--budget", 300, "--labels", "seg.vdb")
    expected = vog.Gaussians.load(tmp_path / "command.ply")
    done = []
    for labels in (segments, vog.Volume.load(tmp_path / "seg.vdb")):
        model = vog.convert(vog.Volume.load(tmp_path / "gas.vdb"), budget=300, labels=labels, progress=done.append)
        assert set(np.unique(model.fields["label"].value)) == {0, 1, 7}
        assert np.array_equal(model.mean, expected.mean)
    assert done == sorted(done[: len(done) // 2]) + sorted(done[len(done) // 2 :]) and done[-1] == pytest.approx(1)


@pytest.mark.parametrize("options, message", [
    ({"labels": np.full((64, 64, 64), 0.5)}, "whole numbers"), ({"labels": np.ones((64, 64, 64)), "periodic": True}, "labels and periodic exclude"),
    ({"labels": np.ones((64, 64, 64)), "report": {}}, "labels and report exclude"), ({"labels": np.ones((64, 64, 64)), "fields": False}, "other fields"),
])  # fmt: skip
def test_labels_are_refused_in_one_line(cloud, options, message):
    with pytest.raises(vog.Error, match=message):
        vog.convert(cloud, **options)
    with pytest.raises(vog.Error, match="single Volume"):
        vog.convert(vog.sample_particles(8), labels=np.ones((8, 8, 8)))


def test_options_of_particles_are_refused_without_effect():
    points = vog.sample_particles(8)
    for options in ({"radius": 1.0, "neighbours": 3}, {"mass_threshold": 0.1}, {"axis_aligned": True}):
        with pytest.raises(vog.Error, match=f"convert: {list(options)[-1]} has no effect"):
            vog.convert(points, **options)


def test_other_things_are_type_errors(cloud):
    for call in (
        lambda: vog.convert(3),
        lambda: vog.convert("cloud.vdb"),
        lambda: vog.convert([]),
        lambda: vog.convert([cloud, 3]),
        lambda: vog.convert(cloud, block="big"),
        lambda: vog.convert(cloud, block=4.0),
        lambda: vog.convert(cloud, budget=-1),
        lambda: vog.convert(cloud, blocks=4),
        lambda: vog.convert(cloud, progress=3),
        lambda: vog.convert(cloud, report=[]),
    ):
        with pytest.raises(TypeError):
            call()


def test_same_bytes_for_any_number_of_threads(tmp_path, cloud):
    files = []
    for count in (0, 1, 2):
        with vog.threads(count):
            vog.convert(cloud, budget=300).save(tmp_path / f"{count}.ply")
        files.append((tmp_path / f"{count}.ply").read_bytes())
    assert files[0] == files[1] == files[2]
    with vog.threads(1):
        assert vog.thread_count() == 1
    with pytest.raises(vog.Error, match="threads: -1"):
        vog.threads(-1)
