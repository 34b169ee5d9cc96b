// arrays.h: NumPy arrays in and out. Errors of shape and kind are vog.Error in one line:
// "position: shape (5, 2), expected (N, 3)".
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include "bindings.h"
#include "vog/memory.h"

namespace vog::python {

/// Any array-like of real numbers, in its own type; refuses text, objects, complex numbers and
/// masked arrays, whose mask would be lost.
py::array numbers_of(const py::handle& data, const std::string& what);
/// [N, columns] of float or double, contiguous; copied only where it is anything else.
template <class Scalar>
py::array_t<Scalar> rows_of(const py::handle& data, const std::string& what, int columns);
/// [N], contiguous.
template <class Scalar>
py::array_t<Scalar> row_of(const py::handle& data, const std::string& what);

/// A copy of [N, sizeof(Item) / sizeof(Scalar)] as the library holds it.
template <class Item, class Scalar>
BigVector<Item> vector_of(const py::handle& data, const std::string& what) {
    constexpr int kColumns = sizeof(Item) / sizeof(Scalar);
    const py::array_t<Scalar> rows = rows_of<Scalar>(data, what, kColumns);
    const auto* first = reinterpret_cast<const Item*>(rows.data());
    return {first, first + rows.shape(0)};
}

/// [N, columns] in the memory of `owner`, which it keeps alive.
template <class Scalar, class Item>
py::array view_of(BigVector<Item>& items, const py::object& owner) {
    constexpr py::ssize_t kColumns = sizeof(Item) / sizeof(Scalar);
    const auto n = static_cast<py::ssize_t>(items.size());
    auto* data = reinterpret_cast<Scalar*>(items.data());
    if (kColumns == 1) return py::array_t<Scalar>(n, data, owner);
    return py::array_t<Scalar>({n, kColumns}, data, owner);
}

/// Writes data of the same shape over items. throws vog::Error for another number of rows
template <class Scalar, class Item>
void assign(BigVector<Item>& items, const py::handle& data, const std::string& what);

/// "(3, 4)".
std::string shape_text(const py::array& array);
/// [2, 3]: lower and upper corner; None for an empty box.
py::object box_array(const Box& box);
/// From [2, 3]; None: empty.
Box box_of(const py::object& corners);

}  // namespace vog::python
