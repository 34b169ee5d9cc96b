"""Projections along an axis and slices: densities, and means of fields weighted by density, as arrays for imshow."""
import json
from typing import Any, NamedTuple, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _vog
from ._packages import described
from ._picture import render
from ._units import is_quantity, parsed, product, units_of, value_in, with_unit

_Array = NDArray[Any]
_AXES = "xyz"
_FITS_LENGTHS = ("Mpc", "kpc", "pc", "AU", "km", "m", "cm", "mm", "um", "nm")
# Pictures beyond this are a mistake rather than a wish: the renderer's own limit, 2^28 pixels.
_MOST_PIXELS = 1 << 28


class _Pair(NamedTuple):
    array: Any
    extent: "tuple[float, float, float, float]"


class Projection(_Pair):
    """Array and extent of a projection or slice: `array, extent = vog.projection(...)`.

    array        [rows, columns] float64, rows from the bottom up, for imshow(origin="lower"); with a unit where units are known
    extent       (left, right, bottom, top), coordinates of the outer edges of the pixels, in `length_unit`; left is above right where the
                 coordinate falls to the right, as in axial slices of scans, whose x is the patient's right
    field        name of the shown field; '' for column density, and for density on a slice
    quantity     'column', 'mean', 'deviation' or 'integral'; 'slice'
    axes         the two directions of the picture, right and up, as unit vectors [2, 3]
    towards      unit vector towards the observer
    unit         unit of the array: an object or a text; None: not known
    length_unit  unit of the extent: an object or a text; None: not known
    request      request of the picture that the array is made of, as Picture has it
    """

    field: str = ""
    quantity: str = "column"
    axes: _Array
    towards: _Array
    unit: Any = None
    length_unit: Any = None
    request: "Optional[dict[str, Any]]" = None
    _name = "density"  # of the values on a slice without a field

    @property
    def pixel_area(self) -> float:
        """Area of a pixel, world units squared."""
        rows, columns = np.shape(self.array)
        left, right, bottom, top = self.extent
        return abs((right - left) / columns * (top - bottom) / rows)

    @property
    def total(self) -> Any:
        """Sum over the pixels times their area: of column density the mass inside the extent."""
        total = np.nansum(_bare(self.array)) * self.pixel_area
        if is_quantity(self.array) and self.length_unit is not None:
            return total * (self.unit * self.length_unit**2)
        return total

    def header(self) -> "dict[str, Any]":
        """Cards of a FITS header: linear world coordinates of the pixels, units, and what the array is.

        For astropy: fits.PrimaryHDU(bare_array, fits.Header(projection.header())), where the array's first row is the
        bottom one, as FITS has it.
        """
        rows, columns = np.shape(self.array)
        left, right, bottom, top = self.extent
        names = [_name_of(axis).lstrip("-") for axis in self.axes]
        cards: "dict[str, Any]" = {}
        for n, (name, low, high, count) in enumerate(zip(names, (left, bottom), (right, top), (columns, rows)), 1):
            cards[f"CTYPE{n}"] = name
            cards[f"CRPIX{n}"] = 0.5  # the outer edge of the first pixel, whose centre is 1
            cards[f"CRVAL{n}"] = low
            cards[f"CDELT{n}"] = (high - low) / count
            if self.length_unit is not None:
                factor, cards[f"CUNIT{n}"] = _fits_length(self.length_unit, max(abs(right - left), abs(top - bottom)))
                cards[f"CRVAL{n}"] *= factor
                cards[f"CDELT{n}"] *= factor
        if self.unit is not None:
            cards["BUNIT"] = _unit_text(self.unit)
        cards["BTYPE"] = self.quantity if not self.field else f"{self.quantity} of {self.field}"
        cards["VIEWDIR"] = ",".join(f"{-x + 0.0:.9g}" for x in self.towards)
        cards["ORIGIN"] = f"vog {_vog.__version__}"
        if self.request is not None:
            cards["VOGREQ"] = json.dumps(self.request)  # how it was drawn, for vog.render
        return cards

    def __repr__(self) -> str:
        rows, columns = np.shape(self.array)
        what = {"column": "column density", "slice": f"slice of {self.field or self._name}"}.get(self.quantity, f"{self.quantity} of {self.field}")
        unit = f" [{self.unit}]" if self.unit is not None else ""
        return f"<vog.Projection: {what}{unit}, {columns}x{rows}, extent {tuple(round(x, 6) for x in self.extent)}>"


