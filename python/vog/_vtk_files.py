"""Files of VTK, by pyvista or VTK: grids whose points lie evenly, and cells of any shape."""
import logging
import re
import warnings
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence

import numpy as np

from . import _vog
from ._files import At, beside
from ._grids import by_name, density_of, lattice, lead_of, named, one_grid
from ._packages import need

# Readers of VTK's own, by which its files are read without pyvista.
_READERS = {".vtk": ("vtkIOLegacy", "vtkGenericDataObjectReader"), **{f".vt{kind}": ("vtkIOXML", "vtkXMLGenericDataObjectReader") for kind in "irsupm"}}
_LACKING = {".pvts": "PStructuredGrid", ".vtpd": "PartitionedDataSet", ".vtpc": "PartitionedDataSetCollection"}  # pyvista lacks them
_READERS.update({extension: ("vtkIOXML", f"vtkXML{kind}Reader") for extension, kind in _LACKING.items()})
# Files that may have several times.
_TIMED = (".pvd", ".foam", ".case", ".exo", ".e", ".ex2")
# Bits of vtkGhostType of cells that do not count: of another part, with finer ones in their place, hidden; and of points.
_GHOSTS, _GHOST_POINTS, _HIDDEN_POINT = 1 | 8 | 32, 1 | 2, 2
# Share of a cell by which points may be off an even spacing.
_EVEN = 1e-3


class _Heard(logging.Handler):
    """What VTK and pyvista report while they read, in place of their logs."""

    def __init__(self, core: Any) -> None:
        super().__init__()
        self.logged: "List[str]" = []
        self.log, self.window, self.own = core.vtkLogger, core.vtkOutputWindow, core.vtkStringOutputWindow()

    def emit(self, record: logging.LogRecord) -> None:
        self.logged.append("ERROR: " + record.getMessage())

    def __enter__(self) -> "_Heard":
        self.before = self.window.GetInstance(), self.log.GetCurrentVerbosityCutoff()
        self.window.SetInstance(self.own)
        self.log.SetStderrVerbosity(self.log.VERBOSITY_OFF)
        logging.getLogger().addHandler(self)
        return self

    def __exit__(self, *_: Any) -> None:
        logging.getLogger().removeHandler(self)
        self.window.SetInstance(self.before[0])
        self.log.SetStderrVerbosity(self.before[1])

    def fault(self) -> str:
        """The first error in one line, without the place in VTK's sources; '': none."""
        text = "\n".join([self.own.GetOutput(), *self.logged])
        found = re.search(r"(?:ERROR: |Generic Warning: (?=[^\n]*\n(?:.*: )?Error reading))(?:In vtk\w+\.\w+, line \d+\s*\n)?(?:\S+ \(\w+\): )?(.*)", text)
        return found[1].strip() if found else ""


def _short_of_numbers(path: str, data: Any) -> bool:
    """Whether a text of VTK's legacy format has fewer words than its data have numbers, which VTK does not report."""
    with open(path, "rb") as file:
        if [next(file, b"").strip() for _ in range(3)][2] != b"ASCII":
            return False
        words = sum(len(line.split()) for line in file)
    parts = [data.GetPointData(), data.GetCellData()] if data.IsA("vtkDataSet") else []
    arrays = [part.GetAbstractArray(n) for part in parts for n in range(part.GetNumberOfArrays())]
    places = 3 * data.GetNumberOfPoints() if data.IsA("vtkPointSet") else 0
    return bool(words < places + sum(array.GetNumberOfValues() for array in arrays))


def dataset(path: str, at: At = {}) -> Any:
    """Data of a file, of one time, as an object of VTK's. Raises vog.Error for a file, or a part of it, that cannot be read whole."""
    try:
        core = need("vtkmodules.vtkCommonCore", f"load: {path}")
    except ImportError as error:
        raise ImportError(f"load: {path}: neither pyvista nor vtk is installed, expected one of them: pip install pyvista", name=error.name) from None
    with _Heard(core) as heard, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The VTK reader")  # pyvista's
        data = _dataset(path, at)
    fault = heard.fault()
    if not fault and path.lower().endswith(".vtk") and _short_of_numbers(path, data):
        fault = "the file ends before its numbers do"
    if fault and not re.search(r"\.p?vt\w+$|\.pvd$", path.lower()) and leaves_of(data):
        warnings.warn(f"{path}: VTK reports: {fault}", stacklevel=5)  # codes write files with less than VTK looks for
    elif fault:
        raise _vog.Error(f"{path}: VTK cannot read it: {fault}")
    return data


