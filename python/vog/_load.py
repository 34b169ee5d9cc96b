"""Any file that vog or a package of this Python reads, by its extension and its contents."""
import contextlib
import fnmatch
import inspect
import os
import re
from typing import Any, Callable, Iterator, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _vog
from ._files import At, read_dicom, read_hdf5, read_numpy, read_ome_zarr, read_openpmd, read_xarray, read_yt
from ._grids import Grids, assembled, by_name, listed
from ._packages import described, need
from ._readers import from_yt
from ._vtk_files import read_vtk

_MODELS = (".ply", ".vogz", ".spz", ".glb", ".usda", ".usdc", ".usd")
_PARTICLES = (".xyz", ".extxyz", ".pts", ".asc", ".csv", ".ecsv", ".tsv", ".dat", ".txt")


class Kind(NamedTuple):
    """A kind of files: what it is in words, its extensions, and the function that reads it."""

    what: str
    extensions: "Tuple[str, ...]"
    read: "Callable[..., Any]"


YT = Kind("a data set of a simulation", (".athdf", ".art"), read_yt)
OME = Kind("an image in OME-Zarr", (), read_ome_zarr)
DICOM = Kind("a series of DICOM", (".dcm", ".ima"), read_dicom)
_OPENPMD = Kind("openPMD", (".bp", ".bp4", ".bp5"), read_openpmd)  # files or folders
_ZARR = Kind("a store of Zarr", (".zarr",), read_xarray)
_KINDS = [
    Kind("NumPy arrays", (".npy", ".npz"), read_numpy),
    Kind("arrays in HDF5", (".h5", ".hdf5", ".hdf", ".he5"), read_hdf5),
    Kind("NetCDF or GRIB", (".nc", ".nc4", ".cdf", ".grib", ".grb", ".grib2", ".grb2"), read_xarray),
    Kind("data of VTK", (".vtk", ".vti", ".vtr", ".vts", ".vtu", ".vtp", ".vtm", ".vtmb", ".vtpc", ".vtpd", ".pvti", ".pvtr", ".pvts", ".pvtu", ".pvd", ".exo", ".e", ".ex2",
         ".case", ".foam", ".cgns"), read_vtk),
    YT, DICOM, _ZARR, _OPENPMD,
]  # fmt: skip


@contextlib.contextmanager
def reading(path: str) -> "Iterator[None]":
    """Context in which exceptions of other packages become a vog.Error that names the file."""
    try:
        yield
    except (_vog.Error, ImportError, MemoryError, TypeError):
        raise
    except Exception as error:
        text = str(error).splitlines()[0] if str(error) else ""
        kind = "" if text and not isinstance(error, LookupError) else type(error).__name__
        raise _vog.Error(f"{path}: cannot be read: {kind}{': ' if kind and text else ''}{text}") from error


def _begins_with(path: str, at: int, magic: bytes) -> bool:
    with open(path, "rb") as file:
        file.seek(at)
        return file.read(len(magic)) == magic


def _remote(path: str) -> "Tuple[Kind, str]":
    """Kind of a store of Zarr at an address, by fsspec."""
    fsspec = need("fsspec", f"load: {path}")
    try:
        system, place = fsspec.core.url_to_fs(path)
        for head in (".zattrs", "zarr.json", ".zmetadata", ".zgroup"):
            with contextlib.suppress(FileNotFoundError):
                return (OME if b'"multiscales"' in system.cat_file(f"{place.rstrip('/')}/{head}") else _ZARR), path
    except ImportError as error:
        raise ImportError(f"load: {path}: {str(error).splitlines()[0]}", name=error.name) from None
    except Exception as error:  # each protocol has exceptions of its own
        raise _vog.Error(f"{path}: cannot be read: {str(error).splitlines()[0] if str(error) else type(error).__name__}") from None
    raise _vog.Error(f"{path}: no store of Zarr there, expected one (download other files first)")


