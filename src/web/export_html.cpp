// export_html.cpp: assembly of the page from its files, models, transfer functions and texts.
#include "vog/export_html.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "core/atomic_file.h"
#include "core/html_text.h"
#include "io/vogz/vogz_bytes.h"
#include "render/pixel_limits.h"
#include "render/splat/splat.h"
#include "shade/transfer_function.h"
#include "vog/error.h"
#include "vog/exposure.h"
#include "vog/field_maps.h"
#include "vog/picture.h"
#include "vog/picture_record.h"
#include "web/modules.h"
#include "web/page_fields.h"
#include "web/page_map.h"
#include "web/page_source.h"
#include "web/web_files.h"

namespace vog {

using namespace shading;
using namespace web;

namespace {

using Json = nlohmann::ordered_json;

/// JSON for a script element, with '<' escaped: no text ends the element or starts a comment.
std::string script_json(const Json& data) {
    const std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text) {
        if (c == '<')
            safe += "\\u003c";
        else
            safe += c;
    }
    return safe;
}

/// Replaces every {{name}} of a page in one pass: inserted text is not searched again.
std::string filled(const std::string& page, const std::map<std::string, std::string>& parts) {
    std::string out;
    std::size_t at = 0;
    for (std::size_t open; (open = page.find("{{", at)) != std::string::npos;) {
        const std::size_t close = page.find("}}", open);
        out.append(page, at, open - at);
        out += parts.at(page.substr(open + 2, close - open - 2));
        at = close + 2;
    }
    return out.append(page, at);
}

Json json_of(const PixelLimits& limits) {
    return {limits.least2, limits.sampled2, limits.variance, limits.mass};
}
Json json_of(Vec3d v) { return {v.x, v.y, v.z}; }

/// All named maps; before them the chosen one if it is not among them or differs from its namesake.
/// chosen_name  receives its name in the list
Json maps_json(const TransferFunction& chosen, std::string& chosen_name) {
    Json maps = Json::array();
    const Json own = map_json(chosen);
    chosen_name = chosen.name.empty() ? "own" : chosen.name;
    bool known = false;
    for (const std::string& name : transfer_function_names()) {
        maps.push_back(map_json(named_transfer_function(name)));
        if (maps.back() == own) known = true;
    }
    if (known) return maps;
    if (is_transfer_function_name(chosen_name)) chosen_name += " (own)";
    maps.insert(maps.begin(), own);
    maps.front()["name"] = chosen_name;
    maps.front()["own"] = true;  // no command knows it by this name
    return maps;
}

/// Box of a model's view; a unit cube if the model is empty.
Box framed_box(const Gaussians& model) {
    const Box box = view_box(model);
    return box.empty() ? Box{{-1, -1, -1}, {1, 1, 1}} : box;
}

Camera first_view(const Gaussians& model, const HtmlOptions& options) {
    PictureRequest request;
    request.options.clip = options.quantity.look.clip;
    return options.camera ? *options.camera
                          : default_view(shown_by(request, subject_of(model)), 1, 1);
}

constexpr VogzPrecision kPrecisePage{kPagePrecision.step / 4, kPagePrecision.field_step / 2};

/// Origin and unit of length of a page's numbers, shared by the levels of a model.
struct PageFrame {
    Vec3d center;  ///< world units
    double unit = 1;
};
/// Centre of the means, and the radius of their box or the largest scale if larger.
PageFrame page_frame(const Gaussians& model) {
    Box means;
    for (const Vec3f& mean : model.mean) means.include(vec_cast<double>(mean));
    if (means.empty()) return {};
    PageFrame frame{model.origin + means.center(), means.radius()};
    for (const Vec3f& s : model.scale)
        frame.unit = std::max({frame.unit, double{s.x}, double{s.y}, double{s.z}});
    return frame;
}

/// Text of a script element of a model's data.
std::string data_element(const std::string& id, const std::string& name, const std::string& bytes) {
    // Longest string of V8, the shortest limit of all engines: 2^29 - 24 characters.
    constexpr std::size_t kMaxText = (std::size_t{1} << 29) - 24;
    const std::string text = base64(bytes);
    if (text.size() > kMaxText)
        throw Error(fmt::format("{}: {} bytes of {} in a page, expected at most {}", name,
                                text.size(), id, kMaxText));
    return fmt::format("<script type=\"text/plain\" id=\"{}\">", id) + text + "</script>\n";
}

/// Levels of a model as elements of a page, appended to `data`.
/// returns  their entry in the page's JSON
Json levels_json(const HtmlModel& model, std::size_t index, const HtmlOptions& options,
                 std::string& data) {
    Json levels = Json::array();
    for (std::size_t n = 0; n < model.levels.size(); ++n) {
        const Gaussians& level = model.levels[n];
        levels.push_back(
            {{"count", std::ranges::count_if(level.density, [](float d) { return d > 0; })}});
        data += data_element(
            fmt::format("model-{}-{}", index, n), model.name,
            vogz::bytes_of(level, {options.precise ? kPrecisePage : kPagePrecision, true}));
    }
    return levels;
}

/// A model's entry in the page's JSON, without its levels.
Json model_json(const HtmlModel& model, const HtmlOptions& options) {
    const Gaussians& finest = model.levels.front();
    const Box box = framed_box(finest);
    const PageFrame frame = page_frame(finest);
    // One picture tells the automatic extinction and the largest column.
    constexpr int kSize = 256;
    const Camera view = first_view(finest, options);
    const DepthImage depth = render_splat(finest, view, kSize, kSize);
    const double extinction =
        options.extinction ? *options.extinction : picture_extinction(depth, finest.source);
    const ColorScale columns = automatic_scale({&depth, 1}, ScaleFit::log);
    const bool empty = std::ranges::none_of(depth.depth, [](float t) { return t > 0; });
    return {{"name", model.name},
            {"center", json_of(frame.center)},
            {"unit", frame.unit},
            {"cutoff", finest.cutoff},
            {"limits", json_of(pixel_limits(finest.cutoff))},
            {"subframeLimits", json_of(subframe_limits(finest.cutoff))},
            {"box",
             {{"center", json_of(box.center())},
              {"half", json_of(0.5 * (box.upper - box.lower))},
              {"radius", box.radius() > 0 ? box.radius() : 1}}},
            {"extinction", extinction},
            {"lowColumn", empty ? 0 : columns.low},
            {"mostColumn", empty ? 0 : columns.high},
            {"logColumn",
             automatic_scale({&depth, 1}, ScaleFit::automatic).kind == ColorScale::Kind::log},
            {"fields", fields_json(finest, view)},
            {"levels", Json::array()}};
}

/// throws  vog::Error for a quantity that the model has not
void check_quantity(const Gaussians& model, const HtmlQuantity& quantity) {
    const std::string& show = quantity.show;
    const bool of_scalars = show == "volume" || show == "maximum";
    if (show != "T" && show != "column" && show != "mean" && show != "deviation" && !of_scalars)
        throw Error(fmt::format(
            "page: quantity '{}', expected T, column, mean, deviation, volume or maximum", show));
    for (const int slabs : {quantity.slabs.value_or(1), quantity.maximum_slabs})
        if (slabs < 1 || slabs > 1024)
            throw Error(fmt::format("page: {} depth slabs, expected 1 to 1024", slabs));
    vog::validate(quantity.look);
    if (quantity.look.clip.planes.size() > kMostHtmlPlanes)
        throw Error(fmt::format("page: {} clip planes, expected at most {}",
                                quantity.look.clip.planes.size(), kMostHtmlPlanes));
    if (quantity.transfer) vog::validate(*quantity.transfer);
    if (show == "T" || show == "column") return;
    if (model.fields.empty() || (of_scalars && model.fields.scalar.empty()))
        throw Error(fmt::format(
            "page: the model has no field for {}, expected one (vog convert --field)", show));
    if (quantity.field.empty()) return;
    const FieldChoice choice = field_choice(quantity.field, model.fields);
    if (of_scalars && choice.part != FieldPart::value)
        throw Error(fmt::format("page: {} of '{}', expected a scalar field", show, quantity.field));
    if (choice.part == FieldPart::magnitude && show != "mean")
        throw Error(fmt::format("page: {} of '{}', expected a component: {}, .x, .y or .z", show,
                                quantity.field, choice.field));
}

/// Request of the page's first picture (vog/picture_record.h).
/// view  the first one
Json picture_json(const HtmlOptions& options, const Camera& view) {
    const HtmlQuantity& quantity = options.quantity;
    PictureRequest request;
    request.show = show_named(quantity.show);
    request.field = quantity.field;
    request.camera = view;
    request.shading = options.shading;
    request.look = quantity.look;
    request.options.clip = quantity.look.clip;
    if (has_scale(request.show)) request.fit = quantity.fit;
    if (const auto& scale = quantity.scale) {
        request.transfer.range.emplace(scale->low, scale->high);
        request.fit = scale->kind == ColorScale::Kind::log ? ScaleFit::log : ScaleFit::linear;
    }
    if (quantity.transfer) request.transfer.points = transfer_points(*quantity.transfer);
    Json picture = Json::parse(request_json(request));
    const VolumeLook& look = quantity.look;
    picture["light_weights"] = {look.ambient, look.diffuse, look.specular, look.power};
    return picture;
}

void check(std::span<const HtmlModel> models, const HtmlOptions& options) {
    if (models.empty()) throw Error("page: no model, expected one or more");
    for (const HtmlModel& model : models) {
        if (model.levels.empty())
            throw Error(
                fmt::format("page: model '{}' has no levels, expected one or more", model.name));
        for (const Gaussians& level : model.levels) validate(level);
    }
    if (options.extinction && !(std::isfinite(*options.extinction) && *options.extinction > 0))
        throw Error(fmt::format("page: extinction {}, expected a finite number above 0",
                                *options.extinction));
    require_valid("page", options.tf);
    check_quantity(models.front().levels.front(), options.quantity);
    if (options.camera) frame_of(*options.camera, 1, 1);
}

/// Style of the text over a background: "light", "dark", or "clear" for a transparent one.
std::string ground_of(const Rgba& background) {
    if (background.a < 0.5f) return "clear";
    const float luma = 0.2126f * background.r + 0.7152f * background.g + 0.0722f * background.b;
    return luma > 0.5f ? "light" : "dark";
}

/// Entries of models in the page's JSON; their levels are appended to `data` unless the page is a site's.
Json entries_json(std::span<const HtmlModel> models, const HtmlOptions& options, bool site,
                  std::string& data) {
    Json entries = Json::array();
    HtmlOptions shared = options;
    for (const HtmlModel& model : models) {
        Json entry = model_json(model, shared);
        if (!site) entry["levels"] = levels_json(model, entries.size(), options, data);
        entries.push_back(std::move(entry));
        if (options.steps) shared.extinction = entries.front().at("extinction").get<double>();
    }
    return entries;
}

/// A page's JSON.
/// site  where its models lie; null: in the page, and their levels are appended to `data`
Json page_json(std::span<const HtmlModel> models, const HtmlOptions& options, const Json& site,
               std::string& data) {
    const Camera camera = first_view(models.front().levels.front(), options);
    const Rgba& ground = options.shading.background;
    std::string map_name;
    Json page = {{"title", options.title},
                 {"picture", picture_json(options, camera)},
                 {"upright", json_of(normalized(camera.up))},
                 {"chosenView", options.camera.has_value()},
                 {"systemBackground", options.system_background},
                 {"background", {ground.r, ground.g, ground.b, ground.a}},
                 {"leastColumn", kLeastColumn}};
    page["maps"] = maps_json(options.tf, map_name);
    page["map"] = map_name;
    // Of volume, of the largest value, and of volume with light.
    page["slabs"] = {options.quantity.slabs.value_or(kVolumeSlabs), options.quantity.maximum_slabs,
                     options.quantity.slabs.value_or(kLitSlabs)};
    page["steps"] = options.steps;
    if (!site.is_null()) page["site"] = site;
    page["models"] = entries_json(models, options, !site.is_null(), data);
    return page;
}

/// What a view of a page's models begins with, for <vog-view>: JSON.
std::string beginning(Json page) {
    for (Json& model : page["models"])
        for (Json& field : model["fields"]) field.erase("histogram"), field.erase("logHistogram");
    return script_json({{"camera", page["picture"]["camera"]},
                        {"upright", page["upright"]},
                        {"chosenView", page["chosenView"]},
                        {"models", page["models"]}});
}

/// Writes a page.
/// data       elements of the models
/// connect    sources of the page's requests, for its security policy; empty: none
HtmlReport write_page(const std::filesystem::path& file, const HtmlOptions& options,
                      const Json& page, std::string data, const std::string& connect) {
    std::string shaders;
    for (const auto& [name, text] : shader_texts())
        shaders += fmt::format("<script type=\"text/plain\" data-shader=\"{}\">\n{}</script>\n",
                               name, text);
    HtmlReport report;
    report.extinction = page.at("models").front().at("extinction");
    report.viewer_bytes = data.size();
    const std::string text = filled(
        web_file("page.html"), {{"title", escaped(options.title)},
                                {"description", escaped(options.description)},
                                {"ground", ground_of(options.shading.background)},
                                {"connect", connect.empty() ? "" : " connect-src " + connect + ";"},
                                {"style", web_file("page.css")},
                                {"page", script_json(page)},
                                {"shaders", shaders},
                                {"models", std::move(data)},
                                {"worker", web_file("page_worker.js")},
                                {"script", web_file("main.js")}});
    report.bytes = text.size();
    report.viewer_bytes = report.bytes - report.viewer_bytes;
    write_file(file, [&](std::ofstream& out) { out << text; });
    return report;
}

}  // namespace

