"""Volumes of other packages' data: yt, xarray, nibabel and tifffile."""
import os
import tempfile
import warnings
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _vog
from ._grids import Grids, assembled, lattice
from ._packages import described, need, root_package
from ._units import in_double, set_units, units_of

# Share of a voxel by which coordinates may be off an even spacing: longitudes in float32 and rounded texts are.
_EVEN = 1e-3


def _is_path(value: object) -> bool:
    return isinstance(value, (str, os.PathLike))


# --- yt


# Level of particles' finest covering grid: 1024 cells along an axis.
_FINEST = 10


def from_yt(
    ds: Any,
    field: Any = ("gas", "density"),
    *,
    fields: Any = None,
    level: Optional[int] = None,
    unit: Optional[str] = None,
    skip_nonfinite: bool = False,
    clip_negative: bool = False,
) -> Any:
    """A field of a yt data set as Levels, one for each level of refinement, or as one covering grid.

    ds              data set of yt.load: patch-based codes (Enzo, FLASH, Athena, Boxlib); with `level` also octree codes and particles
    field           name of the field: 'density' or ('gas', 'density'); 'volume': 1 everywhere, for fields of any sign
    fields          names of further fields, in their own units, or {name: field}, 'velocity' for the vector of three: the result is then a pair of
                    data and {name: field}, for vog.convert(data, fields=...), vog.render and data.save
    level           None: all levels, where finer ones hide coarser ones; 0, 1, ...: a covering grid of the domain at the cell
                    size of that level, as one Volume
    unit            unit of the values: 'g/cm**3'; None: yt's code units, as densities in g/cm**3 are below the range of float32
    skip_nonfinite, clip_negative  as in Volume.from_numpy

    Lengths are in code_length, with the origin of the data set. The result has units, those of yt (vog.projection).

    >>> import yt
    >>> ds = yt.load_uniform_grid({"density": (np.ones((8, 8, 8)), "g/cm**3")}, (8, 8, 8), length_unit="Mpc")
    >>> vog.from_yt(ds, "density", unit="g/cm**3")[0].active_voxels
    512
    """
    if not hasattr(ds, "domain_left_edge") or not hasattr(ds, "index"):
        raise TypeError(f"from_yt: got {described(ds)}, expected a data set of yt.load")
    geometry = getattr(ds.geometry, "value", ds.geometry)
    if geometry != "cartesian":
        raise _vog.Error(f"from_yt: a data set of {geometry} geometry, expected cartesian (a pyvista.StructuredGrid of its cells, saved as .vts, is read as cells)")
    if hasattr(ds.index, "meshes"):
        raise _vog.Error("from_yt: a mesh of hexahedra or other cells, which yt samples on no grid; a pyvista.UnstructuredGrid of it, saved as .vtu, is read as cells")
    if any(getattr(grid, "cell_widths", None) is not None for grid in getattr(ds.index, "grids", ())[:1]):
        raise _vog.Error("from_yt: cells of uneven widths, expected even ones (a pyvista.RectilinearGrid of them, saved as .vtr, is read as cells)")
    field = tuple(field) if isinstance(field, list) else field
    known = [tuple(name) for name in (*ds.field_list, *ds.derived_field_list)]
    names = list(dict.fromkeys([name[1] for name in ds.field_list] + [name[1] for name in known])) + known
    left = ds.domain_left_edge.in_units("code_length").d
    width = ds.domain_width.in_units("code_length").d
    units: "dict[Any, Any]" = {}

    def numbers(values: Any, name: Any) -> Any:
        values = in_double(values)  # factors between units exceed the range of float32
        if name == field:
            values = values.in_base("code") if unit is None else values.in_units(unit)
        units[name] = values.units
        return np.asarray(values.d, dtype=np.float32)

    def of(data: Any, name: Any) -> Any:
        return numbers(data[("gas", name) if ("gas", name) in known else name], name)

    def patches(n: int, name: Any) -> Any:
        """Index of the first cell of each grid of a level, in cells of that level, and its values."""
        edge = width / ds.domain_dimensions / ds.refine_by**n
        for grid in ds.index.select_grids(n):
            first = np.rint((grid.LeftEdge.in_units("code_length").d - left) / edge).astype(int)
            yield tuple(int(i) for i in first), of(grid, name)

    if level is None:
        if not len(getattr(ds.index, "grids", ())):
            raise _vog.Error("from_yt: the data set has no grids (an octree or particles), expected patches, or level= for a covering grid")
        cells = [ds.domain_dimensions * ds.refine_by**n for n in range(ds.index.max_level + 1)]
    elif isinstance(level, bool) or not 0 <= level <= (finest := int(getattr(ds.index, "max_level", getattr(ds, "max_level", _FINEST)))):
        raise _vog.Error(f"from_yt: level {described(level)}, expected 0 to {finest}")
    else:
        # Dimensions of a domain of less than three axes stay 1.
        cells = [np.where(np.arange(3) < ds.dimensionality, ds.domain_dimensions * ds.refine_by**level, 1)]
        cover = ds.covering_grid(level, left_edge=ds.domain_left_edge, dims=cells[0])
    grids = Grids(
        names,
        # The centre of the first voxel lies half a cell inside the domain.
        [lattice(width / count, left + width / count / 2) for count in cells],
        lambda n, name: list(patches(n, name)) if level is None else [((0, 0, 0), of(cover, name))],
        units.get,
        "from_yt",
        ds.quan(1, "code_length").units if hasattr(ds.length_unit, "units") else None,
        (0.0, 0.0, 1.0),
    )
    return assembled(grids, field, fields, levels=level is None, skip_nonfinite=skip_nonfinite, clip_negative=clip_negative)