def kind_of(path: str) -> "Optional[Tuple[Kind, str]]":
    """Kind of a file or folder that vog itself does not read, and the path for its reader; None: another."""
    if "://" in path:
        return _remote(path)
    has = lambda *parts: os.path.exists(os.path.join(path, *parts))
    if os.path.isdir(path):
        names = sorted(os.listdir(path))
        for head in (".zattrs", "zarr.json"):
            if has(head):
                with open(os.path.join(path, head), encoding="utf-8", errors="replace") as file:
                    return (OME if '"multiscales"' in file.read() else _ZARR), path
        if os.path.splitext(path.rstrip("/"))[1].lower() in _OPENPMD.extensions:
            return _OPENPMD, path
        if any(has(name) for name in (".zgroup", ".zmetadata")) or path.rstrip("/").endswith(".zarr"):
            return _ZARR, path
        enzo = [name[: -len(".hierarchy")] for name in names if name.endswith(".hierarchy")]
        ramses = [name for name in names if name.startswith("info_") and name.endswith(".txt")]
        if enzo or ramses or (has("Header") and has("Level_0")):
            return YT, os.path.join(path, (enzo or ramses or [""])[0])
        files = [os.path.join(path, name) for name in names if os.path.isfile(os.path.join(path, name))]
        return (DICOM, path) if any(_begins_with(file, 128, b"DICM") for file in files[:8]) else None
    if not os.path.isfile(path):
        return None
    if os.path.exists(path + ".hierarchy"):
        return YT, path
    extension = os.path.splitext(path)[1].lower()
    for kind in _KINDS:
        if extension in kind.extensions:
            return kind, path
    if not extension and _begins_with(path, 128, b"DICM"):
        return DICOM, path
    # Codes of simulations number their files: sedov_hdf5_plt_cnt_0001.
    own = (*_MODELS, *_PARTICLES, ".vdb", ".nvdb")
    return (YT, path) if extension not in own and _begins_with(path, 0, b"\x89HDF") else None


def read(path: str, kind: Kind, wanted: str, given: "dict[str, Any]", chosen: "Optional[dict[str, Any]]" = None) -> Any:
    """Grids, or data, of a file, by those of the given options that its reader takes.

    wanted  name of the array that decides the lattice; '': the density
    chosen  what the call asks for, for readers that need it
    Raises vog.Error for an option that has no effect.
    """
    known = inspect.signature(kind.read).parameters
    options: "dict[str, Any]" = dict.fromkeys(known)
    options.update({name: value for name, value in {"wanted": wanted, "at": {}, **(chosen or {}), **given}.items() if name in known})
    for name, value in given.items():
        if value is not None and name not in known and not (name == "level" and kind is YT):
            raise _vog.Error(f"load: {path}: {name} has no effect on {kind.what}")
    return kind.read(**{**options, "path": path})


def _own(path: str, density: str, fields: "Union[Sequence[str], Mapping[str, str], None]", **rules: Any) -> Any:
    """Data of a file that vog itself reads."""
    extension = os.path.splitext(path[:-3] if path.lower().endswith(".gz") else path)[1].lower()
    background = rules.pop("background", None)
    if extension in _MODELS:
        if fields or density:
            raise _vog.Error(f"load: {path}: density and fields have no effect on a model, which has its own (model.fields)")
        return _vog.Gaussians.load(path)
    if extension in _PARTICLES:
        points = _vog.Points.load(path, grid=density, skip_nonfinite=rules["skip_nonfinite"])
        return points if fields is None else (points, list(by_name(fields).values()))
    data: Any
    if extension not in (".vdb", ".nvdb"):
        data = _vog.Volume.load(path, density, background=background, **rules)
    else:
        try:
            data = _vog.Levels.load(path, density, **rules)
        except _vog.Error as error:
            try:
                return _vog.Points.load(path, grid=density)
            except _vog.Error:
                raise error from None
        data = data if len(data) > 1 else data[0]
    if fields is None:
        return data
    given: "dict[str, Any]" = by_name(fields)
    for name, grid in list(given.items()):
        if "*" in grid:  # temperature_L*: a grid for each level
            of_level = fnmatch.filter(_vog.grid_names(path), grid)
            if not of_level:
                raise _vog.Error(f"load: {path}: no grid matches {grid!r}; it has {listed(_vog.grid_names(path))}")
            del given[name]
            given[name if name != grid else re.sub(r"_?L?\*", "", grid) or grid] = of_level if isinstance(data, _vog.Levels) else of_level[0]
    return data, given


