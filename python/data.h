// data.h: what a Python object holds, where several kinds are taken.
#pragma once

#include <memory>
#include <string>

#include "bindings.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/points.h"
#include "vog/volume.h"

namespace vog::python {

/// A Levels object or a sequence of Volumes; null for anything else.
std::shared_ptr<const Levels> levels_of(const py::object& data);

/// What views of anything look at.
Box box_to_view(const py::object& data, const std::string& call);

/// throws TypeError: "convert: got int, expected a Volume, ..."
[[noreturn]] void refuse_data(const py::object& data, const std::string& call,
                              const std::string& expected);

}  // namespace vog::python
