// bind_compare.cpp: error metrics between images.
#include <memory>

#include "arrays.h"
#include "data.h"
#include "vog/compare.h"
#include "vog/error.h"

namespace vog::python {

namespace {

std::string text(const char* name, double value) {
    return std::string(name) + "=" + short_text(value);
}

std::string repr(const PictureDifference& d) {
    return "<vog.PictureDifference: " + text("psnr_db", d.psnr_db) + ", " + text("ssim", d.ssim) +
           ", largest=" + std::to_string(d.largest) + ">";
}
std::string repr(const DepthDifference& d) {
    return "<vog.DepthDifference: " + text("psnr_db", d.grey.psnr_db) + ", " +
           text("relative_l2", d.relative_l2) + ", " + text("bias", d.bias) + ">";
}

/// What is compared of a Picture: of T and columns the depth, else the colours.
py::object compared(const py::object& given) {
    if (!py::isinstance(given, py::module_::import("vog").attr("Picture"))) return given;
    try {
        return given.attr("depth");
    } catch (const py::error_already_set&) {
        return given.attr("image");
    }
}

/// Calls work(a, b) for two DepthImages or two Images. throws TypeError for others
template <class Work>
py::object of_kind(const py::object& one, const py::object& two, const std::string& call,
                   const Work& work) {
    const py::object reference = compared(one), other = compared(two);
    if (py::isinstance<DepthImage>(reference) && py::isinstance<DepthImage>(other))
        return work(reference.cast<const DepthImage&>(), other.cast<const DepthImage&>());
    if (py::isinstance<Bitmap>(reference) && py::isinstance<Bitmap>(other))
        return work(reference.cast<const Bitmap&>().image, other.cast<const Bitmap&>().image);
    throw py::type_error(call + ": got " +
                         py::type::of(reference).attr("__name__").cast<std::string>() + " and " +
                         py::type::of(other).attr("__name__").cast<std::string>() +
                         ", expected two Pictures, DepthImages or Images");
}

void bind_differences(py::module_& m) {
    py::class_<PictureDifference>(
        m, "PictureDifference",
        "Error metrics of a picture against a reference, both with 8 bits per channel.\n\n"
        "Formulas: docs/evaluation.md.")
        .def_readonly("psnr_db", &PictureDifference::psnr_db,
                      "Peak signal-to-noise ratio, dB; inf: equal pictures.")
        .def_readonly(
            "ssim", &PictureDifference::ssim,
            "Structural similarity (SSIM) of the grey values; 1: equal; nan below 11 x 11 pixels.")
        .def_readonly("share_off_1", &PictureDifference::share_off_1,
                      "Fraction of the pixels with a channel that differs by more than 1 of 255.")
        .def_readonly("share_off_4", &PictureDifference::share_off_4,
                      "Fraction of the pixels with a channel that differs by more than 4 of 255.")
        .def_readonly("largest", &PictureDifference::largest,
                      "Largest difference of a channel, 0 to 255.")
        .def_property_readonly(
            "largest_at",
            [](const PictureDifference& d) {
                return py::make_tuple(d.largest_row, d.largest_column);
            },
            "(row, column) of the largest difference.")
        .def("__repr__", py::overload_cast<const PictureDifference&>(&repr));
    py::class_<DepthDifference>(
        m, "DepthDifference",
        "Error metrics of a depth image against a reference, both at the reference's extinction.")
        .def_readonly("grey", &DepthDifference::grey,
                      "PictureDifference of V = 1 - exp(-T) as grey pictures.")
        .def_property_readonly(
            "psnr_db", [](const DepthDifference& d) { return d.grey.psnr_db; },
            "Peak signal-to-noise ratio of V as a grey picture, dB.")
        .def_readonly("relative_l2", &DepthDifference::relative_l2,
                      "|T - T_ref| / |T_ref|, Euclidean norms.")
        .def_readonly("bias", &DepthDifference::bias, "Mean T / mean T_ref.")
        .def_readonly("largest_dt", &DepthDifference::largest_dt,
                      "T - T_ref of largest magnitude, with its sign.")
        .def_property_readonly(
            "largest_at",
            [](const DepthDifference& d) {
                return py::make_tuple(d.largest_row, d.largest_column);
            },
            "(row, column) of largest_dt.")
        .def_readonly("extinction", &DepthDifference::extinction,
                      "Extinction of the reference, at which T and V are compared.")
        .def_readonly("identical", &DepthDifference::identical, "Whether all T are equal.")
        .def("__repr__", py::overload_cast<const DepthDifference&>(&repr));
}

}  // namespace

void bind_compare(py::module_& m) {
    bind_differences(m);
    m.def(
        "compare",
        [](const py::object& reference, const py::object& image) {
            return of_kind(reference, image, "compare", [](const auto& a, const auto& b) {
                return py::cast(unlocked([&] { return compare(a, b); }));
            });
        },
        py::arg("reference"), py::arg("image"),
        R"(Error metrics of an image against a reference of the same size.

reference, image  two Pictures, DepthImages or Images; of Pictures of T and columns the numbers, of others the colours

Returns a DepthDifference or a PictureDifference. Raises vog.Error for different sizes.

>>> a = vog.DepthImage.from_numpy([[0, 1], [2, 4]])
>>> b = vog.DepthImage.from_numpy([[0, 1], [2, 5]])
>>> round(vog.compare(a, b).relative_l2, 4)
0.2182)");
    m.def(
        "compare_shaded",
        [](const py::object& given, const py::object& other, const py::object& tf) {
            const py::object one = compared(given), two = compared(other);
            const auto& reference =
                cast_to<const DepthImage&>(one, "reference", "a Picture of T or a DepthImage");
            const auto& image =
                cast_to<const DepthImage&>(two, "image", "a Picture of T or a DepthImage");
            const TransferFunction map = transfer_function_of(tf);
            return unlocked([&] { return compare_shaded(reference, image, map); });
        },
        py::arg("reference"), py::arg("image"), py::arg("tf") = "inferno",
        R"(PictureDifference of two DepthImages after shading on black at the reference's extinction.

tf  transfer function: a TransferFunction or anything it accepts)");
    m.def(
        "difference_map",
        [](const py::object& reference, const py::object& image, double limit, bool bar) {
            return of_kind(reference, image, "difference_map", [&](const auto& a, const auto& b) {
                return py::cast(unlocked([&] {
                    return Bitmap(difference_map(a, b, {limit, bar}));
                }));
            });
        },
        py::arg("reference"), py::arg("image"), py::arg("limit") = 0.0, py::arg("bar") = true,
        R"(Heat map of the differences, as an Image: of V - V_ref for DepthImages (blue: too low, red:
too high), of the channel that differs most for Images.

limit  difference at the end of the colour scale, in units of 1/255; 0: the largest one, rounded up
bar    True: draws the colour scale on the right)");
}

}  // namespace vog::python
