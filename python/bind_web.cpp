// bind_web.cpp: export_html(): models to a self-contained HTML page, or to a site; the module of <vog-view>.
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
        throw py::type_error(
            "export_html: got " + py::type::of(models).attr("__name__").cast<std::string>() +
            ", expected Gaussians or {name: Gaussians}, as vog.convert(data) makes them");
    for (const auto& [name, model] : models.cast<py::dict>())
        all.emplace_back(cast_to<std::string>(name, "models", "names"),
                         &cast_to<const Gaussians&>(model, "models", "{name: Gaussians}"));
    return all;
}

constexpr int kUsualLevels = 8;  ///< of detail in a page

/// Settings of a page with this first model.
HtmlOptions options_of(const std::string& json, const Gaussians& model) try {
    const PictureRequest request = request_of_json(json);
    require_effects(request);
    return html_options(request, model);
} catch (const RequestError& error) {
    throw Error("export_html: " + error.member() + error.text());
} catch (const Error& error) {
    throw Error(std::string("export_html: ") + error.what());
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
            "export_html: url goes with a path of a site or of a compact model (.vogz) as models, "
            "got " +
            py::type::of(models).attr("__name__").cast<std::string>());
    return cast_to<std::filesystem::path>(models, "export_html: models", "a path");
}

/// request            JSON, of which `background` may be missing
/// system_background  whether the reader's colour scheme chooses it
py::dict export_html(const std::filesystem::path& file, const py::object& models,
                     const std::string& request, const std::string& title,
                     const std::string& description, int levels, bool steps, bool precise,
                     const std::string& url, bool system_background) {
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
    HtmlOptions options = options_of(request, *named.front().second);
    options.title = title.empty() ? named.front().first : title;
    options.description = description;
    options.steps = steps;
    options.precise = precise;
    options.system_background = system_background;
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
    m.def("_export_html", &export_html);
    m.def("_view_module", &view_module);
}

}  // namespace vog::python
