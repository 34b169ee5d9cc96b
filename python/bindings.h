// bindings.h: shared declarations of the Python module. Bindings check types and shapes of
// arguments and call the library; they compute nothing.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vog/image.h"
#include "vog/linear.h"
#include "vog/progress.h"
#include "vog/shade.h"

/// Vec3d from any sequence of three numbers: a tuple, a list, a NumPy array.
template <>
struct pybind11::detail::type_caster<vog::Vec3d> {
    PYBIND11_TYPE_CASTER(vog::Vec3d, const_name("tuple[float, float, float]"));
    bool load(handle from, bool) {
        if (!PySequence_Check(from.ptr()) || PyUnicode_Check(from.ptr())) return false;
        const auto items = reinterpret_borrow<sequence>(from);
        if (items.size() != 3) return false;
        for (int axis = 0; axis < 3; ++axis) {
            const object item = items[static_cast<std::size_t>(axis)];
            value[axis] = PyFloat_AsDouble(item.ptr());
            if (PyErr_Occurred()) return PyErr_Clear(), false;
        }
        return true;
    }
    static handle cast(const vog::Vec3d& v, return_value_policy, handle) {
        return make_tuple(v.x, v.y, v.z).release();
    }
};

namespace vog::python {

namespace py = pybind11;

void bind_volume(py::module_& m);
void bind_points(py::module_& m);
void bind_cells(py::module_& m);
void bind_fields(py::module_& m);
void bind_gaussians(py::module_& m);
void bind_sample(py::module_& m);
void bind_camera(py::module_& m);
void bind_shade(py::module_& m);
void bind_image(py::module_& m);
void bind_convert(py::module_& m);
void bind_picture(py::module_& m);
void bind_compare(py::module_& m);
void bind_exchange(py::module_& m);
void bind_voxelize(py::module_& m);
void bind_evaluate(py::module_& m);
void bind_web(py::module_& m);

/// Whether the caller is on Python's main thread, where signals are handled.
bool on_main_thread();
/// Runs Python's signal handlers. throws the exception that a handler raises
void run_signal_handlers();

/// Calls work() without the interpreter lock, so that other Python threads run meanwhile. On the
/// main thread, Ctrl-C interrupts the call.
template <class Work>
auto unlocked(const Work& work) {
    const bool interruptible = on_main_thread();
    const py::gil_scoped_release release;
    constexpr double kPeriodMs = 50;
    std::optional<InterruptCheck> check;
    if (interruptible) check.emplace(run_signal_handlers, kPeriodMs);
    return work();
}

/// Progress callback that calls a Python callable with the finished fraction; None: no callback.
/// The caller keeps the callable alive.
Progress progress_of(const py::object& callable);

/// Issues a Python UserWarning for each text.
void warn(const std::vector<std::string>& texts);

/// Short text of any object, for messages: its type, of arrays and containers the shape, never the content.
std::string described(const py::handle& object);

/// Converts a Python object. throws TypeError: "NAME: got ..., expected ..."
template <class T>
T cast_to(const py::handle& object, const std::string& name, const std::string& expected) {
    try {
        return object.cast<T>();
    } catch (const py::cast_error&) {
        throw py::type_error(name + ": got " + described(object) + ", expected " + expected);
    }
}

/// A number with six significant digits.
std::string short_text(double number);

/// Width and height in pixels, from 512 or (640, 480). throws vog::Error for other objects
std::pair<int, int> size_of(const py::object& size);
/// A number; none for "auto". throws vog::Error for other objects
std::optional<double> extinction_of(const py::object& extinction);
/// Transfer function from a TransferFunction, a name, a JSON file, a Matplotlib colour map, or
/// colours [N, 3 or 4]. throws TypeError for other objects
TransferFunction transfer_function_of(const py::object& tf);

/// Colour from (r, g, b) or (r, g, b, a) in [0, 1], or a name.
Rgba background_of(const py::object& background);

/// A shaded image with its 8-bit values for display.
struct Bitmap {
    Image image;
    bool with_alpha = false;
    std::vector<std::uint8_t> bytes;  ///< [height, width, 3 or 4]

    explicit Bitmap(Image shaded);
};

}  // namespace vog::python