def _dataset(path: str, at: At) -> Any:
    """Data of a file, by pyvista where it is, else by VTK."""
    extension = path[path.rfind(".") :].lower()
    module, name = _READERS.get(extension, ("", ""))
    pyvista: Any = None
    try:
        pyvista = need("pyvista", f"load: {path}")
    except ImportError:
        if not module:
            raise
    if module and (extension in _LACKING or not pyvista):
        reader = getattr(need(f"vtkmodules.{module}", f"load: {path}"), name)()
        beside(path, {}, at)
        reader.SetFileName(path)
        reader.Update()
        return reader.GetOutputDataObject(0)
    timed = pyvista.get_reader(path) if extension in _TIMED else None
    times = timed.number_time_points if timed else 0
    index = beside(path, {"time": times} if times > 1 else {}, at)
    if not index:
        return pyvista.read(path)
    timed.set_active_time_point(index["time"] % times)
    return timed.read()


def leaves_of(data: Any) -> "list[Any]":
    """Data sets with points, of blocks within blocks."""
    if data is None:
        return []
    if data.IsA("vtkDataSet"):
        return [data] if data.GetNumberOfPoints() else []
    for kind, part in (("MultiBlockDataSet", "Block"), ("PartitionedDataSetCollection", "PartitionedDataSet"), ("PartitionedDataSet", "Partition")):
        if data.IsA(f"vtk{kind}"):
            return [leaf for n in range(getattr(data, f"GetNumberOf{part}s")()) for leaf in leaves_of(getattr(data, f"Get{part}")(n))]
    return []


def arrays_of(attributes: Any) -> "Dict[str, Any]":
    """Numbers of points or cells by name: [N] or [N, components]."""
    to_numpy = need("vtkmodules.util.numpy_support", "load").vtk_to_numpy
    found = {}
    for n in range(attributes.GetNumberOfArrays()):
        array = attributes.GetArray(n)  # None of texts
        if array is not None and array.GetNumberOfComponents() in (1, 3) and not str(array.GetName()).startswith("vtk"):
            found[array.GetName() or f"array{n}"] = to_numpy(array)
    return found


def _places(data: Any) -> "Optional[tuple[Any, Any]]":
    """(Numbers of points along the axes, matrix [4, 4] to the points); None where these lie unevenly."""
    to_numpy = need("vtkmodules.util.numpy_support", "load").vtk_to_numpy
    if not any(data.IsA(kind) for kind in ("vtkImageData", "vtkRectilinearGrid", "vtkStructuredGrid")):
        return None
    extent = np.array(data.GetExtent())
    shape = extent[1::2] - extent[::2] + 1
    if data.IsA("vtkImageData"):
        to_world = data.GetIndexToPhysicalMatrix()
        matrix = np.array([[to_world.GetElement(row, column) for column in range(4)] for row in range(4)])
        matrix[:3, 3] += matrix[:3, :3] @ extent[::2]
        return shape, matrix
    if data.IsA("vtkRectilinearGrid"):
        axes = [to_numpy(getattr(data, f"Get{axis}Coordinates")()).astype(float) for axis in "XYZ"]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    else:
        points = to_numpy(data.GetPoints().GetData()).astype(float).reshape((*shape, 3), order="F")
    matrix, origin = np.eye(4), points[0, 0, 0]
    for axis in range(3):
        last = np.zeros(3, int)
        last[axis] = shape[axis] - 1
        if shape[axis] > 1:
            matrix[:3, axis] = (points[tuple(last)] - origin) / (shape[axis] - 1)
    matrix[:3, 3] = origin
    index = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), -1)
    off = np.abs(points - (index @ matrix[:3, :3].T + origin)).max()
    return (shape, matrix) if off <= _EVEN * np.linalg.norm(matrix[:3, :3], axis=0).min() else None


# Types of cells that vog.Cells has, and points and lines, which have no volume.
_SIMPLE = [0, 1, 2, 3, 4, 5, 8, 9, 10, 11, 12, 13, 14]


def _types(mesh: Any) -> Any:
    try:
        types = mesh.GetCellTypes()
    except TypeError:  # VTK before 9.6
        types = mesh.GetCellTypesArray()
    return np.array(need("vtkmodules.util.numpy_support", "load").vtk_to_numpy(types))


class _Mesh(NamedTuple):
    """Cells as vog.Cells takes them, and the arrays of points and cells by name."""

    points: Any
    corners: Any
    ends: Any
    types: Any
    at_points: "Dict[str, Any]"
    at_cells: "Dict[str, Any]"


