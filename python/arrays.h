// arrays.h: conversion from and to NumPy arrays. Wrong shapes and dtypes raise vog.Error:
// "position: shape (5, 2), expected (N, 3)".
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include "bindings.h"
#include "vog/memory.h"

namespace vog::python {

/// An array-like of real numbers as an array of its own dtype.
/// name    of the argument, for errors
/// throws  vog::Error for text, objects, complex numbers, and masked arrays, whose mask would be
///         lost
py::array numbers_of(const py::handle& data, const std::string& name);
/// [N, columns] of float or double, contiguous; copied only if it is not that already.
template <class Scalar>
py::array_t<Scalar> rows_of(const py::handle& data, const std::string& name, int columns);
/// [N] of float or double, contiguous; copied only if it is not that already.
template <class Scalar>
py::array_t<Scalar> row_of(const py::handle& data, const std::string& name);

/// Copy of an array [N, sizeof(Item) / sizeof(Scalar)] as items of the library.
template <class Item, class Scalar>
BigVector<Item> vector_of(const py::handle& data, const std::string& name) {
    constexpr int kColumns = sizeof(Item) / sizeof(Scalar);
    const py::array_t<Scalar> rows = rows_of<Scalar>(data, name, kColumns);
    const auto* first = reinterpret_cast<const Item*>(rows.data());
    return {first, first + rows.shape(0)};
}

/// View [N, columns] of the items, in the memory of `owner`, which the view keeps alive.
template <class Scalar, class Item>
py::array view_of(BigVector<Item>& items, const py::object& owner) {
    constexpr py::ssize_t kColumns = sizeof(Item) / sizeof(Scalar);
    const auto n = static_cast<py::ssize_t>(items.size());
    auto* data = reinterpret_cast<Scalar*>(items.data());
    if (kColumns == 1) return py::array_t<Scalar>(n, data, owner);
    return py::array_t<Scalar>({n, kColumns}, data, owner);
}

/// Overwrites items with data of the same shape. throws vog::Error for another number of rows
template <class Scalar, class Item>
void assign(BigVector<Item>& items, const py::handle& data, const std::string& name);

/// Shape as text: "(3, 4)".
std::string shape_text(const py::array& array);
/// Lower and upper corner as an array [2, 3]; None for an empty box.
py::object box_array(const Box& box);
/// Box of an array [2, 3]; None: empty.
Box box_of(const py::object& corners);

}  // namespace vog::python