# --- xarray


def _even(axis: str, values: Any) -> "tuple[float, float]":
    """First coordinate and spacing of evenly spaced coordinates."""
    values = np.asarray(values)
    if values.dtype.kind not in "fiu":
        raise _vog.Error(f"from_xarray: coordinate '{axis}' of dtype {values.dtype}, expected numbers (isel selects one time)")
    values = values.astype(float)
    if not np.isfinite(values).all():
        raise _vog.Error(f"from_xarray: coordinate '{axis}' has values that are not finite, expected numbers")
    if len(values) == 1:
        return float(values[0]), 1.0
    step = float(values[-1] - values[0]) / (len(values) - 1)
    off = np.abs(values - (values[0] + step * np.arange(len(values))))
    if step == 0 or off.max() > _EVEN * abs(step):
        n = int(off.argmax())
        raise _vog.Error(
            f"from_xarray: coordinate '{axis}' is not evenly spaced: {values[n]:g} at {n} is {off[n]:g} off, expected steps of "
            f"{step:g} (interp() makes even ones, or voxel_size= sets them)"
        )
    return float(values[0]), step


def from_xarray(
    array: Any,
    dims: Optional[Sequence[str]] = None,
    *,
    voxel_size: Any = None,
    skip_nonfinite: bool = False,
    clip_negative: bool = False,
) -> _vog.Volume:
    """A DataArray of xarray as a Volume, with its coordinates and units.

    array       DataArray of three dimensions, or of more where the others have length 1
    dims        names of the dimensions along x, y and z: ('lon', 'lat', 'lev'); None: those called x or lon, y or lat, and z, else
                the last three in reverse, as image stacks and models of the atmosphere have z first
    voxel_size  in place of the coordinates' spacing: a number or (x, y, z)
    skip_nonfinite, clip_negative  as in Volume.from_numpy; missing values are NaN, and those beyond `valid_range`, `valid_min`, `valid_max`

    Coordinates are the centres of voxels and must be evenly spaced, up or down; those along two axes are left out, with a warning.
    With voxel_size they state the direction: latitudes run to the north, and pressures and depths (positive: down) downwards. The attribute `units` of the array and the common
    one of the coordinates become the units of the result; coordinates of different units need voxel_size.

    >>> import xarray
    >>> coordinates = {"z": [10.0, 20.0], "y": [2.0, 1.0, 0.0], "x": [0.0, 1.0, 2.0, 3.0]}
    >>> rain = xarray.DataArray(np.ones((2, 3, 4)), dims=("z", "y", "x"), coords=coordinates, name="rain", attrs={"units": "g/m3"})
    >>> volume = vog.from_xarray(rain)
    >>> volume.index_box, vog.units_of(volume).density
    (((0, 0, 0), (3, 2, 1)), 'g/m3')
    """
    if root_package(array) != "xarray" or not hasattr(array, "dims") or not hasattr(array, "coords") or hasattr(array, "data_vars"):
        more = ", one of the data set's variables: data['name']" if hasattr(array, "data_vars") else ""
        raise TypeError(f"from_xarray: got {described(array)}, expected a DataArray of xarray{more}")
    note_curved(array, "from_xarray", dims)
    array, dims, size, origin, length = oriented(array, dims, voxel_size)
    values = array.data if root_package(array.data) in ("pint", "astropy", "unyt") else valid(array.values, array)
    volume = _vog.Volume.from_numpy(
        values, voxel_size=size, origin=origin, name=str(array.name or "density"), skip_nonfinite=skip_nonfinite,
        clip_negative=clip_negative,
    )  # fmt: skip
    known = units_of(volume)
    density = known.density if known.density is not None else array.attrs.get("units")
    length = known.length if known.length is not None else length
    return set_units(volume, density, length) if density or length is not None else volume


