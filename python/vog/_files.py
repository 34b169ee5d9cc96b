"""Arrays in files of other programs: NumPy, HDF5, NetCDF, GRIB, Zarr, OME-Zarr, DICOM and openPMD."""
import contextlib
import os
import warnings
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _vog
from ._grids import Grids, lattice, lead_of, listed, one_grid
from ._netcdf import classic_bytes
from ._packages import need
from ._readers import _EVEN, axes_of, note_curved, oriented, unit_of, unwritten, valid, valid_limits

# Most voxels of the level of a pyramid that is read where none is named.
_MOST_VOXELS = 2**27
# Bytes of an array that are in memory at a time, at least, where it is read in parts.
_PART_BYTES = 2**24

At = Mapping[str, int]


def chosen(path: str, axis: str, length: int, at: At) -> int:
    """Index along an axis beside x, y and z: of `at`, else the first, with a warning where there are more."""
    index = at.get(axis, 0)
    if not -length <= index < length:
        raise _vog.Error(f"{path}: {axis} {index}, expected 0 to {length - 1}")
    if axis not in at and length > 1:
        warnings.warn(f"{path}: {axis} 0 of {length}; at={{{axis!r}: N}} takes another", stacklevel=4)
    return index


def beside(path: str, axes: "Mapping[str, int]", at: At) -> "Dict[str, int]":
    """Index along each of the axes beside x, y and z, {name: length}; raises vog.Error for others in `at`."""
    for axis in at:
        if axis not in axes:
            raise _vog.Error(f"{path}: at: no axis {axis!r} beside x, y and z, expected {listed(list(axes)) or 'none, as the file has none'}")
    return {axis: chosen(path, axis, length, at) for axis, length in axes.items()}


def is_volume(array: Any) -> bool:
    return array.dtype.kind in "fiub" and (array.ndim == 3 or (array.ndim == 4 and array.shape[3] == 3))


def read_numpy(path: str, voxel_size: Any) -> Grids:
    """Arrays [X, Y, Z] or [X, Y, Z, 3] of a .npy or .npz."""
    try:
        loaded = np.load(path, mmap_mode="r")
    except (ValueError, EOFError) as error:
        raise _vog.Error(f"{path}: not an array of numbers: {str(error).split('. ')[0]}") from None
    arrays = {"density": loaded} if isinstance(loaded, np.ndarray) else {}
    for name in getattr(loaded, "files", ()):
        try:
            arrays[name] = loaded[name]
        except ValueError:  # objects of Python
            arrays[name] = np.empty(0, object)
    shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
    arrays = {name: array for name, array in arrays.items() if is_volume(array)}
    if not arrays:
        raise _vog.Error(f"{path}: {shapes or 'no arrays'}, expected an array of numbers [X, Y, Z]")
    return one_grid(path, lattice(1 if voxel_size is None else voxel_size, 0), arrays, {})


def _text(value: Any) -> Any:
    """Text of an attribute that may be bytes, or an array of one text."""
    first: Any = value if isinstance(value, str) else next(iter(np.ravel(value)), "")
    return first.decode("utf-8", "replace") if isinstance(first, bytes) else first


def read_hdf5(path: str, wanted: str, at: At, voxel_size: Any) -> Any:
    """Arrays of three axes in HDF5, by their paths in the file; particles of a snapshot; data sets that yt knows."""
    h5py = need("h5py", f"load: {path}")
    file = h5py.File(path)
    if "openPMD" in file.attrs:
        return read_openpmd(path, wanted, at)
    beside(path, {}, at)
    if any(name.startswith("PartType") for name in file):
        return _vog.Points.load(path)
    arrays: "Dict[str, Any]" = {}
    file.visititems(lambda name, item: arrays.update({name: item}) if isinstance(item, h5py.Dataset) and is_volume(item) else None)
    if not arrays:
        raise _vog.Error(f"{path}: no array of three axes, expected one (or a data set of a simulation: vog.from_yt(yt.load(...)))")
    units = {name: _text(item.attrs.get("units", "")) for name, item in arrays.items()}
    return one_grid(path, lattice(1 if voxel_size is None else voxel_size, 0), arrays, units)


def _sizes(shape: "Tuple[int, ...]") -> str:
    return " x ".join(map(str, shape))


