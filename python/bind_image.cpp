// bind_image.cpp: DepthImage and Image: NumPy buffers, files, display in notebooks.
#include <algorithm>
#include <memory>

#include "arrays.h"
#include "vog/error.h"
#include "vog/exposure.h"
#include "vog/image.h"
#include "vog/picture.h"

namespace vog::python {

Bitmap::Bitmap(Image shaded)
    : image(std::move(shaded)), with_alpha(!opaque(image)), bytes(image_bytes(image, with_alpha)) {}

Rgba background_of(const py::object& background) {
    if (py::isinstance<py::str>(background))
        return named_background(background.cast<std::string>());
    const py::array given = numbers_of(background, "background");
    const py::array_t<float> c = row_of<float>(given, "background");
    if (c.size() != 3 && c.size() != 4)
        throw Error("background: shape " + shape_text(given) +
                    ", expected (r, g, b), (r, g, b, a), 'black', 'white' or 'transparent'");
    return {c.at(0), c.at(1), c.at(2), c.size() == 4 ? c.at(3) : 1};
}

namespace {

using Depth = std::shared_ptr<DepthImage>;

std::string extent(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

py::bytes png_of(const Image& image) {
    const std::vector<std::uint8_t> png = unlocked([&] { return png_bytes(image); });
    return {reinterpret_cast<const char*>(png.data()), png.size()};
}

Bitmap shaded(const DepthImage& depth, const py::object& tf, const py::object& background,
              bool blend) {
    const TransferFunction map = transfer_function_of(tf);
    const ShadeOptions options{background_of(background), blend};
    return unlocked([&] { return Bitmap(shade(depth, map, options)); });
}

Bitmap plotted(const DepthImage& depth, const std::string& quantity, const py::object& tf,
               const py::object& range, std::optional<bool> log, const std::string& units,
               const std::string& title, bool color_bar, const py::object& background) {
    if (quantity != "column" && quantity != "T")
        throw Error("plot: quantity '" + quantity + "', expected 'column' or 'T'");
    const bool column = quantity == "column";
    if (!column && (log.value_or(false) || !range.is_none() || !units.empty()))
        throw Error("plot: log, range and units work only with quantity 'column'");
    const Show show = show_named(quantity);
    const TransferFunction map =
        tf.is_none() ? named_transfer_function(default_map(show)) : transfer_function_of(tf);
    const ShadeOptions options{background_of(background), false};
    ColorScale scale;
    if (!range.is_none()) {
        const auto [low, high] =
            cast_to<std::pair<double, double>>(range, "range", "two numbers (low, high)");
        scale = {log.value_or(false) ? ColorScale::Kind::log : ColorScale::Kind::linear, low, high};
    }
    return unlocked([&] {
        const DepthImage values = column ? column_density(depth) : depth;
        if (column && scale.kind == ColorScale::Kind::visibility)
            scale = automatic_scale({&values, 1}, !log   ? ScaleFit::automatic
                                                  : *log ? ScaleFit::log
                                                         : ScaleFit::linear);
        const Image image =
            column ? shade_values(values, map, scale, options) : shade(depth, map, options);
        const std::string label = quantity_label(show, "", units);
        return Bitmap(annotated(image, map, scale, {title, label, color_bar}, options.background));
    });
}

py::array column_array(const DepthImage& depth) {
    const DepthImage values = unlocked([&] { return column_density(depth); });
    return py::array_t<float>({values.height, values.width}, values.depth.data());
}

Depth depth_from_numpy(const py::object& data, double extinction) {
    const py::array array = numbers_of(data, "depth");
    if (array.ndim() != 2)
        throw Error("depth: shape " + shape_text(array) + ", expected (height, width)");
    const auto values = py::array_t<float, py::array::c_style | py::array::forcecast>(array);
    auto depth = std::make_shared<DepthImage>(static_cast<int>(array.shape(1)),
                                              static_cast<int>(array.shape(0)));
    std::copy(values.data(), values.data() + values.size(), depth->depth.begin());
    depth->extinction = extinction;
    (void)auto_extinction(*depth);  // throws for negative or non-finite T
    return depth;
}

py::array depth_view(const py::object& self) {
    auto& depth = self.cast<DepthImage&>();
    return py::array_t<float>({depth.height, depth.width}, depth.depth.data(), self);
}

void bind_depth(py::module_& m) {
    py::class_<DepthImage, Depth>(
        m, "DepthImage", py::buffer_protocol(),
        R"(Image of optical depth T: the integral of density along each pixel's ray, times the extinction.

Rows from the top; T is 0 where the ray meets no density. Opacity is V = 1 - exp(-T). np.asarray(image) is
a view [height, width] float32. Setting `extinction` rescales T. Notebooks display it shaded by 'ember'.

>>> depth = vog.DepthImage.from_numpy([[0, 1], [2, 4]], extinction=2)
>>> depth.column_density().tolist()
[[0.0, 0.5], [1.0, 2.0]]
>>> depth.extinction = 1
>>> np.asarray(depth).tolist()
[[0.0, 0.5], [1.0, 2.0]])")
        .def_buffer([](DepthImage& self) {
            return py::buffer_info(
                self.depth.data(), {self.height, self.width},
                {sizeof(float) * static_cast<std::size_t>(self.width), sizeof(float)});
        })
        .def_static("from_numpy", &depth_from_numpy, py::arg("depth"), py::arg("extinction") = 1.0,
                    R"(Creates a DepthImage from an array, which is copied.

depth       [height, width] optical depths T, finite and >= 0
extinction  factor on density that T includes, > 0)")
        .def_static(
            "load",
            [](const std::filesystem::path& file) {
                return std::make_shared<DepthImage>(unlocked([&] { return read_depth(file); }));
            },
            py::arg("file"), "Reads an EXR file with one channel Y, the optical depth T.")
        .def(
            "save",
            [](const DepthImage& self, const std::filesystem::path& file) {
                unlocked([&] { write_exr(file, self); });
            },
            py::arg("file"), "Writes an EXR file with one float32 channel Y, the optical depth T.")
        .def_property_readonly("depth", &depth_view,
                               "[height, width] float32 view of the optical depth T.")
        .def_property_readonly(
            "shape", [](const DepthImage& self) { return py::make_tuple(self.height, self.width); },
            "(height, width) in pixels.")
        .def_property(
            "extinction", [](const DepthImage& self) { return self.extinction; },
            [](DepthImage& self, const py::object& value) {
                const std::optional<double> number = extinction_of(value);
                set_extinction(self, number ? *number : picture_extinction(self));
            },
            R"(Factor on density that T includes. Setting it rescales T without rendering again.

'auto' sets the value at which the 99th percentile of the non-zero T is 4, or the nearest one
whose picture is neither dark nor burnt out.)")
        .def(
            "shade", &shaded, py::arg("tf") = kDefaultMap, py::arg("background") = "black",
            py::arg("blend") = false,
            R"(Maps V = 1 - exp(-T) to colour: tf(V) where T > 0, the background elsewhere. Returns an Image.

tf          transfer function: a TransferFunction, a name, a JSON file, a Matplotlib map or colours
background  (r, g, b) or (r, g, b, a) in [0, 1], 'black', 'white' or 'transparent'
blend       True: colours fade into the background as V goes to 0

>>> image = vog.DepthImage.from_numpy([[0, 1], [2, 4]]).shade("gray", background="white")
>>> np.asarray(image).shape, np.asarray(image)[0, 0].tolist()
((2, 2, 3), [255, 255, 255]))")
        .def("column_density", &column_array,
             R"(Column density, [height, width] float32: T / extinction, density times world length.

Of particles: number or value per area. Rows from the top; 0 where the ray meets no density.)")
        .def(
            "plot", &plotted, py::arg("quantity") = "column", py::arg("tf") = py::none(),
            py::kw_only(), py::arg("range") = py::none(), py::arg("log") = py::none(),
            py::arg("units") = "", py::arg("title") = "", py::arg("color_bar") = true,
            py::arg("background") = "black",
            R"(Map of a quantity with a colour bar. Returns an Image, wider by the bar and higher by the title.

quantity    'column': column density over range; 'T': optical depth, coloured by V = 1 - exp(-T) as shade()
tf          transfer function, as in shade(); None: inferno, of T ember
range       (low, high) column densities at its ends; None: 0 to the largest, with log from the 5th percentile
            of the values above 0, one to four decades
log         True: logarithmic colours, ticks at decades
units       unit of column density, text for the colour bar
title       text above the picture
color_bar   False: no colour bar
background  of empty pixels and margins, as in shade())")
        .def("_repr_png_",
             [](const DepthImage& self) {
                 return png_of(shaded(self, py::str(kDefaultMap), py::str("black"), false).image);
             })
        .def("__repr__",
             [](const DepthImage& self) {
                 return "<vog.DepthImage: " + extent(self.width, self.height) + ", extinction " +
                        short_text(self.extinction) + ">";
             })
        .def(py::pickle(
            [](const py::object& self) {
                return py::make_tuple(self.attr("depth"), self.attr("extinction"));
            },
            [](const py::tuple& state) {
                return depth_from_numpy(state[0], state[1].cast<double>());
            }));
}

/// Bitmap from an array of uint8 in [0, 255] or of floats in [0, 1].
Bitmap picture_from_numpy(const py::object& data) {
    const py::array array = numbers_of(data, "image");
    if (array.ndim() != 3 || (array.shape(2) != 3 && array.shape(2) != 4))
        throw Error("image: shape " + shape_text(array) + ", expected (height, width, 3 or 4)");
    const bool bytes = array.dtype().kind() == 'u' && array.itemsize() == 1;
    if (!bytes && array.dtype().kind() != 'f')
        throw Error("image: dtype " + py::str(array.dtype()).cast<std::string>() +
                    ", expected uint8 or floats in [0, 1]");
    const float scale = bytes ? 255 : 1;
    const auto values = py::array_t<float, py::array::c_style | py::array::forcecast>(array);
    const auto at = values.unchecked<3>();
    Image image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            image.at(x, y) = {at(y, x, 0) / scale, at(y, x, 1) / scale, at(y, x, 2) / scale,
                              array.shape(2) == 4 ? at(y, x, 3) / scale : 1};
    return Bitmap(std::move(image));
}

void bind_bitmap(py::module_& m) {
    py::class_<Bitmap>(m, "Image", py::buffer_protocol(),
                       R"(Bitmap, as DepthImage.shade returns it.

np.asarray(image) is a read-only view [height, width, 3] uint8, or [height, width, 4] if any pixel is not
opaque; `rgba` has the unrounded floats. Notebooks display it.)")
        .def_buffer([](Bitmap& self) {
            const std::size_t channels = self.with_alpha ? 4 : 3;
            const std::size_t width = static_cast<std::size_t>(self.image.width);
            return py::buffer_info(self.bytes.data(),
                                   {static_cast<std::size_t>(self.image.height), width, channels},
                                   {width * channels, channels, std::size_t{1}}, true);
        })
        .def_static("from_numpy", &picture_from_numpy, py::arg("image"),
                    "Creates an Image from an array [height, width, 3 or 4] of uint8, or of floats "
                    "in [0, 1]; copied.")
        .def_static(
            "load",
            [](const std::filesystem::path& file) {
                return unlocked([&] { return Bitmap(read_image(file)); });
            },
            py::arg("file"), "Reads a PNG file, or an EXR file with channels R, G, B.")
        .def(
            "save",
            [](const Bitmap& self, const std::filesystem::path& file) {
                unlocked([&] { write_image(file, self.image); });
            },
            py::arg("file"),
            "Writes a .png file with 8 bits per channel, or an .exr file with floats.")
        .def_property_readonly(
            "rgba",
            [](const py::object& self) {
                Image& image = self.cast<Bitmap&>().image;
                py::array_t<float> view({image.height, image.width, 4},
                                        reinterpret_cast<const float*>(image.pixel.data()), self);
                view.attr("flags").attr("writeable") = false;
                return view;
            },
            "[height, width, 4] float32 view in [0, 1], read-only, with straight alpha.")
        .def_property_readonly(
            "shape",
            [](const Bitmap& self) {
                return py::make_tuple(self.image.height, self.image.width, self.with_alpha ? 4 : 3);
            },
            "(height, width, channels).")
        .def("_repr_png_", [](const Bitmap& self) { return png_of(self.image); })
        .def("__repr__",
             [](const Bitmap& self) {
                 return "<vog.Image: " + extent(self.image.width, self.image.height) +
                        (self.with_alpha ? " RGBA>" : " RGB>");
             })
        .def(py::pickle([](const py::object& self) { return py::make_tuple(self.attr("rgba")); },
                        [](const py::tuple& state) { return picture_from_numpy(state[0]); }));
}

}  // namespace

void bind_image(py::module_& m) {
    bind_depth(m);
    bind_bitmap(m);
}

}  // namespace vog::python