def valid_limits(array: Any) -> "tuple[float, float]":
    """The least and largest valid value that the attributes of a DataArray from NetCDF state: of packed values, unless they are fractions."""
    stated = array.attrs.get("valid_range", (array.attrs.get("valid_min", -np.inf), array.attrs.get("valid_max", np.inf)))
    try:
        low, high = (float(end) for end in stated)
    except (TypeError, ValueError):
        raise _vog.Error(f"'{array.name}': valid range {described(stated)}, expected two numbers") from None
    packed = np.dtype(array.encoding.get("dtype", array.dtype)).kind in "iu"
    if packed and all(np.asarray(end).dtype.kind in "iu" or np.isinf(end) for end in stated):
        scale, offset = array.encoding.get("scale_factor", 1), array.encoding.get("add_offset", 0)
        low, high = sorted((low * scale + offset, high * scale + offset))
    return low, high


# Values of NetCDF's types where none was written and the file states no _FillValue, which xarray leaves as they are.
_UNWRITTEN = {"f4": 9.969209968386869e36, "f8": 9.969209968386869e36, "i2": -32767, "u2": 65535, "i4": -2147483647, "u4": 4294967295}


def unwritten(array: Any) -> Any:
    """The value of a DataArray from NetCDF where none was written; None where the file states it, or has none."""
    encoding = array.encoding
    if "_FillValue" in encoding or "missing_value" in encoding or ("source" not in encoding and array.dtype.kind != "f"):
        return None
    value = _UNWRITTEN.get(np.dtype(encoding.get("dtype", array.dtype)).str[1:])
    return None if value is None else value * encoding.get("scale_factor", 1) + encoding.get("add_offset", 0)


def valid(values: Any, array: Any) -> Any:
    """Values of a DataArray, NaN beyond its valid limits and where none was written."""
    ends = valid_limits(array)
    # The limits are valid, rounded as the values are.
    slack = 1e-6 * max([abs(end) for end in ends if np.isfinite(end)], default=0.0)
    beyond = (values < ends[0] - slack) | (values > ends[1] + slack)
    fill = unwritten(array)
    if fill is not None:
        beyond |= np.isclose(values, fill, rtol=1e-6, atol=0)
    return np.where(beyond, np.nan, values) if beyond.any() else values


# Names of dimensions along x and y, and of those that are no places.
_X, _Y = ("x", "lon", "longitude"), ("y", "lat", "latitude")
_NO_PLACES = ("t", "time", "valid_time", "step", "member", "ensemble", "number", "realization", "run", "c", "channel", "band")
def unit_of(coordinate: Any) -> str:
    """Unit of a coordinate, whose metres have one name."""
    unit = str(coordinate.attrs.get("units", ""))
    return "m" if unit.lower() in ("metre", "metres", "meter", "meters") else unit


