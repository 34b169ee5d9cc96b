"""Models and volumes as data of VTK and PyVista."""
from typing import Any, Optional

import numpy as np

from . import _vog
from ._packages import described, need


def _array(values: Any, name: str) -> Any:
    """A VTK array of its own memory, named."""
    to_vtk = need("vtkmodules.util.numpy_support", "to_vtk").numpy_to_vtk
    made = to_vtk(np.ascontiguousarray(values), deep=True)
    made.SetName(name)
    return made


def _points(model: _vog.Gaussians) -> Any:
    """Points with the Gaussians' arrays, a vertex each."""
    model_data = need("vtkmodules.vtkCommonDataModel", "to_vtk")
    core = need("vtkmodules.vtkCommonCore", "to_vtk")
    support = need("vtkmodules.util.numpy_support", "to_vtk")
    points = core.vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(_array(model.world_mean, "Points"))
    made = model_data.vtkPolyData()
    made.SetPoints(points)
    count = len(model)
    vertices = model_data.vtkCellArray()
    vertices.SetData(
        support.numpy_to_vtkIdTypeArray(np.arange(count + 1, dtype=np.int64), deep=True),
        support.numpy_to_vtkIdTypeArray(np.arange(count, dtype=np.int64), deep=True),
    )
    made.SetVerts(vertices)
    arrays = made.GetPointData()
    for name, values in (("density", model.density), ("scale", model.scale), ("rotation", model.rotation)):
        arrays.AddArray(_array(values, name))
    arrays.AddArray(_array(model_masses(model), "mass"))
    for name, field in model.fields.items():
        # As in files: the value of a field called like one of these is NAME_value.
        arrays.AddArray(_array(field.value, f"{name}_value" if name in ("density", "scale", "rotation", "mass") else name))
        if not field.is_vector:
            arrays.AddArray(_array(field.gradient, f"{name}_gradient"))
            arrays.AddArray(_array(field.deviation, f"{name}_deviation"))
    arrays.SetActiveScalars("density")
    return made


def model_masses(model: _vog.Gaussians) -> Any:
    """[N] float64: integral of each truncated Gaussian, density times world units cubed."""
    from math import erf, exp, pi, sqrt

    c = float(model.cutoff)
    share = erf(c / sqrt(2)) - sqrt(2 / pi) * c * exp(-c * c / 2)
    return model.density.astype(float) * model.scale.astype(float).prod(axis=1) * (2 * pi) ** 1.5 * share


def _image(volume: _vog.Volume, fields: "dict[str, Any]") -> Any:
    """Image data whose points are the centres of the voxels of the index box."""
    if volume.active_voxels == 0:
        raise _vog.Error("to_vtk: the volume has no active voxel, expected one")
    lower = np.array(volume.index_box[0], dtype=float)
    values = volume.to_numpy()
    linear = volume.matrix[:3, :3]
    spacing = np.linalg.norm(linear, axis=0)
    turn = linear / spacing
    if not np.allclose(turn.T @ turn, np.eye(3), atol=1e-5):
        raise _vog.Error("to_vtk: voxels with skewed axes, expected right angles between them, as image data of VTK have")
    made = need("vtkmodules.vtkCommonDataModel", "to_vtk").vtkImageData()
    made.SetDimensions(*values.shape)
    made.SetOrigin(*(volume.matrix @ [*lower, 1])[:3])
    made.SetSpacing(*spacing)
    made.SetDirectionMatrix(*turn.ravel())
    arrays = made.GetPointData()
    # x is fastest in VTK.
    arrays.AddArray(_array(values.ravel(order="F"), volume.name or "density"))
    arrays.SetActiveScalars(volume.name or "density")
    for name, field in fields.items():
        field = np.asarray(field)
        flat = field.ravel(order="F") if field.ndim == 3 else np.moveaxis(field, 3, 0).reshape(3, -1, order="F").T
        arrays.AddArray(_array(flat, name))
    return made


def to_vtk(
    data: Any,
    *,
    voxel_size: Optional[float] = None,
    like: Any = None,
) -> Any:
    """A model or a volume as a data set of VTK, with copies of its arrays.

    data        Gaussians, a Volume or Levels
    voxel_size  voxelises Gaussians: edge of a voxel, world units
    like        voxelises Gaussians on the lattice of a Volume, or of the finest of Levels

    Returns vtkPolyData for Gaussians: points at their means, arrays density, scale (standard deviations), rotation (quaternions
    w, x, y, z), mass, and the fields (NAME_value where a field has one of these names). With voxel_size or like, and for a Volume,
    vtkImageData: points at the centres of the voxels, with the density and the fields. For Levels vtkMultiBlockDataSet, an image
    of each level. Needs the package vtk.

    >>> import vtkmodules
    >>> model = vog.convert(vog.sample_cloud(64), block=8)
    >>> vog.to_vtk(model).GetNumberOfPoints() == len(model)
    True
    """
    need("vtkmodules", "vog.to_vtk")
    if isinstance(data, _vog.Gaussians):
        if voxel_size is None and like is None:
            return _points(data)
        # The field that is the measure itself is the volume's own.
        if all(field.is_measure for field in data.fields.values()):
            return _image(_vog.voxelize(data, voxel_size=voxel_size, like=like), {})
        volume, fields = _vog.voxelize(data, voxel_size=voxel_size, like=like, fields=True)
        return _image(volume, fields)
    if not isinstance(data, (_vog.Volume, _vog.Levels)):
        raise TypeError(f"to_vtk: got {described(data)}, expected Gaussians, a Volume or Levels")
    if voxel_size is not None or like is not None:
        raise _vog.Error("to_vtk: voxel_size and like work only with Gaussians; a Volume has its own lattice")
    if isinstance(data, _vog.Volume):
        return _image(data, {})
    blocks = need("vtkmodules.vtkCommonDataModel", "to_vtk").vtkMultiBlockDataSet()
    for n in range(len(data)):
        blocks.SetBlock(n, _image(data[n], {}))
    return blocks


def to_pyvista(
    data: Any,
    *,
    voxel_size: Optional[float] = None,
    like: Any = None,
) -> Any:
    """Like to_vtk, but returns a pyvista.PolyData or pyvista.ImageData, for .plot() and filters. Needs the package pyvista.

    data, voxel_size, like  as in to_vtk

    >>> import pyvista
    >>> vog.to_pyvista(vog.sample_cloud(64)).array_names
    ['density']
    """
    pyvista = need("pyvista", "vog.to_pyvista")
    return pyvista.wrap(to_vtk(data, voxel_size=voxel_size, like=like))
