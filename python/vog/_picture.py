"""Pictures: requests in the words of `vog render`, and the pictures drawn from them."""
import inspect
import json
import os
import textwrap
from typing import Any, Callable, Dict, Iterable, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _messages, _vog
from ._packages import described

_Size = Union[int, Sequence[int]]

# Members of requests by their keywords: (takes, text, unset, choices, shows, renderers).
_MEMBERS = _vog._request_schema()
_OF_LAYERS = ("tf", "range", "scale", "window", "bands", "threshold", "gradient_opacity", "unit_distance")
_RECOLORED = ("tf", "range", "scale", "extinction", "background", "blend", "least_column", "color_bar", "axes", "scale_bar", "title")


class Scale(NamedTuple):
    """Colour scale of a picture: values at the two ends of the colours, 'linear' or 'log' between them."""

    low: float
    high: float
    kind: str


class Light(NamedTuple):
    """Light of volume pictures, for the keyword light of render(): one value instead of several keywords, or several in a list.

    towards            direction of the world towards the light, 3 numbers; None: the upper left of the view, or the eye with surfaces
    camera             towards is right, up and towards the viewer, and turns with the view
    strength           factor of its light; lights add up
    shadows            matter absorbs light on its way
    ambient_occlusion  matter absorbs ambient light
    scattering         octaves of multiple scattering, 1 to 16, which brighten shadows
    asymmetry          g of the phase function (Henyey and Greenstein), -0.99 to 0.99; above 0 light goes on forward
    surfaces           also shade surfaces by gradients
    weights            ambient, diffuse, specular and power; None: the default

    >>> sun = vog.Light((1, 2, 1), ambient_occlusion=True, scattering=3)
    >>> vog.render(vog.sample_cloud(64), size=64, show="volume", light=sun).request["light_from"]
    [1.0, 2.0, 1.0]
    >>> fill = vog.Light((-1, 0, 1), camera=True, strength=0.3)
    >>> vog.render(vog.sample_cloud(64), size=64, show="volume", light=[vog.Light((1, 2, 1)), fill]).request["light_from"]
    [[1.0, 2.0, 1.0], 'camera:-1,0,1=0.3']
    """

    towards: "Optional[Sequence[float]]" = None
    shadows: bool = True
    ambient_occlusion: bool = False
    scattering: int = 1
    surfaces: bool = False
    weights: "Optional[Sequence[float]]" = None
    asymmetry: float = 0
    strength: float = 1
    camera: bool = False

    def _members(self) -> "Dict[str, Any]":
        parts: "Dict[str, Any]" = {"shadows": self.shadows or None, "ambient_occlusion": self.ambient_occlusion or None, "light_weights": self.weights}
        parts["scattering"] = None if self.scattering == 1 else self.scattering
        parts["asymmetry"] = self.asymmetry or None
        return {**parts, "light" if self.surfaces else "light_from": self._word()}

    def _word(self) -> Any:
        """The light alone, as requests have it."""
        if not self.camera and self.strength == 1:
            return "head" if self.surfaces and self.towards is None else self.towards
        if self.towards is None and not self.surfaces:
            raise _vog.Error("Light: camera and strength without a direction; expected towards=(x, y, z)")
        towards = "head" if self.towards is None else ("camera:" if self.camera else "") + ",".join(f"{float(v)!r}" for v in self.towards)
        return f"{towards}={float(self.strength)!r}"


def _all_lights(call: str, lights: "Sequence[Any]") -> "Dict[str, Any]":
    """Members for several lights, which have the other parts of a look in common."""
    if any(not isinstance(light, Light) for light in lights):
        raise _vog.Error(f"{call}: light: expected a list of vog.Light, or of directions and texts")
    key, first = "light" if lights[0].surfaces else "light_from", lights[0]._members()
    for light in lights:
        if {**light._members(), key: None} != {**first, key: None}:
            raise _vog.Error(f"{call}: lights of one picture differ only in towards, camera and strength")
    return {**first, key: [light._word() for light in lights]}


