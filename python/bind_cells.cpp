// bind_cells.cpp: Cells: meshes of cells of any shape from arrays.
#include <limits>
#include <memory>
#include <utility>

#include "arrays.h"
#include "vog/cells.h"
#include "vog/error.h"

namespace vog::python {

namespace {

/// Values [N], or [N, 3], of points or cells, told apart by their number.
CellValues values_of(const py::handle& given, const std::string& name, const Cells& cells) {
    CellValues values{name};
    std::string at;
    py::object array = py::reinterpret_borrow<py::object>(given);
    if (py::isinstance<py::dict>(given)) {
        const auto parts = given.cast<py::dict>();
        if (!parts.contains("value")) throw Error("cells: " + name + ": value: missing");
        array = parts["value"];
        if (parts.contains("unit"))
            values.unit = cast_to<std::string>(parts["unit"], name + ": unit", "a text");
        if (parts.contains("at")) at = cast_to<std::string>(parts["at"], name + ": at", "a text");
    }
    const py::array numbers = numbers_of(array, name);
    const auto size = static_cast<std::size_t>(numbers.ndim() ? numbers.shape(0) : 0);
    if (size != cells.points.size() && size != cells.size())
        throw Error("cells: " + name + ": shape " + shape_text(numbers) + ", expected " +
                    std::to_string(cells.points.size()) + " values of points or " +
                    std::to_string(cells.size()) + " of cells");
    values.at_points = size == cells.points.size() && at != "cells";
    if (numbers.ndim() == 1) {
        const py::array_t<float> row = row_of<float>(numbers, name);
        values.component.emplace_back(row.data(), row.data() + row.size());
        return values;
    }
    const py::array_t<float> rows = rows_of<float>(numbers, name, 3);
    for (py::ssize_t c = 0; c < 3; ++c) {
        BigVector<float>& component = values.component.emplace_back();
        component.reserve(size);
        for (py::ssize_t n = 0; n < rows.shape(0); ++n) component.push_back(rows.at(n, c));
    }
    return values;
}

/// Integers of an array [N], in any integer dtype.
template <class Integer>
BigVector<Integer> integers_of(const py::handle& given, const std::string& name) {
    const py::array numbers = numbers_of(given, name);
    if (numbers.ndim() != 1 || (numbers.dtype().kind() != 'i' && numbers.dtype().kind() != 'u'))
        throw Error(name + ": shape " + shape_text(numbers) + ", expected (N,) whole numbers");
    const auto all = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(numbers);
    BigVector<Integer> integers;
    integers.reserve(static_cast<std::size_t>(all.size()));
    for (py::ssize_t n = 0; n < all.size(); ++n) {
        const std::int64_t value = all.at(n);
        if (value < 0 || static_cast<std::uint64_t>(value) > std::numeric_limits<Integer>::max())
            throw Error(name + ": " + std::to_string(value) + " at " + std::to_string(n) +
                        ", expected 0 to " + std::to_string(std::numeric_limits<Integer>::max()));
        integers.push_back(static_cast<Integer>(value));
    }
    return integers;
}

std::shared_ptr<Cells> cells_from(const py::object& points, const py::object& corners,
                                  const py::object& types, const py::object& density,
                                  const py::object& ends, const py::dict& fields, double thickness,
                                  const std::string& name, const std::string& source) {
    auto cells = std::make_shared<Cells>();
    cells->source = source;
    cells->points = vector_of<Vec3d, double>(points, "points");
    cells->type = integers_of<std::uint8_t>(types, "types");
    cells->corner = integers_of<std::uint32_t>(corners, "corners");
    if (!ends.is_none()) {
        cells->end = integers_of<std::uint64_t>(ends, "ends");
    } else {
        std::uint64_t end = 0;
        for (const int type : cells->type) {
            if (corner_count(type) == 0)
                throw Error("cells: type " + std::to_string(type) +
                            ", expected 5, 8, 9, 10, 11, 12, 13 or 14, or ends= beside others");
            cells->end.push_back(end += static_cast<std::uint64_t>(corner_count(type)));
        }
    }
    cells->thickness = thickness;
    cells->density = values_of(density, name, *cells);
    cells->units.density = cells->density.unit;
    for (const auto& [key, field] : fields)
        cells->fields.push_back(
            values_of(field, cast_to<std::string>(key, "fields", "names"), *cells));
    validate(*cells);
    return cells;
}

/// Values as the constructor takes them.
py::dict given_of(const CellValues& values) {
    py::dict given;
    const std::size_t count = values.component.size(), size = values.component.front().size();
    py::array_t<float> array(count == 1 ? std::vector{size} : std::vector{size, count});
    for (std::size_t c = 0; c < count; ++c)
        for (std::size_t n = 0; n < size; ++n)
            array.mutable_data()[n * count + c] = values.component[c][n];
    given["value"] = array, given["unit"] = values.unit;
    given["at"] = values.at_points ? "points" : "cells";
    return given;
}
py::tuple state_of_cells(const Cells& self) {
    py::dict fields;
    for (const CellValues& field : self.fields) fields[py::str(field.name)] = given_of(field);
    const auto array = [](const auto& numbers) {
        using Number = std::remove_cvref_t<decltype(numbers[0])>;
        return py::array_t<Number>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
    };
    const py::array_t<double> points({self.points.size(), std::size_t{3}},
                                     reinterpret_cast<const double*>(self.points.data()));
    return py::make_tuple(points, array(self.corner), array(self.type), given_of(self.density),
                          array(self.end), fields, self.thickness, self.density.name, self.source,
                          self.units.length, self.units.density);
}
std::shared_ptr<Cells> cells_of(const py::tuple& s) {
    auto cells = cells_from(s[0], s[1], s[2], s[3], s[4], s[5], s[6].cast<double>(),
                            s[7].cast<std::string>(), s[8].cast<std::string>());
    cells->units = {s[9].cast<std::string>(), s[10].cast<std::string>()};
    return cells;
}

}  // namespace

void bind_cells(py::module_& m) {
    py::class_<Cells, std::shared_ptr<Cells>>(
        m, "Cells",
        R"(Mesh of cells of any shape: tetrahedra, hexahedra, wedges, pyramids, thin shells.

points     [N, 3] world units
corners    [K] numbers of points, those of one cell after those of another, in VTK's order
types      [M] of VTK: 5 triangle, 8 pixel, 9 quad, 10 tetrahedron, 11 voxel, 12 hexahedron, 13 wedge, 14 pyramid
density    [N] values at points, linear between them, or [M] constant in each cell; >= 0, per world unit
ends       [M] end of each cell in corners; default: by the types
fields     {name: values}, at points or in cells like the density, of any sign; [N, 3] or [M, 3] for vectors. {"value": values, "unit": "K"}
           states the unit; add "at": "cells" or "points" where there are as many cells as points
thickness  of triangles, pixels and quads, world units; 0 leaves them out
name       of the density

vog.convert makes Gaussians of them, without a grid between. Cells that are inverted, flat or not finite are counted in a warning.

>>> cells = vog.Cells(np.vstack([np.zeros(3), np.eye(3)]), [0, 1, 2, 3], [10], [6.0])
>>> round(vog.convert(cells, budget=1).mass, 6)
1.0)")
        .def(py::init(&cells_from), py::arg("points"), py::arg("corners"), py::arg("types"),
             py::arg("density"), py::kw_only(), py::arg("ends") = py::none(),
             py::arg("fields") = py::dict(), py::arg("thickness") = 0.0,
             py::arg("name") = "density", py::arg("source") = "")
        .def_property_readonly(
            "box", [](const Cells& self) { return box_array(bounds(self)); },
            "[2, 3] float64: lower and upper corner in world space.")
        .def_property(
            "_units",
            [](const Cells& self) { return py::make_tuple(self.units.length, self.units.density); },
            [](Cells& self, const std::pair<std::string, std::string>& units) {
                self.units = {units.first, units.second};
            })
        .def(py::pickle(&state_of_cells, &cells_of))
        .def("__len__", &Cells::size)
        .def("__repr__", [](const Cells& self) {
            std::string names = self.density.name;
            for (const CellValues& field : self.fields) names += ", " + field.name;
            return "<vog.Cells: " + std::to_string(self.size()) + " cells of " +
                   std::to_string(self.points.size()) + " points, " + names + ">";
        });
}

}  // namespace vog::python
