"""Pages in notebooks and, if anywidget is installed, the element <vog-view> as a live widget."""
import html
import importlib
import json
import os
import tempfile
from pathlib import Path
from typing import Any, Callable, List, Mapping, Optional, Sequence, Union
from urllib.parse import parse_qsl, quote

from . import _vog
from ._packages import described
from ._picture import _json as request_json

_HEIGHT = 520
# Options of vog.export_html that a widget has not, and those that are no request.
_OF_WHOLE_PAGES, _OF_FILES = ("description", "levels", "slabs", "url"), ("title", "steps", "precise")
_Models = Any


def _models(data: Any, call: str) -> Any:
    """Models of what can be shown; volumes and particles are converted."""
    if isinstance(data, Mapping):
        return {name: _models(one, call) for name, one in data.items()}
    if isinstance(data, (list, tuple)) and data and not all(isinstance(one, _vog.Volume) for one in data):
        return {f"model {n}": _models(one, call) for n, one in enumerate(data, 1)}
    if isinstance(data, _vog.Gaussians):
        return data
    if isinstance(data, (_vog.Volume, _vog.Levels, _vog.Points, _vog.Cells, list, tuple)) and (not isinstance(data, (list, tuple)) or data):
        return _vog.convert(data)
    raise TypeError(f"{call}: got {described(data)}, expected Gaussians, a Volume, Levels, Points, Cells, or a list or dict of them")


def page_html(data: Any, **options: Any) -> str:
    """Text of the page that vog.export_html writes.

    data     Gaussians, a Volume, Levels, Points or Cells, or a list or dict of them; all but Gaussians are converted
    options  of vog.export_html
    """
    models = _models(data, "page_html")
    with tempfile.TemporaryDirectory(prefix="vog-page-") as folder:
        _vog.export_html(os.path.join(folder, "page.html"), models, **options)
        return Path(folder, "page.html").read_text(encoding="utf-8")