# Units of coordinates that shrink upwards.
_PRESSURES = ("Pa", "hPa", "kPa", "mbar", "mb", "millibar", "millibars", "bar", "dbar")


def axes_of(array: Any) -> "Sequence[Any]":
    """Dimensions of a DataArray along x, y and z: by their names, else the last three of places in reverse."""
    if all(axis in array.dims for axis in "xyz"):
        return ("x", "y", "z")
    real = [name for name in array.dims if array.sizes[name] > 1 or name in ("x", "y", "z")]
    places = [name for name in real if str(name).lower() not in _NO_PLACES and (name not in array.coords or array.coords[name].dtype.kind in "fiu")]
    real = next((names for names in (places, real) if len(names) >= 3), list(array.dims))
    x, y = (next((name for name in real if str(name).lower() in names), None) for names in (_X, _Y))
    rest = [name for name in real if name not in (x, y)]
    return tuple(reversed(real[-3:])) if x is None or y is None or not rest else (x, y, next((name for name in rest if name == "z"), rest[-1]))


def note_curved(array: Any, source: str, dims: Optional[Sequence[str]] = None) -> None:
    """A warning for coordinates along two axes and more, such as lat(y, x), which are left out."""
    bare = {name for name in dims or axes_of(array) if name not in array.coords}
    curved = [str(name) for name, values in array.coords.items() if values.ndim > 1 and bare & set(values.dims)]
    if curved:
        warnings.warn(
            f"{source}: coordinates along several axes are left out: {', '.join(curved)}; positions are indices "
            "(a pyvista.StructuredGrid of them, saved as .vts, is read as cells)", stacklevel=4
        )  # fmt: skip


def _direction(name: Any, coordinate: Any, voxel_size: Any) -> "tuple[float, float]":
    """First place and step along an axis; with voxel_size the step is 1 upwards or -1."""
    values = coordinate.values
    if voxel_size is None:
        return _even(name, values)
    falls = bool(values.dtype.kind in "fiu" and len(values) > 1 and values[-1] < values[0])
    down = coordinate.attrs.get("positive") == "down" or coordinate.attrs.get("units") in _PRESSURES
    return 0.0, -1.0 if len(values) > 1 and falls != down else 1.0


def oriented(array: Any, dims: Optional[Sequence[str]], voxel_size: Any) -> "tuple[Any, Any, Any, Any, Optional[str]]":
    """A DataArray along x, y and z, upwards; its dimensions, edges of a voxel, first centre, and unit of length."""
    lengths = dict(zip(array.dims, array.shape))
    dims = axes_of(array) if dims is None else dims
    if len(dims) != 3 or len(set(dims)) != 3 or any(name not in lengths for name in dims):
        raise _vog.Error(f"from_xarray: dims {tuple(dims)}, expected three of {tuple(array.dims)}")
    for name in array.dims:
        if name not in dims:
            if lengths[name] != 1:
                raise _vog.Error(f"from_xarray: dimension '{name}' of length {lengths[name]} beside {tuple(dims)}, expected isel({name}=0), say")
            array = array.isel({name: 0})
    array = array.transpose(*dims)
    first, edge, units = [], [], []
    for name in dims:
        has = name in array.coords
        start, step = _direction(name, array.coords[name], voxel_size) if has else (0.0, 1.0)
        if step < 0:
            array = array.isel({name: slice(None, None, -1)})
            start, step = start + step * (lengths[name] - 1), -step
        first.append(start)
        edge.append(step)
        units.append(unit_of(array.coords[name]) if has else "")
    if voxel_size is not None:
        return array, dims, voxel_size, None, None
    if len(set(units)) > 1:
        listed = ", ".join(f"{name} [{unit}]" for name, unit in zip(dims, units))
        raise _vog.Error(f"from_xarray: coordinates of different units: {listed}, expected one unit of length, or voxel_size=")
    return array, dims, edge, first, units[0] or None


