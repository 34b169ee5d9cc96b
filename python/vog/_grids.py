"""Named arrays on lattices, of one grid or of levels, as a Volume or Levels with fields."""
import itertools
import os
import tempfile
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import _vog
from ._units import set_units

Blocks = List[Tuple[Tuple[int, ...], Any]]


class Grids(NamedTuple):
    """Arrays of a data set, read when they are wanted.

    names   of the arrays
    levels  matrix [4, 4] of each level: world = matrix @ (i, j, k, 1) of a voxel's centre
    blocks  (level, name) -> [((i, j, k), array [X, Y, Z] or [X, Y, Z, 3])]
    unit    name -> unit of the values; None: not known
    source  file, for messages
    """

    names: Sequence[Any]
    levels: Sequence[Any]
    blocks: Callable[[int, Any], Blocks]
    unit: Callable[[Any], Any]
    source: str
    length: Any = None
    up: "Optional[Tuple[float, float, float]]" = None
    scan: bool = False  # values above a background are density, as the readers of images have it
    # of arrays larger than memory: name -> shape [X, Y, Z], dtype, and arrays [X, Y, n] one after another along z
    slabs: "Optional[Callable[[Any], Tuple[Tuple[int, ...], Any, Iterable[Any]]]]" = None
    vectors: Sequence[Any] = ()  # names of the arrays [X, Y, Z, 3]


def one_grid(source: str, matrix: Any, arrays: "Dict[str, Any]", units: "Dict[str, Any]", **more: Any) -> Grids:
    """Arrays of one lattice, whose first voxel has the index (0, 0, 0)."""
    vectors = [name for name, array in arrays.items() if array.ndim > 3]
    return Grids(list(arrays), [matrix], lambda _, name: [((0, 0, 0), np.asarray(arrays[name]))], units.get, source, vectors=vectors, **more)


def lattice(spacing: Any, origin: Any) -> Any:
    """Matrix of voxels along the axes, the first one centred on the origin."""
    edges = np.asarray(spacing, float)
    if edges.shape not in ((), (3,)) or not np.all(np.isfinite(edges) & (edges > 0)):
        raise _vog.Error(f"edges of voxels {spacing}: expected a number or (x, y, z), finite and above 0; voxel_size= sets them")
    matrix = np.diag([*np.broadcast_to(edges, 3), 1.0])
    matrix[:3, 3] = origin
    return matrix


def named(names: "Sequence[Any]", name: Any, source: str) -> "Sequence[Any]":
    """The array of this name, or its three components: wind_x, wind_y, wind_z; vx, vy, vz of v."""
    if name in names:
        return [name]
    for between in ("_", "-", ""):
        parts = [f"{name}{between}{axis}" for axis in "xyz"]
        if all(part in names for part in parts):
            return parts
    raise _vog.Error(f"{source}: no field {name!r}, expected one of {listed(names)}")


def listed(names: "Sequence[Any]") -> str:
    return ", ".join(map(str, names[:20])) + (", ..." if len(names) > 20 else "")


_USUAL = ("density", "Density", "rho", "dens")


def by_name(fields: Any) -> "Dict[str, Any]":
    """Arrays of fields by the names that these get: of a mapping, or of a list of arrays."""
    if isinstance(fields, Mapping):
        return dict(fields)
    return {field if isinstance(field, str) else field[-1]: field for field in ([fields] if isinstance(fields, str) else fields or ())}


def density_of(names: "Sequence[Any]", name: Any, source: str) -> Any:
    """The array that is the density: the one of this name; '': the only one, or one called density or rho."""
    if name:
        parts = named(names, name, source)
        if len(parts) > 1:
            raise _vog.Error(f"{source}: {name!r} is a vector, which is no density, expected one of {listed(parts)}")
        return parts[0]
    if len(names) == 1:
        return names[0]
    for usual in _USUAL:
        if usual in names:
            return usual
    if not names:
        raise _vog.Error(f"{source}: no arrays of numbers, expected one at least")
    raise _vog.Error(f"{source}: several arrays, none called density, expected the name of one: {listed(names)}")


def lead_of(names: "Sequence[Any]", wanted: Any, source: str) -> "Sequence[Any]":
    """The array that decides the lattice, or its components: the one of this name; '': the density, else the first."""
    usual = [name for name in _USUAL if name in names]
    return named(names, wanted, source) if wanted else [usual[0] if usual else names[0]]


def _values(grids: Grids, level: int, name: Any) -> Blocks:
    parts = [grids.blocks(level, part) for part in named(grids.names, name, grids.source)]
    return parts[0] if len(parts) == 1 else [(blocks[0][0], np.stack([block[1] for block in blocks], -1)) for blocks in zip(*parts)]


_NRRD_TYPES = {"uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"}


