// arrays.cpp: conversion from and to NumPy arrays.
#include "arrays.h"

#include <algorithm>

#include "vog/error.h"

namespace vog::python {

std::string shape_text(const py::array& array) {
    return py::str(array.attr("shape")).cast<std::string>();
}

py::array numbers_of(const py::handle& data, const std::string& name) {
    const py::module_ numpy = py::module_::import("numpy");
    if (py::isinstance(data, numpy.attr("ma").attr("MaskedArray")))
        throw Error(
            name +
            ": masked array, expected a plain array (array.filled(0), and active= for voxels)");
    const py::array array = py::array::ensure(data);
    if (!array) {
        PyErr_Clear();
        throw Error(name +
                    ": cannot be converted to a NumPy array, expected an array of real numbers");
    }
    const char kind = array.dtype().kind();
    if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b')
        throw Error(name + ": dtype " + py::str(array.dtype()).cast<std::string>() +
                    ", expected real numbers");
    return array;
}

namespace {

/// The array as contiguous scalars; a copy only if it is not that already.
template <class Scalar>
py::array_t<Scalar> contiguous(const py::array& array, const std::string& name) {
    auto result = py::array_t<Scalar, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!result) {
        PyErr_Clear();
        throw Error(name + ": cannot be converted to numbers");
    }
    return result;
}

}  // namespace

template <class Scalar>
py::array_t<Scalar> rows_of(const py::handle& data, const std::string& name, int columns) {
    const py::array array = numbers_of(data, name);
    if (array.ndim() != 2 || array.shape(1) != columns)
        throw Error(name + ": shape " + shape_text(array) + ", expected (N, " +
                    std::to_string(columns) + ")");
    return contiguous<Scalar>(array, name);
}

template <class Scalar>
py::array_t<Scalar> row_of(const py::handle& data, const std::string& name) {
    const py::array array = numbers_of(data, name);
    if (array.ndim() != 1) throw Error(name + ": shape " + shape_text(array) + ", expected (N,)");
    return contiguous<Scalar>(array, name);
}

template <class Scalar, class Item>
void assign(BigVector<Item>& items, const py::handle& data, const std::string& name) {
    constexpr int kColumns = sizeof(Item) / sizeof(Scalar);
    py::array_t<Scalar> from;
    if constexpr (kColumns == 1)
        from = row_of<Scalar>(data, name);
    else
        from = rows_of<Scalar>(data, name, kColumns);
    if (static_cast<std::size_t>(from.shape(0)) != items.size())
        throw Error(name + ": " + std::to_string(from.shape(0)) + " rows, expected " +
                    std::to_string(items.size()));
    // In place: views that Python holds stay where they are. They may be name is assigned.
    const auto* first = reinterpret_cast<const Item*>(from.data());
    if (first != items.data()) std::copy(first, first + items.size(), items.begin());
}

template py::array_t<float> rows_of(const py::handle&, const std::string&, int);
template py::array_t<double> rows_of(const py::handle&, const std::string&, int);
template py::array_t<float> row_of(const py::handle&, const std::string&);
template py::array_t<double> row_of(const py::handle&, const std::string&);
template void assign<float>(BigVector<Vec3f>&, const py::handle&, const std::string&);
template void assign<double>(BigVector<Vec3d>&, const py::handle&, const std::string&);
template void assign<float>(BigVector<Quat>&, const py::handle&, const std::string&);
template void assign<float>(BigVector<float>&, const py::handle&, const std::string&);

py::object box_array(const Box& box) {
    if (box.empty()) return py::none();
    py::array_t<double> corners({2, 3});
    auto at = corners.mutable_unchecked<2>();
    for (int axis = 0; axis < 3; ++axis) {
        at(0, axis) = box.lower[axis];
        at(1, axis) = box.upper[axis];
    }
    return corners;
}

Box box_of(const py::object& corners) {
    if (corners.is_none()) return {};
    const py::array_t<double> rows = rows_of<double>(corners, "box", 3);
    if (rows.shape(0) != 2)
        throw Error("box: shape " + shape_text(rows) + ", expected (2, 3): lower and upper corner");
    const auto at = rows.unchecked<2>();
    return {{at(0, 0), at(0, 1), at(0, 2)}, {at(1, 0), at(1, 1), at(1, 2)}};
}

}  // namespace vog::python
