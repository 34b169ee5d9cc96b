"""Picture: its request drawn again, here and by the command; other colours of the same numbers; marks, units, refusals."""
import functools
import json
import pickle
import threading

import numpy as np
import pytest

import vog
from conftest import request_of, same_picture

X, Y, Z = np.mgrid[:24, :24, :24].astype("f4") - 11.5
BALL = np.exp(-(X**2 + Y**2 + Z**2) / 60).astype("f4")
BALL[BALL < 0.02] = 0
HEAT = {"heat": {"value": 300 + 10 * X, "unit": "K"}, "wind": np.stack([X, 0 * Y, -Z], axis=-1)}
SHOWS = ("T", "column", "mean", "deviation", "maximum", "volume", "slice")


@pytest.fixture(scope="module")
def volume():
    return vog.Volume.from_numpy(BALL, voxel_size=0.5)


@pytest.fixture(scope="module")
def gas(volume):
    return vog.convert(volume, block=4, fields=HEAT)


@pytest.fixture(scope="module")
def sources(volume, gas):
    return {"model": gas, "volume": volume, "levels": vog.sample_levels(64)}


def same(one, other):
    """Whether two pictures have the same numbers and colours, bit for bit, and the same request."""
    planes = [(getattr(one, name), getattr(other, name)) for name in ("values", "column", "mean", "deviation")]
    return (
        all(a is b if a is None or b is None else a.tobytes() == b.tobytes() for a, b in planes)
        and one.image.rgba.tobytes() == other.image.rgba.tobytes()
        and one.request == other.request
        and (one.scale, one.label, one.unit, one.extinction, one.camera) == (other.scale, other.label, other.unit, other.extinction, other.camera)
    )


def shown(show, **more):
    """Keywords of a quantity, with a field where it needs one."""
    return {"show": show, **({"field": "density"} if show in ("mean", "deviation") else {"plane": "z"} if show == "slice" else {}), **more}


@pytest.mark.parametrize("show", SHOWS)
@pytest.mark.parametrize("kind", ["model", "volume", "levels"])
def test_a_request_draws_the_same_picture_again(sources, kind, show):
    data = sources[kind]
    picture = vog.render(data, size=(48, 32), **shown(show, background="white", tf="viridis", title="Again", color_bar=True))
    again = vog.render(data, **picture.request)
    assert same(again, picture) and picture.image.shape[1] > 48
    assert same(vog.Scene(data).render(**json.loads(json.dumps(picture.request))), picture)  # plain data
    assert picture.shape == (32, 48) and picture.request["size"] == [48, 32] and picture.request.get("show", "T") == show


@pytest.mark.parametrize(
    "options",
    [
        {"field": "heat", "show": "mean", "scale": "symmetric"},
        {"field": "wind.magnitude", "show": "deviation", "scale": "log", "least_column": 0.1, "units": "km / s"},
        {"field": "wind", "show": "mean", "range": (-3, 3), "renderer": "trace", "clip": [[-99, -99, -99], [99, 0, 99]]},
        {"field": "heat", "show": "maximum", "units": "mK", "slabs": 7},
        {"field": "heat", "show": "volume", "light": (1, 2, 3), "light_weights": (0.2, 0.6, 0.3, 8), "threshold": 290},
        {"show": "volume", "field": "density", "window": (0.5, 0.4), "unit_distance": 2, "precision": 0},
        {"show": "volume", "field": "density", "shadows": True, "light_from": (1, 2, 3), "scattering": 4, "asymmetry": 0.3, "ambient_occlusion": True},
        {"show": "volume", "bands": [(0.1, 0.3, (0, 0, 1), 0.2), (0.3, np.inf, (1, 1, 0), 0.6)], "field": "density"},
        {"show": "volume", "tf": np.array([[0, 0, 0, 0], [1, 0.5, 0, 0.5], [1, 1, 1, 1]]), "field": "density", "range": (0.1, 0.9)},
        {"extinction": 3, "blend": True, "background": (0.2, 0.4, 1), "tf": np.array([[0, 0, 1], [1, 0, 0]]), "kappa": 0.1},
        {"clip_planes": [(1, 0, 0, 2), (0, -1, 0, 1)], "axes": True, "scale_bar": True},
        {"pixel_error": 2, "scale_bar": True, "show": "column"},
        {"renderer": "trace", "anyhit": "collect", "hits_per_slab": 8, "stop_transmittance": 0.01, "extinction": 2},
        {"show": "column", "camera": vog.Camera((1, 2, 30), orthographic_width=14), "aabb_sigma": 1.5, "background": "transparent"},
    ],
)
def test_requests_of_all_members_draw_the_same_again(gas, options):
    picture = vog.render(gas, **{"size": 40, **options})
    assert same(vog.render(gas, **picture.request), picture)
    for key in options:
        assert key in picture.request, key
    with pytest.raises(TypeError, match="shows"):
        vog.render(gas, **{**picture.request, "shows": "T"})


