"""One request, one picture: the command and Python, with no options, of each quantity of a model, a volume and levels, bit for
bit; volumes and the models made of them have the same defaults."""
import json

import numpy as np
import pytest

import vog
from conftest import request_of, same_picture

SHOWS = ("T", "column", "mean", "deviation", "maximum", "volume", "slice")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """{kind: (data in Python, arguments of the command)}"""
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
    return {
        "model": (vog.Gaussians.load(folder / "cloud.ply"), [folder / "cloud.ply"]),
        "volume": (vog.Volume.load(folder / "cloud.vdb"), [folder / "cloud.vdb"]),
        "levels": (vog.Levels.load(names), names),
    }


@pytest.mark.parametrize("show", SHOWS)
@pytest.mark.parametrize("kind", ["model", "volume", "levels"])
def test_the_command_and_python_draw_the_same(command, tmp_path, sources, kind, show):
    data, inputs = sources[kind]
    field = ["--field", "density"] if show in ("mean", "deviation") else []
    values = [] if show == "volume" else ["--values-out", "v.npy"]
    plane = ["--plane", "y=0.1"] if show == "slice" else []
    command("render", *inputs, "--show", show, *field, *plane, *values, "-o", "command.png")
    picture = vog.render(data, show=show, field="density" if field else "", plane=plane[-1] if plane else None)
    picture.save(tmp_path / "python.png")
    assert same_picture(tmp_path / "python.png", tmp_path / "command.png")
    if show == "volume":  # whose numbers are colours
        command("render", *inputs, "--show", show, "-o", "command.exr")
        assert np.array_equal(vog.Image.load(tmp_path / "command.exr").rgba, picture.image.rgba)
        assert np.array_equal(picture.values, picture.image.rgba[..., 3]) or picture.image.rgba[..., 3].min() == 1
    else:
        assert np.array_equal(picture.values, np.load(tmp_path / "v.npy"), equal_nan=True)


@pytest.mark.parametrize("options, arguments", [
    (["--tf", "viridis"], {"tf": "viridis"}),
    (["--tf", "viridis", "--range", "0.1,0.6"], {"tf": "viridis", "range": (0.1, 0.6)}),
    (["--scale", "linear", "--threshold", "0.2"], {"scale": "linear", "threshold": 0.2}),
    (["--window", "0.5,0.4"], {"window": (0.5, 0.4)}),
    (["--band", "0.1,0.3,#ff0000,0.2"], {"bands": [(0.1, 0.3, (1, 0, 0), 0.2)]}),
    (["--light", "head"], {"light": "head"}),
    (["--shadows", "--light-from", "1,2,3", "--set", "scattering=4", "--set", "asymmetry=0.5"],
     {"shadows": True, "light_from": (1, 2, 3), "scattering": 4, "asymmetry": 0.5}),
    (["--light", "studio"], {"light": "studio"}),
    (["--light", "1,2,3", "--set", "light-weights=0.3,0.6,0.2,10"], {"light": (1, 2, 3), "light_weights": (0.3, 0.6, 0.2, 10)}),
    (["--renderer", "trace"], {"renderer": "trace"}),
    (["--slabs", "7"], {"slabs": 7}),
    (["--clip", "1,0,0,0"], {"clip_planes": [(1, 0, 0, 0)]}),
    (["--layer", "tf=viridis,range=0.1,0.6", "--layer", "band=0.1,0.3,red,0.2"], {"layers": [{"tf": "viridis", "range": (0.1, 0.6)}, {"bands": [(0.1, 0.3, "red", 0.2)]}]}),
    (["--unit-distance", "0.1", "--background", "white"], {"unit_distance": 0.1, "background": "white"}),
])  # fmt: skip
def test_volumes_are_the_same_with_options(command, tmp_path, sources, options, arguments):
    data, inputs = sources["model"]
    command("render", *inputs, "--show", "volume", "--size", "96x64", *options, "-o", "command.exr")
    command("render", *inputs, "--show", "volume", "--size", "96x64", *options, "-o", "command.png")
    picture = vog.render(data, size=(96, 64), show="volume", **arguments)
    assert np.array_equal(picture.image.rgba, vog.Image.load(tmp_path / "command.exr").rgba)
    assert picture.request == request_of(tmp_path / "command.png")


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
    # T of a box and of a Gaussian with its moments differ where voxels are alone: 1 beside 6 / (2 pi) along an axis; the mean luminance is
    # the same at extinctions 22 % apart in this view, of a cloud 0.1 %.
    assert vog.render(model, size=256).extinction == pytest.approx(vog.render(volume, size=256).extinction, rel=0.25)
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
    levels, _ = sources["levels"]
    few = [levels[n] for n in range(len(levels))]
    rendered = vog.render(few, size=32, show="volume")
    assert np.array_equal(rendered.image, vog.render(levels, size=32, show="volume").image)
    assert 0 < rendered.values.max() <= 1
    heat = [np.broadcast_to(np.float32(n + 1), level.to_numpy().shape) for n, level in enumerate(few)]
    fields = {"heat": [(level.index_box[0], array) for level, array in zip(few, heat)]}
    highest = vog.render(levels, size=32, show="maximum", field="heat", fields=fields).values
    assert set(np.unique(highest[~np.isnan(highest)])) <= {1.0, 2.0, 3.0}