def _bare(array: Any) -> _Array:
    """The numbers of an array with or without a unit."""
    return np.asarray(getattr(array, "magnitude", getattr(array, "value", array)))


def _name_of(axis: _Array) -> str:
    for k in range(3):
        if abs(axis[k]) > 1 - 1e-12:
            return ("" if axis[k] > 0 else "-") + _AXES[k].upper()
    return "OFFSET"


def _unit_text(unit: Any) -> str:
    """Text of a unit for a FITS header: astropy's own form of it where astropy has the unit."""
    to_string = getattr(unit, "to_string", None)
    try:
        return str(to_string("fits")) if to_string else str(unit)
    except Exception:  # no FITS form of this unit: its usual text
        return str(unit)


def _fits_length(unit: Any, size: float) -> "tuple[float, str]":
    """Factor to a unit of FITS's own list, and its text: the unit itself, or of others, such as code_length, the largest of which
    `size` is at least one."""
    text = _unit_text(unit)
    if text in _FITS_LENGTHS:
        return 1.0, text
    if isinstance(unit, str):
        try:
            unit = parsed(unit, "projection")
        except (ImportError, _vog.Error):
            return 1.0, text
    factors = {}
    for name in _FITS_LENGTHS:
        try:
            factors[name] = float(value_in(with_unit(1.0, unit, "projection"), name, "projection"))
        except Exception:  # no length, or a name that the package lacks
            continue
        if factors[name] * size >= 1:
            return factors[name], name
    return (factors[name], name) if factors else (1.0, text)


def _vector(value: Any, name: str) -> _Array:
    try:
        vector = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        vector = np.zeros(0)
    length = float(np.linalg.norm(vector)) if vector.shape == (3,) else 0.0
    if not (np.isfinite(length) and length > 0):
        expected = "'x', 'y', 'z', '-x', '-y', '-z', 0, 1, 2 or a vector of three numbers"
        raise _vog.Error(f"projection: {name} {described(value)}, expected {expected}")
    return vector / length


def _frame(axis: Any, up: Any) -> "tuple[_Array, _Array, _Array]":
    """Unit vectors to the right, up, and towards the observer: right x up = towards."""
    name = axis[-1:] if isinstance(axis, str) and axis.lstrip("+-") in ("x", "y", "z") and len(axis) <= 2 else ""
    if name or (not isinstance(axis, (str, bool)) and isinstance(axis, (int, np.integer)) and 0 <= axis <= 2):
        n = _AXES.index(name) if name else int(axis)
        towards = np.zeros(3)
        towards[n] = -1.0 if isinstance(axis, str) and axis[0] == "-" else 1.0
        # Cyclic, as in yt: the axes of the picture along x are y and z, along y z and x, along z x and y.
        default = np.zeros(3)
        default[(n + 2) % 3] = 1.0
    else:
        towards = _vector(axis, "axis")
        default = np.array([0.0, 0.0, 1.0] if abs(towards[2]) < 0.999 else [0.0, 1.0, 0.0])
    above = default if up is None else _frame(up, None)[2] if isinstance(up, str) else _vector(up, "up")
    right = np.cross(above, towards)
    if np.linalg.norm(right) < 1e-9:
        raise _vog.Error(f"projection: up {described(up)}, expected a direction that is not the axis'")
    right /= np.linalg.norm(right)
    return right, np.cross(towards, right), towards


def _corners(lower: Any, upper: Any) -> _Array:
    return np.array([[(lower, upper)[n >> k & 1][k] for k in range(3)] for n in range(8)], dtype=float)


def _bounds(data: Any, axes: _Array) -> "tuple[_Array, _Array]":
    """Least and largest coordinates of the data along unit vectors [n, 3], in double precision."""
    if isinstance(data, _vog.Levels):
        boxes = [data[n].voxel_box for n in range(len(data))]
    else:
        own = getattr(data, "voxel_box", None)
        boxes = [own if own is not None else data.box]
    points = [_corners(*box) for box in boxes if box is not None]
    if not points:
        raise _vog.Error("projection: the data are empty, expected Gaussians or active voxels, or width=")
    along = np.concatenate(points) @ axes.T
    return along.min(axis=0), along.max(axis=0)


def _with_text(value: Any) -> bool:
    """Whether a value is a number, or several, with the text of a unit: (16, 'Mpc')."""
    return isinstance(value, (list, tuple)) and len(value) == 2 and isinstance(value[1], str)


