"""show "volume" and "maximum": models and voxels by value, transfer functions, clips, light, errors."""
import numpy as np
import pytest

import vog

X, Y, Z = np.mgrid[:24, :24, :24].astype("f4") - 11.5
BALL = np.exp(-(X**2 + Y**2 + Z**2) / 60).astype("f4")
BALL[BALL < 0.02] = 0
BANDS = [(0.1, 0.3, (0, 0, 1), 0.2), (0.6, 2, (1, 1, 0), 0.6)]


@pytest.fixture(scope="module")
def volume():
    return vog.Volume.from_numpy(BALL)


@pytest.fixture(scope="module")
def model(volume):
    return vog.convert(volume, budget=400)


def psnr(a, b):
    return vog.compare(a, b).psnr_db


def test_models_look_like_their_voxels(volume, model):
    assert list(model.fields) == ["density"]
    camera = vog.Camera.orbit(volume, 30, 20, frame="data")
    for transfer in ({"tf": "magma", "unit_distance": 4}, {"bands": BANDS, "unit_distance": 2}):
        truth = vog.render(volume, camera, 96, show="volume", **transfer)
        slabs = vog.render(model, camera, 96, show="volume", **transfer)
        exact = vog.render(model, camera, 96, show="volume", renderer="trace", **transfer)
        assert np.asarray(truth.image).max() > 0.2
        assert psnr(truth, slabs) > 30
        assert psnr(exact, slabs) > 45


def test_clip_light_and_background(volume, model):
    camera = vog.Camera.orbit(volume, 0, 0)
    for data in (volume, model):
        options = {"camera": camera, "size": 48, "show": "volume", "bands": BANDS}
        whole = np.asarray(vog.render(data, **options).image)
        half = np.asarray(vog.render(data, clip_planes=[(0, -1, 0, -11.5)], **options).image)  # below
        box = np.asarray(vog.render(data, clip=[[-99, -99, -99], [99, 11.5, 99]], **options).image)
        assert np.allclose(half, box, atol=0.02)
        assert half[:20].sum() == 0 and np.allclose(half[30:], whole[30:], atol=0.02)
        lit = np.asarray(vog.render(data, light="head", **options).image)
        assert not np.allclose(lit, whole, atol=0.02)
        clear = np.asarray(vog.render(data, background="transparent", **options).image)
        assert clear.shape[-1] == 4 and clear[0, 0, 3] == 0


def test_other_fields_weigh_by_density():
    volume = vog.Volume.from_numpy(BALL)
    heat = {"heat": np.broadcast_to(np.linspace(0, 1, 24, dtype="f4")[:, None, None], BALL.shape).copy()}
    model = vog.convert(volume, budget=400, fields=heat)
    camera = vog.Camera.orbit(volume, 30, 20)
    transfer = {"field": "heat", "tf": "inferno", "unit_distance": 4}
    truth = vog.render(volume, camera, 96, show="volume", fields=heat, **transfer)
    assert psnr(truth, vog.render(model, camera, 96, show="volume", **transfer)) > 30


def test_errors_are_one_line(volume, model):
    for call, message in (
        (lambda: vog.render(model, show="volume", field="cold"), "render: no field 'cold' in the model, expected one of density"),
        (lambda: vog.render(model, show="volume", slabs=0), "render: slabs 0: expected 1 to 1024"),
        (lambda: vog.render(model, show="volume", renderer="reference"), "reference"),
        (lambda: vog.render(volume, show="volume", clip=[[1, 1, 1], [0, 2, 2]]), "clip box"),
        (lambda: vog.render(volume, show="volume", light="side"), 'light side'),
        (lambda: vog.render(volume, show="volume", window=(1, 2), bands=BANDS), "window has no effect beside `bands`"),
        (lambda: vog.render(volume, show="volume", bands=[(1, 0, (1, 1, 1), 1)]), "band"),
        (lambda: vog.render(vog.convert(volume, block=4, fields=False), show="volume"), "no field named, the model has none"),
        (lambda: vog.render(volume, show="volume", unit_distance=-1), "unit_distance"),
    ):
        with pytest.raises(vog.Error) as error:
            call()
        assert message in str(error.value) and "\n" not in str(error.value)