# --- nibabel


def _affine(image: Any) -> Any:
    """Affine of an image of nibabel, or its qform where the sform is singular, as from_nifti of a path has it."""
    matrix = np.asarray(image.affine, float)
    if np.isfinite(matrix).all() and np.linalg.det(matrix[:3, :3]) != 0:
        return matrix
    qform = getattr(image.header, "get_qform", lambda coded: (None, 0))(coded=True)[0]
    if qform is None:
        raise _vog.Error("from_nifti: an affine that is singular and no qform, expected one of them to place the voxels")
    return qform


def from_nifti(
    image: Any,
    *,
    frame: int = 0,
    skip_nonfinite: bool = False,
    clip_negative: bool = False,
) -> _vog.Volume:
    """A NIfTI image as a Volume in RAS coordinates (x to the right, y to the front, z up).

    image   path of a .nii or .nii.gz file, read without nibabel; or an image of nibabel.load
    frame   of an image of several frames: which one
    skip_nonfinite, clip_negative  as in Volume.from_numpy; Hounsfield units are negative

    The unit of length of the header becomes the result's.

    >>> import nibabel
    >>> image = nibabel.Nifti1Image(np.ones((4, 5, 6), np.float32), np.diag([2, 2, 3, 1]))
    >>> volume = vog.from_nifti(image)
    >>> volume.index_box[1], volume.voxel_volume
    ((3, 4, 5), 12.0)
    """
    rules: "dict[str, Any]" = {"skip_nonfinite": skip_nonfinite, "clip_negative": clip_negative}
    if _is_path(image):
        names = _vog.grid_names(image)
        if isinstance(frame, bool) or not 0 <= frame < len(names):
            raise _vog.Error(f"from_nifti: {os.fspath(image)}: frame {described(frame)}, expected 0 to {len(names) - 1}")
        return _vog.Volume.load(image, grid=names[frame], **rules)
    if not (hasattr(image, "affine") and hasattr(image, "dataobj")):
        raise TypeError(f"from_nifti: got {described(image)}, expected a path or an image of nibabel.load")
    shape = image.shape
    frames = int(np.prod(shape[3:])) if len(shape) > 3 else 1
    if len(shape) < 3 or isinstance(frame, bool) or not 0 <= frame < frames:
        raise _vog.Error(f"from_nifti: image of shape {shape}, frame {described(frame)}, expected (X, Y, Z) or a frame of more")
    data = image.dataobj
    if getattr(data, "offset", None) == 0 and bytes(image.header.get("magic", b"") if hasattr(image.header, "get") else b"")[:2] == b"n+":
        raise _vog.Error("from_nifti: vox_offset 0, by which nibabel reads the head as values, expected the path of the file in place of the image")
    values = np.asanyarray(data[(..., *np.unravel_index(frame, shape[3:]))] if len(shape) > 3 else data)
    volume = _vog.Volume.from_numpy(values, matrix=_affine(image), name="value", **rules)
    to_units = getattr(image.header, "get_xyzt_units", None)
    length = {"meter": "m", "mm": "mm", "micron": "um"}.get(to_units()[0]) if to_units else None
    return set_units(volume, None, length)


# --- tifffile


def _tiff_head(image: Any) -> Any:
    """Edges of a voxel, the first one's place and the units of a TiffFile, from its file, or from a copy of one in memory."""
    handle = image.filehandle
    try:
        if os.path.isfile(handle.path):
            return _head_of_first(handle.path)
        with tempfile.NamedTemporaryFile(suffix=".tif") as copy:
            handle.seek(0)
            copy.write(handle.read())
            copy.flush()
            return _head_of_first(copy.name)
    except _vog.Error as error:
        raise _vog.Error(f"from_tiff: {error} (voxel_size= gives the edges of a voxel)") from None


def _head_of_first(path: Any) -> Any:
    return _vog._volume_head(path, _vog.grid_names(path)[0])


