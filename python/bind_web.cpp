// bind_web.cpp: export_html(): models to a self-contained HTML page, or to a site.
#include <algorithm>
#include <memory>

#include "bindings.h"
#include "vog/error.h"
#include "vog/export_html.h"
#include "vog/lod.h"
#include "vog/picture_record.h"
#include "vog/site.h"

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

/// Quantity of the page's first picture.
struct QuantityArguments {
    const std::string &show, &field;
    const py::object &range, &clip, &clip_planes, &light, &unit_distance;
    std::optional<bool> log;

    /// Request of these keywords, as render() takes them.
    PictureRequest request(const py::object& tf) const try {
        py::dict given;
        given["show"] = show, given["field"] = field, given["range"] = range, given["clip"] = clip;
        given["clip_planes"] = clip_planes, given["light"] = light;
        given["unit_distance"] = unit_distance, given["tf"] = tf;
        if (log && (*log || show != "T")) given["scale"] = *log ? "log" : "linear";
        const PictureRequest request = request_of_json(py::module_::import("vog._picture")
                                                           .attr("_json")("export_html", given)
                                                           .cast<std::string>());
        require_effects(request);
        return request;
    } catch (const RequestError& error) {
        const std::string& member = error.member();
        throw Error("export_html: " + (member == "scale" ? "log" : member) + error.text());
    } catch (const Error& error) {
        throw Error(std::string("export_html: ") + error.what());
    }
};

constexpr int kUsualLevels = 8;  ///< of detail in a page

/// Sets the field and the transfer function of a page's volume, with the defaults of the command.
void choose_volume(HtmlQuantity& quantity, PictureRequest request, std::optional<bool> log,
                   const Gaussians& model) {
    const ScalarField* field = request.field.empty() ? scalar_to_begin_with(model.fields)
                                                     : model.fields.find_scalar(request.field);
    if (!field) return;  // write_html says so
    quantity.field = field->name;
    request.transfer.log = log;
    quantity.transfer = choose_transfer(request.transfer, value_data(model, *field)).transfer;
}

HtmlQuantity quantity_of(const QuantityArguments& given, const py::object& tf,
                         const Gaussians& model) {
    const PictureRequest request = given.request(tf);
    HtmlQuantity quantity;
    quantity.show = given.show;
    quantity.field = given.field;
    if (given.log) quantity.fit = *given.log ? ScaleFit::log : ScaleFit::linear;
    if (request.transfer.range && request.show != Show::volume) {
        const auto [low, high] = *request.transfer.range;
        quantity.scale =
            ColorScale{given.log.value_or(false) ? ColorScale::Kind::log : ColorScale::Kind::linear,
                       low, high};
        (void)scale_position(*quantity.scale, low);  // checks the range
    }
    if (request.show == Show::volume) choose_volume(quantity, request, given.log, model);
    quantity.look = request.look;
    quantity.look.clip = request.options.clip;
    return quantity;
}

/// Whether a path names a folder: an existing one, or by a slash at its end.
bool is_folder(const std::filesystem::path& path) {
    return !path.has_filename() || std::filesystem::is_directory(path);
}

/// Writes models as a site.
py::dict export_site(const std::filesystem::path& folder, const Named& named,
                     const HtmlOptions& options) {
    std::uint64_t page_bytes = 0;
    const SiteReport report = unlocked([&] {
        std::optional<SiteWriter> site;
        std::vector<HtmlModel> entries;
        for (const auto& [name, model] : named) {
            Gaussians copy = *model;
            Hierarchy hierarchy;
            entries.push_back(prepare_for_site(name, copy, hierarchy));
            if (!site) {
                require_page(entries, options);
                site.emplace(folder, options.precise ? kPagePrecision : VogzPrecision{});
            }
            site->add(name, copy, hierarchy);
        }
        const SiteReport written = site->finish(options.steps);
        page_bytes = write_site_page(folder, entries, options).bytes;
        return written;
    });
    py::dict result;
    result["bytes"] = report.bytes + page_bytes;
    result["viewer_bytes"] = page_bytes;
    result["gaussians"] = report.gaussians;
    result["chunks"] = report.chunks;
    return result;
}

/// Path of data that lies elsewhere than its page.
std::filesystem::path path_elsewhere(const py::object& models) {
    if (!py::isinstance<py::str>(models) && !py::hasattr(models, "__fspath__"))
        throw py::type_error(
            "export_html: url goes with a path of a site or of a compact model "
            "(.vogz) as models, got " +
            py::type::of(models).attr("__name__").cast<std::string>());
    return cast_to<std::filesystem::path>(models, "export_html: models", "a path");
}

