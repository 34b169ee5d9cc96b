// bind_web.cpp: export_html(): models to a self-contained HTML page.
#include <memory>

#include "bindings.h"
#include "vog/error.h"
#include "vog/export_html.h"
#include "vog/lod.h"

namespace vog::python {

namespace {

using Named = std::vector<std::pair<std::string, const Gaussians*>>;

Named named_models(const py::object& models, const std::string& title) {
    if (py::isinstance<Gaussians>(models))
        return {{title.empty() ? "model" : title, &models.cast<const Gaussians&>()}};
    Named all;
    if (!py::isinstance<py::dict>(models))
        throw py::type_error("export_html: got " +
                             py::type::of(models).attr("__name__").cast<std::string>() +
                             ", expected Gaussians or {name: Gaussians}");
    for (const auto& [name, model] : models.cast<py::dict>())
        all.emplace_back(cast_to<std::string>(name, "models", "names"),
                         &cast_to<const Gaussians&>(model, "models", "{name: Gaussians}"));
    return all;
}

py::dict export_html(const std::filesystem::path& file, const py::object& models,
                     const std::string& title, const std::string& description, int levels,
                     const std::optional<Camera>& camera, const py::object& extinction,
                     const py::object& tf, const py::object& background, bool blend) {
    const Named named = named_models(models, title);
    if (named.empty()) throw Error("export_html: no model, expected at least one");
    if (levels < 1)
        throw Error("export_html: " + std::to_string(levels) + " levels, expected 1 or more");
    HtmlOptions options;
    options.title = title.empty() ? named.front().first : title;
    options.description = description;
    options.camera = camera;
    options.extinction = extinction_of(extinction);
    options.tf = transfer_function_of(tf);
    options.system_background =
        py::isinstance<py::str>(background) && background.cast<std::string>() == "system";
    if (!options.system_background) options.shading.background = background_of(background);
    options.shading.blend = blend;
    const HtmlReport report = unlocked([&] {
        std::vector<HtmlModel> entries;
        for (const auto& [name, model] : named)
            entries.push_back({name, detail_levels(*model, static_cast<std::size_t>(levels))});
        return write_html(file, entries, options);
    });
    py::dict result;
    result["bytes"] = report.bytes;
    result["viewer_bytes"] = report.viewer_bytes;
    result["gaussians"] = report.gaussians;
    return result;
}

}  // namespace

void bind_web(py::module_& m) {
    m.def(
        "export_html", &export_html, py::arg("file"), py::arg("models"), py::kw_only(),
        py::arg("title") = "", py::arg("description") = "", py::arg("levels") = 8,
        py::arg("camera") = py::none(), py::arg("extinction") = "auto", py::arg("tf") = "inferno",
        py::arg("background") = "black", py::arg("blend") = false,
        R"(Writes models to one self-contained HTML page, which needs no server, network or other file.

file         page to write
models       Gaussians, or {name: Gaussians}: the page lets its reader select one
title        title of the page; default: the first name
description  text below the title
levels       largest number of levels of detail: the model, then a quarter as many Gaussians each time
camera       initial view; None: Camera.orbit of each model, fitted
extinction   factor on density, or 'auto': by the initial view of each model
tf           initial transfer function
background   as in DepthImage.shade; 'system': black or white by the reader's colour scheme
blend        True: colours fade into the background as V goes to 0

Returns a dict: bytes (size of the file), viewer_bytes (size without the models), gaussians.)");
}

}  // namespace vog::python
