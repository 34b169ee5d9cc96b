"""Script of a Programmable Source of ParaView: the Gaussians of a vog model as points with their arrays.

In ParaView: Sources > Programmable Source, Output Data Set Type vtkPolyData, this text as its script, and in "RequestInformation
Script" nothing. Set FILE below, or the variable VOG_MODEL. ParaView's Python must find vog: start it as

    PYTHONPATH=build/release/python paraview

Colour by density, temperature, ...; Glyphs > Scale Array "scale" draws the sizes. For voxels set VOXEL_SIZE and Output Data Set
Type vtkImageData: ParaView then has volume rendering, slices and contours of the model.
"""
import os

import vog

FILE = os.environ.get("VOG_MODEL", "model.ply")
VOXEL_SIZE = float(os.environ.get("VOG_VOXEL_SIZE", "0"))  # world units; 0: points

model = vog.Gaussians.load(FILE)
data = vog.to_vtk(model, voxel_size=VOXEL_SIZE) if VOXEL_SIZE > 0 else vog.to_vtk(model)
self.GetOutputDataObject(0).ShallowCopy(data)  # noqa: F821  (ParaView's)