def site_files(data: Any, **options: Any) -> "dict[str, bytes]":
    """Files of the site that vog.export_html writes, by their names, without its page."""
    models = _models(data, "show")
    with tempfile.TemporaryDirectory(prefix="vog-site-") as folder:
        _vog.export_html(folder, models, **options)
        files = [file for file in Path(folder).rglob("*") if file.is_file() and file.name != "index.html"]
        return {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


class Page:
    """A page for browsers, which notebooks show in the output of a cell. vog.show makes one."""

    def __init__(self, text: str, height: int = _HEIGHT) -> None:
        self.html: str = text  #: the whole page, without anything outside of it
        self.height: int = height  #: of the output, CSS pixels

    def save(self, file: "Union[str, os.PathLike[str]]") -> None:
        """Writes the page to a file."""
        Path(file).write_text(self.html, encoding="utf-8")

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 0"
        return f'<iframe srcdoc="{html.escape(self.html)}" style="{style}" allowfullscreen></iframe>'

    def __repr__(self) -> str:
        return f"<vog.Page: {len(self.html)} bytes>"


# --- settings of the picture, in the words of its links (docs/web.md)


def _numbers(text: str) -> List[float]:
    return [float(part) for part in text.split(",")]


def _text(values: Any) -> str:
    return ",".join(f"{float(value):.9g}" for value in values)


def settings_of(link: str) -> "dict[str, str]":
    """Settings of a link: {'tf': 'viridis', 'camera.eye': '1,2,3'}."""
    return dict(parse_qsl(link.lstrip("#"), keep_blank_values=True))


def link_of(settings: "Mapping[str, str]") -> str:
    """Link with settings."""
    return "#" + "&".join(f"{name}={quote(value, safe=',:.-')}" for name, value in settings.items())


class Settings:
    """Settings of a shown page or widget that Python reads and sets: a part of the widget, and usable without a notebook.

    send  receives a link with the settings that change

    >>> settings = vog.Settings(print)
    >>> settings.tf = "viridis"
    #tf=viridis
    >>> settings.receive("#tf=magma&range=0,2")  # as a page sends it
    >>> settings.tf, settings.range
    ('magma', (0.0, 2.0))
    """

    def __init__(self, send: "Callable[[str], None]") -> None:
        self._out = send
        self._now: "dict[str, str]" = {}
        self._callbacks: "List[Callable[[Settings], Any]]" = []

    def _set(self, **settings: str) -> None:
        self._now.update(settings)
        self._out(link_of(settings))

    def receive(self, link: str) -> None:
        """Takes the settings that a page reports, and calls on_change's functions where they differ."""
        settings = settings_of(link)
        if settings == self._now:
            return
        self._now = settings
        for callback in list(self._callbacks):
            callback(self)

    def on_change(self, callback: "Callable[[Any], Any]") -> "Callable[[Any], Any]":
        """Calls a function with this object whenever someone changes the page's settings. Returns the function, so it works as a decorator."""
        if not callable(callback):
            raise TypeError(f"on_change: got {described(callback)}, expected a function")
        self._callbacks.append(callback)
        return callback

    @property
    def settings(self) -> "dict[str, str]":
        """All settings in the words of the page's links."""
        return dict(self._now)

    @property
    def camera(self) -> "Optional[_vog.Camera]":
        """The view; None until the page has reported one."""
        s = {name[7:]: value for name, value in self._now.items() if name.startswith("camera.")}
        if "eye" not in s or "look_at" not in s:
            return None
        lens = "orthographic_width" if "orthographic_width" in s else "fov_degrees"
        more: "dict[str, Any]" = {lens: float(s.get(lens, "40"))}
        return _vog.Camera(_numbers(s["eye"]), _numbers(s["look_at"]), _numbers(s.get("up", "0,1,0")), **more)

    @camera.setter
    def camera(self, camera: "_vog.Camera") -> None:
        if not isinstance(camera, _vog.Camera):
            raise TypeError(f"camera: got {described(camera)}, expected a Camera")
        for lens in ("orthographic_width", "fov_degrees"):
            self._now.pop(f"camera.{lens}", None)
        lens = "orthographic_width" if camera.orthographic_width else "fov_degrees"
        # Angles and widths belong to the size that the page reports.
        size = {"size": self._now["size"]} if "size" in self._now else {}
        view = {"eye": camera.eye, "look_at": camera.look_at, "up": camera.up, lens: [getattr(camera, lens)]}
        self._set(**size, **{f"camera.{name}": _text(values) for name, values in view.items()})

    @property
    def tf(self) -> str:
        """Name of the colour map."""
        text = self._now.get("tf", "")
        return str(json.loads(text)["name"]) if text.startswith("{") else text

    @tf.setter
    def tf(self, name: str) -> None:
        if name not in _vog.TransferFunction.names():
            raise _vog.Error(f"tf: got {described(name)}, expected one of {', '.join(_vog.TransferFunction.names())}")
        self._set(tf=name)

    @property
    def show(self) -> str:
        """Quantity: 'T', 'column', 'mean', 'deviation', 'volume' or 'maximum'."""
        return self._now.get("show", "T")

    @show.setter
    def show(self, quantity: str) -> None:
        allowed = ("T", "column", "mean", "deviation", "volume", "maximum")
        if quantity not in allowed:
            raise _vog.Error(f"show: got {described(quantity)}, expected one of {', '.join(allowed)}")
        self._set(show=quantity)

    @property
    def model(self) -> int:
        """Which of several models, 1 the first."""
        return int(self._now.get("model", "1"))

    @model.setter
    def model(self, number: int) -> None:
        if isinstance(number, bool) or not isinstance(number, int) or number < 1:
            raise _vog.Error(f"model: got {described(number)}, expected the number of a model, 1 the first")
        self._set(model=str(number))

    @property
    def field(self) -> str:
        """Name of the field; empty: none is shown."""
        return self._now.get("field", "")

    @field.setter
    def field(self, name: str) -> None:
        if not isinstance(name, str):
            raise TypeError(f"field: got {described(name)}, expected a name")
        self._set(field=name)

    @property
    def range(self) -> "Optional[tuple[float, float]]":
        """Values at the two ends of the colours; None: the page's own."""
        low, high = _numbers(self._now["range"]) if "range" in self._now else (0.0, 0.0)
        return (low, high) if "range" in self._now else None

    @range.setter
    def range(self, values: "Sequence[float]") -> None:
        low, high = _checked(values, 2, "range")
        if not low < high:
            raise _vog.Error(f"range: got {low:g}, {high:g}, expected the lower value first")
        self._set(range=_text([low, high]))

    @property
    def clip(self) -> "Optional[tuple[List[float], List[float]]]":
        """Box that is left of the data, (lower, upper), world units; None: all of it."""
        if not self._now.get("clip"):
            return None
        numbers = _numbers(self._now["clip"])
        return numbers[:3], numbers[3:]

    @clip.setter
    def clip(self, box: Any) -> None:
        try:
            lower, upper = box
        except (TypeError, ValueError):
            raise _vog.Error(f"clip: got {described(box)}, expected (lower, upper)") from None
        corners = _checked(lower, 3, "clip") + _checked(upper, 3, "clip")
        if not all(a < b for a, b in zip(corners[:3], corners[3:])):
            raise _vog.Error("clip: expected each lower corner below the upper one")
        self._set(clip=_text(corners))

    @property
    def transfer_function(self) -> "Optional[dict[str, Any]]":
        """Own transfer function of show='volume', which setting it selects: {'colors': [[value, r, g, b], ...], 'opacity': [[value, opacity], ...], 'unit':
        world length over which opacities hold}; None: the page's own."""
        text = self._now.get("tf", "")
        points = json.loads(text) if text.startswith("{") else {}
        return {"colors": points["colors"], "opacity": points["opacity"], "unit": points["unit_distance"]} if "domain" in points else None

    @transfer_function.setter
    def transfer_function(self, transfer: "Mapping[str, Any]") -> None:
        if not isinstance(transfer, Mapping) or not {"colors", "opacity", "unit"} <= set(transfer):
            raise _vog.Error(f"transfer_function: got {described(transfer)}, expected a dict with colors, opacity and unit")
        points = {name: [_checked(point, count, f"transfer_function: {name}") for point in transfer[name]] for name, count in (("colors", 4), ("opacity", 2))}
        unit = _checked([transfer["unit"]], 1, "transfer_function: unit")[0]
        if not unit > 0:
            raise _vog.Error(f"transfer_function: unit {unit:g}, expected a length above 0")
        values = [point[0] for point in points["colors"] + points["opacity"]]
        domain = [min(values), max(values)] if min(values) < max(values) else [values[0], values[0] + 1]
        self._set(show="volume", tf=json.dumps({"name": "own", "domain": domain, "unit_distance": unit, **points}, separators=(",", ":")))


def _checked(values: Any, count: int, name: str) -> List[float]:
    try:
        numbers = [float(value) for value in values]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) != count or not all(number - number == 0 for number in numbers):
        raise _vog.Error(f"{name}: got {described(values)}, expected {count} finite number{'s' if count > 1 else ''}")
    return numbers