@pytest.mark.parametrize("show", SHOWS)
@pytest.mark.parametrize("kind", ["model", "volume"])
def test_the_command_and_python_take_each_others_requests(tmp_path, command, sources, kind, show):
    data = sources[kind]
    name = {"model": "a.ply", "volume": "a.vdb"}[kind]
    data.save(tmp_path / name)
    data = {"model": vog.Gaussians, "volume": vog.Volume}[kind].load(tmp_path / name)
    camera = vog.Camera.orbit(data, 57, -12, fov_degrees=50)
    marks = {"color_bar": True, "title": "Mass × 3 µm"}
    picture = vog.render(data, camera, (40, 48), **shown(show, tf="magma", background=(0.1, 0.2, 0.3), **marks))
    picture.save(tmp_path / "p.png")
    assert request_of(tmp_path / "p.png") == picture.request
    values = [] if show == "volume" else ["--values-out", "q.npy"]
    command("render", "--request", "p.png", name, "-o", "q.png", *values)
    assert same_picture(tmp_path / "p.png", tmp_path / "q.png")
    if values:
        assert np.array_equal(np.load(tmp_path / "q.npy"), picture.values, equal_nan=True)
    # The command's picture, drawn here.
    field = ["--field", "density"] if show in ("mean", "deviation") else ["--plane", "z"] if show == "slice" else []
    command("render", name, "--show", show, *field, "--size", "48x40", "--tf", "cividis", "--axes", "-o", "c.png", *values)
    again = vog.render(data, **request_of(tmp_path / "c.png"))
    again.save(tmp_path / "d.png")
    assert same_picture(tmp_path / "c.png", tmp_path / "d.png")
    if values:
        assert np.array_equal(np.load(tmp_path / "q.npy"), again.values, equal_nan=True)
    # Files of EXR and JSON keep the request, too.
    picture.save(tmp_path / "p.exr")
    (tmp_path / "p.json").write_text(json.dumps({"picture": picture.request}))
    for file in ("p.exr", "p.json"):
        command("render", "--request", file, name, "-o", "r.png")
        assert same_picture(tmp_path / "p.png", tmp_path / "r.png")


def test_options_beside_a_request_come_first(tmp_path, command, gas):
    gas.save(tmp_path / "a.ply")
    picture = vog.render(gas, size=32, show="column", scale="log")
    picture.save(tmp_path / "p.png")
    command("render", "--request", "p.png", "a.ply", "--tf", "jet", "--size", "48", "-o", "q.png")
    vog.render(gas, **{**picture.request, "tf": "jet", "size": 48}).save(tmp_path / "r.png")
    assert same_picture(tmp_path / "q.png", tmp_path / "r.png")


