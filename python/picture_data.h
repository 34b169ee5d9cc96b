// picture_data.h: scenes of Python's data for the quantity that a picture shows.
#pragma once

#include "bindings.h"
#include "vog/picture.h"

namespace vog::python {

/// Whether data are Gaussians or Points.
bool is_gaussians(const py::object& data);
/// Triangles of a pair (points, triangles), which isosurface() returns, for a layer; null for other objects.
std::shared_ptr<const Surface> surface_of(const py::object& data);
/// throws  TypeError for data that are not drawn; vog::Error for fields of a model
void require_drawable(const py::object& data, const py::object& fields);

/// Scene of Cells, with all their fields. Warns of cells that are left out.
Scene scene_of_cells(const py::object& data);
/// Scene of Gaussians, a Volume, Levels, a list of Volumes, Cells, Points or a surface, with the field that the request shows.
/// fields   of voxels: {"temperature": array} of a call, or None
/// request  its field becomes the scene's
/// throws   vog::Error for a field that is not there
Scene scene_of_data(const py::object& data, const py::object& fields, PictureRequest& request);

}  // namespace vog::python