class Layer:
    """One of several fields in a volume picture: vog.render([vog.Layer(gas, "density", tf="blues"), vog.Layer(stars, tf="white")]).

    data      Gaussians, a Volume, Levels, a list of Volumes or Cells; or a surface, (points [P, 3], triangles [N, 3]), as isosurface() returns it
    field     its scalar field; None: the density
    fields    of voxels: the field at them, {'temperature': array}, as convert() takes it
    visible   whether it is drawn
    plane     draw the field only on this plane: "z", "z=0.5", "axial", or (nx, ny, nz, d)
    color     of a surface: a name, "#rrggbb" or (r, g, b); None: a light grey
    opacity   of a plane or a surface, up to 1; None: 1
    request   tf, range, scale, window, bands, threshold, gradient_opacity and unit_distance, as render() has them

    Where layers overlap, their extinctions add up and their colours mix in proportion. Planes and surfaces hide what lies behind them. All
    but planes cast shadows on each other.

    >>> cloud, head = vog.sample_cloud(64), vog.sample_head(64)
    >>> picture = vog.render([vog.Layer(cloud, tf="white"), vog.Layer(vog.convert(head), threshold=900)], size=64)
    >>> picture.label
    'volume of density, ct'
    >>> inside = vog.Layer(vog.isosurface(cloud, 0.3), color="orange")
    >>> seen = vog.render([vog.Layer(cloud, tf="white"), inside, vog.Layer(head, plane="z", tf="gray")], size=64)
    >>> float(seen.values.max())
    1.0
    """

    def __init__(
        self, data: "Union[_vog._Drawable, Tuple[Any, Any]]", field: "Optional[str]" = None, *, fields: "Optional[Dict[str, Any]]" = None,
        visible: bool = True, **request: Any
    ) -> None:
        self.data, self.fields, self.visible = data, fields, visible
        _messages.refuse_unknown("Layer", request, (*_OF_LAYERS, "plane", "color", "opacity"))
        self._request = {"field": field, **request}

    def _member(self, place: int) -> "Dict[str, Any]":
        row = {key: _plain(value, key) for key, value in self._request.items() if value is not None}
        return {"input": place, "visible": self.visible, **row}


def _plain(value: Any, key: str, nested: bool = False) -> Any:
    """A value of a request as JSON has it."""
    if key == "tf" and not nested and not (isinstance(value, dict) or value is None):
        try:
            return json.loads(_vog._transfer_json(value))["tf"]
        except _vog.Error as error:
            raise _vog.Error(f"tf: {error}") from None
    if isinstance(value, _vog.Camera):
        lens = {"orthographic_width": value.orthographic_width} if value.orthographic_width else {"fov_degrees": value.fov_degrees}
        return {"eye": value.eye, "look_at": value.look_at, "up": value.up, **lens}
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, dict):
        return {name: _plain(part, key, True) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part, key, True) for part in value]
    if isinstance(value, float) and not np.isfinite(value):
        if key == "bands" and value == np.inf:
            return None  # the upper end of a band
        raise _vog.Error(f"{key} {value}, expected finite numbers")
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"{key}: got {described(value)}, expected numbers, a text or a list of them")


def _json(call: str, request: "Dict[str, Any]", known: "Sequence[str]" = (*_MEMBERS, "camera")) -> str:
    _messages.refuse_unknown(call, request, known)
    light = request.get("light")
    if isinstance(light, Light) or (isinstance(light, list) and any(isinstance(one, Light) for one in light)):
        parts = light._members() if isinstance(light, Light) else _all_lights(call, light)
        twice = [key for key in parts if key != "light" and request.get(key) is not None]
        if twice:
            raise _vog.Error(f"{call}: {twice[0]} beside a vog.Light, which has it")
        request = {**request, "light": None, **parts}
    try:
        return json.dumps({key: _plain(value, key) for key, value in request.items() if value is not None})
    except (_vog.Error, TypeError) as error:
        raise type(error)(f"{call}: {error}") from None


