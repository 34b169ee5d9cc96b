// data.h: dispatch of Python arguments that accept several kinds of data.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bindings.h"
#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/points.h"
#include "vog/volume.h"

namespace vog::python {

/// Levels from a Levels object or a sequence of Volumes; null for other objects.
std::shared_ptr<const Levels> levels_of(const py::object& data);

/// Direction of an argument `up`: (x, y, z), or the name of an axis: "z", "-y".
/// throws  vog::Error for another name
Vec3d direction_of(const py::object& up);

/// What views of data frame. call  name of the Python function, for errors
Subject subject_to_view(const py::object& data, const std::string& call);

/// Throws TypeError: "convert: got int, expected a Volume, ..."
[[noreturn]] void refuse_data(const py::object& data, const std::string& call,
                              const std::string& expected);

}  // namespace vog::python
