"""vog.show without Jupyter: pages as text, and settings in the words of links."""
import html
import re

import numpy as np
import pytest

import vog


@pytest.fixture(scope="module")
def model():
    return vog.convert(vog.sample_cloud(64), block=8)


def test_models_show_themselves_as_a_page_of_their_own(model):
    text = model._repr_html_()
    inner = html.unescape(re.fullmatch(r'<iframe srcdoc="([^"]*)" style="[^"]*" allowfullscreen></iframe>', text)[1])
    assert inner.startswith("<!doctype html>") or inner.lower().startswith("<!doctype html>")
    assert "http://" not in inner and "https://" not in inner
    assert vog.show(model, live=False, title="A <cloud>").html != inner


def test_large_models_show_fewer_and_say_so(model, monkeypatch):
    monkeypatch.setattr(vog._show, "_MOST_SHOWN", len(model) // 2)
    text = model._repr_html_()
    assert f" of {len(model):,} Gaussians" in text
    assert len(text) < len(vog.show(model, live=False)._repr_html_())


def test_pages_are_saved_and_take_what_is_no_model_yet(model, tmp_path):
    assert '"name":"model 2"' in vog.show([model, model], live=False).html
    page = vog.show({"a": model, "b": vog.sample_cloud(64)}, live=False, height=300)
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page.html
    assert "height: 300px" in page._repr_html_()


@pytest.mark.parametrize("data", [3, "a.ply", [], None, np.zeros((3, 3))])
def test_other_data_are_refused(data):
    with pytest.raises(TypeError, match="expected Gaussians"):
        vog.show(data, live=False)


def test_settings_go_both_ways():
    sent = []
    settings = vog.Settings(sent.append)
    camera = vog.Camera((1, 2, 3), (0, 0, 1), (0, 0, 1), 25)
    settings.camera = camera
    settings.tf, settings.show, settings.field, settings.model = "viridis", "volume", "gas temperature", 2
    settings.range = (1, 2.5)
    settings.clip = ((0, 0, 0), (1, 1, 1))
    assert settings.tf == "viridis" and settings.transfer_function is None
    transfer = {"colors": [[0, 0, 0, 0], [1, 1, 1, 1]], "opacity": [[0, 0], [1, 0.5]], "unit": 2.0}
    settings.transfer_function = transfer
    other = vog.Settings(lambda link: None)
    other.receive("#" + "&".join(link.lstrip("#") for link in sent))
    assert other.settings == settings.settings
    assert (other.camera.eye, other.camera.look_at, other.camera.fov_degrees) == ((1, 2, 3), (0, 0, 1), 25)
    assert (other.tf, other.show, other.field, other.range, other.model) == ("own", "volume", "gas temperature", (1, 2.5), 2)
    assert other.clip == ([0, 0, 0], [1, 1, 1])
    assert other.transfer_function == transfer
    settings.camera = vog.Camera((1, 2, 3), (0, 0, 0), orthographic_width=7)
    assert settings.camera.orthographic_width == 7


def test_changes_by_hand_call_functions_once():
    settings, seen = vog.Settings(lambda link: None), []
    settings.on_change(lambda one: seen.append(one.tf))
    settings.receive("#tf=magma")
    settings.receive("#tf=magma")
    assert seen == ["magma"]
    with pytest.raises(TypeError, match="expected a function"):
        settings.on_change(3)


@pytest.mark.parametrize(
    "name, value",
    [("tf", "infreno"), ("show", "nothing"), ("range", (2, 1)), ("range", (1, float("nan"))), ("clip", 3), ("clip", ((1, 1, 1), (0, 0, 0))),
     ("camera", "x"), ("field", 3), ("model", 0), ("model", "a"), ("transfer_function", {"colors": []}),
     ("transfer_function", {"colors": [[0, 0, 0]], "opacity": [[0, 0]], "unit": 1}),
     ("transfer_function", {"colors": [[0, 0, 0, 0]], "opacity": [[0, 0]], "unit": 0})],
)  # fmt: skip
def test_wrong_settings_are_one_line_and_send_nothing(name, value):
    sent = []
    settings = vog.Settings(sent.append)
    with pytest.raises((TypeError, vog.Error)) as error:
        setattr(settings, name, value)
    assert "\n" not in str(error.value) and "expected" in str(error.value)
    assert sent == []


def test_errors_of_calls_show_types_and_no_arrays(model):
    array = np.arange(1e6).reshape(1000, 1000)
    for call in (lambda: model.save(array), lambda: vog.Camera("x", array), lambda: vog.sample_cloud(array), lambda: vog.Gaussians(array, array)):
        with pytest.raises((TypeError, vog.Error)) as error:
            call()
        assert "\n" not in str(error.value)
        assert "[" not in re.sub(r"(Optional|Union|tuple|dict|list|Sequence|numpy\.ndarray|Callable)\[[^\n]*?\]+", "", str(error.value)) or "array(" not in str(error.value)
        assert "array(" not in str(error.value) and "0.000e" not in str(error.value)
    with pytest.raises(TypeError, match=r"ndarray of shape \(1000, 1000\)"):
        model.save(array)


def test_live_without_anywidget_says_what_to_install(model, monkeypatch):
    import importlib

    real = importlib.import_module

    def absent(name, *more):
        if name == "anywidget":
            raise ModuleNotFoundError("No module named 'anywidget'", name="anywidget")
        return real(name, *more)

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(ImportError, match="pip install anywidget"):
        vog.show(model, live=True)
    assert isinstance(vog.show(model), vog.Page)
