// bind_exchange.cpp: export_splats(): models as files of other programs' splats.
#include <filesystem>
#include <optional>

#include "arrays.h"
#include "data.h"
#include "vog/error.h"
#include "vog/exchange.h"
#include "vog/picture.h"

namespace vog::python {

namespace {

py::dict export_splats(const Gaussians& model, const std::filesystem::path& file,
                       const py::object& extinction, const py::object& colors,
                       const std::optional<std::string>& units, const py::object& up,
                       const std::string& layout) {
    if (units && *units != "world" && *units != "box")
        throw Error("export_splats: units '" + *units + "', expected 'world' or 'box'");
    if (layout != "3dgs" && layout != "volprim")
        throw Error("export_splats: layout '" + layout + "', expected '3dgs' or 'volprim'");
    const bool volprim = layout == "volprim";
    if (volprim && file.extension() != ".ply")
        throw Error("export_splats: layout 'volprim' needs a .ply file, got '" + file.string() +
                    "'");
    if (volprim && (units == "box" || !up.is_none() || !colors.is_none()))
        throw Error(
            "export_splats: layout 'volprim' has no colours and the data's coordinates: leave out "
            "colors, up and units='box'");
    const Vec3d upright = up.is_none() ? Vec3d{0, 1, 0} : direction_of(up);
    BigVector<Vec3f> color;
    if (!colors.is_none()) color = vector_of<Vec3f, float>(colors, "colors");
    const std::optional<double> stated = extinction_of(extinction);
    double factor = 1;
    SplatsError error;
    Splats splats;
    unlocked([&] {
        factor = stated ? *stated : default_extinction(model);
        if (volprim) return write_volprim(file, model, factor);
        error = splats_error(model, splats_of(model, color, {factor, false}), factor);
        splats = splats_of(model, color, {factor, units != "world"});
        write_splats(file, splats, upright);
    });
    py::dict report;
    report["extinction"] = factor;
    if (volprim) return report;
    report["mean_db"] = error.mean_db;
    report["worst_db"] = error.worst_db;
    report["depth"] = error.depth;
    report["opaque"] = error.opaque;
    report["world_scale"] = splats.world_scale;
    report["world_center"] = splats.world_center;
    return report;
}

}  // namespace

void bind_exchange(py::module_& m) {
    m.def("export_splats", &export_splats, py::arg("model"), py::arg("file"), py::kw_only(),
          py::arg("extinction") = "auto", py::arg("colors") = py::none(),
          py::arg("units") = py::none(), py::arg("up") = py::none(), py::arg("layout") = "3dgs", R"(
Writes a model as splats of one opacity each, for renderers of 3D Gaussian splatting: .ply, .spz, .glb, .usda.

extinction  factor on density, or 'auto': the 99th percentile of T in the fitted view 'paper' is 4
colors      [N, 3] red, green, blue of the Gaussians, [0, 1]; None: white
units       'box': the model's box centred at 0 with a longest edge of 2, which viewers open in view; or 'world'. The file
            states the scale. None: 'box', and 'world' with layout 'volprim'
up          direction that is upright in the data: 'x', '-x', 'y', '-y', 'z', '-z' or (x, y, z); None: 'y'. Viewers show it
            upright, and vog reads the file back in the data's axes
layout      of a .ply: '3dgs', or 'volprim', volumetric primitives

Returns a dict: extinction, and of splats mean_db and worst_db, PSNR of V against the model over seven parallel views,
depth, their optical depth over the model's, opaque, the share of splats that are, world_scale, world units in one unit of the
file, and world_center, the point of the world at its 0.

Raises vog.Error for another extension or option, and for positions that .spz cannot hold.

>>> report = vog.export_splats(vog.convert(vog.sample_cloud(64), block=8), "cloud.glb", up="z")
>>> report["worst_db"] > 20
True)");
}

}  // namespace vog::python