def _ghosts(attributes: Any, bits: int) -> Any:
    """Which points or cells have one of these bits in vtkGhostType, or None."""
    array = attributes.GetArray("vtkGhostType")
    return None if array is None else (need("vtkmodules.util.numpy_support", "load").vtk_to_numpy(array) & bits) != 0


def _plain(mesh: Any) -> _Mesh:
    to_numpy = need("vtkmodules.util.numpy_support", "load").vtk_to_numpy
    corners, ends = to_numpy(mesh.GetCells().GetConnectivityArray()), to_numpy(mesh.GetCells().GetOffsetsArray())[1:]
    return _Mesh(to_numpy(mesh.GetPoints().GetData()), corners, ends, _types(mesh), arrays_of(mesh.GetPointData()), arrays_of(mesh.GetCellData()))


def _only(mesh: Any, cells: Any) -> Any:
    """A mesh of some of the cells."""
    core = need("vtkmodules.vtkFiltersCore", "load")
    extract = (core if hasattr(core, "vtkExtractCells") else need("vtkmodules.vtkFiltersExtraction", "load")).vtkExtractCells()
    ids = need("vtkmodules.vtkCommonCore", "load").vtkIdList()
    for n in np.flatnonzero(cells):
        ids.InsertNextId(int(n))
    extract.SetInputData(mesh)
    extract.SetCellList(ids)
    extract.Update()
    return extract.GetOutput()


def _fans(rows: Any, start: int, streams: "List[List[int]]") -> "tuple[Any, Any, Any, int]":
    """Tetrahedra between each polyhedron's centroid and the triangles around the centroids of its faces: exact where it is star-shaped.

    rows     points with their values, [points, 3 + values]
    start    index of the first new point
    streams  of each cell its number of faces, and of each face the number of its corners and these
    Returns the new rows, corners [tetrahedra, 4], the cell of each, and the number of cells that are not star-shaped.
    """
    faces, cell_of_face = [], []
    for n, stream in enumerate(streams):
        at = 1
        for _ in range(stream[0]):
            faces.append(stream[at + 1 : at + 1 + stream[at]])
            cell_of_face.append(n)
            at += 1 + stream[at]
    sizes = [len(face) for face in faces]
    face, cell = np.repeat(np.arange(len(faces)), sizes), np.repeat(cell_of_face, sizes)  # of each edge
    first, second = np.concatenate(faces), np.concatenate([[*face[1:], face[0]] for face in faces])
    a, b = rows[first], rows[second]
    sums: "Callable[[Any, Any], Any]" = lambda group, values: np.stack([np.bincount(group, column) for column in values.T], -1)

    def mean(group: Any, values: Any, weights: Any) -> Any:
        weights = np.where(np.bincount(group, weights)[group] == 0, 1.0, weights)
        return sums(group, values * weights[:, None]) / np.bincount(group, weights)[:, None]

    middle = mean(face, a, np.ones(len(a)))[face]
    normal = np.cross((a - middle)[:, :3], (b - middle)[:, :3])
    whole = sums(face, normal)
    centres = mean(face, (middle + a + b) / 3, (normal * whole[face]).sum(1))
    centre = centres[face]
    volume: "Callable[[Any], Any]" = lambda apex: (np.cross((a - centre)[:, :3], (b - centre)[:, :3]) * (centre - apex)[:, :3]).sum(1)
    inner = mean(cell, centre, np.ones(len(a)))[cell]
    # Faces that all turn outwards add up to nothing; the volumes of others have no sign.
    signed = np.linalg.norm(sums(cell_of_face, whole), axis=1) <= 1e-6 * np.bincount(cell_of_face, np.linalg.norm(whole, axis=1))
    size = volume(inner)
    apexes = mean(cell, (inner + centre + a + b) / 4, np.where(signed[cell], size, np.abs(size)))
    size = volume(apexes[cell])
    total = np.bincount(cell, np.abs(size))
    uncertain = signed & (total - np.abs(np.bincount(cell, size)) > 1e-3 * total)
    real = np.abs(size) > 1e-12 * total[cell]
    inverted = size > 0
    corners = np.stack([np.where(inverted, second, first), np.where(inverted, first, second), start + face, start + len(faces) + cell], -1)
    return np.concatenate([centres, apexes]), corners[real], cell[real], int(uncertain.sum())