def from_tiff(
    image: Any,
    *,
    voxel_size: Any = None,
    frame: int = 0,
    channel: int = 0,
    skip_nonfinite: bool = False,
    clip_negative: bool = False,
) -> _vog.Volume:
    """A TIFF stack as a Volume: x along rows, y down, z from page to page.

    image       path of a file or a folder of slices, or a pattern 's*.tif', read without tifffile; or a tifffile.TiffFile
    voxel_size  edge of a voxel: a number, (x, y, z) or Quantities; None: ImageJ's or OME's, else of the resolution tags, else 1
    frame, channel  of a stack with several times or channels
    skip_nonfinite, clip_negative  as in Volume.from_numpy

    >>> import tifffile
    >>> tifffile.imwrite("stack.tif", np.ones((4, 5, 6), np.uint8), photometric="minisblack")
    >>> vog.from_tiff("stack.tif", voxel_size=0.5).index_box[1]
    (5, 4, 3)
    """
    rules: "dict[str, Any]" = {"skip_nonfinite": skip_nonfinite, "clip_negative": clip_negative}
    if _is_path(image):
        names = _vog.grid_names(image)
        # Images are called t1c0 with several times and channels, t1 or c0 with several of one, or have a colour's name.
        named = [f"t{frame}c{channel}"] + [f"t{frame}"] * (channel == 0) + [f"c{channel}"] * (frame == 0)
        if frame == 0 and not names[0].startswith("t") and isinstance(channel, int) and 0 <= channel < len(names):
            named.append(names[channel])
        found = [name for name in named if name in names]
        if not found or isinstance(frame, bool) or isinstance(channel, bool):
            raise _vog.Error(f"from_tiff: {os.fspath(image)}: frame {described(frame)}, channel {described(channel)}, expected one of {', '.join(names)}")
        volume = _vog.Volume.load(image, grid=found[0], **rules)
        if voxel_size is None:
            return volume
        lower, upper = volume.index_box
        made: _vog.Volume = _vog.Volume.from_numpy(
            volume.to_numpy(), voxel_size=voxel_size, first=lower, name=volume.name, **rules
        )
        return made
    if not (hasattr(image, "pages") and hasattr(image, "series") and hasattr(image, "asarray")):
        raise TypeError(f"from_tiff: got {described(image)}, expected a path or a tifffile.TiffFile")
    series = image.series[0]
    stack, axes = series.asarray(), series.axes
    wanted = {"T": frame, "C": channel, "S": channel}
    for name in [axis for axis in axes if axis not in "YX"]:
        at = axes.index(name)
        # One axis of pages is z: Z, I (a series of pages) or Q (unknown to tifffile).
        if name in ("Z", "I", "Q") and sum(axis in "ZIQ" for axis in axes) == 1:
            continue
        index = wanted.get(name, 0)
        if isinstance(index, bool) or not 0 <= index < stack.shape[at] or (name not in wanted and stack.shape[at] > 1):
            raise _vog.Error(f"from_tiff: axes {axes} of shape {stack.shape}, no {described(index)} along {name}, expected ZYX, frame or channel")
        stack, axes = np.take(stack, index, axis=at), axes[:at] + axes[at + 1 :]
    if stack.ndim == 2:
        stack = stack[None]
    if stack.ndim != 3 or not axes.endswith("YX"):
        raise _vog.Error(f"from_tiff: axes {axes} of shape {stack.shape}, expected ZYX")
    # ImageJ's calibration: a polynomial of degree 1 to 4 (docs/scans.md).
    fiji = getattr(image, "imagej_metadata", None) or {}
    terms = [fiji[f"c{n}"] for n in range(int(fiji.get("cf", -2)) + 2) if f"c{n}" in fiji]
    if terms and fiji["cf"] < 4:
        stack = np.polynomial.polynomial.polyval(stack.astype(float), terms)
    size, origin, unit, _ = (voxel_size, None, None, None) if voxel_size is not None else _tiff_head(image)
    volume = _vog.Volume.from_numpy(stack.T, voxel_size=size, origin=origin, name="value", **rules)
    return set_units(volume, None, unit) if unit else volume
