"""Files of VTK, by pyvista or VTK: grids whose points lie evenly, and cells of any shape."""
from typing import Any, Dict, List, Optional, Sequence

import numpy as np

from . import _vog
from ._grids import density_of, lattice, named, one_grid
from ._packages import need

# Readers of VTK's own, by which its files are read without pyvista.
_READERS = {".vtk": ("vtkIOLegacy", "vtkGenericDataObjectReader")}
_READERS.update({f".vt{kind}": ("vtkIOXML", "vtkXMLGenericDataObjectReader") for kind in "irsupm"})
# Share of a cell by which points may be off an even spacing.
_EVEN = 1e-3


def dataset(path: str) -> Any:
    """Data of a file, as an object of VTK's: by pyvista where it is, else by VTK."""
    extension = path[path.rfind(".") :].lower()
    module, name = _READERS.get(extension, ("", ""))
    try:
        pyvista = need("pyvista", f"load: {path}")
    except ImportError:
        if not module:
            raise
        try:
            reader = getattr(need(f"vtkmodules.{module}", f"load: {path}"), name)()
        except ImportError as error:
            raise ImportError(f"load: {path}: neither pyvista nor vtk is installed, expected one of them: pip install pyvista", name=error.name) from None
        reader.SetFileName(path)
        reader.Update()
        return reader.GetOutputDataObject(0)
    return pyvista.read(path)


def leaves_of(data: Any) -> "list[Any]":
    """Data sets with points, of blocks within blocks."""
    if data is None:
        return []
    if data.IsA("vtkDataSet"):
        return [data] if data.GetNumberOfPoints() else []
    if data.IsA("vtkMultiBlockDataSet"):
        return [leaf for n in range(data.GetNumberOfBlocks()) for leaf in leaves_of(data.GetBlock(n))]
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


def _mesh_of(leaves: "List[Any]") -> Any:
    """One mesh of all blocks; polyhedra, polygons and curved cells are divided into tetrahedra and triangles."""
    append = need("vtkmodules.vtkFiltersCore", "load").vtkAppendFilter()
    for leaf in leaves:
        append.AddInputData(leaf)
    append.Update()
    mesh = append.GetOutput()
    if np.isin(_types(mesh), _SIMPLE).all():
        return mesh
    divide = need("vtkmodules.vtkFiltersGeneral", "load").vtkDataSetTriangleFilter()
    divide.SetInputData(mesh)
    divide.Update()
    return divide.GetOutput()


def _cells(path: str, leaves: "List[Any]", density: str, fields: "Sequence[str]", thickness: float, clip: bool) -> Any:
    """Cells of all blocks, with density and fields of their points or cells."""
    mesh = _mesh_of(leaves)
    to_numpy = need("vtkmodules.util.numpy_support", "load").vtk_to_numpy
    points, cells = arrays_of(mesh.GetPointData()), arrays_of(mesh.GetCellData())
    values: "Dict[str, Any]" = {name: {"value": array, "at": "cells"} for name, array in cells.items()}
    values.update({name: {"value": array, "at": "points"} for name, array in points.items()})
    types = _types(mesh)
    ghosts = mesh.GetCellData().GetArray("vtkGhostType")
    if ghosts is not None:  # cells that another part has, too
        types[to_numpy(ghosts) != 0] = 0
    if density == "volume" and density not in values:
        main: Any = {"value": np.ones(len(types)), "at": "cells"}
    else:
        density = density_of(list(values), density, path)
        main = values[density]
        main = {**main, "value": np.maximum(main["value"], 0) if clip else main["value"]}
    return _vog.Cells(
        to_numpy(mesh.GetPoints().GetData()), to_numpy(mesh.GetCells().GetConnectivityArray()), types, main,
        ends=to_numpy(mesh.GetCells().GetOffsetsArray())[1:], fields={name: values[named(list(values), name, path)[0]] for name in fields},
        thickness=thickness, name=density, source=path,
    )  # fmt: skip


def read_vtk(
    path: str, wanted: str, density: str = "", fields: "Optional[Sequence[str]]" = None, thickness: "Optional[float]" = None, clip_negative: bool = False
) -> Any:
    """Arrays of an even grid, of its points or, where the density is theirs, of its cells; Cells of every other mesh."""
    leaves = leaves_of(dataset(path))
    if not any(attributes.GetNumberOfArrays() for leaf in leaves for attributes in (leaf.GetPointData(), leaf.GetCellData())):
        raise _vog.Error(f"{path}: no arrays of numbers at points or in cells, expected one at least")
    places = _places(leaves[0]) if len(leaves) == 1 else None
    if places is None:
        return _cells(path, leaves, density, fields or [], thickness or 0.0, clip_negative)
    (shape, matrix), data = places, leaves[0]
    points, cells = arrays_of(data.GetPointData()), arrays_of(data.GetCellData())
    if not points or (cells and density_of([*points, *cells], wanted, path) not in points):
        # Cells lie between points; a grid of one layer of points has one layer of cells.
        matrix = matrix @ lattice(1, np.where(shape > 1, 0.5, 0))
        points, shape = cells, np.maximum(shape - 1, 1)
    arrays = {name: array.reshape((*shape, *array.shape[1:]), order="F") for name, array in points.items()}
    return one_grid(path, matrix, arrays, {})