HtmlReport write_html(const std::filesystem::path& file, std::span<const HtmlModel> models,
                      const HtmlOptions& options) {
    check(models, options);
    std::string data;
    const Json page = page_json(models, options, nullptr, data);
    HtmlReport report = write_page(file, options, page, std::move(data), "");
    for (const HtmlModel& model : models) report.gaussians += model.levels.front().size();
    return report;
}

void require_page(std::span<const HtmlModel> models, const HtmlOptions& options) {
    check(models, options);
}

HtmlReport write_site_page(const std::filesystem::path& folder, std::span<const HtmlModel> models,
                           const HtmlOptions& options) {
    check(models, options);
    std::string data;
    const Json page =
        page_json(models, options, {{"manifest", "manifest.json"}, {"base", ""}}, data);
    write_file(folder / "page.json", [&](std::ofstream& out) { out << beginning(page) << "\n"; });
    return write_page(folder / "index.html", options, page, "", "'self'");
}

std::string page_of_file(const HtmlModel& model) {
    std::string data;
    return beginning(page_json({&model, 1}, {}, {{"file", model.name}}, data));
}

HtmlReport write_streaming_page(const std::filesystem::path& file,
                                std::span<const HtmlModel> models, const HtmlSource& source,
                                const HtmlOptions& options) {
    const std::string connect = allowed_origin(source);
    check(models, options);
    std::string data;
    const Json site = source.file ? Json{{"file", source.url}}
                                  : Json{{"manifest", "manifest.json"}, {"base", source.url}};
    return write_page(file, options, page_json(models, options, site, data), "", connect);
}

}  // namespace vog