def load(
    path: Any,
    density: str = "",
    *,
    fields: "Union[Sequence[str], Mapping[str, str], None]" = None,
    level: "Optional[int]" = None,
    at: "Optional[At]" = None,
    voxel_size: Any = None,
    unit: "Optional[str]" = None,
    thickness: "Optional[float]" = None,
    background: "Optional[float]" = None,
    skip_nonfinite: bool = False,
    clip_negative: bool = False,
) -> Any:
    """Any file or folder that vog or a package of this Python reads, as Volume, Levels, Cells, Points or Gaussians.

    path        a file of vog's own formats; .npy, .npz; HDF5 (h5py); NetCDF, GRIB and Zarr (xarray); OME-Zarr (zarr); VTK's files
                (pyvista or vtk); data sets of simulations (yt); a series of DICOM (pydicom); openPMD (openpmd_api)
                or the address of a Zarr store, "https://...", "s3://..." (fsspec)
    density     name of the array, grid or field; '': the only one, else the one called density; 'volume': 1 in every voxel, for
                fields of any sign
    fields      names of further arrays, of any sign, or {name: array} to rename them; 'velocity' is also the vector of velocity_x, velocity_y, velocity_z. The result
                is then a pair: data and {name: field}, for vog.convert(data, fields=...), vog.render and data.save;
                for Cells, which contain their fields, the second is None
    level       of simulations: one covering grid of this level; of OME-Zarr: a level of the pyramid, 0 the finest
    at          index along axes beside x, y and z: {"time": 3}, also the time of .pvd, .foam, .case and .exo;
                0 elsewhere, with a warning
    voxel_size  for NumPy and HDF5; replaces the coordinates of xarray
    thickness   of surfaces in VTK meshes, whose triangles and quads otherwise have no volume
    unit        of simulations: unit of the density, as in from_yt
    background  of scans and microscopy: value of empty space, as in Volume.load
    skip_nonfinite, clip_negative  as in Volume.from_numpy

    Units and positions come from the file. Raises ImportError, in one line, if a package is missing.

    >>> np.savez("box.npz", density=np.ones((8, 8, 8)), heat=np.arange(512.0).reshape(8, 8, 8) - 256)
    >>> volume, fields = vog.load("box.npz", fields=["heat"])
    >>> vog.convert(volume, block=4, fields=fields).fields["heat"].range[0]
    -256.0
    """
    path = os.fspath(path)
    rules: "dict[str, Any]" = {"skip_nonfinite": skip_nonfinite, "clip_negative": clip_negative}
    given = {"level": level, "at": at, "voxel_size": voxel_size, "unit": unit, "thickness": thickness, "background": background}
    given = {name: value for name, value in given.items() if value is not None}
    found = kind_of(path)
    if found is None:
        for name in given:
            if name != "background":
                raise _vog.Error(f"load: {path}: {name} has no effect on files that vog itself reads")
        return _own(path, density, fields, background=background, **rules)
    if at is not None and not (isinstance(at, Mapping) and all(isinstance(index, (int, np.integer)) for index in at.values())):
        raise _vog.Error(f"load: {path}: at {described(at) if not isinstance(at, Mapping) else dict(at)}: write an index for each axis, {{'time': 3}} say")
    with reading(path):
        return _other(path, *found, density, fields, given, rules)


def _other(path: str, kind: Kind, place: str, density: str, fields: Any, given: "dict[str, Any]", rules: "dict[str, Any]") -> Any:
    """Data of a file that a package of this Python reads."""
    if kind is YT:
        return from_yt(read(place, kind, "", {n: v for n, v in given.items() if n != "unit"}), density or "density", fields=fields, level=given.get("level"), unit=given.get("unit"), **rules)
    wanted = next(iter(by_name(fields).values()), "") if density == "volume" else density
    own = {"density": density, "fields": fields, "clip_negative": rules["clip_negative"]}
    data = read(place, kind, wanted, {n: v for n, v in given.items() if n != "background"}, own)
    if isinstance(data, _vog.Cells):
        return data if fields is None else (data, None)
    if not isinstance(data, Grids):
        return data if fields is None else (data, list(by_name(fields).values()))
    if "thickness" in given:
        raise _vog.Error(f"load: {path}: thickness has no effect on grids")
    if "background" in given and not data.scan:
        raise _vog.Error(f"load: {path}: background has no effect on {kind.what}")
    return assembled(data, density, fields, background=given.get("background"), **rules)