def write_scan(file: Any, grids: Grids, name: str) -> None:
    """Writes an array as NRRD, which vog reads as it reads scans."""
    if grids.slabs:
        shape, dtype, slabs = grids.slabs(name)
    else:
        array = grids.blocks(0, name)[0][1]
        shape, dtype, slabs = array.shape, array.dtype, [array]
    dtype = np.dtype(dtype if dtype.name in _NRRD_TYPES else np.float32)
    vector = lambda column: "(" + ",".join(f"{x:.17g}" for x in column[:3]) + ")"
    matrix = np.asarray(grids.levels[0])
    kind = {"float32": "float", "float64": "double"}.get(dtype.name, dtype.name)
    head = ["NRRD0004", f"type: {kind}", "dimension: 3", "space: right-anterior-superior", "sizes: " + " ".join(map(str, shape)),
            "space directions: " + " ".join(map(vector, matrix.T[:3])), f"space origin: {vector(matrix[:, 3])}",
            "encoding: raw", "endian: little"]  # fmt: skip
    if grids.length:
        head.append(f'space units: "{grids.length}" "{grids.length}" "{grids.length}"')
    with open(file, "wb") as out:
        out.write(("\n".join(head) + "\n\n").encode())
        for slab in slabs:
            for plane in np.moveaxis(slab, 2, 0):
                out.write(plane.astype(dtype.newbyteorder("<")).tobytes(order="F"))


def _scan_volume(grids: Grids, name: str, **rules: Any) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, os.path.basename(os.path.normpath(grids.source)).split(".")[0] + ".nrrd")
        write_scan(file, grids, name)
        volume = _vog.Volume.load(file, **rules)
    volume.name = name
    return volume


def _volume_of_slabs(slabs: "Iterable[Any]", matrix: Any, name: str, rules: "Dict[str, Any]") -> Any:
    """The volume of arrays [X, Y, n] one after another along z."""

    def parts() -> "Iterable[Tuple[Tuple[int, int, int], Any]]":
        first, held = 0, np.zeros((0, 0, 0))
        for slab in itertools.chain(slabs, [None]):
            # Parts share no leaf of 8 voxels.
            slab = held if slab is None else np.concatenate([held, slab], 2) if held.size else slab
            depth = slab.shape[2] if slab is held else slab.shape[2] // 8 * 8
            part, held = slab[:, :, :depth], slab[:, :, depth:]
            if (part > 0).any() or ((part != 0).any() and not any(rules.values())):  # which is refused
                yield (0, 0, first), part
            first += depth

    return _vog.Volume._from_parts(parts(), matrix, name, **rules)


def assembled(
    grids: Grids, density: Any, fields: Any, levels: bool = False, background: "Optional[float]" = None, **rules: Any
) -> Any:
    """A Volume, or Levels of several levels; with fields a pair of it and {name: field}, as vog.convert takes them.

    density  name of the array; 'volume' where there is none: 1 in every voxel, for fields of any sign
    levels   True: return Levels even for a single level
    background  of scans, as in Volume.load
    rules    skip_nonfinite and clip_negative of Volume.from_numpy
    """
    several = levels or len(grids.levels) > 1
    arrays = by_name(fields)
    ones = density == "volume" and density not in grids.names
    if ones and not arrays:
        raise _vog.Error(f"{grids.source}: density='volume' counts volume, expected the names of fields with it: fields=[...]")
    name = next(iter(arrays.values())) if ones else density_of(grids.names, density, grids.source)
    given: "Dict[str, Any]" = {}
    for new, field in arrays.items():
        of_level: "List[Any]" = [_values(grids, level, field) for level in range(len(grids.levels))]
        unit = grids.unit(named(grids.names, field, grids.source)[0])
        value = of_level if len(of_level) > 1 else of_level[0]
        given[new] = {"value": value, "unit": str(unit)} if unit else value
    volumes = []
    for level, matrix in enumerate(grids.levels):
        blocks = [] if (grids.scan or grids.slabs) and not ones else _values(grids, level, name)
        if ones:
            blocks = [(first, np.isfinite(array if array.ndim == 3 else array.sum(-1)).astype(np.float32)) for first, array in blocks]
        title = "volume" if ones else name if isinstance(name, str) else name[-1]
        if grids.scan and not ones:
            volume = _scan_volume(grids, title, background=background, **rules)
        elif grids.slabs and not ones:
            volume = _volume_of_slabs(grids.slabs(name)[2], matrix, title, rules)
        else:
            volume = _vog.Volume.from_blocks(blocks, matrix=matrix, all_active=several and not ones, name=title, **rules)
        if grids.up:
            volume.up = grids.up
        unit = None if ones else grids.unit(name)
        volumes.append(set_units(volume, unit, grids.length) if unit or grids.length else volume)
    made: Any = volumes[0]
    if several:
        made = _vog.Levels(volumes)
        if unit or grids.length:
            set_units(made, unit, grids.length)
    return made if fields is None else (made, given)