def _length(value: Any, unit: Any, name: str) -> float:
    if _with_text(value):
        like = None if isinstance(unit, str) else unit
        value = with_unit(float(value[0]), parsed(value[1], f"projection: {name}", like), "projection")
    if is_quantity(value):
        if unit is None:
            raise _vog.Error(f"projection: {name} has a unit, but the data have none, expected a number (vog.set_units sets units)")
        value = value_in(value, parsed(unit, "projection") if isinstance(unit, str) else unit, f"projection: {name}")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"projection: {name}: got {described(value)}, expected a number or two") from None


def _pair_of(value: Any) -> "tuple[Any, Any]":
    """Two values of one, or of a sequence of two."""
    if _with_text(value):
        return value, value
    if isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and np.ndim(value) == 1):
        if len(value) != 2:
            raise _vog.Error(f"projection: got {described(value)}, expected one number or two")
        return value[0], value[1]
    return value, value


def _pixels(resolution: Any, sides: "tuple[float, float]") -> "tuple[int, int, tuple[float, float]]":
    """Columns, rows, and the sides of the picture, whose pixels are square."""
    given = list(_pair_of(resolution))
    for n, count in enumerate(given):
        if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or count < 1:
            raise _vog.Error(f"projection: resolution {described(given[n])}, expected pixels, 1 or more: 512 or (640, 480)")
    if isinstance(resolution, (int, np.integer)):
        edge = max(sides) / int(resolution)
        columns, rows = (max(1, int(np.ceil(side / edge - 1e-9))) for side in sides)
    else:
        columns, rows = int(given[0]), int(given[1])
        edge = max(sides[0] / columns, sides[1] / rows)
    if columns * rows > _MOST_PIXELS:
        raise _vog.Error(f"projection: {columns} x {rows} pixels, expected at most 2^28 in all")
    return columns, rows, (edge * columns, edge * rows)


_Direction = Union[str, int, Sequence[float], _Array]


def projection(
    data: Any,
    field: Optional[str] = None,
    axis: _Direction = "z",
    width: Any = None,
    resolution: Union[int, "tuple[int, int]"] = 512,
    *,
    center: Any = None,
    up: Optional[_Direction] = None,
    quantity: Optional[str] = None,
    fields: Optional["dict[str, Any]"] = None,
    unit: Any = None,
) -> Projection:
    """Projects a model or a volume along an axis: array and extent, for imshow.

    data        Gaussians, a Volume, Levels, a list of Volumes or Cells
    field       name of a field; None: column density, the integral of density along each ray. Of vectors 'velocity' is the
                component away from the observer, 'velocity.x' that along x, 'velocity.magnitude' the root mean square
    axis        direction towards the observer: 'x', 'y', 'z', '-x', ..., 0, 1, 2 or a vector (x, y, z). Along x the picture has y
                to the right and z up, along y z and x, along z x and y, as in yt; along -x, -y, -z the right is turned round
    width       width of the picture, world units: a number (a square) or (width, height), Quantities, or with a unit's text: (16, 'Mpc'); None:
                the active voxels, or those that a model was made of; for other models their box
    resolution  pixels of the longer side, or (columns, rows). Pixels are square: where the two differ in shape the extent is
                enlarged about its centre
    center      world point (x, y, z) in the middle; None: the middle of the data
    up          direction that is up in the picture, of a vector `axis` by default z, or y where the view is along z
    quantity    of a field: 'mean', weighted by density (default), 'deviation', the standard deviation about it, or 'integral' of
                density times field. Means are NaN where the ray meets no density
    fields      {name: array or grid} of a volume, as in vog.convert
    unit        unit of the result: a text or a unit of astropy, pint or unyt; None: density times length of the data's units,
                or the field's unit; without units a plain array

    Every pixel is the exact integral along the ray through its centre, of Gaussians as of voxels. The sum of the pixels times
    their area is the mass to the error of that sampling (docs/python.md, "Projections and slices").

    Returns a Projection, which unpacks to (array, extent).

    >>> volume = vog.Volume.from_numpy(np.full((4, 4, 2), 3.0), voxel_size=0.5)
    >>> array, extent = vog.projection(volume, axis="z", resolution=4)
    >>> array.shape, extent
    ((4, 4), (-0.25, 1.75, -0.25, 1.75))
    >>> bool(np.allclose(array, 3.0 * 2 * 0.5))  # density times two voxels
    True
    """
    named = isinstance(field, str) and (field.lstrip("-") not in ("x", "y", "z") or field in (*(fields or ()), *getattr(data, "fields", ())))
    if isinstance(field, (int, str, tuple)) and not named:
        raise TypeError(f"projection: {field!r} is no field but an axis, which is a keyword: axis={field!r}")
    return _mapped(data, field, axis, width, resolution, center, up, quantity or ("mean" if field else "column"), fields, unit)