def test_maximum_of_models_is_near_that_of_voxels(volume, model):
    camera = vog.Camera.orbit(volume, 30, 20)
    truth = vog.render(volume, camera, 64, show="maximum").values
    assert truth.dtype == np.float32 and truth.shape == (64, 64) and np.nanmax(truth) == BALL.max()
    for options in ({}, {"renderer": "trace"}, {"slabs": 64}):
        image = vog.render(model, camera, (64, 64), show="maximum", **options).values
        both = ~np.isnan(truth) & ~np.isnan(image)
        assert both.mean() > 0.2 and np.sqrt(np.mean((truth - image)[both] ** 2)) < 0.05
    half = vog.render(volume, camera, 64, show="maximum", clip_planes=[(0, -1, 0, -5)]).values
    assert np.nanmax(half) < 0.6
    with pytest.raises(vog.Error, match="render: no field 'none' in the model"):
        vog.render(model, camera, 16, show="maximum", field="none")
    with pytest.raises(TypeError, match="render: got int, expected Gaussians"):
        vog.render(3, show="maximum")


def test_interpolated_voxels_are_smooth(volume, model):
    camera = vog.Camera.orbit(volume, 30, 20)
    constant = vog.render(volume, camera, 96, show="volume", bands=BANDS)
    linear = vog.render(volume, camera, 96, show="volume", bands=BANDS, interpolation="linear")
    assert 20 < psnr(constant, linear) < 60
    assert psnr(linear, vog.render(volume, camera, 96, show="volume", bands=BANDS, interpolation="linear", step=0.1)) > 30
    for wrong in ({"interpolation": "cubic"}, {"interpolation": "linear", "step": 0}):
        with pytest.raises(vog.Error, match="expected"):
            vog.render(volume, camera, 16, show="volume", **wrong)
    with pytest.raises(vog.Error, match="render: interpolation is not for renderer 'splat'"):
        vog.render(model, camera, 16, show="volume", interpolation="linear")


@pytest.mark.parametrize(
    "call, options",
    [
        ("render", {"show": "volume", "window": (0.5, 1), "tf": "viridis"}), ("render", {"show": "volume", "bands": BANDS, "range": (0, 1)}),
        ("render", {"show": "volume", "step": 0.1}), ("render of volume", {"show": "volume", "step": 0.1}),
        ("render of volume", {"show": "volume", "slabs": 8}), ("render", {"show": "volume", "renderer": "trace", "slabs": 8}),
        ("render of volume", {"show": "maximum", "slabs": 8}), ("render of volume", {"step": 0.1}),
        ("render", {"show": "volume", "scale": "symmetric"}), ("render", {"show": "column", "scale": "symmetric"}),
        ("render", {"show": "volume", "window": (0.5, 1), "scale": "log"}), ("render", {"renderer": "trace", "hits_per_slab": 8}),
        ("export_html", {"field": "density"}), ("export_html", {"range": (0, 1)}),
        ("export_html", {"scale": "log"}), ("export_html", {"show": "mean", "light": "head"}),
        ("export_html", {"unit_distance": 1}), ("export_html", {"show": "column", "field": "density"}), ("export_html of folder/", {"levels": 2}),
    ],
)  # fmt: skip
def test_options_without_effect_are_refused(volume, model, tmp_path, call, options):
    name, _, of = call.partition(" of ")
    first = [volume if of == "volume" else model] if name != "export_html" else [f"{tmp_path}/{of or 'page.html'}", model]
    with pytest.raises(vog.Error, match=f"^{name}: {list(options)[-1]} ") as error:
        getattr(vog, name)(*first, **options)
    assert "\n" not in str(error.value)
