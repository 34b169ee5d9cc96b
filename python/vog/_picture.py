"""Pictures: requests in the words of `vog render`, and what is drawn of them."""
import json
import os
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _messages, _vog
from ._packages import described

_Size = Union[int, Sequence[int]]


class Scale(NamedTuple):
    """Colour scale of a picture: values at the two ends of the colours, 'linear' or 'log' between them."""

    low: float
    high: float
    kind: str


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


def _json(call: str, request: "Dict[str, Any]") -> str:
    known = _vog._request_keys()
    for key in request:
        if key not in known:
            raise TypeError(f"{call}: unknown keyword '{key}', expected {', '.join(known)}")
    try:
        return json.dumps({key: _plain(value, key) for key, value in request.items() if value is not None})
    except (_vog.Error, TypeError) as error:
        raise type(error)(f"{call}: {error}") from None


class Scene:
    """Data made ready for pictures from any number of views.

    data    Gaussians, a Volume, Levels, a list of Volumes, or Points (one Gaussian each). Leave its arrays as they are while the scene is used
    fields  of voxels: the field at them, {'temperature': array}, as convert() takes it
    """

    def __init__(self, data: "_vog._Drawable", fields: "Optional[Dict[str, Any]]" = None) -> None:
        self._scene = _vog._Scene(data, fields)

    def render(
        self, camera: "Optional[_vog.Camera]" = None, size: _Size = 512, *, progress: "Optional[Callable[[float], Any]]" = None, **request: Any
    ) -> "_vog.Picture":
        """One picture; the keywords are vog.render's. What one kind of picture needs is prepared once."""
        return self._scene.draw(_json("render", {"camera": camera, "size": size, **request}), progress)

    def __repr__(self) -> str:
        return "<vog.Scene>"