def test_real_data_is_drawn_again_by_its_request(tmp_path, command, data):
    smoke = data("smoke.vdb")
    volume = vog.Volume.load(smoke)
    for show in SHOWS:
        picture = vog.render(volume, size=48, **shown(show, background="white"))
        assert same(vog.render(volume, **picture.request), picture)
        picture.save(tmp_path / "p.png")
        command("render", "--request", "p.png", smoke, "-o", "q.png")
        assert same_picture(tmp_path / "p.png", tmp_path / "q.png")


# --- Other colours of the same numbers. ---


@pytest.mark.parametrize("show", SHOWS)
def test_recolored_pictures_are_drawn_ones(gas, show):
    picture = vog.render(gas, size=40, **shown(show))
    plain = {"background": "white", "color_bar": True, "axes": True, "scale_bar": True, "title": "T"}
    for options in [plain] if show == "volume" else [{"tf": "viridis"}, {"tf": np.array([[0, 0, 0.0], [1, 1, 1]]), **plain}]:
        other = picture.recolor(**options)
        assert same(other, vog.render(gas, picture.camera, 40, **shown(show, **options))), options
        assert not np.array_equal(other.image, picture.image) and same(picture.recolor(), picture)
        assert same(vog.render(gas, **other.request), other)
    back = picture.recolor(**plain).recolor(color_bar=False, axes=False, scale_bar=False, title="", background="black")
    assert same(back, picture)


def test_recolored_scales(gas):
    column = vog.render(gas, size=40, show="column", scale="linear")
    assert column.scale == vog.Scale(0, column.values.max(), "linear") and column.scale.low == 0
    log = column.recolor(scale="log")
    assert log.scale.kind == "log" and log.scale.high == column.scale.high and log.scale.high / 1e4 <= log.scale.low < log.scale.high / 10
    assert same(log, vog.render(gas, size=40, show="column", scale="log"))
    assert same(log.recolor(scale="linear"), column)
    assert log.recolor(tf="jet").scale == log.scale
    assert log.recolor(range=(0.1, 10)).scale == vog.Scale(0.1, 10, "log")
    assert column.recolor(range=(0, 2)).scale == vog.Scale(0, 2, "linear")
    wind = vog.render(gas, size=40, show="mean", field="wind").recolor(scale="symmetric")
    assert wind.scale.low == -wind.scale.high < 0
    assert np.isnan(wind.recolor(least_column=0.5).values).sum() == np.isnan(wind.values).sum()  # the numbers stay
    assert (np.asarray(wind.recolor(least_column=0.5).image) > 0).sum() < (np.asarray(wind.image) > 0).sum()


def test_recolored_extinctions(gas):
    picture = vog.render(gas, size=40)
    assert picture.scale is None and picture.extinction > 0
    for extinction in (picture.extinction / 3, 2):
        other = picture.recolor(extinction=extinction)
        drawn = vog.render(gas, size=40, extinction=extinction)
        assert other.extinction == extinction and np.allclose(other.values, drawn.values, rtol=1e-6)
        assert np.abs(np.asarray(other.image, int) - np.asarray(drawn.image, int)).max() <= 1
        assert np.allclose(other.values / extinction, picture.values / picture.extinction, rtol=1e-6)


def test_recolor_refuses_what_is_to_be_drawn(gas):
    light, t = vog.render(gas, size=16, show="volume", field="density"), vog.render(gas, size=16)
    for picture, options, message in (
        (light, {"tf": "jet"}, "recolor: .*draw it again"),
        (light, {"range": (0, 1)}, "recolor: .*draw it again"),
        (t, {"range": (0, 1)}, "recolor: range has no effect on show 'T'"),
        (t, {"extinction": 0}, "recolor: extinction 0: expected auto or a number above 0"),
        (t, {"background": (1, 2, 3)}, "recolor: background"),
    ):
        with pytest.raises(vog.Error, match=message) as error:
            picture.recolor(**options)
        assert "\n" not in str(error.value)
    with pytest.raises(TypeError, match="recolor: unknown keyword 'field', expected tf, range"):
        t.recolor(field="heat")


