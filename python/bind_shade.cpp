// bind_shade.cpp: TransferFunction: names, files, arrays, Matplotlib maps.
#include <algorithm>

#include "arrays.h"
#include "vog/error.h"
#include "vog/shade.h"

namespace vog::python {

namespace {

TransferFunction from_colors(const py::object& colors, const std::string& name) {
    const py::array given = numbers_of(colors, "colors");
    const bool with_alpha = given.ndim() == 2 && given.shape(1) == 4;
    const py::array_t<float> rows = rows_of<float>(given, "colors", with_alpha ? 4 : 3);
    const auto at = rows.unchecked<2>();
    std::vector<Rgba> list;
    for (py::ssize_t i = 0; i < rows.shape(0); ++i)
        list.push_back({at(i, 0), at(i, 1), at(i, 2), with_alpha ? at(i, 3) : 1});
    return sampled_transfer_function(name, list);
}

bool is_colormap(const py::object& object) {
    return PyCallable_Check(object.ptr()) && py::hasattr(object, "N") &&
           py::hasattr(object, "name");
}

/// Transfer function of a Matplotlib map's table, which integer indices read entry by entry.
TransferFunction from_matplotlib(const py::object& map) {
    py::object colormap = map;
    if (py::isinstance<py::str>(map))
        colormap = py::module_::import("matplotlib").attr("colormaps")[map];
    if (!is_colormap(colormap))
        throw py::type_error("from_matplotlib: got " +
                             py::type::of(map).attr("__name__").cast<std::string>() +
                             ", expected a colour map or the name of one");
    const py::object entries = py::module_::import("numpy").attr("arange")(colormap.attr("N"));
    return from_colors(colormap(entries), py::str(colormap.attr("name")).cast<std::string>());
}

py::array_t<float> colors_of(const TransferFunction& tf) {
    py::array_t<float> points({static_cast<py::ssize_t>(tf.color.size()), py::ssize_t{4}});
    auto at = points.mutable_unchecked<2>();
    for (py::ssize_t i = 0; i < points.shape(0); ++i) {
        const ColorPoint& p = tf.color[static_cast<std::size_t>(i)];
        at(i, 0) = p.v, at(i, 1) = p.r, at(i, 2) = p.g, at(i, 3) = p.b;
    }
    return points;
}
py::array_t<float> opacities_of(const TransferFunction& tf) {
    py::array_t<float> points({static_cast<py::ssize_t>(tf.opacity.size()), py::ssize_t{2}});
    auto at = points.mutable_unchecked<2>();
    for (py::ssize_t i = 0; i < points.shape(0); ++i) {
        const OpacityPoint& p = tf.opacity[static_cast<std::size_t>(i)];
        at(i, 0) = p.v, at(i, 1) = p.opacity;
    }
    return points;
}

TransferFunction from_points(const std::string& name, const py::object& color,
                             const py::object& opacity) {
    TransferFunction tf;
    tf.name = name;
    const py::array_t<float> c = rows_of<float>(color, "color", 4);
    const auto at = c.unchecked<2>();
    for (py::ssize_t i = 0; i < c.shape(0); ++i)
        tf.color.push_back({at(i, 0), at(i, 1), at(i, 2), at(i, 3)});
    if (!opacity.is_none()) {
        const py::array_t<float> o = rows_of<float>(opacity, "opacity", 2);
        const auto of = o.unchecked<2>();
        for (py::ssize_t i = 0; i < o.shape(0); ++i) tf.opacity.push_back({of(i, 0), of(i, 1)});
    }
    (void)color_at(tf, 0);  // throws for invalid points
    return tf;
}

/// Colours [..., 4] at v [...].
py::array_t<float> call(const TransferFunction& tf, const py::object& v) {
    const py::array given = numbers_of(v, "v");
    const auto values = py::array_t<float, py::array::c_style | py::array::forcecast>(given);
    std::vector<py::ssize_t> shape(given.shape(), given.shape() + given.ndim());
    shape.push_back(4);
    py::array_t<float> colors(shape);
    auto* out = colors.mutable_data();
    for (py::ssize_t i = 0; i < values.size(); ++i) {
        const Rgba c = color_at(tf, values.data()[i]);
        *out++ = c.r, *out++ = c.g, *out++ = c.b, *out++ = c.a;
    }
    return colors;
}

}  // namespace

TransferFunction transfer_function_of(const py::object& tf) {
    if (py::isinstance<TransferFunction>(tf)) return tf.cast<TransferFunction>();
    if (py::isinstance<py::str>(tf) || py::hasattr(tf, "__fspath__"))
        return load_transfer_function(cast_to<std::filesystem::path>(tf, "tf", "a path").string());
    if (is_colormap(tf)) return from_matplotlib(tf);
    if (py::isinstance<py::array>(tf)) return from_colors(tf, "colors");
    throw py::type_error("tf: got " + py::type::of(tf).attr("__name__").cast<std::string>() +
                         ", expected a TransferFunction, a name, a JSON file, a Matplotlib colour "
                         "map or colours [N, 3 or 4]");
}

void bind_shade(py::module_& m) {
    py::class_<TransferFunction>(
        m, "TransferFunction",
        R"(Transfer function: colour and opacity as functions of V = 1 - exp(-T), the opacity of a ray, in [0, 1].

TransferFunction('inferno')      a built-in map; names() lists them
TransferFunction('map.json')     a JSON file of vog or a ParaView colour map
TransferFunction(cmap)           a Matplotlib colour map
TransferFunction(colors)         [N, 3 or 4] colours in [0, 1] at equal steps of V; alpha is opacity

Parameters called tf accept all of these. tf(v) is the colour [..., 4] at V = v.

>>> ramp = vog.TransferFunction(np.array([[0, 0, 0], [1, 0.5, 0]]))
>>> ramp(0.5)
array([0.5 , 0.25, 0.  , 1.  ], dtype=float32)
>>> "inferno" in vog.TransferFunction.names()
True)")
        .def(py::init(&transfer_function_of), py::arg("tf"))
        .def_static("names", &transfer_function_names, "Names of the built-in transfer functions.")
        .def_static(
            "load", [](const std::filesystem::path& file) { return read_transfer_function(file); },
            py::arg("file"),
            "Reads a JSON file of vog or a ParaView colour map (its first preset).")
        .def_static("from_matplotlib", &from_matplotlib, py::arg("colormap"),
                    "Converts a Matplotlib colour map, given as an object or by name.")
        .def_static(
            "from_colors", &from_colors, py::arg("colors"), py::arg("name") = "colors",
            "Creates one from [N, 3 or 4] colours in [0, 1] at equal steps of V from 0 to 1.")
        .def_static("from_points", &from_points, py::arg("name"), py::arg("color"),
                    py::arg("opacity") = py::none(),
                    R"(Creates a piecewise linear transfer function.

name     for messages and files
color    [N, 4] rows v, r, g, b, sorted by v
opacity  [N, 2] rows v, opacity, sorted by v; None: opaque)")
        .def(
            "save",
            [](const TransferFunction& self, const std::filesystem::path& file) {
                write_transfer_function(file, self);
            },
            py::arg("file"), "Writes a JSON file, for `vog render --tf`.")
        .def_readwrite("name", &TransferFunction::name, "Name, for messages and files.")
        .def_property_readonly("color", &colors_of,
                               "[N, 4] float32 copy: colour points, rows v, r, g, b.")
        .def_property_readonly(
            "opacity", &opacities_of,
            "[N, 2] float32 copy: opacity points, rows v, opacity; [0, 2]: opaque.")
        .def("__call__", &call, py::arg("v"), "Colours [..., 4]: r, g, b, opacity at v in [0, 1].")
        .def("__repr__",
             [](const TransferFunction& self) {
                 return "<vog.TransferFunction '" + self.name +
                        "': " + std::to_string(self.color.size()) + " colours" +
                        (self.opacity.empty() ? ">" : ", with opacity>");
             })
        .def(py::pickle(
            [](const TransferFunction& self) {
                return py::make_tuple(self.name, colors_of(self), opacities_of(self));
            },
            [](const py::tuple& state) {
                return from_points(state[0].cast<std::string>(), state[1], state[2]);
            }));
}

}  // namespace vog::python