def _state_keywords(call: Any, keys: "Iterable[str]") -> None:
    """Puts these members in the place of **request in a call's signature, and their texts in that of KEYWORDS in its docstring."""
    signature, texts = inspect.signature(call), []
    for key in keys:
        takes, text, unset, choices, shows, renderers = _MEMBERS[key]
        words = " or ".join(f"'{word}'" for word in choices) or takes or "bool"
        text = f"{words}: {text}".replace(". Repeatable", "; a list of rows") + (f". Default: {unset}" if unset else "")
        for name, values in (("show", shows), ("renderer", renderers)):
            text += f". For {name} {', '.join(map(repr, values.split()))}" if values else ""
        texts.append(textwrap.fill(text, 120, initial_indent=f"    {key:19} ", subsequent_indent=" " * 24))
    parameters = [one for one in signature.parameters.values() if one.kind != one.VAR_KEYWORD]
    parameters += [inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=None) for key in keys]
    call.__signature__ = signature.replace(parameters=parameters)
    call.__doc__ = (call.__doc__ or "").replace("    KEYWORDS", "\n".join(texts))


class Scene:
    """Data prepared once, for pictures from any number of views.

    data    Gaussians, a Volume, Levels, a list of Volumes, Cells, or Points (one Gaussian each); or a list of Layers. Do not change its arrays
            while you use the scene
    fields  of voxels: the field at them, {'temperature': array}, as convert() takes it
    """

    def __init__(self, data: "Union[_vog._Drawable, Sequence[Layer]]", fields: "Optional[Dict[str, Any]]" = None) -> None:
        self._layers = list(data) if isinstance(data, (list, tuple)) and any(isinstance(one, Layer) for one in data) else []
        if not self._layers:
            self._scene = _vog._Scene([data], [fields])
            return
        if fields is not None or not all(isinstance(one, Layer) for one in self._layers):
            raise TypeError("render: a list with Layers must contain only Layers, each with its own fields")
        self._scene = _vog._Scene([one.data for one in self._layers], [one.fields for one in self._layers])

    def render(
        self, camera: "Optional[_vog.Camera]" = None, size: _Size = 512, *, progress: "Optional[Callable[[float], Any]]" = None, **request: Any
    ) -> "_vog.Picture":
        """One picture; the keywords are vog.render's. What one kind of picture needs is prepared once."""
        if self._layers:
            own = {"show": "volume", "layers": [one._member(n) for n, one in enumerate(self._layers)]}
            request = {**own, **{key: value for key, value in request.items() if value is not None}}
        return self._scene.draw(_json("render", {"camera": camera, "size": size, **request}), progress)

    def __repr__(self) -> str:
        return "<vog.Scene>"


def render(
    data: "Union[_vog._Drawable, Sequence[Layer]]",
    camera: "Optional[_vog.Camera]" = None,
    size: _Size = 512,
    *,
    fields: "Optional[Dict[str, Any]]" = None,
    progress: "Optional[Callable[[float], Any]]" = None,
    **request: Any,
) -> "_vog.Picture":
    """Draws one picture. The keywords are the options of `vog render`; the same request gives the same picture there.

    data                Gaussians, a Volume, Levels, a list of Volumes, Cells, or Points (one Gaussian each); or a list of Layers for
                        one volume picture of all
    camera              None: Camera.orbit(data), fitted to the picture
    size                pixels, 512 or (width, height)
    fields              of voxels: the field at them, {'temperature': array}, as convert() takes it
    progress            is called with the finished fraction

    Keywords of the request; None: the default. Where the command takes numbers with commas, pass sequences or arrays. tf may also be a
    TransferFunction, a Matplotlib map or colours [N, 3 or 4].

    KEYWORDS

    For many views of the same data, make a Scene. Releases the interpreter's lock; Ctrl-C interrupts it. Returns a Picture.

    >>> volume = vog.sample_cloud(64)
    >>> picture = vog.render(vog.convert(volume, block=4), size=(64, 48))
    >>> picture.values.shape, picture.label
    ((48, 64), 'T')
    >>> vog.compare(vog.render(volume, size=(64, 48)), picture).psnr_db > 30
    True
    >>> head = vog.render(vog.sample_head(64), size=64, show="volume", window=(1040, 400), background="white")
    >>> np.asarray(head.image).shape
    (64, 64, 3)
    >>> cloud = vog.render(volume, size=64, show="volume", tf="white", light="studio")
    >>> bool(np.asarray(cloud.image).mean() < np.asarray(vog.render(volume, size=64, show="volume", tf="white").image).mean())
    True
    """
    if fields is not None and request.get("show") in (None, "T", "column"):
        raise _vog.Error("render: fields have no effect on show 'T' and 'column', expected another show, and field")
    if fields is not None and not request.get("field"):
        raise _vog.Error(f"render: show '{request['show']}': expected field, one of fields" + (f": {', '.join(map(str, fields))}" if isinstance(fields, dict) else ""))
    return Scene(data, fields).render(camera, size, progress=progress, **request)