# --- Numbers, marks and units. ---


@pytest.mark.parametrize(
    "light, members",
    [
        (vog.Light((1, 2, 3)), {"shadows": True, "light_from": (1, 2, 3)}),
        (vog.Light(scattering=4, ambient_occlusion=True, asymmetry=0.5), {"shadows": True, "scattering": 4, "ambient_occlusion": True, "asymmetry": 0.5}),
        (vog.Light((1, 2, 3), surfaces=True, weights=(0.1, 0.8, 0.2, 9)), {"light": (1, 2, 3), "shadows": True, "light_weights": (0.1, 0.8, 0.2, 9)}),
        (vog.Light(surfaces=True, shadows=False), {"light": "head"}),
        (vog.Light((0, 1, 1), camera=True, strength=0.5), {"shadows": True, "light_from": "camera:0,1,1=0.5"}),
        ([vog.Light((1, 2, 3)), vog.Light((0, 1, 1), camera=True, strength=0.3)], {"shadows": True, "light_from": [(1, 2, 3), "camera:0,1,1=0.3"]}),
        ([vog.Light(surfaces=True, shadows=False), vog.Light((1, 0, 0), surfaces=True, shadows=False)], {"light": ["head", (1, 0, 0)]}),
    ],
)
def test_a_light_is_the_members_of_its_parts(gas, light, members):
    drawn = functools.partial(vog.render, gas, size=32, show="volume", field="density")
    assert same(drawn(light=light), drawn(**members))
    with pytest.raises(vog.Error, match="scattering beside a vog.Light, which has it"):
        drawn(light=light, scattering=2)


def test_bad_lights_are_refused(gas):
    for light, message in [
        (vog.Light((0, 0, 0)), "light_from"),
        (vog.Light((1, 2, 3), scattering=99), "scattering"),
        (vog.Light((1, 2, 3), shadows=False), "light_from"),
        (vog.Light((1, 2, 3), strength=-1), "a finite strength, 0 or more"),
        (vog.Light(strength=2), "expected towards"),
        ([vog.Light((1, 2, 3)), vog.Light((1, 2, 3), scattering=2)], "differ only in towards, camera and strength"),
        ([vog.Light((1, 2, 3)), "head"], "expected a list of vog.Light"),
        (["head"] * 9, "8 at most"),
    ]:
        with pytest.raises(vog.Error, match=message):
            vog.render(gas, size=16, show="volume", field="density", light=light)


def test_numbers_are_those_of_the_closed_form():
    # One Gaussian of unit standard deviation: along the axis the column is its peak times sqrt(2 pi).
    one = vog.Gaussians([[0, 0, 0]], [[1, 1, 1]], [0.7], cutoff=8, fields={"heat": {"value": [5.0], "unit": "K"}})
    camera = vog.Camera((0, 0, 20), orthographic_width=0.02)
    column = 0.7 * np.sqrt(2 * np.pi)
    for show, expected in (("column", column), ("T", 2 * column), ("mean", 5), ("maximum", 5)):
        more = {"extinction": 2} if show == "T" else {"field": "heat"} if show != "column" else {}
        picture = vog.render(one, camera, 5, show=show, **more)
        assert picture.values[2, 2] == pytest.approx(expected, rel=1e-4)
    assert picture.unit == "K" and picture.label == "maximum of heat [K]"
    # A slab of one voxel's depth: V = 1 - (1 - opacity)^(length / unit distance).
    slab = vog.Volume.from_numpy(np.full((8, 8, 4), 1, "f4"))
    light = vog.render(slab, vog.Camera((3.5, 3.5, 99), (3.5, 3.5, 0), orthographic_width=2), 4, show="volume",
                       bands=[(0.5, 2, (1, 0.5, 0), 0.3)], unit_distance=2)  # fmt: skip
    assert np.allclose(light.values, 1 - 0.7**2, atol=1e-5)
    assert np.allclose(light.image.rgba[..., :3], (1 - 0.7**2) * np.array([1, 0.5, 0]), atol=1e-5)


