"""One request, one picture: the command and Python, with no options, of each quantity of a model, a volume and levels, bit for
bit; volumes and the models made of them have the same defaults."""
import json

import numpy as np
import pytest

import vog

SHOWS = ("T", "column", "mean", "deviation", "maximum", "volume")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """{kind: (data in Python, arguments of the command, field of the command, field and fields of Python)}"""
    folder = tmp_path_factory.mktemp("same")
    volume = vog.sample_cloud(64)
    volume.save(folder / "cloud.vdb")
    vog.convert(volume).save(folder / "cloud.ply")
    levels = vog.sample_levels(64)
    names = []
    for n in range(len(levels)):
        levels[n].name = "density"
        levels[n].save(folder / f"level{n}.vdb")
        names.append(folder / f"level{n}.vdb")
    own = {"fields": {"density": "density"}}
    return {
        "model": (vog.Gaussians.load(folder / "cloud.ply"), [folder / "cloud.ply"], {}),
        "volume": (vog.Volume.load(folder / "cloud.vdb"), [folder / "cloud.vdb"], own),
        "levels": (vog.Levels.load(names), names, own),
    }


def numbers(file):
    return np.load(file)


@pytest.mark.parametrize("show", SHOWS)
@pytest.mark.parametrize("kind", ["model", "volume", "levels"])
def test_the_command_and_python_draw_the_same(command, tmp_path, sources, kind, show):
    data, inputs, own = sources[kind]
    field = ["--field", "density"] if show in ("mean", "deviation") else []
    values = {"T": ["--depth-out", "t.exr"], "volume": []}.get(show, ["--values-out", "v.npy"])
    command("render", *inputs, "--show", show, *field, *values, "-o", "command.png")
    if show == "volume":
        command("render", *inputs, "--show", show, "-o", "command.exr")
        picture = vog.render_volume(data)
        picture.save(tmp_path / "python.exr")
        assert (tmp_path / "python.exr").read_bytes() == (tmp_path / "command.exr").read_bytes()
    elif show == "T":
        depth = vog.render(data)
        depth.save(tmp_path / "python.exr")
        assert (tmp_path / "python.exr").read_bytes() == (tmp_path / "t.exr").read_bytes()
        picture = depth.shade()
    elif show == "maximum":
        assert np.array_equal(vog.render_maximum(data), numbers(tmp_path / "v.npy"), equal_nan=True)
        return
    else:
        more = {"field": "density", **own} if field else {}
        maps = vog.render(data, show=show, **more)
        assert np.array_equal(maps.to_numpy(), numbers(tmp_path / "v.npy"), equal_nan=True)
        picture = maps.plot(color_bar=False)
    picture.save(tmp_path / "python.png")
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "command.png").read_bytes()


@pytest.mark.parametrize("options, arguments", [
    (["--tf", "viridis"], {"tf": "viridis"}),
    (["--tf", "viridis", "--range", "0.1,0.6"], {"tf": "viridis", "value_range": (0.1, 0.6)}),
    (["--window", "0.5,0.4"], {"window": (0.5, 0.4)}),
    (["--band", "0.1,0.3,#ff0000,0.2"], {"bands": [(0.1, 0.3, (1, 0, 0), 0.2)]}),
    (["--light", "head"], {"light": "head"}),
    (["--renderer", "trace"], {"renderer": "trace"}),
    (["--clip-plane", "1,0,0,0"], {"clip_planes": [(1, 0, 0, 0)]}),
])  # fmt: skip
def test_volumes_are_the_same_with_options(command, tmp_path, sources, options, arguments):
    data, inputs, _ = sources["model"]
    command("render", *inputs, "--show", "volume", "--size", "96x64", *options, "-o", "command.exr")
    vog.render_volume(data, size=(96, 64), **arguments).save(tmp_path / "python.exr")
    assert (tmp_path / "python.exr").read_bytes() == (tmp_path / "command.exr").read_bytes()


def two_voxels(distance):
    array = np.zeros((32, 16, 16), dtype=np.float32)
    array[2, 2, 2] = array[2 + distance, 7, 5] = 1
    return vog.Volume.from_numpy(array)


@pytest.mark.parametrize("make", [lambda: vog.sample_cloud(64), lambda: vog.sample_head(64), lambda: two_voxels(20)])
def test_volumes_and_their_models_have_the_same_defaults(command, tmp_path, make):
    volume = make()
    volume.save(tmp_path / "a.vdb")
    model = vog.convert(volume)
    model.save(tmp_path / "a.ply")
    # Unit distance, range and view of --show volume.
    reports = [json.loads(command("render", f"a.{kind}", "--show", "volume", "--size", "64", "-o", f"{kind}.exr", "--json")) for kind in ("vdb", "ply")]
    for key in ("unit_distance", "range", "camera"):
        assert reports[0][key] == reports[1][key], key
    # T of a box and of a Gaussian with its moments differ where voxels are alone: 1 beside 6 / (2 pi) along an axis, 15 % in this view.
    assert vog.render(model, size=256).extinction == pytest.approx(vog.render(volume, size=256).extinction, rel=0.15)
    for axis in ("x", "z", (1, 2, 3)):
        truth, made = (vog.projection(data, axis=axis, resolution=64) for data in (volume, model))
        assert made.extent == truth.extent and np.shape(made.array) == np.shape(truth.array)


def test_fields_have_the_same_unit_distance_at_voxels_and_in_models(command, tmp_path):
    command("sample", "fire", "fire.vdb", "--size", "64")
    command("convert", "fire.vdb", "-o", "fire.ply", "--field", "temperature")
    units = [
        json.loads(command("render", file, "--show", "volume", "--field", "temperature", "--size", "64", "-o", "p.png", "--json"))["unit_distance"]
        for file in ("fire.vdb", "fire.ply")
    ]
    assert units[0] == units[1]


def test_levels_have_volume_pictures_and_maxima_with_fields(sources):
    levels, _, _ = sources["levels"]
    few = [levels[n] for n in range(len(levels))]
    rendered = vog.render_volume(few, size=32)
    assert np.array_equal(np.asarray(rendered), np.asarray(vog.render_volume(levels, size=32)))
    assert np.asarray(rendered).max() > 0
    heat = [np.broadcast_to(np.float32(n + 1), level.to_numpy().shape) for n, level in enumerate(few)]
    fields = {"heat": [(level.index_box[0], array) for level, array in zip(few, heat)]}
    highest = vog.render_maximum(levels, size=32, field="heat", fields=fields)
    assert set(np.unique(highest[~np.isnan(highest)])) <= {1.0, 2.0, 3.0}