def _widget_class() -> Any:
    """The widget's class; None without anywidget."""
    try:
        anywidget: Any = importlib.import_module("anywidget")
        traitlets: Any = importlib.import_module("traitlets")
    except ModuleNotFoundError as error:
        if error.name not in ("anywidget", "traitlets"):
            raise
        return None
    script = Path(__file__).with_name("_widget.js").read_text(encoding="utf-8")
    module: Any = _vog

    class Widget(Settings, anywidget.AnyWidget):  # in this order: traitlets calls the constructor of the class behind its own
        """The element <vog-view> in a notebook: settings of Settings go both ways. vog.show makes one where anywidget is installed."""

        _esm = module._view_module() + script
        files = traitlets.Dict().tag(sync=True)  # of the model's site
        height = traitlets.Int(_HEIGHT).tag(sync=True)
        begin = traitlets.Unicode().tag(sync=True)  # request of the first picture, JSON
        sent = traitlets.Unicode().tag(sync=True)  # settings for the picture
        link = traitlets.Unicode().tag(sync=True)  # settings of the picture

        def __init__(self, data: Any, height: int = _HEIGHT, **options: Any) -> None:
            for name in _OF_WHOLE_PAGES:
                if name in options:
                    raise _vog.Error(f"show: {name} has no effect on a live widget, expected live=False beside it")
            self._options = options
            self._count = 0
            Settings.__init__(self, self._to_page)
            request = {"background": "black", **{key: value for key, value in options.items() if key not in _OF_FILES}}
            anywidget.AnyWidget.__init__(self, files=site_files(data, **options), begin=request_json("show", request), height=height)
            self.observe(lambda change: self.receive(change["new"]), "link")

        def _to_page(self, link: str) -> None:
            # A number makes equal settings another message: the picture may have changed meanwhile.
            self._count += 1
            self.sent = f"{self._count} {link}"
            self.link = link_of(self._now)  # for what is displayed later

        def set_model(self, data: Any) -> None:
            """Shows another model in place, under the same settings."""
            self.files = site_files(data, **self._options)

    Widget.__module__ = "vog"
    return Widget


def show(data: _Models, *, live: Optional[bool] = None, height: int = _HEIGHT, **options: Any) -> Any:
    """Shows models, volumes or particles in a notebook: a picture that you can turn and explore, without server or network.

    data     Gaussians, a Volume, Levels, Points or Cells, or a list or dict of them; all but Gaussians are converted by vog.convert
    live     True: a widget, a picture that shares its settings with Python, which needs anywidget; False: a whole page with its controls.
             None: a widget if anywidget is installed
    height   of the output, CSS pixels
    options  of vog.export_html: title, show, field, tf, light, ...; description, levels, slabs and url only for a page

    Returns a Page (`.html`, `.save(file)`), or a Widget, whose `camera`, `tf`, `show`, `field`, `range`, `clip`, `model` (1 the first) and
    `transfer_function` are read and set, with `on_change(function)` and `set_model(model)`.

    >>> page = vog.show(vog.sample_cloud(64), live=False, title="A cloud")
    >>> page.save("cloud.html")
    """
    if isinstance(height, bool) or not isinstance(height, int) or not 100 <= height <= 10000:
        raise _vog.Error(f"show: height {described(height)}, expected 100 to 10000 pixels")
    if live is not False:
        widget = _widget_class()
        if widget is not None:
            return widget(data, height=height, **options)
        if live:
            raise ImportError("show: live=True needs the Python package anywidget, which is not installed: pip install anywidget", name="anywidget")
    return Page(page_html(data, **options), height)


# A page as the last value of a cell stays in the notebook's file: of larger models it has so many, with a line that says so.
_MOST_SHOWN = 200_000


def _repr_html_(data: Any) -> str:
    if len(data) <= _MOST_SHOWN:
        return Page(page_html(data))._repr_html_()
    few = data.coarsen(_MOST_SHOWN)
    return f"{Page(page_html(few))._repr_html_()}<p>{len(few):,} of {len(data):,} Gaussians; vog.show(model) has all of them.</p>"


def show_models() -> None:
    """Makes models show themselves as the last value of a cell."""
    model: Any = _vog.Gaussians
    model._repr_html_ = _repr_html_