def test_marks(volume):
    camera = vog.Camera.orbit(volume)
    plain = vog.render(volume, camera, (64, 48))
    assert plain.image.shape == (48, 64, 3)
    for marks in ({"color_bar": True}, {"axes": True}, {"scale_bar": True}, {"title": "A title"}):
        marked = vog.render(volume, camera, (64, 48), background="white", **marks)
        assert marked.shape == (48, 64) and marked.image.shape[0] >= 48 and marked.image.shape[1] >= 64
        assert np.array_equal(marked.values, plain.values) and marked.request[list(marks)[0]] == list(marks.values())[0]
        assert not np.array_equal(marked.image, plain.recolor(background="white").image)
    assert vog.render(volume, size=(64, 48), color_bar=True).image.shape[1] > 64
    assert vog.render(volume, size=(64, 48), title="A title").image.shape[0] > 48
    # Axes take their room from the fitted view.
    far, near = (np.linalg.norm(np.subtract(view.eye, view.look_at)) for view in (vog.render(volume, size=64, axes=axes).camera for axes in (True, False)))
    assert far > near


def test_units(gas):
    kelvin = vog.render(gas, size=32, show="mean", field="heat")
    assert kelvin.unit == "K" and kelvin.label == "heat [K]"
    milli = vog.render(gas, size=32, show="mean", field="heat", units="mK")
    assert milli.unit == "mK" and milli.label == "heat [mK]"
    assert np.allclose(milli.values, 1000 * kelvin.values, rtol=1e-6, equal_nan=True)
    assert milli.scale.high == pytest.approx(1000 * kelvin.scale.high, rel=1e-6)
    with pytest.raises(vog.Error, match="render: units m: the data are in K, expected a unit that it converts to"):
        vog.render(gas, size=32, show="mean", field="heat", units="m")
    column = vog.render(gas, size=32, show="column", units="g/cm2")  # the data state none: a label
    assert column.unit == "g/cm2" and column.label == "column density [g/cm2]"
    assert np.array_equal(column.values, vog.render(gas, size=32, show="column").values)


def test_files(tmp_path, gas):
    t, maximum, light = (vog.render(gas, size=16, **shown(show, field="density" if show != "T" else "")) for show in ("T", "maximum", "volume"))
    for picture in (t, maximum):
        picture.save(tmp_path / "a.npy")
        picture.save_values(tmp_path / "b.npy")
        assert np.array_equal(np.load(tmp_path / "a.npy"), picture.values, equal_nan=True)
        assert (tmp_path / "a.npy").read_bytes() == (tmp_path / "b.npy").read_bytes()
    t.save_values(tmp_path / "t.exr")
    assert vog.compare(t, vog.DepthImage.load(tmp_path / "t.exr")).identical
    maximum.save_values(tmp_path / "maximum.exr")
    assert b"maximum" in (tmp_path / "maximum.exr").read_bytes()
    for picture in (t, maximum, light):
        picture.save(tmp_path / "a.exr")
        assert np.allclose(vog.Image.load(tmp_path / "a.exr").rgba, picture.image.rgba)
    for call, message in (
        (lambda: t.save(tmp_path / "a.jpg"), r"a.jpg: extension '.jpg', expected .png or .exr"),
        (lambda: t.save_values(tmp_path / "a.png"), r"a.png: cannot write '.png' for values, expected .npy or .exr"),
        (lambda: light.depth, "depth: of show 'T' and 'column'"),
    ):
        with pytest.raises(vog.Error, match=message):
            call()
    light.save_values(tmp_path / "light.npy")
    assert np.array_equal(np.load(tmp_path / "light.npy"), light.values)


# --- Refusals. ---