# Members of requests that a page begins with: as `vog page` has them.
_OF_PAGES = [
    key
    for key, (_, _, _, _, shows, renderers) in _MEMBERS.items()
    if key in ("show", "field", "range", "scale", "tf", "extinction", "background", "blend", "clip", "clip_planes")
    or (shows.startswith("volume") and key != "layers")
]


def export_html(
    file: "Union[str, os.PathLike[str]]",
    models: Any,
    *,
    title: str = "",
    description: str = "",
    levels: int = 8,
    camera: "Optional[_vog.Camera]" = None,
    steps: bool = False,
    precise: bool = False,
    url: str = "",
    **request: Any,
) -> "Dict[str, int]":
    """Writes models to one self-contained HTML page, which needs no server, network or other file.

    file                page to write; or a folder (existing, or a name ending in /) for a site, from which a browser loads only what its
                        views need, from any web server (vog serve shows it)
    models              Gaussians, or {name: Gaussians}: the page lets its reader select one
    title               title of the page; default: the first name
    description         text below the title
    levels              largest number of levels of detail: the model, then a quarter as many Gaussians each time
    camera              initial view; None: Camera.orbit of each model, fitted
    steps               True: the models are steps in time, with a play bar and one extinction
    precise             True: numbers four times as fine, for 4 more bytes per Gaussian
    url                 address of https or http, or relative to the page, at which a copy of the data lies: models is then the path of a
                        site or of a compact model (vog pack --hierarchy --deflate), and the page streams it from there

    Keywords of the page's first picture, as in render(); None: the default. background may also be 'system': black or
    white to match the reader's system theme.

    KEYWORDS

    Returns a dict: bytes (size of the file), viewer_bytes (size without the models), gaussians.

    >>> model = vog.convert(vog.sample_cloud(64), block=8)
    >>> report = vog.export_html("cloud.html", {"cloud": model}, title="A cloud", show="volume", light="studio")
    >>> report["gaussians"] == len(model)
    True
    """
    system = isinstance(request.get("background"), str) and request["background"] == "system"
    given = {"camera": camera, **request, **({"background": None} if system else {})}
    text = _json("export_html", given, (*_OF_PAGES, "camera"))
    module: Any = _vog
    written: "Dict[str, int]" = module._export_html(file, models, text, title, description, levels, steps, precise, url, system)
    return written


def recolor(self: Any, **request: Any) -> Any:
    """Changes colours, scale and annotations without drawing again. None keeps a setting. Returns a new Picture.

    >>> picture = vog.render(vog.sample_cloud(64), size=64, show="column").recolor(tf="viridis", scale="log", color_bar=True)
    >>> picture.scale.kind
    'log'
    """
    text = _json("recolor", request, _RECOLORED)
    if request.get("scale") is not None and request.get("range") is None:
        text = json.dumps({"range": None, **json.loads(text)})  # another kind has another range
    return self._recolored(text)


def extend_picture() -> None:
    """Adds render() to the module, and what Picture has in Python's own types."""
    module: Any = _vog
    module.render = render
    module.__all__.append("render")
    _state_keywords(render, [key for key in _MEMBERS if key != "size"])
    _state_keywords(recolor, _RECOLORED)
    module.export_html = _messages._shortened(export_html, _vog.Error, "export_html")
    module.__all__.append("export_html")
    _state_keywords(module.export_html, _OF_PAGES)
    scene: Any = _vog._Scene
    scene.draw = _messages._shortened(scene.draw, _vog.Error)
    picture: Any = _vog.Picture
    picture.recolor = recolor
    picture.scale = property(lambda self: Scale(*self._scale) if self._scale else None, doc="Scale of the colours; None: of T.")
    picture.request = property(
        lambda self: json.loads(self._request),
        doc="The request with every default, a dict: vog.render(data, **picture.request) draws it again.",
    )
