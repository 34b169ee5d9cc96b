// volume_look.h: transfer functions of values, light and clips of pictures, and lists of numbers, from Python.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bindings.h"
#include "vog/picture.h"
#include "vog/volume_picture.h"

namespace vog::python {

/// Numbers of a list or an array of any shape.
/// what    "render_volume: window", for messages
/// throws  vog::Error for another count
std::vector<double> numbers_in(const py::object& list, std::size_t count, const std::string& what);

/// The rows of a list or an array.
/// throws  TypeError for what has none
py::iterable rows_in(const py::object& list, const std::string& what);

/// Keyword arguments that choose a transfer function of values.
struct ValueArguments {
    const char* call;  ///< name of the Python function, for errors
    const char* range_name;
    const py::object &tf, &value_range, &unit_distance;
    py::object window = py::none(), bands = py::none();
    std::optional<bool> log{};
};
/// throws  vog::Error for numbers out of range, and for tf and value_range beside a window or bands, which replace them
TransferRequest transfer_request(const ValueArguments& a);

/// light        None, "head" or a direction
/// clip         None or a box, [2, 3]
/// clip_planes  None or rows (nx, ny, nz, d)
/// function     for messages
VolumeLook look_of(const std::string& function, const py::object& light, const py::object& clip,
                   const py::object& clip_planes = py::none());

}  // namespace vog::python