def render(
    data: "_vog._Drawable",
    camera: "Optional[_vog.Camera]" = None,
    size: _Size = 512,
    *,
    show: str = "T",
    field: str = "",
    fields: "Optional[Dict[str, Any]]" = None,
    tf: Any = None,
    range: "Optional[ArrayLike]" = None,
    scale: str = "auto",
    window: "Optional[ArrayLike]" = None,
    bands: "Optional[Sequence[Any]]" = None,
    threshold: "Optional[float]" = None,
    unit_distance: "Optional[float]" = None,
    light: "Union[str, ArrayLike, None]" = None,
    light_weights: "Optional[ArrayLike]" = None,
    shadows: bool = False,
    light_from: "Optional[ArrayLike]" = None,
    ambient_occlusion: bool = False,
    scattering: int = 1,
    clip: "Optional[ArrayLike]" = None,
    clip_planes: "Optional[ArrayLike]" = None,
    extinction: "Union[str, float]" = "auto",
    background: "Union[str, ArrayLike]" = "black",
    blend: bool = False,
    units: str = "",
    least_column: "Optional[float]" = None,
    color_bar: bool = False,
    axes: bool = False,
    scale_bar: bool = False,
    title: str = "",
    renderer: "Optional[str]" = None,
    slabs: "Optional[int]" = None,
    pixel_error: "Optional[float]" = None,
    aabb_sigma: "Optional[float]" = None,
    kappa: "Optional[float]" = None,
    anyhit: "Optional[str]" = None,
    hits_per_slab: "Optional[int]" = None,
    stop_transmittance: "Optional[float]" = None,
    interpolation: "Optional[str]" = None,
    step: "Optional[float]" = None,
    samples: "Optional[int]" = None,
    progress: "Optional[Callable[[float], Any]]" = None,
) -> "_vog.Picture":
    """One picture of a request, in the words of `vog render`; the same request gives the same picture there.

    data           Gaussians, a Volume, Levels, a list of Volumes, or Points (one Gaussian each)
    camera         None: Camera.orbit(data), fitted to the picture
    size           pixels, 512 or (width, height)
    show           'T', optical depth; 'column', the integral of the density along the ray; of a field 'mean', weighted by density along
                   the ray, 'deviation', its standard deviation, 'maximum', the largest value on the ray, or 'volume', emission and
                   absorption under a transfer function of its values
    field          'temperature'; of vectors 'velocity' (along the view, away from the eye positive), 'velocity.x', '.y', '.z' or
                   'velocity.magnitude' (root mean square). '': of volume and maximum the data's own values
    fields         of voxels: the field at them, {'temperature': array}, as convert() takes it
    tf             transfer function: a TransferFunction, a name, a JSON file, a Matplotlib map or colours [N, 3 or 4]; None: ember for T
                   and volume, else inferno. Of volume a file may have its points at values
    range          (low, high) values at its ends; None: of column 0, or with scale 'log' the 5th percentile, and the largest; of
                   fields the 1st and the 99th percentile; of volume those of the data, weighted by mass
    scale          'linear', 'log', of fields 'symmetric' about 0, or 'auto': linear, of volume log where values above 0 extend over a
                   decade and more
    window         of volume: (centre, width) of medical pictures, in place of tf
    bands          of volume: rows (lower, upper, colour, opacity) or, of a surface, (value, colour), in place of tf; colours
                   are (r, g, b), '#rrggbb' or names
    threshold      of volume: nothing is shown below
    unit_distance  of volume: world length that opacities refer to; None: the file's; of window, bands and a tf with opacities a
                   hundredth of the box's diagonal; of a colour map the one at which the data, spread evenly over the silhouette of
                   their box, have an optical depth of 2
    light          of volume: 'head', a direction towards the light, or 'studio': shadows, ambient occlusion and three octaves of
                   scattering; None: emission and absorption alone
    light_weights  (ambient, diffuse, specular, power)
    shadows        of volume: light is absorbed on its way from the direction of `light`, else `light_from`, else the upper left of
                   the view
    ambient_occlusion
                   of volume: ambient light is absorbed on its way from all directions
    scattering     octaves of multiple scattering, which brighten the inside of shadows
    clip           box of the world that is shown, [2, 3]; None: all. Exact on every ray
    clip_planes    rows (nx, ny, nz, d): the side where n.x >= d stays
    extinction     of T: factor on density; 'auto': the 99th percentile of the non-zero T becomes 4, more or less where the picture would be dark or burnt out
    background     'black', 'white', 'transparent', or (r, g, b) in [0, 1]
    blend          of T: colours fade into the background as V goes to 0
    units          unit of the shown numbers: they convert to it where the data state theirs; else a text for the label
    least_column   of mean and deviation: share of the largest column below which nothing is shown
    color_bar, axes, scale_bar, title
                   marks around and over the picture
    renderer       of models 'splat' (exact, object order), 'trace' (the same ray by ray), 'cuda', 'optix' (on an NVIDIA GPU); of voxels
                   'reference' or 'optix'; None: the first of them
    slabs          of volume and maximum: depth slabs, 1 to 1024
    pixel_error    error of coarser Gaussians that are drawn in place of finer ones, pixels
    aabb_sigma     splat, trace, optix: the paper's boxes, in its radii; 0: none
    kappa          cuts kernels at this share of their peak, in place of the model's own cutoff
    anyhit         trace, optix: 'accumulate' or, as the paper, 'collect', with hits_per_slab hits at once until transmittance falls
                   below stop_transmittance
    interpolation  reference: 'constant' (exact) or 'linear' between voxel centres, by `step` voxels
    samples        reference, optix: N for the mean of N x N rays in each pixel; 1: the ray through its centre
    progress       is called with the finished fraction

    For many views of one thing make a Scene. The interpreter's lock is released; Ctrl-C ends it. Returns a Picture.

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
    >>> np.asarray(cloud.image).mean() < np.asarray(vog.render(volume, size=64, show="volume", tf="white").image).mean()
    True
    """
    request = {key: value for key, value in locals().items() if key not in ("data", "fields", "progress", "camera", "size")}
    if fields is not None and (show in ("T", "column") or not field):
        raise _vog.Error("render: fields: expected field, the shown one, and a show that has one")
    return Scene(data, fields).render(camera, size, progress=progress, **request)


def recolor(
    self: Any,
    *,
    tf: Any = None,
    range: "Optional[ArrayLike]" = None,
    scale: "Optional[str]" = None,
    extinction: "Optional[float]" = None,
    background: "Union[str, ArrayLike, None]" = None,
    blend: "Optional[bool]" = None,
    least_column: "Optional[float]" = None,
    color_bar: "Optional[bool]" = None,
    axes: "Optional[bool]" = None,
    scale_bar: "Optional[bool]" = None,
    title: "Optional[str]" = None,
) -> Any:
    """The same numbers under other colours, scale and marks, without drawing again: a Picture. None: as they are.

    >>> picture = vog.render(vog.sample_cloud(64), size=64, show="column").recolor(tf="viridis", scale="log", color_bar=True)
    >>> picture.scale.kind
    'log'
    """
    request = {key: value for key, value in locals().items() if key != "self"}
    text = _json("recolor", request)
    if scale is not None and range is None:
        text = json.dumps({"range": None, **json.loads(text)})  # another kind has another range
    return self._recolored(text)


def extend_picture() -> None:
    """Adds what Picture has in Python's own types."""
    scene: Any = _vog._Scene
    scene.draw = _messages._shortened(scene.draw, _vog.Error)
    picture: Any = _vog.Picture
    picture.recolor = recolor
    picture.scale = property(lambda self: Scale(*self._scale) if self._scale else None, doc="Scale of the colours; None: of T.")
    picture.request = property(
        lambda self: json.loads(self._request),
        doc="The request with every default, a dict: vog.render(data, **picture.request) draws it again.",
    )
