// volume_look.h: light and clips of pictures, and lists of numbers, from Python.
#pragma once

#include <string>
#include <vector>

#include "bindings.h"
#include "vog/volume_picture.h"

namespace vog::python {

/// Numbers of a list or an array of any shape.
/// what    "render_volume: window", for messages
/// throws  vog::Error for another count
std::vector<double> numbers_in(const py::object& list, std::size_t count, const std::string& what);

/// The rows of a list or an array.
/// throws  TypeError for what has none
py::iterable rows_in(const py::object& list, const std::string& what);

/// light        None, "head" or a direction
/// clip         None or a box, [2, 3]
/// clip_planes  None or rows (nx, ny, nz, d)
/// function     for messages
VolumeLook look_of(const std::string& function, const py::object& light, const py::object& clip,
                   const py::object& clip_planes = py::none());

}  // namespace vog::python