def slice(  # noqa: A001 - the field's word
    data: Any,
    axis: _Direction = "z",
    position: Any = None,
    field: Optional[str] = None,
    width: Any = None,
    resolution: Union[int, "tuple[int, int]"] = 512,
    *,
    thickness: Any = None,
    center: Any = None,
    up: Optional[_Direction] = None,
    fields: Optional["dict[str, Any]"] = None,
    unit: Any = None,
) -> Projection:
    """Slices a model or a volume across an axis: array and extent, for imshow.

    axis       normal of the plane, towards the observer, as projection() takes it, with the same axes of the picture; of scans also
               'axial', 'coronal' or 'sagittal', as radiologists see them
    position   coordinate of the plane along the axis, world units or with a unit: (5, 'Mpc'); of a scan's plane up, to the front or
               to the right; None: the middle of the data
    field      name of a field at the plane, weighted by density; None: the density
    thickness  average over this length across the plane: the mean of density, or of the field weighted by density; None: the plane itself

    Data, width, resolution, center, up, fields and unit are those of projection(). Of a model the density is the exact sum of its
    Gaussians at the centre of each pixel; of voxels a pixel has the value of the voxel that holds its centre, of levels the finest.
    NaN outside of the data.

    Returns a Projection, which unpacks to (array, extent).

    >>> volume = vog.Volume.from_numpy(np.arange(32.0).reshape(4, 4, 2), voxel_size=0.5)
    >>> array, extent = vog.slice(volume, "z", 0.5, resolution=4)
    >>> array[0].tolist(), extent
    ([1.0, 9.0, 17.0, 25.0], (-0.25, 1.75, -0.25, 1.75))
    """
    try:
        if isinstance(axis, str) and axis in ("axial", "coronal", "sagittal"):
            at = "" if position is None else f"={_length(position, units_of(data).length, 'position')!r}"
            camera = render(data, show="slice", plane=axis + at, size=8).camera
            towards = np.subtract(camera.eye, camera.look_at)
            axis, up = towards, up if up is not None else camera.up
            position = camera.look_at @ towards / np.linalg.norm(towards)
        return _mapped(data, field, axis, width, resolution, center, up, "slice", fields, unit, position, thickness)
    except (_vog.Error, TypeError) as error:
        raise type(error)(str(error).replace("projection:", "slice:", 1)) from None


