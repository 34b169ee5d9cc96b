// bind_points.cpp: Points: particles from files and arrays, with array views.
#include <memory>
#include <variant>

#include "arrays.h"
#include "vog/error.h"
#include "vog/points.h"

namespace vog::python {

namespace {

std::shared_ptr<Points> from_numpy(const py::object& position, const py::object& velocity,
                                   const py::dict& attributes, const std::string& source) {
    auto points = std::make_shared<Points>();
    points->source = source;
    points->position = vector_of<Vec3d, double>(position, "position");
    if (!velocity.is_none()) points->velocity = vector_of<Vec3f, float>(velocity, "velocity");
    for (const auto& [name, values] : attributes) {
        const auto text = py::str(name).cast<std::string>();
        const py::array_t<float> row = row_of<float>(values, "attribute '" + text + "'");
        points->attributes.push_back({text, {row.data(), row.data() + row.size()}});
    }
    validate(*points);
    return points;
}

py::dict attributes_of(const py::object& self) {
    py::dict all;
    for (PointAttribute& attribute : self.cast<Points&>().attributes)
        all[py::str(attribute.name)] = view_of<float>(attribute.value, self);
    return all;
}

py::object velocity_of(const py::object& self) {
    auto& points = self.cast<Points&>();
    if (points.velocity.empty()) return py::none();
    return view_of<float>(points.velocity, self);
}

}  // namespace

void bind_points(py::module_& m) {
    py::class_<Points, std::shared_ptr<Points>>(
        m, "Points",
        R"(Particles in world space, with optional velocities and scalar attributes.

The arrays are views of the particles' memory: writing to them changes the particles.)")
        .def_static(
            "load",
            [](const std::variant<std::filesystem::path, std::vector<std::filesystem::path>>& file,
               const std::vector<std::string>& columns, const std::string& grid,
               bool skip_nonfinite) {
                std::vector<std::filesystem::path> files;
                if (const auto* several = std::get_if<1>(&file))
                    files = *several;
                else
                    files.push_back(std::get<0>(file));
                if (files.empty()) throw Error("no files, expected one or more");
                std::vector<std::string> notes;
                auto points = std::make_shared<Points>(unlocked([&] {
                    return read_points(files, {columns, grid, {skip_nonfinite}}, &notes);
                }));
                if (!notes.empty()) warn(notes);
                return points;
            },
            py::arg("file"), py::kw_only(), py::arg("columns") = std::vector<std::string>{},
            py::arg("grid") = "", py::arg("skip_nonfinite") = false,
            R"(Reads particles from text (.xyz, .extxyz, .pts, .asc, .txt, .dat, .csv, .ecsv, .tsv), a PointDataGrid (.vdb) or a snapshot (.hdf5). Returns Points.

file     a path, or a list of paths that are read as one: the parts of a snapshot
columns  text files: the columns of x, y, z, or of x, y, z, vx, vy, vz: names, or numbers from 1 as text.
         Default: columns of these names, else the first ones. Other numeric columns become attributes
grid     .vdb files: name of the grid; snapshots: type of the particles, 'PartType0'; default: the only one, else gas, else the largest
skip_nonfinite  leaves particles with NaN or infinite numbers out, which are an error otherwise

Raises vog.Error for an unreadable file, with the line.)")
        .def_static("from_numpy", &from_numpy, py::arg("position"),
                    py::arg("velocity") = py::none(), py::arg("attributes") = py::dict(),
                    py::kw_only(), py::arg("source") = "",
                    R"(Creates particles from arrays, which are copied.

position    [N, 3] world units, any real dtype
velocity    [N, 3], or None
attributes  {name: [N]}, such as {'mass': m}
source      name for messages and models

>>> points = vog.Points.from_numpy(np.eye(3), attributes={"mass": [1, 2, 3]})
>>> len(points), points.value_names
(3, ['count', 'mass']))")
        .def(
            "save",
            [](const Points& self, const std::filesystem::path& file) {
                unlocked([&] { write_points(file, self); });
            },
            py::arg("file"), "Writes text (.xyz, .csv, .tsv) or a PointDataGrid (.vdb).")
        .def_property_readonly(
            "position",
            [](const py::object& self) {
                return view_of<double>(self.cast<Points&>().position, self);
            },
            "[N, 3] float64 view: positions, world units.")
        .def_property_readonly("velocity", &velocity_of,
                               "[N, 3] float32 view: velocities, or None.")
        .def_property_readonly("attributes", &attributes_of,
                               "{name: [N] float32 view}: scalar attributes.")
        .def_readwrite("source", &Points::source,
                       "Source of the particles, for messages and models.")
        .def_property_readonly(
            "value_names", [](const Points& self) { return point_value_names(self); },
            "Valid values of convert(points, value=...): 'count', 'speed', names of attributes.")
        .def_property_readonly(
            "box", [](const Points& self) { return box_array(bounds(self)); },
            "[2, 3] float64: lower and upper corner in world space.")
        .def_property(
            "_units",
            [](const Points& self) { return py::make_tuple(self.length_unit, std::string()); },
            [](Points& self, const std::pair<std::string, std::string>& units) {
                self.length_unit = units.first;
            })
        .def("__len__", &Points::size)
        .def("__repr__",
             [](const Points& self) {
                 std::string names;
                 for (const PointAttribute& a : self.attributes) names += ", " + a.name;
                 return "<vog.Points: " + std::to_string(self.size()) + " particles" +
                        (self.velocity.empty() ? "" : ", velocity") + names + ">";
             })
        .def(py::pickle(
            [](const py::object& self) {
                return py::make_tuple(self.attr("position"), self.attr("velocity"),
                                      self.attr("attributes"), self.attr("source"));
            },
            [](const py::tuple& state) {
                return from_numpy(state[0], state[1], state[2].cast<py::dict>(),
                                  state[3].cast<std::string>());
            }));
}

}  // namespace vog::python
