// bind_field_maps.cpp: FieldMaps: maps of a field as NumPy arrays, files and pictures.
#include <algorithm>

#include "arrays.h"
#include "shown_maps.h"
#include "vog/error.h"
#include "vog/picture.h"

namespace vog::python {

namespace {

/// View [height, width] of one of the maps.
py::array view(const py::object& self, const std::vector<float>& map) {
    const FieldMaps& maps = self.cast<const ShownMaps&>().maps;
    return py::array_t<float>({maps.height, maps.width}, map.data(), self);
}
template <std::vector<float> FieldMaps::*kMap>
py::array map_of(const py::object& self) {
    return view(self, self.cast<const ShownMaps&>().maps.*kMap);
}

ScaleFit fit_named(const std::string& scale) {
    if (scale == "auto") return ScaleFit::automatic;
    if (scale == "linear") return ScaleFit::linear;
    if (scale == "log") return ScaleFit::log;
    if (scale == "symmetric") return ScaleFit::symmetric;
    throw Error("plot: scale '" + scale + "', expected 'auto', 'linear', 'log' or 'symmetric'");
}

Picture plotted(const ShownMaps& self, const py::object& tf, const py::object& range,
                const std::string& scale, double least_column, const std::string& units,
                const std::string& title, bool color_bar, const py::object& background) {
    const Show show = show_named(self.show);
    const TransferFunction map =
        tf.is_none() ? named_transfer_function(default_map(show)) : transfer_function_of(tf);
    const ShadeOptions options{background_of(background), false};
    const ScaleFit fit = fit_named(scale);
    if (!(least_column >= 0 && least_column <= 1))
        throw Error("plot: least_column " + short_text(least_column) + ", expected 0 to 1");
    std::optional<ColorScale> fixed;
    if (!range.is_none()) {
        const auto [low, high] =
            cast_to<std::pair<double, double>>(range, "range", "two numbers (low, high)");
        fixed = {fit == ScaleFit::log ? ColorScale::Kind::log : ColorScale::Kind::linear, low,
                 high};
    }
    return unlocked([&] {
        const ColoredMap colored = colored_map(self.maps, show, fit, fixed, least_column);
        const Image image = shade_map(colored.shown, map, colored.scale, options);
        const std::string unit = !units.empty() ? units : self.show == "column" ? "" : self.unit;
        const std::string label = quantity_label(show, self.name, unit);
        if (!color_bar && title.empty()) return Picture(image);
        return Picture(
            annotated(image, map, colored.scale, {title, label, color_bar}, options.background));
    });
}

void save(const ShownMaps& self, const std::filesystem::path& file) {
    unlocked([&] {
        const FieldMaps& maps = self.maps;
        if (file.extension() == ".exr") {
            const NamedValues channels[] = {
                {"column", maps.column}, {"mean", maps.mean}, {"deviation", maps.deviation}};
            write_channels(file, maps.width, maps.height, channels);
        } else {
            write_map(file, {maps.width, maps.height, self.shown()});
        }
    });
}

std::vector<float> row(const py::handle& array) {
    const py::array_t<float, py::array::c_style | py::array::forcecast> values(
        numbers_of(array, "pickle of FieldMaps"));
    return {values.data(), values.data() + values.size()};
}

}  // namespace

void bind_field_maps(py::module_& m) {
    py::class_<ShownMaps>(
        m, "FieldMaps", py::buffer_protocol(),
        R"(Maps of a field, as render(show='column', 'mean' or 'deviation') returns them.

Rows from the top; mean and deviation are NaN where the ray meets no density. to_numpy() is the shown map;
column, mean and deviation are all three. Notebooks display it with a colour bar.)")
        .def_buffer([](ShownMaps& self) {
            const auto width = static_cast<std::size_t>(self.maps.width);
            return py::buffer_info(const_cast<float*>(self.shown().data()),
                                   {static_cast<std::size_t>(self.maps.height), width},
                                   {sizeof(float) * width, sizeof(float)});
        })
        .def(
            "to_numpy",
            [](const py::object& self) {
                return view(self, self.cast<const ShownMaps&>().shown());
            },
            "[height, width] float32: the shown map, a view.")
        .def_property_readonly("column", &map_of<&FieldMaps::column>,
                               "[height, width] float32: integral of the density along the ray, "
                               "density times world units.")
        .def_property_readonly("mean", &map_of<&FieldMaps::mean>,
                               "[height, width] float32: mean along the ray, weighted by density.")
        .def_property_readonly("deviation", &map_of<&FieldMaps::deviation>,
                               "[height, width] float32: standard deviation likewise.")
        .def_readonly("show", &ShownMaps::show, "The shown map: 'column', 'mean' or 'deviation'.")
        .def_readonly("name", &ShownMaps::name,
                      "Name of the shown number: 'velocity along the view'.")
        .def_readonly("unit", &ShownMaps::unit, "Unit of the field: 'K'; empty: not known.")
        .def_property_readonly(
            "shape",
            [](const ShownMaps& self) { return py::make_tuple(self.maps.height, self.maps.width); },
            "(height, width) in pixels.")
        .def("save", &save, py::arg("file"),
             "Writes the shown map as .npy, or all three as channels column, mean and deviation of "
             "an .exr.")
        .def(
            "plot", &plotted, py::arg("tf") = py::none(), py::kw_only(),
            py::arg("range") = py::none(), py::arg("scale") = "auto",
            py::arg("least_column") = kLeastColumn, py::arg("units") = "", py::arg("title") = "",
            py::arg("color_bar") = true, py::arg("background") = "black",
            R"(Picture of the shown map with a colour bar. Returns an Image, wider by the bar and higher by the title.

tf            transfer function: a TransferFunction, a name, a JSON file, a Matplotlib map or colours; None: inferno
range         (low, high) values at its ends; None: of column 0 and the largest, or with scale='log' the four decades
              below it; of fields the 1st and the 99th percentile of the pixels whose column is at least a thousandth
              of the largest
scale         'linear', 'log', 'symmetric': the range is centred at 0, for velocities; or 'auto': linear
least_column  share of the largest column below which nothing is shown
units         unit on the colour bar; '': the field's
title         text above the picture
color_bar     False: no colour bar
background    of empty pixels and margins, as in DepthImage.shade())")
        .def("_repr_png_",
             [](const py::object& self) { return self.attr("plot")().attr("_repr_png_")(); })
        .def("__repr__",
             [](const ShownMaps& self) {
                 return "<vog.FieldMaps: " + self.show +
                        (self.name.empty() ? "" : " of " + self.name) + ", " +
                        std::to_string(self.maps.width) + "x" + std::to_string(self.maps.height) +
                        ">";
             })
        .def(py::pickle(
            [](const py::object& self) {
                const auto& maps = self.cast<const ShownMaps&>();
                return py::make_tuple(self.attr("column"), self.attr("mean"),
                                      self.attr("deviation"), maps.show, maps.name, maps.unit);
            },
            [](const py::tuple& state) {
                const auto column = state[0].cast<py::array>();
                return ShownMaps{
                    {static_cast<int>(column.shape(1)), static_cast<int>(column.shape(0)),
                     row(state[0]), row(state[1]), row(state[2])},
                    state[3].cast<std::string>(),
                    state[4].cast<std::string>(),
                    state[5].cast<std::string>()};
            }));
}

}  // namespace vog::python