py::dict export_html(const std::filesystem::path& file, const py::object& models,
                     const std::string& title, const std::string& description, int levels,
                     const std::optional<Camera>& camera, const py::object& extinction,
                     const py::object& chosen, const py::object& background, bool blend,
                     const std::string& show, const std::string& field, const py::object& range,
                     std::optional<bool> log, const py::object& unit_distance,
                     const py::object& light, const py::object& clip, const py::object& clip_planes,
                     bool steps, bool precise, const std::string& url) {
    const py::object tf =
        chosen.is_none() ? py::object(py::str(default_map(show_named(show)))) : chosen;
    std::vector<HtmlModel> elsewhere;
    HtmlSource source{url, false};
    if (!url.empty()) {
        if (is_folder(file) || precise || levels != kUsualLevels)
            throw Error(
                "export_html: url goes with a page, and without levels and precise: the model is "
                "written already");
        const std::filesystem::path path = path_elsewhere(models);
        source.file = !is_site(path);
        if (!source.file && !url.ends_with('/')) source.url += '/';
        elsewhere = unlocked([&] { return models_to_stream(path); });
        if (!title.empty() && source.file) elsewhere.front().name = title;
    }
    Named named;
    for (const HtmlModel& entry : elsewhere) named.emplace_back(entry.name, &entry.levels.front());
    if (url.empty()) named = named_models(models, title);
    if (named.empty()) throw Error("export_html: no model, expected at least one");
    if (levels < 1)
        throw Error("export_html: " + std::to_string(levels) + " levels, expected 1 or more");
    HtmlOptions options;
    options.title = title.empty() ? named.front().first : title;
    options.description = description;
    options.camera = camera;
    options.extinction = extinction_of(extinction);
    options.quantity =
        quantity_of({show, field, range, clip, clip_planes, light, unit_distance, log}, tf,
                    *named.front().second);
    // A file of values is of volume; the other quantities then have the default colours.
    const bool of_values = py::hasattr(tf, "__fspath__") ||
                           (py::isinstance<py::str>(tf) &&
                            !std::ranges::count(transfer_function_names(), tf.cast<std::string>()));
    if (show != "volume" || !of_values) options.tf = transfer_function_of(tf);
    options.steps = steps;
    options.precise = precise;
    options.system_background =
        py::isinstance<py::str>(background) && background.cast<std::string>() == "system";
    if (!options.system_background) options.shading.background = background_of(background);
    options.shading.blend = blend;
    if (is_folder(file)) {
        if (levels != kUsualLevels)
            throw Error("export_html: levels has no effect on a site, expected a name in .html");
        return export_site(file, named, options);
    }
    const HtmlReport report = unlocked([&] {
        if (!url.empty()) return write_streaming_page(file, elsewhere, source, options);
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
        py::arg("title") = "", py::arg("description") = "", py::arg("levels") = kUsualLevels,
        py::arg("camera") = py::none(), py::arg("extinction") = "auto", py::arg("tf") = py::none(),
        py::arg("background") = "black", py::arg("blend") = false, py::arg("show") = "T",
        py::arg("field") = "", py::arg("range") = py::none(), py::arg("log") = py::none(),
        py::arg("unit_distance") = py::none(), py::arg("light") = py::none(),
        py::arg("clip") = py::none(), py::arg("clip_planes") = py::none(), py::arg("steps") = false,
        py::arg("precise") = false, py::arg("url") = "",
        R"(Writes models to one self-contained HTML page, which needs no server, network or other file.

file         page to write; or a folder, an existing one or a name that ends in /: a site, of whose models a browser loads what its
             views need from any web server (vog serve shows it)
models       Gaussians, or {name: Gaussians}: the page lets its reader select one
title        title of the page; default: the first name
description  text below the title
levels       largest number of levels of detail: the model, then a quarter as many Gaussians each time
camera       initial view; None: Camera.orbit of each model, fitted
extinction   factor on density, or 'auto': by the initial view of each model
tf           initial transfer function; None: ember, for maps inferno
background   as in DepthImage.shade; 'system': black or white by the reader's colour scheme
blend        True: colours fade into the background as V goes to 0
show         what the page shows first: 'T', 'column', or of a field 'mean', 'deviation', 'volume' or 'maximum'
field        name of that field; '': the first one, of volume and maximum the density where the model has it
range        (low, high), values of the first and the last colour; None: of the initial view, volume: of the data
log          True: logarithmic colours; None: of volume where most of the mass has values over a decade and more, else linear
unit_distance  of volume: length that opacities refer to, world units; None: found by the page
light        of volume: 'head', 'studio' (shadows and ambient occlusion), the direction towards the light, or a Light; None: none
clip         box of the world that is shown first, [2, 3]; None: all
clip_planes  rows (nx, ny, nz, d): first shown is the side where n.x >= d; at most 10
steps        True: the models are steps in time, with a play bar and one extinction
precise      True: numbers four times as fine, for 4 bytes more a Gaussian
url          address of https or http, or relative to the page, at which a copy of the data lies: models is then the path of a site or of
             a compact model (vog pack --hierarchy --deflate), and the page streams it from there

Returns a dict: bytes (size of the file), viewer_bytes (size without the models), gaussians.

>>> model = vog.convert(vog.sample_cloud(64), block=8)
>>> report = vog.export_html("cloud.html", {"cloud": model}, title="A cloud")
>>> report["gaussians"] == len(model)
True)");
}

}  // namespace vog::python