BAD = [
    ({"show": "mode"}, "show"), ({"show": 3}, "show"), ({"show": "mean"}, "show 'mean'"), ({"show": "mean", "field": "p"}, "no field 'p'"),
    ({"show": "slice", "plane": "w=1"}, "plane w=1"), ({"show": "slice", "plane": "z", "thickness": 0}, "thickness 0"),
    ({"show": "maximum", "field": 3}, "field 3"), ({"show": "maximum", "fields": {"a": X}}, "show 'maximum': expected field, one of fields: a"),
    ({"tf": "no-such-map"}, "tf: no-such-map: neither a file nor the name"), ({"tf": np.zeros((2, 5))}, "tf"), ({"tf": {"colors": 3}}, "tf"),
    ({"show": "column", "range": (1, 0)}, "range"), ({"show": "column", "range": 3}, "range"), ({"show": "column", "range": (0, np.nan)}, "range"),
    ({"show": "column", "range": (0, 1), "scale": "log"}, "range"), ({"show": "column", "scale": "cubic"}, "scale"),
    ({"show": "volume", "window": (1, 0)}, "window"), ({"show": "volume", "window": "wide"}, "window"),
    ({"show": "volume", "window": (1, 2), "bands": [(0, 1, (1, 1, 1), 1)]}, "window"),
    ({"show": "volume", "bands": [(0, 1)]}, "bands"), ({"show": "volume", "bands": [(1, 0, (1, 1, 1), 1)]}, "band"),
    ({"show": "volume", "threshold": "much"}, "threshold"), ({"show": "volume", "unit_distance": 0}, "unit_distance"),
    *(({"show": "volume", "gradient_opacity": bad}, "gradient_opacity") for bad in ([(0, 1)], [(1, 0), (1, 1)], [(0, 0), (1, 2)], [(-1, 0), (1, 1)], "steep", [(0, 0), (1,)], [(k, 0) for k in range(9)])),
    ({"show": "volume", "unit_distance": np.inf}, "unit_distance"), ({"show": "volume", "light": "side"}, "light"),
    ({"show": "volume", "light": (0, 0, 0)}, "light"), ({"show": "volume", "light_weights": (1, 1, 1, 1)}, "light_weights"),
    ({"show": "volume", "light": "head", "light_weights": (1, 1)}, "light_weights"), ({"clip": [[1, 1, 1], [0, 2, 2]]}, "clip"),
    ({"clip": [1, 2]}, "clip"), ({"clip_planes": (0, 0, 1, 0)}, "clip_planes"), ({"clip_planes": [(0, 0, 0, 1)]}, "clip"),
    ({"extinction": "much"}, "extinction"), ({"extinction": -1}, "extinction"), ({"background": "blue"}, "background"),
    ({"background": (1, 2, 3)}, "background"), ({"blend": "yes"}, "blend"), ({"show": "column", "units": 3}, "units"),
    ({"show": "mean", "field": "heat", "least_column": 2}, "least_column"), ({"color_bar": "yes"}, "color_bar"), ({"axes": 1}, "axes"),
    ({"scale_bar": []}, "scale_bar"), ({"title": 3}, "title"), ({"camera": 3}, "camera"), ({"camera": {"eye": 1}}, "camera"),
    ({"size": (10, 20, 30)}, "size"), ({"size": 0}, "size"), ({"size": 10.5}, "size"), ({"size": "big"}, "size"), ({"size": 10**9}, "size"),
    ({"renderer": "magic"}, "renderer 'magic', expected"), ({"renderer": "reference"}, "renderer 'reference', expected"),
    ({"show": "volume", "slabs": 0}, "slabs"), ({"show": "volume", "precision": 2}, "precision"), ({"show": "volume", "slabs": 1.5}, "slabs"), ({"pixel_error": -1}, "pixel_error"),
    ({"aabb_sigma": -1}, "aabb_sigma"), ({"kappa": 2}, "kappa"), ({"anyhit": "collect"}, "anyhit is not for renderer 'splat'"),
    ({"renderer": "trace", "anyhit": "some"}, "anyhit"), ({"renderer": "trace", "anyhit": "collect", "hits_per_slab": 0}, "hits_per_slab"),
    ({"renderer": "trace", "anyhit": "collect", "stop_transmittance": 0.1}, "stop_transmittance"),
    ({"interpolation": "linear"}, "interpolation is not for renderer 'splat'"), ({"interpolation": "cubic"}, "interpolation"),
    ({"step": -1}, "step"), ({"samples": 0}, "samples"), ({"samples": 2}, "samples is not for renderer 'splat'"),
    # Keywords without effect on T.
    *(({key: value}, f"{key} has no effect on show 'T', expected ") for key, value in (
        ("field", "heat"), ("range", (0, 1)), ("scale", "log"), ("window", (1, 2)), ("bands", [(0, 1, (1, 1, 1), 1)]), ("threshold", 1),
        ("unit_distance", 1), ("gradient_opacity", [(0, 0), (1, 1)]), ("light", "head"), ("light_weights", (1, 1, 1, 1)), ("shadows", True), ("light_from", (1, 0, 0)), ("clip_lights", False), ("ambient_occlusion", True), ("scattering", 2), ("asymmetry", 0.2), ("layers", [{}]), ("units", "K"), ("least_column", 0.5), ("slabs", 8), ("precision", 0))),
    ({"show": "column", "extinction": 2}, "extinction has no effect on show 'column'"), ({"show": "volume", "blend": True}, "blend has no effect"),
]  # fmt: skip