def _mapped(
    data: Any, field: Any, axis: Any, width: Any, resolution: Any, center: Any, up: Any, quantity: str, fields: Any, unit: Any, position: Any = None, thickness: Any = None
) -> Projection:
    if isinstance(data, (list, tuple)) and data and all(isinstance(one, _vog.Volume) for one in data):
        data = _vog.Levels(data)
    if not isinstance(data, (_vog.Gaussians, _vog.Volume, _vog.Levels, _vog.Cells)):
        hint = "; vog.convert makes one of Points" if isinstance(data, _vog.Points) else ""
        raise TypeError(f"projection: got {described(data)}, expected Gaussians, a Volume, Levels, a list of Volumes or Cells{hint}")
    flat = quantity == "slice"
    allowed = ("mean", "deviation", "integral") if field else ("column",)
    if quantity not in allowed and not flat:
        raise _vog.Error(f"projection: quantity '{quantity}' {'of a field' if field else 'without a field'}, expected {' or '.join(allowed)}")
    units = units_of(data)
    right, above, towards = _frame(axis, up)
    axes = np.array([right, above, towards])
    if width is not None and center is not None:
        low = high = np.zeros(3)
    else:
        low, high = _bounds(data, axes)
    middle = 0.5 * (low + high)
    if center is not None:
        if _with_text(center) and np.ndim(center[0]) == 1:
            center = [(part, center[1]) for part in center[0]]
        parts = list(center) if isinstance(center, (list, tuple, np.ndarray)) or np.ndim(center) == 1 else []
        if len(parts) != 3:
            raise _vog.Error(f"projection: center {described(center)}, expected three numbers")
        middle = axes @ np.array([_length(part, units.length, "center") for part in parts])
    if position is not None:
        middle[2] = _length(position, units.length, "position")
    if width is None:
        reach = 2 * np.maximum(high - middle, middle - low)
        sides = (float(reach[0]), float(reach[1]))
    else:
        wide, tall = _pair_of(width)
        sides = (_length(wide, units.length, "width"), _length(tall, units.length, "width"))
    if not all(np.isfinite(side) and side > 0 for side in sides):
        raise _vog.Error(f"projection: width {sides[0]:g} x {sides[1]:g}, expected finite numbers above 0")
    columns, rows, sides = _pixels(resolution, sides)

    # Rays start in front of everything, whatever the width.
    box = data.box
    deep = float(np.linalg.norm(box[1] - box[0])) if box is not None else 1.0
    place = middle @ axes
    front = place + towards * (max((_corners(*box) @ towards).max() - middle[2], 0) + deep if box is not None else deep)
    camera = _vog.Camera(front, place, above, orthographic_width=sides[0])
    plane = None if not flat else [*map(float, towards), float(middle[2])]
    thick = None if thickness is None else _length(thickness, units.length, "thickness")
    array, picture = _drawn(data, camera, (columns, rows), field, quantity, fields, plane, thick)
    field_unit = picture.unit
    # World coordinates, also where the picture runs against their axis.
    signs = [-1 if _name_of(axis).startswith("-") else 1 for axis in axes[:2]]
    extent = [sign * (middle[n] + end * sides[n] / 2) for n, sign in enumerate(signs) for end in (-1, 1)]

    natural = None
    if units.density is not None and units.length is not None:
        natural = product(units.density, units.length, 0 if flat else 1, "projection")
    if field:
        known = parsed(field_unit, "projection", natural) if field_unit and natural is not None else None
        natural = known if quantity != "integral" else known * natural if known is not None else None
    result: Any = array
    if natural is not None:
        result = with_unit(array, natural, "projection")
        if unit is None and "code_" in str(natural):  # no reader beside the data set has its units of code
            result = result.in_cgs()
            natural = result.units
        if unit is None and getattr(natural, "scale", 1) != 1:  # '12.8 Mpc', which is no unit of FITS
            natural = type(natural)(1, natural.bases, natural.powers)
            result = result.to(natural)
        if unit is not None:
            result = _converted(result, unit)
            natural = parsed(unit, "projection", natural) if isinstance(unit, str) else unit
    elif unit is not None:
        raise _vog.Error(
            f"projection: unit '{unit}', but the data have no units, expected Quantities in from_numpy, or vog.set_units(data, density, length)"
        )
    made = Projection(result, tuple(float(x) + 0.0 for x in extent))  # type: ignore[arg-type]
    made.field, made.quantity, made.request = field or "", quantity, picture.request
    made.axes, made.towards, made._name = axes[:2], towards, picture.label.split(" [")[0]
    length = units.length
    made.unit = natural
    made.length_unit = parsed(length, "projection", natural) if isinstance(length, str) and natural is not None else length
    return made


def _converted(quantity: Any, unit: Any) -> Any:
    try:
        return quantity.to(unit)
    except Exception as error:
        if not any(word in type(error).__name__ for word in ("Unit", "Dimension", "Conversion", "Value", "Undefined")):
            raise
        raise _vog.Error(f"projection: unit '{unit}', expected one that {quantity.units if hasattr(quantity, 'units') else quantity.unit} converts to") from None


def _drawn(
    data: Any, camera: _vog.Camera, size: "tuple[int, int]", field: Optional[str], quantity: str, fields: Any, plane: Any, thickness: Any
) -> "tuple[_Array, Any]":
    """Array [rows, columns] from the bottom up, and the picture whose numbers it holds."""
    if not field and fields is not None:
        raise _vog.Error("projection: fields without a field, expected the name of one")
    show = quantity if plane else "column" if not field else "deviation" if quantity == "deviation" else "mean"
    picture: Any = render(data, camera, size, show=show, field=field or "", fields=fields, plane=plane, thickness=thickness)
    shown = np.asarray(picture.values, dtype=float)
    if quantity == "integral":
        shown = np.where(picture.column > 0, shown * picture.column, 0.0)
    return shown[::-1].copy(), picture