def read_xarray(path: str, wanted: str, at: At, voxel_size: Any) -> Grids:
    """Variables of three dimensions and more of NetCDF, GRIB or Zarr, along x, y and z."""
    xarray = need("xarray", f"load: {path}")
    if "://" not in path and os.path.isfile(path):
        size, whole = os.path.getsize(path), classic_bytes(path)
        if size < whole:
            raise _vog.Error(f"{path}: truncated: {size:,} bytes, expected {whole:,} by the head of NetCDF")
    try:
        data = xarray.open_zarr(path) if os.path.isdir(path) or "://" in path else xarray.open_dataset(path)
    except ImportError as error:
        raise ImportError(f"load: {path}: {str(error).splitlines()[0]}", name=error.name) from None
    except Exception as error:  # each engine has exceptions of its own
        if type(error).__name__ == "ContainsArrayError":
            raise _vog.Error(f"{path}: an array of Zarr without names of axes; vog.Volume.from_numpy(zarr.open({path!r})[:]) takes it") from None
        text = str(error).splitlines()[0].split(". ")[0] if str(error) else type(error).__name__
        raise _vog.Error(f"{path}: xarray cannot read it: {text} (NetCDF needs netcdf4 or h5netcdf, GRIB cfgrib, Zarr zarr)") from None
    variables = {str(name): array for name, array in data.data_vars.items()}
    if not variables:  # those of groups, by their paths
        with contextlib.suppress(Exception):
            groups = xarray.open_groups(path, engine="zarr" if os.path.isdir(path) else None)
            variables = {f"{group.strip('/')}/{name}": array for group, inner in groups.items() for name, array in inner.data_vars.items()}
    arrays = {name: array for name, array in variables.items() if array.dtype.kind in "fiub" and sum(length > 1 for length in array.shape) >= 3}
    if wanted in variables and variables[wanted].dtype.kind not in "fiub":
        raise _vog.Error(f"{path}: '{wanted}' holds no numbers but {variables[wanted].dtype}; {listed(list(arrays)) or 'no other variable'} holds some in three dimensions")
    if not arrays:
        shapes = ", ".join(f"{name} {array.shape}" + ("" if array.dtype.kind in "fiub" else " of no numbers") for name, array in variables.items())
        older = "" if hasattr(xarray, "open_groups") else " (those in groups need a newer xarray: pip install -U xarray)"
        raise _vog.Error(f"{path}: {shapes or 'no variables' + older}, expected a variable of three dimensions")
    lead = arrays[lead_of(list(arrays), wanted, path)[0]]
    others: "Callable[[Any], Dict[Any, int]]" = lambda array: {axis: array.sizes[axis] for axis in array.dims if axis not in axes_of(array)}
    beside(path, {axis: 1 for array in arrays.values() for axis in others(array)}, dict.fromkeys(at, 0))
    fixed = beside(path, others(lead), {axis: index for axis, index in at.items() if axis in others(lead)})

    def one(array: Any) -> Any:
        """The part along x, y and z; further axes than those of the first array are fixed, too."""
        new = {axis: length for axis, length in others(array).items() if axis not in fixed}
        fixed.update(beside(path, new, {axis: index for axis, index in at.items() if axis in new}))
        return array.isel({axis: fixed[axis] for axis in others(array)})

    note_curved(one(lead), path)
    units = {unit_of(lead.coords[axis]) for axis in axes_of(lead) if axis in lead.coords}
    if voxel_size is None and len(units) > 1:
        warnings.warn(f"{path}: coordinates of several units ({', '.join(sorted(units))}): voxels are cubes of 1; voxel_size= gives others", stacklevel=3)
        voxel_size = 1

    def placed(array: Any) -> "Tuple[Any, Any, Any, Any]":
        array, dims, size, origin, length = oriented(one(array), None, voxel_size)
        return array, dims, lattice(size, 0 if origin is None else origin), length

    first, _, matrix, length = placed(lead)
    shape = first.shape

    def slabs(name: str) -> Any:
        source = one(arrays[name])
        array, dims, own, _ = placed(arrays[name])
        if np.abs(np.linalg.solve(matrix, own) - np.eye(4)).max() > _EVEN:  # in voxels
            raise _vog.Error(f"{path}: '{name}' has other coordinates than '{lead.name}'; interp_like() of xarray brings it to the same")
        if array.shape != shape:
            raise _vog.Error(f"{path}: '{name}' has {_sizes(array.shape)} voxels, '{lead.name}' {_sizes(shape)}; isel() or interp_like() of xarray brings it to the same")
        turned = [dim in array.coords and array.coords[dim].values[0] != source.coords[dim].values[0] for dim in dims]
        rows = max(1, int(arrays[name].encoding.get("preferred_chunks", {}).get(dims[2], 1)))
        depth = rows * max(1, _PART_BYTES // (array.dtype.itemsize * array.shape[0] * array.shape[1] * rows))

        def part(first: int) -> Any:
            last = min(first + depth, array.shape[2])
            along = slice(array.shape[2] - last, array.shape[2] - first) if turned[2] else slice(first, last)
            # Loaded before it is turned: xarray turns what is not by an index of each value.
            loaded = source.isel({dims[2]: along}).load().transpose(..., *dims)
            values = valid(loaded.values, loaded)
            return values.reshape(values.shape[-3:])[tuple(slice(None, None, -1 if back else 1) for back in turned)]

        limited = np.isfinite(valid_limits(array)).any() or unwritten(array) is not None  # values beyond are NaN
        return array.shape, np.result_type(array.dtype, np.float32) if limited else array.dtype, map(part, range(0, array.shape[2], depth))

    def blocks(_: int, name: str) -> Any:
        return [((0, 0, 0), np.concatenate(list(slabs(name)[2]), 2))]

    return Grids(list(arrays), [matrix], blocks, lambda name: arrays[name].attrs.get("units"), path, length, slabs=slabs)


# --- images


def read_ome_zarr(path: str, level: Optional[int], at: At) -> Grids:
    """Channels of an OME-Zarr image, of the finest level of its pyramid that fits, or the one that is named."""
    group = need("zarr", f"load: {path}").open_group(path, mode="r")
    stated = dict(group.attrs)
    image = stated.get("ome", stated)["multiscales"][0]
    axes: "List[Dict[str, Any]]" = [{"name": axis} if isinstance(axis, str) else axis for axis in image.get("axes", ["t", "c", "z", "y", "x"])]
    names = [axis["name"] for axis in axes]
    if names[-3:] != ["z", "y", "x"]:
        raise _vog.Error(f"{path}: axes {', '.join(names)}, expected z, y and x at the end")
    levels = [group[entry["path"]] for entry in image["datasets"]]
    sizes = [int(np.prod(array.shape[-3:])) for array in levels]
    if level is None:
        level = next((n for n, size in enumerate(sizes) if size <= _MOST_VOXELS), len(levels) - 1)
        if level > 0:
            warnings.warn(f"{path}: level {level} of {len(levels)}, with {sizes[level]:,} voxels; level=0 takes {sizes[0]:,}", stacklevel=3)
    if isinstance(level, bool) or not 0 <= level < len(levels):
        raise _vog.Error(f"{path}: level {level}, expected 0 to {len(levels) - 1}")
    array = levels[level]
    if array.ndim != len(names):
        raise _vog.Error(f"{path}: axes {', '.join(names)} of an array with {array.ndim} axes; its metadata must name each")
    scale, place = np.ones(len(axes)), np.zeros(len(axes))
    for step in (*image["datasets"][level].get("coordinateTransformations", ()), *image.get("coordinateTransformations", ())):
        factor = np.asarray(step.get("scale", 1.0), float)
        scale, place = scale * factor, place * factor + np.asarray(step.get("translation", 0.0), float)
    for axis, edge in zip(names[-3:], scale[-3:]):
        if not (edge > 0 and np.isfinite(edge)):
            raise _vog.Error(f"{path}: the scale of axis {axis} is {edge:g} in coordinateTransformations, expected a size above 0")
    fixed = beside(path, {axis: array.shape[n] for n, axis in enumerate(names[:-3]) if axis != "c"}, at)
    channels = array.shape[names.index("c")] if "c" in names else 1
    labels = [str(one.get("label", f"c{n}")) for n, one in enumerate(stated.get("ome", stated).get("omero", {}).get("channels", []))]
    if len(labels) != channels or len(set(labels)) != channels:
        labels = [f"c{n}" for n in range(channels)]

    def blocks(_: int, name: str) -> Any:
        return [((0, 0, 0), np.concatenate(list(slabs(name)[2]), 2))]

    def slabs(name: str) -> Any:
        index = tuple(labels.index(name) if axis == "c" else fixed[axis] for axis in names[:-3])
        depth = (getattr(array, "shards", None) or array.chunks)[-3]
        parts = (np.asarray(array[(*index, slice(z, z + depth))]).T for z in range(0, array.shape[-3], depth))
        return array.shape[:-4:-1], array.dtype, parts

    lengths = [str(axis.get("unit", "")) for axis in axes[:-4:-1]]
    factors = np.ones(3)
    if len(set(lengths)) > 1:
        if not all(unit in _OME_UNITS for unit in lengths):
            words = ", ".join(f"{axis} {unit or 'without one'}" for axis, unit in zip("xyz", lengths))
            raise _vog.Error(f"{path}: axes in several units of length ({words}), expected the same or known ones: {', '.join(_OME_UNITS)}")
        factors = np.array([_OME_UNITS[unit][1] for unit in lengths]) / _OME_UNITS[lengths[0]][1]
    matrix = lattice(scale[:-4:-1] * factors, place[:-4:-1] * factors)
    length = _OME_UNITS.get(lengths[0], (lengths[0], 1.0))[0]
    return Grids(labels, [matrix], blocks, lambda _: None, path, length or None, scan=True, slabs=slabs)


# Units of length of OME-Zarr by their names: what vog calls them, and their metres.
_OME_UNITS = {"angstrom": ("angstrom", 1e-10), "nanometer": ("nm", 1e-9), "micrometer": ("um", 1e-6), "millimeter": ("mm", 1e-3), "centimeter": ("cm", 1e-2), "meter": ("m", 1.0)}


def _dicom_slices(path: str) -> "List[Any]":
    """Heads of the slices of one series: that of a file, or the longest one of a folder."""
    pydicom = need("pydicom", f"load: {path}")
    folder = path if os.path.isdir(path) else os.path.dirname(path) or "."
    series: "Dict[str, List[Any]]" = {}
    for name in sorted(os.listdir(folder)):
        try:
            head = pydicom.dcmread(os.path.join(folder, name), stop_before_pixels=True)
        except (pydicom.errors.InvalidDicomError, IsADirectoryError):
            continue
        if "ImagePositionPatient" in head:
            series.setdefault(str(head.get("SeriesInstanceUID")), []).append(head)
    if not series:
        raise _vog.Error(f"{path}: no slices of DICOM with a position, expected a series (dcm2niix makes a .nii of other kinds)")
    chosen_uid = max(series, key=lambda uid: len(series[uid]))
    if not os.path.isdir(path):
        own = str(pydicom.dcmread(path, stop_before_pixels=True).get("SeriesInstanceUID"))
        chosen_uid = own if own in series else chosen_uid
    if len(series) > 1:
        warnings.warn(f"{path}: one of {len(series)} series, with {len(series[chosen_uid])} slices; a slice's name takes another", stacklevel=4)
    return series[chosen_uid]


def _same_kind(path: str, slices: "List[Any]") -> None:
    """Raises vog.Error for a slice that is none of grey values, or lies otherwise than the first."""
    first = slices[0]
    for one in slices:
        lacks = [name for name in ("ImageOrientationPatient", "PixelSpacing", "Rows", "Columns") if not one.get(name)]
        wrong = f"no {lacks[0]}" if lacks else ""
        if int(one.get("NumberOfFrames") or 1) > 1:
            wrong = f"{one.NumberOfFrames} frames in one file"
        elif int(one.get("SamplesPerPixel") or 1) > 1:
            wrong = f"colours ({one.get('PhotometricInterpretation')})"
        elif not lacks and (one.Rows, one.Columns) != (first.Rows, first.Columns):
            wrong = f"{one.Columns} x {one.Rows} pixels, {first.Columns} x {first.Rows} in {os.path.basename(first.filename)}"
        elif not lacks and not all(np.allclose(np.array(one[name].value, float), np.array(first[name].value, float), atol=1e-3)
                                for name in ("ImageOrientationPatient", "PixelSpacing")):
            wrong = f"turned or scaled otherwise than {os.path.basename(first.filename)}"
        if wrong:
            raise _vog.Error(f"{one.filename}: {wrong}, expected slices of grey values of one size (dcm2niix makes .nii files of other series)")
    if first.get("PhotometricInterpretation") == "MONOCHROME1":
        warnings.warn(f"{path}: MONOCHROME1, whose high values are meant to be dark: values are as stored", stacklevel=5)


def read_dicom(path: str) -> Grids:
    """A series of slices, in RAS coordinates as of NIfTI, in mm; of computed tomography in Hounsfield units."""
    dcmread = need("pydicom", f"load: {path}").dcmread
    slices = _dicom_slices(path)
    _same_kind(path, slices)
    head = slices[0]
    row, column = np.reshape([float(x) for x in head.ImageOrientationPatient], (2, 3))
    along = np.cross(row, column)
    places = np.array([[float(x) for x in one.ImagePositionPatient] for one in slices])
    order = np.argsort(places @ along)
    slices, places = [slices[n] for n in order], places[order]
    steps = np.diff(places @ along)
    if len(steps) and (steps.min() <= 0 or np.ptp(steps) > 0.01 * steps.mean()):
        raise _vog.Error(f"{path}: slices {steps.min():g} to {steps.max():g} mm apart, expected even steps above 0 (dcm2niix makes even ones)")
    step = (places[-1] - places[0]) / len(steps) if len(steps) else along * float(head.get("SpacingBetweenSlices") or head.get("SliceThickness") or 1)
    down, right = (float(x) for x in head.PixelSpacing)
    matrix = np.eye(4)
    matrix[:3] = np.stack([row * right, column * down, step, places[0]], -1)

    def blocks(_: int, name: str) -> Any:
        pixels = []
        for one in slices:
            whole = dcmread(one.filename)
            try:
                stored = whole.pixel_array
            except Exception as error:  # each decoder has exceptions of its own
                raise _vog.Error(f"{one.filename}: pydicom cannot read its pixels: {str(error).splitlines()[0]} (dcm2niix may)") from None
            pixels.append(stored * np.float32(whole.get("RescaleSlope", 1)) + np.float32(whole.get("RescaleIntercept", 0)))
        return [((0, 0, 0), np.stack(pixels).astype(np.float32).T)]

    unit = "HU" if head.get("Modality") == "CT" else None
    # DICOM's axes are to the left and to the back.
    return Grids(["value"], [np.diag([-1.0, -1, 1, 1]) @ matrix], blocks, lambda _: unit, path, "mm", scan=True)


# --- particles and meshes


def read_openpmd(path: str, wanted: str, at: At) -> Grids:
    """Meshes of one iteration of openPMD along x, y and z: E_x or rho."""
    io = need("openpmd_api", f"load: {path}")
    series = io.Series(path, io.Access.read_only)
    steps = sorted(series.iterations)
    iteration = series.iterations[steps[beside(path, {"iteration": len(steps)}, at)["iteration"]]]
    parts = {(name if part == io.Mesh_Record_Component.SCALAR else f"{name}_{part}"): (mesh, mesh[part])
             for name, mesh in iteration.meshes.items() for part in mesh if sorted(mesh.axis_labels) == ["x", "y", "z"]}  # fmt: skip
    if not parts:
        axes = ", ".join(f"{name} along {', '.join(mesh.axis_labels)}" for name, mesh in iteration.meshes.items())
        raise _vog.Error(f"{path}: {axes or 'no meshes'}, expected a mesh along x, y and z")
    order: "Callable[[str], List[int]]" = lambda name: [list(parts[name][0].axis_labels).index(axis) for axis in "xyz"]

    def placed(name: str) -> Any:
        mesh, part = parts[name]
        spacing, offset = (np.asarray(values, float)[order(name)] * mesh.grid_unit_SI for values in (mesh.grid_spacing, mesh.grid_global_offset))
        return lattice(spacing, offset + np.asarray(part.position, float)[order(name)] * spacing)

    lead = lead_of(list(parts), wanted, path)[0]
    matrix, shape = placed(lead), [parts[lead][1].shape[n] for n in order(lead)]

    def blocks(_: int, name: str) -> Any:
        off = np.linalg.solve(matrix, placed(name)) - np.eye(4)  # in voxels
        if [parts[name][1].shape[n] for n in order(name)] != shape or np.abs(off[:, :3]).max() > 1e-6 or np.abs(off[:, 3]).max() >= 1 - 1e-6:
            raise _vog.Error(f"{path}: '{name}' has another lattice than '{lead}', expected arrays of one lattice")
        if np.abs(off[:, 3]).max() > 1e-6:
            shift = ", ".join(f"{x:.3g}" for x in off[:3, 3])
            warnings.warn(f"{path}: '{name}' is staggered, by {shift} voxels from '{lead}', at whose places its values are used", stacklevel=5)
        values = parts[name][1].load_chunk()
        series.flush()
        return [((0, 0, 0), np.transpose(values, order(name)) * parts[name][1].unit_SI)]

    return Grids(list(parts), [matrix], blocks, lambda _: None, path, "m")


def read_yt(path: str) -> Any:
    """Data set of yt."""
    yt = need("yt", f"load: {path}")
    yt.set_log_level("error")
    yt.config.ytcfg["yt", "suppress_stream_logging"] = True  # no bars of progress
    return yt.load(path)