@pytest.mark.parametrize("options, message", BAD)
def test_bad_requests_are_refused_in_one_line_that_names_the_keyword(gas, options, message):
    draws = [functools.partial(vog.render, gas), vog.Scene(gas).render] if "fields" not in options else [functools.partial(vog.render, gas)]
    for draw in draws:
        with pytest.raises(vog.Error) as error:
            draw(**{"size": 16, **options})
        text = str(error.value)
        assert text.startswith("render: " + message) and "\n" not in text and len(text) < 500, text


def test_every_keyword_is_refused_by_some_value():
    import inspect

    keywords = set(inspect.signature(vog.render).parameters) - {"data", "progress"}
    assert keywords - {key for options, _ in BAD for key in options} == set()


@pytest.mark.parametrize("wrong", [{"title": b"x"}, {"field": object()}, {"tf": 3}, {"size": {1}}, {"progress": 3}, {"data": 3}, {"data": "model.ply"}])
def test_the_wrong_kind_of_thing_is_a_type_error(gas, wrong):
    with pytest.raises(TypeError) as error:
        vog.render(**{"data": gas, "size": 16, **wrong})
    assert "\n" not in str(error.value) and "expected" in str(error.value)


def test_pictures_are_pickled(volume):
    for show in ("T", "column", "maximum", "volume"):
        picture = vog.render(volume, size=(20, 16), show=show, color_bar=True)
        again = pickle.loads(pickle.dumps(picture))
        assert np.array_equal(again.values, picture.values, equal_nan=True) and again.request == picture.request
        assert np.array_equal(again.image.rgba, picture.image.rgba) and again.scale == picture.scale and again.label == picture.label
    column = pickle.loads(pickle.dumps(vog.render(volume, size=16, show="column")))
    assert np.array_equal(column.recolor(tf="gray").values, column.values)


def test_one_scene_draws_other_quantities_on_other_threads(volume):
    scene, shows, faults = vog.Scene(volume), ("T", "column", "maximum", "volume"), []
    expected = {show: vog.render(volume, size=60, show=show).values for show in shows}

    def draw(show):
        for _ in range(10):
            values = scene.render(size=60, show=show, progress=lambda done: None).values
            if not np.array_equal(values, expected[show], equal_nan=True):
                faults.append(show)

    threads = [threading.Thread(target=draw, args=(show,)) for show in shows]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults
