# Type stubs of the compiled module vog._vog. Its docstrings have shapes, units and errors.
# tests/python/test_stubs.py checks the stubs against the module, and with VOG_WRITE_STUB=1 writes the keywords of requests.
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, Optional, SupportsFloat, SupportsIndex, Tuple, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import TypeAlias

from ._picture import Layer, Scale

__all__ = [
    "Error",
    "memory_limit",
    "peak_memory",
    "thread_count",
    "threads",
    "Camera",
    "Cells",
    "TransferFunction",
    "DepthImage",
    "Image",
    "Volume",
    "Levels",
    "grid_names",
    "Points",
    "Field",
    "Gaussians",
    "sample_cloud",
    "sample_explosion",
    "sample_head",
    "sample_fire",
    "sample_levels",
    "sample_particles",
    "convert",
    "Picture",
    "PictureDifference",
    "DepthDifference",
    "render",
    "compare",
    "compare_shaded",
    "difference_map",
    "evaluate",
    "export_html",
    "export_splats",
    "voxelize",
    "isosurface",
]
__version__: str

_Path: TypeAlias = Union[str, os.PathLike[str]]
_Vector: TypeAlias = Union[Sequence[float], NDArray[Any]]
_Index: TypeAlias = Sequence[int]
_Size: TypeAlias = Union[int, Sequence[int]]
_Extinction: TypeAlias = Union[float, str]
_Progress: TypeAlias = Callable[[float], object]
_Mesh: TypeAlias = Union[Volume, Levels, Sequence[Volume]]
_Drawable: TypeAlias = Union[Gaussians, Points, Cells, _Mesh]
# A TransferFunction, a name, a JSON file, a Matplotlib colour map, colours [N, 3 or 4].
_Map: TypeAlias = Union[TransferFunction, _Path, NDArray[Any], Callable[[Any], Any]]

class Error(Exception): ...

def thread_count() -> int: ...
def peak_memory() -> int: ...

class memory_limit:
    def __init__(self, bytes: float, folder: str = ...) -> None: ...
    def __enter__(self) -> memory_limit: ...
    def __exit__(self, *args: object) -> None: ...

class threads:
    def __init__(self, count: int) -> None: ...
    def __enter__(self) -> threads: ...
    def __exit__(self, *args: object) -> None: ...

class Camera:
    eye: tuple[float, float, float]
    look_at: tuple[float, float, float]
    up: tuple[float, float, float]
    fov_degrees: float
    orthographic_width: float
    def __init__(
        self,
        eye: _Vector,
        look_at: _Vector = ...,
        up: _Vector = ...,
        fov_degrees: float = ...,
        orthographic_width: float = ...,
    ) -> None: ...
    @staticmethod
    def paper_view(data: Union[_Drawable, NDArray[Any]]) -> Camera: ...
    @staticmethod
    def orbit(
        data: Union[_Drawable, NDArray[Any]],
        azimuth: Optional[float] = ...,
        elevation: Optional[float] = ...,
        distance: Optional[float] = ...,
        fov_degrees: float = ...,
        up: Union[str, _Vector, None] = ...,
        roll: float = ...,
        orthographic: bool = ...,
        width: Optional[float] = ...,
        aspect: float = ...,
        view: Optional[str] = ...,
        frame: str = ...,
    ) -> Camera: ...
    @staticmethod
    def load(file: _Path) -> Camera: ...
    def save(self, file: _Path) -> None: ...
    def __eq__(self, other: object) -> bool: ...

class TransferFunction:
    name: str
    def __init__(self, tf: _Map) -> None: ...
    @staticmethod
    def names() -> list[str]: ...
    @staticmethod
    def load(file: _Path) -> TransferFunction: ...
    @staticmethod
    def from_matplotlib(colormap: Any) -> TransferFunction: ...
    @staticmethod
    def from_colors(colors: ArrayLike, name: str = ...) -> TransferFunction: ...
    @staticmethod
    def from_points(name: str, color: ArrayLike, opacity: Union[ArrayLike, None] = ...) -> TransferFunction: ...
    def save(self, file: _Path) -> None: ...
    @property
    def color(self) -> NDArray[np.float32]: ...
    @property
    def opacity(self) -> NDArray[np.float32]: ...
    def __call__(self, v: ArrayLike) -> NDArray[np.float32]: ...

class DepthImage:
    @staticmethod
    def from_numpy(depth: ArrayLike, extinction: float = ...) -> DepthImage: ...
    @staticmethod
    def load(file: _Path) -> DepthImage: ...
    def save(self, file: _Path) -> None: ...
    @property
    def depth(self) -> NDArray[np.float32]: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    @property
    def extinction(self) -> float: ...
    @extinction.setter
    def extinction(self, value: _Extinction) -> None: ...
    def shade(
        self, tf: _Map = ..., background: Union[str, _Vector] = ..., blend: bool = ...
    ) -> Image: ...
    def column_density(self) -> NDArray[np.float32]: ...
    def plot(
        self,
        quantity: str = ...,
        tf: Optional[_Map] = ...,
        *,
        range: Union[tuple[float, float], None] = ...,
        log: bool = ...,
        units: str = ...,
        title: str = ...,
        color_bar: bool = ...,
        background: Union[str, _Vector] = ...,
    ) -> Image: ...
    def _repr_png_(self) -> bytes: ...
    def __array__(self, dtype: Any = ...) -> NDArray[np.float32]: ...

class Image:
    @staticmethod
    def from_numpy(image: ArrayLike) -> Image: ...
    @staticmethod
    def load(file: _Path) -> Image: ...
    def save(self, file: _Path) -> None: ...
    @property
    def rgba(self) -> NDArray[np.float32]: ...
    @property
    def shape(self) -> tuple[int, int, int]: ...
    def _repr_png_(self) -> bytes: ...
    def __array__(self, dtype: Any = ...) -> NDArray[np.uint8]: ...

class Volume:
    name: str
    background: float
    _units: tuple[str, str]
    @staticmethod
    def load(
        file: _Path,
        grid: str = ...,
        *,
        level_set_to_fog: bool = ...,
        mask: bool = ...,
        skip_nonfinite: bool = ...,
        clip_negative: bool = ...,
        background: Optional[float] = ...,
    ) -> Volume: ...
    @staticmethod
    def from_numpy(
        array: ArrayLike,
        voxel_size: Union[SupportsFloat, _Vector, None] = ...,
        origin: Union[_Vector, None] = ...,
        *,
        matrix: Union[ArrayLike, None] = ...,
        active: Union[NDArray[np.bool_], None] = ...,
        first: _Index = ...,
        name: str = ...,
        skip_nonfinite: bool = ...,
        clip_negative: bool = ...,
    ) -> Volume: ...
    @staticmethod
    def _from_parts(
        parts: Iterable[tuple[_Index, ArrayLike]], matrix: ArrayLike, name: str, skip_nonfinite: bool, clip_negative: bool
    ) -> Volume: ...
    @staticmethod
    def from_blocks(
        blocks: Iterable[tuple[_Index, ArrayLike]],
        voxel_size: Union[SupportsFloat, _Vector, None] = ...,
        origin: Union[_Vector, None] = ...,
        *,
        matrix: Union[ArrayLike, None] = ...,
        all_active: bool = ...,
        name: str = ...,
        skip_nonfinite: bool = ...,
        clip_negative: bool = ...,
    ) -> Volume: ...
    def to_numpy(
        self, first: Union[_Index, None] = ..., shape: Union[_Index, None] = ...
    ) -> NDArray[np.float32]: ...
    def save(self, file: _Path, half: bool = ..., *, fields: Union[dict[str, Any], None] = ...) -> None: ...
    @property
    def source(self) -> str: ...
    @property
    def matrix(self) -> NDArray[np.float64]: ...
    @property
    def active_voxels(self) -> int: ...
    @property
    def leaves(self) -> int: ...
    @property
    def tiles(self) -> int: ...
    @property
    def voxel_volume(self) -> float: ...
    @property
    def mass(self) -> float: ...
    @property
    def index_box(self) -> tuple[tuple[int, int, int], tuple[int, int, int]]: ...
    @property
    def box(self) -> Union[NDArray[np.float64], None]: ...
    @property
    def voxel_box(self) -> Union[NDArray[np.float64], None]: ...
    @property
    def up(self) -> Union[tuple[float, float, float], None]: ...
    @up.setter
    def up(self, value: Union[str, _Vector, None]) -> None: ...
    @property
    def front(self) -> Union[tuple[float, float, float], None]: ...
    @front.setter
    def front(self, value: Union[str, _Vector, None]) -> None: ...

class Levels:
    def __init__(self, volumes: Iterable[Volume], masks: Iterable[Volume] = ..., *, force: bool = ...) -> None: ...
    @staticmethod
    def load(
        files: Union[_Path, Sequence[_Path]],
        grid: str = ...,
        mask: str = ...,
        *,
        level_set_to_fog: bool = ...,
        force: bool = ...,
        skip_nonfinite: bool = ...,
        clip_negative: bool = ...,
    ) -> Levels: ...
    def save(self, file: _Path, *, fields: Union[dict[str, Any], None] = ...) -> None: ...
    @property
    def arrangement(self) -> str: ...
    def __getitem__(self, index: int) -> Volume: ...
    def __len__(self) -> int: ...
    @property
    def box(self) -> Union[NDArray[np.float64], None]: ...

def grid_names(file: _Path) -> list[str]: ...
def _volume_head(file: _Path, grid: str = ...) -> tuple[tuple[float, float, float], tuple[float, float, float], str, str]: ...

class Points:
    source: str
    _units: tuple[str, str]
    @staticmethod
    def load(
        file: Union[_Path, Sequence[_Path]],
        *,
        columns: Sequence[str] = ...,
        grid: str = ...,
        skip_nonfinite: bool = ...,
    ) -> Points: ...
    @staticmethod
    def from_numpy(
        position: ArrayLike,
        velocity: Union[ArrayLike, None] = ...,
        attributes: dict[str, ArrayLike] = ...,
        *,
        source: str = ...,
    ) -> Points: ...
    def save(self, file: _Path) -> None: ...
    @property
    def position(self) -> NDArray[np.float64]: ...
    @property
    def velocity(self) -> Union[NDArray[np.float32], None]: ...
    @property
    def attributes(self) -> dict[str, NDArray[np.float32]]: ...
    @property
    def value_names(self) -> list[str]: ...
    @property
    def box(self) -> Union[NDArray[np.float64], None]: ...
    def __len__(self) -> int: ...

class Cells:
    _units: tuple[str, str]
    def __init__(
        self,
        points: ArrayLike,
        corners: ArrayLike,
        types: ArrayLike,
        density: Any,
        *,
        ends: Union[ArrayLike, None] = ...,
        fields: dict[str, Any] = ...,
        thickness: float = ...,
        name: str = ...,
        source: str = ...,
    ) -> None: ...
    @property
    def box(self) -> Union[NDArray[np.float64], None]: ...
    def __len__(self) -> int: ...

class Field:
    @property
    def name(self) -> str: ...
    @property
    def is_vector(self) -> bool: ...
    @property
    def is_measure(self) -> bool: ...
    @property
    def background(self) -> float: ...
    @property
    def unit(self) -> str: ...
    @property
    def range(self) -> tuple[float, float]: ...
    @property
    def spread(self) -> Union[tuple[float, float, float], None]: ...
    @property
    def value(self) -> NDArray[np.float32]: ...
    @value.setter
    def value(self, value: ArrayLike) -> None: ...
    @property
    def gradient(self) -> NDArray[np.float32]: ...
    @gradient.setter
    def gradient(self, value: ArrayLike) -> None: ...
    @property
    def deviation(self) -> NDArray[np.float32]: ...
    @deviation.setter
    def deviation(self, value: ArrayLike) -> None: ...
    @property
    def skewness(self) -> NDArray[np.float32]: ...
    @skewness.setter
    def skewness(self, value: ArrayLike) -> None: ...
    @property
    def covariance(self) -> NDArray[np.float32]: ...

class Gaussians:
    cutoff: float
    _units: tuple[str, str]
    source: str
    def __init__(
        self,
        mean: ArrayLike,
        scale: ArrayLike,
        density: ArrayLike,
        rotation: Union[ArrayLike, None] = ...,
        *,
        cutoff: float = ...,
        box: Union[ArrayLike, None] = ...,
        origin: Union[ArrayLike, None] = ...,
        fields: Union[Mapping[str, Union[Field, Mapping[str, Any]]], None] = ...,
    ) -> None: ...
    @staticmethod
    def load(
        file: _Path,
        *,
        level: Union[int, None] = ...,
        box: Union[ArrayLike, None] = ...,
        fields: Union[Sequence[str], None] = ...,
        skip_nonfinite: bool = ...,
    ) -> Gaussians: ...
    def save(
        self,
        file: _Path,
        *,
        step: Union[float, None] = ...,
        field_step: Union[float, None] = ...,
        max_loss: Union[float, None] = ...,
        reference: Union[Volume, Levels, Sequence[Volume], None] = ...,
        hierarchy: bool = ...,
    ) -> None: ...
    def coarsen(self, budget: int) -> Gaussians: ...
    @property
    def source_voxels(self) -> int: ...
    @property
    def method(self) -> str: ...
    @property
    def options(self) -> str: ...
    @property
    def summary(self) -> str: ...
    @property
    def mean(self) -> NDArray[np.float32]: ...
    @mean.setter
    def mean(self, value: ArrayLike) -> None: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def world_mean(self) -> NDArray[np.float64]: ...
    @property
    def scale(self) -> NDArray[np.float32]: ...
    @scale.setter
    def scale(self, value: ArrayLike) -> None: ...
    @property
    def rotation(self) -> NDArray[np.float32]: ...
    @rotation.setter
    def rotation(self, value: ArrayLike) -> None: ...
    @property
    def density(self) -> NDArray[np.float32]: ...
    @density.setter
    def density(self, value: ArrayLike) -> None: ...
    @property
    def fields(self) -> Mapping[str, Field]: ...
    @property
    def axis_aligned(self) -> bool: ...
    @property
    def box(self) -> Union[NDArray[np.float64], None]: ...
    @property
    def voxel_box(self) -> Union[NDArray[np.float64], None]: ...
    @property
    def mass(self) -> float: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: Union[SupportsIndex, slice, NDArray[Any], Sequence[int], Sequence[bool]]) -> Gaussians: ...
    def __add__(self, other: Gaussians) -> Gaussians: ...

def sample_cloud(size: int = ..., seed: int = ...) -> Volume: ...
def sample_explosion(size: int = ..., seed: int = ...) -> Volume: ...
def sample_head(size: int = ..., seed: int = ...) -> Volume: ...
def sample_fire(size: int = ..., seed: int = ...) -> Tuple[Volume, Volume]: ...
def sample_levels(size: int = ..., seed: int = ...) -> Levels: ...
def sample_particles(size: int = ..., seed: int = ...) -> Points: ...
def convert(
    data: Union[_Mesh, Points, Cells],
    *,
    method: str = ...,
    fields: Union[dict[str, Any], Sequence[str], bool, None] = ...,
    labels: Any = ...,
    progress: Union[_Progress, None] = ...,
    report: Union[dict[str, Any], None] = ...,
    error: Optional[float] = ..., budget: Optional[int] = ..., block: Optional[int] = ..., lod: Optional[int] = ...,
    soft_steps: Optional[int] = ..., refine_seconds: Optional[float] = ..., spread: Optional[float] = ...,
    mass_threshold: Optional[float] = ..., axis_aligned: Optional[bool] = ..., measure: Optional[bool] = ...,
    joint_field: Optional[str] = ..., joint_steps: Optional[int] = ..., strategy: Optional[str] = ..., dense_block: Optional[int] = ...,
    amplitude: Optional[str] = ..., kappa: Optional[float] = ..., opacity_threshold: Optional[float] = ...,
    variance_threshold: Optional[float] = ..., similarity: Optional[float] = ..., tree_depth: Optional[int] = ...,
    minimum_radius: Optional[float] = ..., value: Optional[str] = ..., radius: Optional[float] = ..., neighbours: Optional[int] = ...,
    smoothing: Optional[ArrayLike] = ..., periodic: Optional[ArrayLike] = ...,
) -> Gaussians: ...