def _polyhedra(path: str, mesh: Any, cells: Any) -> _Mesh:
    """The polyhedra of a mesh, [cells] of it, as tetrahedra."""
    plain = _plain(mesh)
    columns = [plain.points, *(array.reshape(len(array), -1) for array in plain.at_points.values())]
    parts, made, uncertain = [np.concatenate(columns, 1).astype(float)], [], 0
    ids, start = need("vtkmodules.vtkCommonCore", "load").vtkIdList(), len(plain.points)
    for run in np.array_split(cells, len(cells) // 4096 + 1):
        streams = []
        for n in run:
            mesh.GetFaceStream(int(n), ids)
            streams.append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
        rows, corners, cell, bad = _fans(parts[0], start, streams)
        parts.append(rows)
        made.append((corners, run[cell]))
        start, uncertain = start + len(rows), uncertain + bad
    if uncertain:
        warnings.warn(f"{path}: {uncertain} of {len(cells)} polyhedra are not star-shaped, their volumes count too much", stacklevel=7)
    rows, corners, cell = np.concatenate(parts), *(np.concatenate(part) for part in zip(*made))
    values = np.split(rows, np.cumsum([column.shape[1] for column in columns]), axis=1)[1:]
    at_points = {name: value.reshape(-1, *array.shape[1:]) for value, (name, array) in zip(values, plain.at_points.items())}
    at_cells = {name: array[cell] for name, array in plain.at_cells.items()}
    return _Mesh(rows[:, :3], corners.ravel(), 4 * np.arange(1, len(cell) + 1), np.full(len(cell), 10, np.uint8), at_points, at_cells)


def _mesh_of(path: str, leaves: "List[Any]") -> _Mesh:
    """One mesh of all blocks without ghosts; polyhedra, polygons and curved cells are divided into tetrahedra and triangles."""
    append = need("vtkmodules.vtkFiltersCore", "load").vtkAppendFilter()
    for kind in ("Cell", "Point"):
        if any(getattr(leaf, f"Get{kind}Data")().HasArray("vtkGhostType") for leaf in leaves):
            for leaf in leaves:  # the filter keeps only arrays of all blocks
                getattr(leaf, f"Allocate{kind}GhostArray")()
    for leaf in leaves:
        append.AddInputData(leaf)
    append.Update()
    mesh, plain = append.GetOutput(), _plain(append.GetOutput())
    out, hidden = _ghosts(mesh.GetCellData(), _GHOSTS), _ghosts(mesh.GetPointData(), _HIDDEN_POINT)
    kept = np.ones(len(plain.types), bool) if out is None else ~out
    if hidden is not None:  # hides the cells around it
        kept[np.searchsorted(plain.ends, np.flatnonzero(hidden[plain.corners]), "right")] = False
    _note_ghosts(path, int((~kept).sum()), len(kept), "cells")
    solid = kept & (plain.types == 42)
    solids = _polyhedra(path, mesh, np.flatnonzero(solid)) if solid.any() else None
    if solids and not (kept & ~solid).any():
        return solids
    mesh = mesh if (kept & ~solid).all() else _only(mesh, kept & ~solid)
    if not np.isin(_types(mesh), _SIMPLE).all():
        divide = need("vtkmodules.vtkFiltersGeneral", "load").vtkDataSetTriangleFilter()
        divide.SetInputData(mesh)
        divide.Update()
        mesh = divide.GetOutput()
    rest = _plain(mesh)
    if solids is None:
        return rest
    points, corners, ends, types = (np.concatenate(pair) for pair in zip(solids[:4], (
        rest.points, rest.corners + len(solids.points), rest.ends + len(solids.corners), rest.types)))  # fmt: skip
    at_points, at_cells = ({name: np.concatenate([array, other[name]]) for name, array in one.items()} for one, other in zip(solids[4:], rest[4:]))
    return _Mesh(points, corners, ends, types, at_points, at_cells)


def _note_ghosts(path: str, out: int, count: int, what: str) -> None:
    if out:
        warnings.warn(f"{path}: {out} of {count} {what} are ghosts or hidden (vtkGhostType) and do not count", stacklevel=6)


def _with_density(path: str, leaves: "List[Any]", density: str) -> "tuple[List[Any], str]":
    """Blocks that have the density, and its name; others, such as patches of a boundary, are left out."""
    names = [list({**arrays_of(leaf.GetPointData()), **arrays_of(leaf.GetCellData())}) for leaf in leaves]
    every = list(dict.fromkeys(name for own in names for name in own))
    if density == "volume" and density not in every:
        return leaves, density
    density = density_of(every, density, path)
    kept = [leaf for leaf, own in zip(leaves, names) if density in own]
    if len(kept) < len(leaves):
        warnings.warn(f"{path}: {len(leaves) - len(kept)} of {len(leaves)} blocks have no {density!r} and are left out", stacklevel=6)
    return kept, density


def _cells(path: str, leaves: "List[Any]", density: str, fields: Any, thickness: float, clip: bool) -> Any:
    """Cells of all blocks, with density and fields of their points or cells; of one name in both, those of the cells."""
    leaves, density = _with_density(path, leaves, density)
    mesh = _mesh_of(path, leaves)
    values: "Dict[str, Any]" = {name: {"value": array, "at": "points"} for name, array in mesh.at_points.items()}
    values.update({name: {"value": array, "at": "cells"} for name, array in mesh.at_cells.items()})

    def field(name: str) -> Any:
        parts = [values[part] for part in named(list(values), name, path)]
        if len({part["at"] for part in parts}) > 1:
            raise _vog.Error(f"{path}: components of {name!r} at points and in cells, expected all in one place")
        return parts[0] if len(parts) == 1 else {**parts[0], "value": np.stack([part["value"] for part in parts], -1)}

    if density == "volume" and density not in values:
        main: Any = {"value": np.ones(len(mesh.types)), "at": "cells"}
    elif density not in values:
        raise _vog.Error(f"{path}: {density!r} lies at points in some blocks and in cells in others, expected one of them")
    else:
        main = values[density]
        main = {**main, "value": np.maximum(main["value"], 0) if clip else main["value"]}
    return _vog.Cells(
        mesh.points, mesh.corners, mesh.types, main, ends=mesh.ends, fields={name: field(array) for name, array in by_name(fields).items()},
        thickness=thickness, name=density, source=path,
    )  # fmt: skip


def _outside(data: Any, shape: Any, cells: bool) -> Any:
    """[X, Y, Z]: points of a grid, or cells, that are ghosts or hidden, by themselves or by their neighbours; shape of the points."""
    around, own = ("Point", "Cell") if cells else ("Cell", "Point")
    bits = {"Cell": _GHOSTS, "Point": _HIDDEN_POINT if cells else _GHOST_POINTS}
    sizes = {"Point": shape, "Cell": np.maximum(shape - 1, 1)}
    outside = {kind: _ghosts(getattr(data, f"Get{kind}Data")(), bits[kind]) for kind in sizes}
    out = {kind: np.zeros(sizes[kind], bool) if flags is None else flags.reshape(sizes[kind], order="F") for kind, flags in outside.items()}
    near = out[around] if cells else np.pad(out[around], [(1, 1) if n > 1 else (0, 0) for n in shape], constant_values=True)
    for axis in np.flatnonzero(shape > 1):
        # A corner hides its cells; a point is hidden by all cells around it.
        parts = [np.take(near, np.arange(n, near.shape[axis] - 1 + n), axis) for n in (0, 1)]
        near = parts[0] | parts[1] if cells else parts[0] & parts[1]
    return out[own] | near


def read_vtk(
    path: str, wanted: str, at: At, density: str = "", fields: Any = None, thickness: "Optional[float]" = None, clip_negative: bool = False
) -> Any:
    """Arrays of an even grid, of its points or, where the density is theirs, of its cells; Cells of every other mesh."""
    leaves = leaves_of(dataset(path, at))
    if not any(attributes.GetNumberOfArrays() for leaf in leaves for attributes in (leaf.GetPointData(), leaf.GetCellData())):
        raise _vog.Error(f"{path}: no arrays of numbers at points or in cells, expected one at least")
    places = _places(leaves[0]) if len(leaves) == 1 else None
    if places is None:
        return _cells(path, leaves, density, fields, thickness or 0.0, clip_negative)
    (shape, matrix), data = places, leaves[0]
    points, cells = arrays_of(data.GetPointData()), arrays_of(data.GetCellData())
    in_cells = not points or (bool(cells) and lead_of(list({**points, **cells}), wanted, path)[0] in cells)
    out = _outside(data, shape, in_cells)
    if in_cells:
        # Cells lie between points; a grid of one layer of points has one layer of cells.
        matrix = matrix @ lattice(1, np.where(shape > 1, 0.5, 0))
        points, shape = cells, np.maximum(shape - 1, 1)
    arrays = {name: array.reshape((*shape, *array.shape[1:]), order="F") for name, array in points.items()}
    if out.any():
        _note_ghosts(path, int(out.sum()), out.size, "cells" if in_cells else "points")
        for name in lead_of(list(arrays), wanted, path):
            # A field's volume counts where it is a number.
            none = np.nan if density == "volume" and density not in arrays else 0
            arrays[name] = np.where(out.reshape(out.shape + (1,) * (arrays[name].ndim - 3)), none, arrays[name])
    return one_grid(path, matrix, arrays, {})