class Picture:
    @property
    def values(self) -> NDArray[np.float32]: ...
    @property
    def column(self) -> Union[NDArray[np.float32], None]: ...
    @property
    def mean(self) -> Union[NDArray[np.float32], None]: ...
    @property
    def deviation(self) -> Union[NDArray[np.float32], None]: ...
    @property
    def image(self) -> Image: ...
    @property
    def depth(self) -> DepthImage: ...
    @property
    def scale(self) -> Union[Scale, None]: ...
    @property
    def label(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def extinction(self) -> float: ...
    @property
    def camera(self) -> Camera: ...
    @property
    def request(self) -> dict[str, Any]: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    def recolor(
        self,
        *,
        tf: Optional[_Map] = ..., range: Optional[ArrayLike] = ..., scale: Optional[str] = ..., extinction: Optional[_Extinction] = ...,
        background: Optional[Union[str, _Vector]] = ..., blend: Optional[bool] = ..., least_column: Optional[float] = ...,
        color_bar: Optional[bool] = ..., axes: Optional[bool] = ..., scale_bar: Optional[bool] = ..., title: Optional[str] = ...,
    ) -> Picture: ...
    def save(self, file: _Path) -> None: ...
    def save_values(self, file: _Path) -> None: ...
    @property
    def _scale(self) -> Union[tuple[float, float, str], None]: ...
    @property
    def _request(self) -> str: ...
    def _recolored(self, request: str, /) -> Picture: ...
    def _repr_png_(self) -> bytes: ...
    def __array__(self, dtype: Any = ...) -> NDArray[np.float32]: ...

class _Scene:
    def __init__(self, data: Any, fields: Any, /) -> None: ...
    def draw(self, request: str, progress: Union[_Progress, None], /) -> Picture: ...

def _transfer_json(tf: Any, /) -> str: ...
def _conversion_schema() -> dict[str, str]: ...
def _request_schema() -> dict[str, tuple[str, str, str, list[str], str, str]]: ...
def render(
    data: Union[_Drawable, Sequence[Layer]],
    camera: Optional[Camera] = ...,
    size: _Size = ...,
    *,
    fields: Optional[dict[str, Any]] = ...,
    progress: Optional[_Progress] = ...,
    show: Optional[str] = ..., field: Optional[str] = ..., range: Optional[ArrayLike] = ..., scale: Optional[str] = ...,
    units: Optional[str] = ..., least_column: Optional[float] = ..., tf: Optional[_Map] = ..., extinction: Optional[_Extinction] = ...,
    background: Optional[Union[str, _Vector]] = ..., blend: Optional[bool] = ..., window: Optional[ArrayLike] = ...,
    bands: Optional[Sequence[Any]] = ..., threshold: Optional[float] = ..., gradient_opacity: Optional[ArrayLike] = ...,
    unit_distance: Optional[float] = ..., light: Optional[Union[str, ArrayLike]] = ..., shadows: Optional[bool] = ...,
    light_from: Optional[Union[str, ArrayLike]] = ..., ambient_occlusion: Optional[bool] = ..., scattering: Optional[int] = ...,
    asymmetry: Optional[float] = ..., light_weights: Optional[ArrayLike] = ..., slabs: Optional[int] = ...,
    precision: Optional[float] = ..., layers: Optional[Sequence[dict[str, Any]]] = ..., clip: Optional[ArrayLike] = ...,
    clip_lights: Optional[bool] = ..., clip_planes: Optional[ArrayLike] = ..., plane: Optional[ArrayLike] = ...,
    thickness: Optional[float] = ..., color_bar: Optional[bool] = ..., axes: Optional[bool] = ..., scale_bar: Optional[bool] = ...,
    title: Optional[str] = ..., renderer: Optional[str] = ..., pixel_error: Optional[float] = ..., kappa: Optional[float] = ...,
    aabb_sigma: Optional[float] = ..., interpolation: Optional[str] = ..., step: Optional[float] = ..., samples: Optional[int] = ...,
    anyhit: Optional[str] = ..., hits_per_slab: Optional[int] = ..., stop_transmittance: Optional[float] = ...,
) -> Picture: ...

class PictureDifference:
    @property
    def psnr_db(self) -> float: ...
    @property
    def ssim(self) -> float: ...
    @property
    def share_off_1(self) -> float: ...
    @property
    def share_off_4(self) -> float: ...
    @property
    def largest(self) -> int: ...
    @property
    def largest_at(self) -> tuple[int, int]: ...

class DepthDifference:
    @property
    def grey(self) -> PictureDifference: ...
    @property
    def psnr_db(self) -> float: ...
    @property
    def relative_l2(self) -> float: ...
    @property
    def bias(self) -> float: ...
    @property
    def largest_dt(self) -> float: ...
    @property
    def largest_at(self) -> tuple[int, int]: ...
    @property
    def extinction(self) -> float: ...
    @property
    def identical(self) -> bool: ...

@overload
def compare(reference: DepthImage, image: Union[DepthImage, Picture]) -> DepthDifference: ...
@overload
def compare(reference: Picture, image: DepthImage) -> DepthDifference: ...
@overload
def compare(reference: Image, image: Union[Image, Picture]) -> PictureDifference: ...
@overload
def compare(reference: Picture, image: Image) -> PictureDifference: ...
@overload
def compare(reference: Picture, image: Picture) -> Any: ...  # DepthDifference of T and columns, else PictureDifference
def compare_shaded(reference: Union[DepthImage, Picture], image: Union[DepthImage, Picture], tf: _Map = ...) -> PictureDifference: ...
def difference_map(
    reference: Union[DepthImage, Image, Picture], image: Union[DepthImage, Image, Picture], limit: float = ..., bar: bool = ...
) -> Image: ...
def evaluate(
    data: _Mesh,
    folder: _Path,
    *,
    size: _Size = ...,
    repeats: int = ...,
    extinction: _Extinction = ...,
    tf: Union[str, Sequence[str], None] = ...,
    conversions: str = ...,
    models: dict[str, Gaussians] = ...,
    show: str = ...,
    fields: Union[dict[str, Any], None] = ...,
    voxels: bool = ...,
    resume: bool = ...,
    progress: Union[_Progress, None] = ...,
) -> dict[str, Any]: ...
def export_html(
    file: _Path,
    models: Union[Gaussians, dict[str, Gaussians], _Path],
    *,
    title: str = ...,
    description: str = ...,
    levels: int = ...,
    camera: Union[Camera, None] = ...,
    steps: bool = ...,
    precise: bool = ...,
    url: str = ...,
    show: Optional[str] = ..., field: Optional[str] = ..., range: Optional[ArrayLike] = ..., scale: Optional[str] = ...,
    tf: Optional[_Map] = ..., extinction: Optional[_Extinction] = ..., background: Optional[Union[str, _Vector]] = ...,
    blend: Optional[bool] = ..., window: Optional[ArrayLike] = ..., bands: Optional[Sequence[Any]] = ..., threshold: Optional[float] = ...,
    gradient_opacity: Optional[ArrayLike] = ..., unit_distance: Optional[float] = ..., light: Optional[Union[str, ArrayLike]] = ...,
    shadows: Optional[bool] = ..., light_from: Optional[Union[str, ArrayLike]] = ..., ambient_occlusion: Optional[bool] = ...,
    scattering: Optional[int] = ..., asymmetry: Optional[float] = ..., light_weights: Optional[ArrayLike] = ..., slabs: Optional[int] = ...,
    precision: Optional[float] = ..., clip: Optional[ArrayLike] = ..., clip_lights: Optional[bool] = ...,
    clip_planes: Optional[ArrayLike] = ...,
) -> dict[str, int]: ...
def export_splats(
    model: Gaussians,
    file: _Path,
    *,
    extinction: _Extinction = ...,
    colors: Union[ArrayLike, None] = ...,
    units: Union[Literal["world", "box"], None] = ...,
    up: Union[str, _Vector, None] = ...,
    layout: Literal["3dgs", "volprim"] = ...,
) -> dict[str, Any]: ...
def isosurface(data: Union[Volume, Gaussians], value: SupportsFloat, *, voxel_size: Optional[SupportsFloat] = ...) -> Tuple[NDArray[np.float64], NDArray[np.uint32]]: ...
def voxelize(
    model: Gaussians,
    *,
    voxel_size: Union[SupportsFloat, None] = ...,
    like: Union[_Mesh, None] = ...,
    within: bool = ...,
    fields: bool = ...,
    name: str = ...,
    file: Union[_Path, None] = ...,
    progress: Union[_Progress, None] = ...,
) -> Any: ...
